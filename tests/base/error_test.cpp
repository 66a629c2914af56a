#include "isochor/base/error.h"

#include <gmock/gmock.h>

#include <limits>
#include <string>

namespace isochor {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string message_of(int numerator, int denominator) {
  try {
    ISOCHOR_REQUIRE(denominator != 0, "numerator", numerator);
  } catch (const PreconditionError& error) {
    return error.what();
  }
  return "";
}

TEST(Error, RequireIsSilentWhenItHolds) { EXPECT_EQ(message_of(1, 2), ""); }

TEST(Error, RequireNamesConditionPlaceAndValues) {
  EXPECT_THAT(message_of(7, 0), AllOf(HasSubstr("requirement failed: denominator != 0 at "),
                                      HasSubstr("error_test.cpp:"), HasSubstr("numerator 7")));
}

TEST(Error, RequireWithoutValuesEndsWithThePlace) {
  try {
    ISOCHOR_REQUIRE(1 > 2);
    FAIL() << "did not throw";
  } catch (const PreconditionError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("1 > 2"), Not(HasSubstr(" with "))));
  }
}

TEST(Error, RequirePrintsDoublesWithAllTheirDigits) {
  const double nearly_one = 1.0 - std::numeric_limits<double>::epsilon() / 2;
  try {
    ISOCHOR_REQUIRE(nearly_one == 1.0, nearly_one);
    FAIL() << "did not throw";
  } catch (const PreconditionError& error) {
    const std::string text = error.what();
    EXPECT_EQ(std::stod(text.substr(text.rfind("with ") + 5)), nearly_one);
  }
}

TEST(Error, RequireEvaluatesItsConditionOnceAndBindsLikeOneStatement) {
  int evaluations = 0;
  if (evaluations == 0)
    ISOCHOR_REQUIRE(++evaluations == 1);
  else
    FAIL() << "the else belongs to the if, not to the macro";
  EXPECT_EQ(evaluations, 1);
}

TEST(Error, InputErrorReadsFileEntityReason) {
  const InputError error("wing.step", "#12", "degree 26 exceeds 25");
  EXPECT_STREQ(error.what(), "wing.step: #12: degree 26 exceeds 25");
  EXPECT_EQ(error.file(), "wing.step");
  EXPECT_EQ(error.entity(), "#12");
  EXPECT_EQ(error.reason(), "degree 26 exceeds 25");
}

TEST(Error, InputErrorLeavesOutEmptyParts) {
  EXPECT_STREQ(InputError("", "", "empty extent").what(), "empty extent");
  EXPECT_STREQ(InputError("a.json", "", "no patches").what(), "a.json: no patches");
  EXPECT_STREQ(InputError("", "face:3", "not closed").what(), "face:3: not closed");
}

TEST(Error, InFileFillsInOnlyAMissingName) {
  const InputError inner("", "edits[0].move[1]", "uv 1.5 is outside [0, 1]");
  EXPECT_STREQ(inner.in_file("edits.json").what(),
               "edits.json: edits[0].move[1]: uv 1.5 is outside [0, 1]");
  EXPECT_EQ(inner.in_file("edits.json").in_file("other.json").file(), "edits.json");
  EXPECT_EQ(inner.file(), "") << "the original stays as it was";
}

TEST(Error, ChannelsAreCaughtApart) {
  EXPECT_THROW(throw InputError("", "", "x"), std::runtime_error);
  EXPECT_THROW(ISOCHOR_REQUIRE(false), std::logic_error);
  const auto caught_as_input = [] {
    try {
      ISOCHOR_REQUIRE(false);
    } catch (const std::runtime_error&) {
      return true;
    } catch (const std::exception&) {
      return false;
    }
    return true;
  };
  EXPECT_FALSE(caught_as_input()) << "a bug must never look like bad input";
}

}  // namespace
}  // namespace isochor
