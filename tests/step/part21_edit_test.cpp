#include "isochor/step/part21_edit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "isochor/base/error.h"
#include "isochor/step/part21_references.h"

namespace isochor::internal {
namespace {

std::string with_data(const std::string& data, const std::string& after = "ENDSEC;\n") {
  return "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n" + data + after + "END-ISO-10303-21;\n";
}

TEST(StepReal, HasAPointAndFewDigits) {
  EXPECT_EQ(step_real(0.0), "0.");
  EXPECT_EQ(step_real(-0.0), "-0.");
  EXPECT_EQ(step_real(1.0), "1.");
  EXPECT_EQ(step_real(-2.5), "-2.5");
  EXPECT_EQ(step_real(0.1), "0.1");
  EXPECT_EQ(step_real(1e-5), "1.E-5");
  EXPECT_EQ(step_real(-2.5e-7), "-2.5E-7");
  EXPECT_EQ(step_real(1e300), "1.E300");
  EXPECT_THROW((void)step_real(std::nan("")), PreconditionError);
  EXPECT_THROW((void)step_real(std::numeric_limits<double>::infinity()), PreconditionError);
}

// The reader is the judge.
TEST(StepReal, ReadsBackToTheSameBits) {
  std::mt19937_64 random(7);
  std::string list;
  std::vector<double> values = {std::numeric_limits<double>::denorm_min(),
                                std::numeric_limits<double>::max(), 1.0 / 3.0, -0.0};
  while (values.size() < 2000) {
    const std::uint64_t bits = random();
    double x = 0.0;
    std::memcpy(&x, &bits, sizeof x);
    if (std::isfinite(x)) values.push_back(x);
  }
  for (double x : values) list += (list.empty() ? "" : ",") + step_real(x);
  const Part21File file("f.step", with_data("#1=A(" + list + ");\n"));
  const auto record = file.record(file.instances()[0], "A");
  ASSERT_EQ(record.arguments.size(), values.size());
  for (size_t k = 0; k < values.size(); ++k) {
    EXPECT_TRUE(record.arguments[k].is(Part21Kind::kReal));
    EXPECT_EQ(std::memcmp(&record.arguments[k].number, &values[k], sizeof(double)), 0) << k;
  }
}

TEST(Part21Edit, WithoutChangesIsTheFile) {
  const std::string text = with_data("#1=A();\r\n/* c */ #2=B(#1) ;\n") + "tail\xFF";
  const Part21File file("f.step", text);
  const Part21Edit edit(file);
  EXPECT_TRUE(edit.empty());
  EXPECT_EQ(edit.text(), text);
}

TEST(Part21Edit, ChangesOnlyWhatWasAsked) {
  const std::string data = "#1=A('#7',#2,\n #2);\n#2=B();\n";
  const Part21File file("f.step", with_data(data));
  Part21Edit edit(file);
  const auto& instance = file.instances()[0];
  const auto record = file.record(instance, "A");
  EXPECT_EQ(edit.append(instance, "C(1.)"), 3u);
  EXPECT_EQ(edit.append(instance, "D(#3)"), 4u);
  edit.repoint(instance, record.arguments[1], 3);
  edit.repoint(instance, record.arguments[2], 2);  // as it is
  EXPECT_EQ(edit.text(), with_data("#1=A('#7',#3,\n #2);\n#2=B();\n#3=C(1.);\n#4=D(#3);\n"));
  EXPECT_EQ(edit.lines_appended(), 2);
  EXPECT_EQ(edit.lines_changed(), 1);
  edit.repoint(instance, record.arguments[1], 4);  // the last word counts
  EXPECT_EQ(edit.text(), with_data("#1=A('#7',#4,\n #2);\n#2=B();\n#3=C(1.);\n#4=D(#3);\n"));
  EXPECT_EQ(edit.lines_changed(), 1);
}

TEST(Part21Edit, AppendsOneLine) {
  const Part21File file("f.step", with_data("#1=A();\n"));
  Part21Edit edit(file);
  (void)edit.append(file.instances()[0], "B((1,\r\n2),\n'it''s')");
  EXPECT_EQ(edit.text(), with_data("#1=A();\n#2=B((1,2),'it''s');\n"));
}

TEST(Part21Edit, RefusesOverlaps) {
  const Part21File file("f.step", with_data("#1=A((#2,#3));\n#2=B();\n#3=B();\n"));
  Part21Edit edit(file);
  const auto& instance = file.instances()[0];
  const auto record = file.record(instance, "A");
  const auto& list = record.arguments[0];
  edit.replace(instance, list.items[1].span, "#9");
  EXPECT_THROW(edit.replace(instance, list.span, "()"), PreconditionError);
  EXPECT_THROW(edit.replace(file.instances()[1], list.span, "()"), PreconditionError);
  EXPECT_THROW(edit.repoint(instance, list, 2), PreconditionError);
}

TEST(Part21Edit, AppendsToTheSectionOfTheNeighbour) {
  std::string text = with_data("#5=A();\n");
  text.insert(text.find("END-ISO"), "DATA('b',('S'));\n#9=B();\n  ENDSEC;\n");
  const Part21File file("f.step", text);
  Part21Edit edit(file);
  (void)edit.append(file.instances()[1], "C()");
  (void)edit.append(file.instances()[0], "D()");
  std::string expected = text;
  expected.insert(expected.find("  ENDSEC"), "#10=C();\n");
  expected.insert(expected.find("ENDSEC;\nDATA('b'"), "#11=D();\n");
  EXPECT_EQ(edit.text(), expected);
}

TEST(Part21Edit, KeepsTheLineEndingAndSharedLines) {
  const Part21File windows("f.step",
                           "ISO-10303-21;\r\nHEADER;\r\nENDSEC;\r\nDATA;\r\n#1=A();\r\nENDSEC;\r\n"
                           "END-ISO-10303-21;\r\n");
  Part21Edit edit(windows);
  (void)edit.append(windows.instances()[0], "B()");
  EXPECT_NE(edit.text().find("#1=A();\r\n#2=B();\r\nENDSEC;\r\n"), std::string::npos);
  const Part21File line("f.step", with_data("#1=A(); "));
  Part21Edit other(line);
  (void)other.append(line.instances()[0], "B()");
  EXPECT_EQ(other.text(), with_data("#1=A(); \n#2=B();\n"));
}

TEST(Part21References, ListsEveryUse) {
  const Part21File file("f.step",
                        with_data("#1=A(#2,(#3,(#2)),T(#2));\n#2=B('#2');\n#3=(C(#2)D(#1));\n"));
  const Part21References references(file);
  EXPECT_EQ(references.to(1).size(), 1u);
  EXPECT_EQ(references.to(2).size(), 4u);
  EXPECT_EQ(references.to(3).size(), 1u);
  EXPECT_EQ(references.to(4).size(), 0u);
  for (const Part21Use& use : references.to(2)) EXPECT_EQ(file.text(use.span), "#2");
  EXPECT_EQ(references.to(2).begin()->user, 0u);
}

}  // namespace
}  // namespace isochor::internal
