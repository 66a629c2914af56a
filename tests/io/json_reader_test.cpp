#include "isochor/io/json_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <functional>

#include "isochor/base/error.h"
#include "isochor/io/value.h"

namespace isochor {
namespace {

using internal::Json;
using internal::JsonValue;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Lt;
using ::testing::ResultOf;

std::string error_of(const std::string& text) {
  try {
    internal::parse_json(text, "f.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

Rational rational_of(const std::string& text) {
  const Json json = internal::parse_json(text, "f.json");
  const std::string file = "f.json";
  return JsonValue(json, "here", file).rational();
}

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

TEST(JsonReader, TreeIsWhatTheLibraryBuilds) {
  const std::string text =
      R"({"b": [1, -2, 18446744073709551615, 0.5, -1e300, true, false, null, "x\u00e9\n"],)"
      R"( "a": {"z": {}, "y": [[], [[1]], {"b": 1}]}, "": ""})";
  EXPECT_EQ(internal::parse_json(text, "f"), Json::parse(text));
  EXPECT_EQ(internal::parse_json(text, "f").dump(), Json::parse(text).dump());  // order of keys
  for (const char* scalar : {"3", "\"s\"", "null", "[]", "{}", " [1] "}) {
    EXPECT_EQ(internal::parse_json(scalar, "f"), Json::parse(scalar)) << scalar;
  }
}

TEST(JsonReader, RepeatedKeysOnlyWithinOneObject) {
  EXPECT_THAT(error_of(R"({"a": {"b": 1, "b": 2}})"), HasSubstr("f.json: b: the key occurs twice"));
  EXPECT_EQ(error_of(R"([{"b": 1}, {"b": {"b": 2}}])"), "no error");
}

TEST(JsonReader, DeepNestingIsNamed) {
  const auto nested = [](size_t depth) {
    return R"({"a": )" + std::string(depth - 1, '[') + std::string(depth - 1, ']') + "}";
  };
  EXPECT_EQ(error_of(nested(64)), "no error");
  EXPECT_THAT(error_of(nested(65)), HasSubstr("f.json: a: lists and objects are nested more"));
  EXPECT_THAT(error_of(std::string(10'000'000, '[')), HasSubstr("nested"));
}

TEST(JsonReader, MessagesDoNotQuoteMegabytes) {
  for (const std::string& text :
       {std::string("{\"a\": \"") + std::string(1'000'000, 'x'), std::string(1'000'000, 'x'),
        std::string("[1"), std::string(), std::string("[1e999]"), std::string("[NaN]"),
        std::string("[1] 2"), std::string("\"\xff\"")}) {
    EXPECT_THAT(error_of(text),
                AllOf(HasSubstr("f.json: not valid JSON: "),
                      ResultOf([](const std::string& s) { return s.size(); }, Lt(350u))));
  }
}

// A text twice as long takes twice the time, not four times, in both directions.
TEST(JsonReader, ManyKeysAreLinear) {
  constexpr int kKeys = 200'000;
  std::string text = "{";
  Value value = Value::object();
  for (int i = 0; i < kKeys; ++i) {
    text += (i == 0 ? "\"k" : ",\"k") + std::to_string(i) + "\":1";
    value.set("k" + std::to_string(i), 1);
  }
  text += "}";
  // Quadratic work is 2e10 comparisons of texts: far more than a minute.
  EXPECT_LT(seconds_of([&] { EXPECT_EQ(error_of(text), "no error"); }), 10.0);
  std::string written;
  EXPECT_LT(seconds_of([&] { written = to_json(value, -1); }), 10.0);
  EXPECT_EQ(written, text + "\n");
}

TEST(JsonReader, RationalsAreExactOrTheNearestDouble) {
  EXPECT_EQ(rational_of("\"0.1\""), Rational(1, 10));
  EXPECT_EQ(rational_of("\"-3/2\""), Rational(-3, 2));
  EXPECT_EQ(rational_of("0.5"), Rational(1, 2));
  EXPECT_EQ(rational_of("0.1"), Rational(0.1));
  EXPECT_NE(rational_of("0.1"), Rational(1, 10));
  EXPECT_EQ(rational_of("9007199254740993").to_string(), "9007199254740993");  // 2^53 + 1
  EXPECT_EQ(rational_of("18446744073709551615").to_string(), "18446744073709551615");
  EXPECT_EQ(rational_of("-9223372036854775808").to_string(), "-9223372036854775808");
  for (const char* wrong : {"true", "[]", "\"x\"", "null", "\"1/0\"", "\"\"", "\"NaN\""}) {
    EXPECT_THROW(rational_of(wrong), InputError) << wrong;
  }
}

}  // namespace
}  // namespace isochor
