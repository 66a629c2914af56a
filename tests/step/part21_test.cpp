#include "isochor/step/part21.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <random>
#include <set>

#include "isochor/base/error.h"
#include "temp_folder.h"

namespace isochor::internal {
namespace {

const char* const kHead =
    "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
    "FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\n";

std::string with_data(const std::string& data) {
  return kHead + ("DATA;\n" + data) + "ENDSEC;\nEND-ISO-10303-21;\n";
}

// "line 7: reason", or "" when the text is accepted and every instance can be parsed.
std::string refusal(const std::string& text) {
  try {
    const Part21File file("f.step", text);
    for (const auto& instance : file.instances()) (void)file.records(instance);
  } catch (const InputError& e) {
    EXPECT_EQ(e.file(), "f.step");
    return e.entity() + ": " + e.reason();
  }
  return "";
}

TEST(Part21, ListsInstancesWithTheirPlaces) {
  const std::string text =
      with_data("#10=CARTESIAN_POINT('a',(1.,2.,3.));\n\n#2 = VERTEX(#10) ;\n");
  const Part21File file("f.step", text);
  ASSERT_EQ(file.instances().size(), 2u);
  const auto& point = file.instances()[0];
  EXPECT_EQ(point.number, 10u);
  EXPECT_EQ(point.keyword, "CARTESIAN_POINT");
  EXPECT_EQ(point.line, 8u);
  EXPECT_EQ(file.text(point.span), "#10=CARTESIAN_POINT('a',(1.,2.,3.));");
  EXPECT_EQ(file.text(point.body), "CARTESIAN_POINT('a',(1.,2.,3.))");
  EXPECT_EQ(file.instances()[1].line, 10u);
  EXPECT_EQ(file.largest_number(), 10u);
  EXPECT_EQ(file.find(2), &file.instances()[1]);
  EXPECT_EQ(file.find(3), nullptr);
  EXPECT_EQ(file.line_ending(), "\n");
  EXPECT_EQ(text.substr(file.sections()[0].endsec, 7), "ENDSEC;");
}

TEST(Part21, ParsesEveryKindOfValue) {
  const Part21File file(
      "f.step",
      with_data(
          "#1=X('it''s',\"0F\",-12,+1.,-1.5E-3,.TRUE.,(#7,(  )),LENGTH_MEASURE(2.5),$,*);\n"));
  const auto record = file.record(file.instances()[0], "X");
  const auto& a = record.arguments;
  ASSERT_EQ(a.size(), 10u);
  EXPECT_EQ(file.string_of(a[0]), "it's");
  EXPECT_EQ(file.text(a[0].span), "'it''s'");
  EXPECT_TRUE(a[1].is(Part21Kind::kBinary));
  EXPECT_TRUE(a[2].is(Part21Kind::kInteger));
  EXPECT_EQ(a[2].number, -12.0);
  EXPECT_TRUE(a[3].is(Part21Kind::kReal));
  EXPECT_EQ(a[3].number, 1.0);
  EXPECT_EQ(a[4].number, -1.5e-3);
  EXPECT_EQ(a[5].word, "TRUE");
  ASSERT_EQ(a[6].items.size(), 2u);
  EXPECT_EQ(a[6].items[0].reference, 7u);
  EXPECT_TRUE(a[6].items[1].items.empty());
  EXPECT_EQ(a[7].word, "LENGTH_MEASURE");
  EXPECT_EQ(a[7].items.at(0).number, 2.5);
  EXPECT_TRUE(a[8].is(Part21Kind::kOmitted));
  EXPECT_TRUE(a[9].is(Part21Kind::kDerived));
}

TEST(Part21, ReadsRealsToTheNearestDouble) {
  const Part21File file(
      "f.step", with_data("#1=R(1.,0.1,-1.E-5,1E3,123456789012345678.,4.9406564584124654E-324,"
                          "1.E-400,1.7976931348623157E+308,-0.);\n"));
  const auto record = file.record(file.instances()[0], "R");
  const double expected[] = {1.0,
                             0.1,
                             -1e-5,
                             1e3,
                             123456789012345678.0,
                             4.9406564584124654e-324,
                             0.0,
                             1.7976931348623157e308,
                             -0.0};
  for (size_t k = 0; k < record.arguments.size(); ++k) {
    EXPECT_EQ(record.arguments[k].number, expected[k]) << k;
  }
}

TEST(Part21, ReadsComplexInstances) {
  const Part21File file("f.step", with_data("#1=( A(1) /* ( */ B_2($,#1)\r\nC() );\n"));
  const auto& instance = file.instances()[0];
  EXPECT_TRUE(instance.complex());
  const auto parts = file.records(instance);
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_EQ(parts[1].keyword, "B_2");
  EXPECT_EQ(file.text(parts[1].span), "B_2($,#1)");
  EXPECT_TRUE(file.is_a(instance, "C"));
  EXPECT_FALSE(file.is_a(instance, "D"));
  EXPECT_EQ(&file.follow(instance, parts[1].arguments[1]), &instance);
}

TEST(Part21, SkipsCommentsAndTrapsInStrings) {
  const std::string text = with_data(
      "/* #5=A(); ' */#1/*(*/=/*)*/A/*;*/(/**/'/* ; #2=B() '''/***/,'\\X2\\03B1\\X0\\;')/*;*/;\n"
      "#3=B(');ENDSEC;');\n");
  const Part21File file("f.step", text);
  ASSERT_EQ(file.instances().size(), 2u);
  const auto record = file.record(file.instances()[0], "A");
  EXPECT_EQ(file.string_of(record.arguments.at(0)), "/* ; #2=B() '");
  EXPECT_EQ(file.string_of(record.arguments.at(1)), "\xCE\xB1;");
}

TEST(Part21, DecodesControlDirectives) {
  const Part21File file("f.step", with_data("#1=A('\\X\\E9\\S\\i\\\\x','\\X4\\0001F600\\X0\\!',"
                                            "'\\X2\\D83DDE00\\X0\\','C:\\temp','\\PA\\b');\n"));
  const auto record = file.record(file.instances()[0], "A");
  const char* expected[] = {"\xC3\xA9\xC3\xA9\\x", "\xF0\x9F\x98\x80!", "\xF0\x9F\x98\x80",
                            "C:\\temp", "b"};
  for (size_t k = 0; k < 5; ++k) EXPECT_EQ(file.string_of(record.arguments[k]), expected[k]) << k;
}

TEST(Part21, AllowsJunkBeforeAndAfterAndSeveralSections) {
  std::string text = "\xEF\xBB\xBFjunk\n" + with_data("#1=A();\n") + "SIGNATURE anything";
  const size_t end = text.find("END-ISO");
  text.insert(end, "DATA('second',('S'));\n#2=B(#1);\nENDSEC;\n");
  const Part21File file("f.step", text);
  ASSERT_EQ(file.sections().size(), 2u);
  EXPECT_EQ(file.instances()[0].section, 0u);
  EXPECT_EQ(file.instances()[1].section, 1u);
  EXPECT_EQ(file.instances()[0].line, 9u);
}

TEST(Part21, CountsLinesWithEveryLineEnding) {
  for (const std::string ending : {"\r\n", "\n", "\r"}) {
    std::string text;
    for (char c : with_data("#1=A();\n#2=B(\n$);\n#3=C();\n")) {
      text += c == '\n' ? ending : std::string(1, c);
    }
    const Part21File file("f.step", text);
    EXPECT_EQ(file.line_ending(), ending);
    EXPECT_EQ(file.instances()[2].line, 11u);
    EXPECT_EQ(file.line_of(file.instances()[2].span.begin), 11u);
  }
}

TEST(Part21, RefusesWithTheLine) {
  const auto data = [](const std::string& text) { return refusal(with_data(text)); };
  EXPECT_EQ(refusal("ISO-10303-2"), "line 1: is not a STEP file: 'ISO-10303-21' is missing");
  EXPECT_EQ(refusal("ISO-10303-21;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n"),
            "line 2: the HEADER section is missing");
  EXPECT_EQ(refusal("ISO-10303-21;HEADER;ENDSEC;\nEND-ISO-10303-21;"),
            "line 2: the file has no DATA section");
  EXPECT_EQ(data("#1=A('x);\n"), "line 8: a string is not closed");
  EXPECT_EQ(data("#1=A();\n/* comment\n"), "line 9: a comment is not closed");
  EXPECT_EQ(data("#1=A((1,2);\n"), "line 8: ';' inside a list: a parenthesis is not closed");
  EXPECT_EQ(data("#1=A();\n#2=B();\n#01=C();\n"), "line 10: #1 stands in line 8 already");
  EXPECT_EQ(data("#1=&SCOPE #2=A(); ENDSCOPE B();\n"), "line 8: '&SCOPE' is not supported");
  EXPECT_EQ(data("#1=A()\n#2=B();\n"), "line 9: an instance does not end with ';'");
  EXPECT_EQ(data("#=A();\n"), "line 8: '#' is not followed by a number");
  EXPECT_EQ(data("#1 A();\n"), "line 8: an instance number is not followed by '='");
  EXPECT_EQ(data("#9999999999999999999=A();\n"), "line 8: an instance number has too many digits");
  EXPECT_EQ(data("#1=A(1,,2);\n"), "line 8: a value is missing");
  EXPECT_EQ(data("#1=A(1 2);\n"), "line 8: ',' or ')' is missing");
  EXPECT_EQ(data("#1=A(.T);\n"), "line 8: an enumeration is not closed by '.'");
  EXPECT_EQ(data("#1=A(-);\n"), "line 8: a number has no digits");
  EXPECT_EQ(data("#1=A(1.E);\n"), "line 8: an exponent has no digits");
  EXPECT_EQ(data("#1=A(\n1.E999);\n"), "line 9: the number 1.E999 is too large");
  EXPECT_EQ(data("#1=(A() 5);\n"), "line 8: a keyword is missing");
  EXPECT_EQ(data("#1=A(x/y);\n"), "line 8: '(' is missing");
  EXPECT_EQ(data("stray\n"), "line 8: neither an instance (#12=...) nor ENDSEC");
  const std::string whole = with_data("#1=A();\n");
  EXPECT_EQ(refusal(whole.substr(0, whole.rfind("ENDSEC"))),
            "line 7: ENDSEC is missing: this section does not end");
  EXPECT_EQ(refusal(whole.substr(0, whole.rfind("END-ISO"))),
            "line 10: the file ends before END-ISO-10303-21");
}

TEST(Part21, RefusesReferencesToNothing) {
  const Part21File file("f.step", with_data("#1=A(\n#7,$);\n"));
  const auto record = file.record(file.instances()[0], "A");
  const auto reason = [&](size_t k) {
    try {
      (void)file.follow(file.instances()[0], record.arguments[k]);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(reason(0), "f.step: line 9: #1 refers to #7, which is not in the file");
  EXPECT_EQ(reason(1), "f.step: line 9: #1 has '$' where it should refer to an instance");
  EXPECT_THROW((void)file.record(file.instances()[0], "B"), InputError);
}

TEST(Part21, LimitsTheDepthOfLists) {
  const size_t deep = 200000;
  const auto nested = [](size_t n) {
    return with_data("#1=A" + std::string(n, '(') + std::string(n, ')') + ";\n");
  };
  EXPECT_EQ(refusal(nested(60)), "");
  EXPECT_EQ(refusal(nested(deep)), "line 8: lists are nested too deeply");
}

// Whatever happens to the bytes, the reader answers; what it accepts, it delimits without overlap.
TEST(Part21, SurvivesDamage) {
  const std::string whole = with_data(
      "#1=CARTESIAN_POINT('',(0.,-1.5E-3,2.));\n#2=(A(#1,'it''s') B((),.T.,\"0\"));/* x */\n"
      "#3=C(LENGTH_MEASURE(1.),$,*);\n");
  std::mt19937 random(20261122);
  const std::string alphabet = "#()';\"/*.,$=&E-1\\\n ";
  const auto pick = [&](size_t below) { return static_cast<size_t>(random() % below); };
  int accepted = 0;
  for (int round = 0; round < 4000; ++round) {
    std::string text = whole;
    for (size_t k = 1 + pick(3); k > 0; --k) {
      const size_t at = pick(text.size());
      const size_t kind = pick(4);
      if (kind == 0) text[at] = alphabet[pick(alphabet.size())];
      if (kind == 1) text.erase(at, 1 + pick(20));
      if (kind == 2) text.insert(at, text.substr(pick(text.size()), 1 + pick(20)));
      if (kind == 3) text[at] = static_cast<char>(text[at] ^ (1 << pick(8)));
    }
    try {
      const Part21File file("f.step", text);
      std::set<std::uint64_t> numbers;
      size_t last = 0;
      for (const auto& instance : file.instances()) {
        EXPECT_LE(last, instance.span.begin);
        EXPECT_LT(instance.span.begin, instance.body.begin);
        EXPECT_LE(instance.body.end, instance.span.end);
        last = instance.span.end;
        EXPECT_TRUE(numbers.insert(instance.number).second);
        EXPECT_EQ(file.line_of(instance.span.begin), instance.line);
      }
      for (const auto& instance : file.instances()) {
        for (const auto& part : file.records(instance)) {
          for (const auto& value : part.arguments) {
            EXPECT_LT(value.span.begin, value.span.end);
            if (value.is(Part21Kind::kString)) (void)file.string_of(value);
          }
        }
      }
      ++accepted;
    } catch (const InputError& e) {
      EXPECT_EQ(e.entity().rfind("line ", 0), 0u) << e.what();
    }
  }
  EXPECT_GT(accepted, 200);
  EXPECT_LT(accepted, 3800);
}

// Twice the bytes may take about twice the time: no worst case of hashes, lists or comments.
TEST(Part21, TakesTimeInProportion) {
  const auto seconds = [](const std::string& text) {
    const auto start = std::chrono::steady_clock::now();
    (void)refusal(text);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  std::string points, sparse;
  for (int k = 1; k <= 100000; ++k) {
    points += "#" + std::to_string(k) + "=CARTESIAN_POINT('',(1.25,-3.E-2,1.));\n";
    sparse += "#" + std::to_string((100001 - k) * 4194304L) + "=A(/**/'''');\n";
  }
  EXPECT_LT(seconds(with_data(points)), 5.0);
  EXPECT_LT(seconds(with_data(sparse)), 5.0);
  EXPECT_LT(seconds(with_data(std::string(1000000, '('))), 5.0);
  EXPECT_LT(seconds(std::string(1000000, '\'') + with_data(std::string(999999, '\''))), 5.0);
}

TEST(Part21, LoadsFiles) {
  const TempFolder folder;
  const std::string path = folder.file("a.step");
  EXPECT_THROW((void)load_part21(path), InputError);
  std::ofstream(path, std::ios::binary) << with_data("#1=A();\r\n");
  EXPECT_EQ(load_part21(path).instances().size(), 1u);
}

}  // namespace
}  // namespace isochor::internal
