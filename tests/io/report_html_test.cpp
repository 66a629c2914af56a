#include "isochor/io/report_html.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace isochor {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

HtmlReport one_edit() {
  Certificate edit;
  edit.name = "wider <b> & \"fuller\"";
  edit.volume.before = 232.879018756999;
  edit.volume.after = 232.879018756999;
  edit.volume.relative_change = 8.19e-19;
  edit.volume.bound = 2.5e-15;
  edit.moves = {{"face:1 at uv (1, 2)", Vec3::Zero(), Vec3(0, 0, 0.35), Vec3(0, 0, 0.35), 1.8e-15}};
  edit.joins.count = 3;
  edit.locked = {{"face:1", "it is trimmed", 12}};
  HtmlReport report;
  report.model = "a<b>.step";
  report.unit = "m";
  report.edits = {edit};
  report.json = "{\"isochor_report\": 1}";
  return report;
}

// Every element that is opened is closed, in order. Outside of tags, '<' is always escaped.
void expect_balanced(const std::string& page) {
  std::vector<std::string> open;
  for (size_t at = page.find('<'); at != std::string::npos; at = page.find('<', at + 1)) {
    const bool closes = page[at + 1] == '/';
    const size_t from = at + (closes ? 2 : 1);
    const std::string name = page.substr(from, page.find_first_of(" >", from) - from);
    if (name == "!DOCTYPE" || name == "meta" || name == "img") continue;
    if (!closes) {
      open.push_back(name);
      continue;
    }
    ASSERT_FALSE(open.empty()) << name;
    EXPECT_EQ(open.back(), name);
    open.pop_back();
  }
  EXPECT_TRUE(open.empty());
}

TEST(Base64, VectorsOfTheStandard) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string("\xff\xfe\x00", 3)), "//4A");
}

TEST(HtmlReport, ShowsTheNumbersOfEveryEdit) {
  const std::string page = format_html(one_edit());
  expect_balanced(page);
  for (const char* text :
       {"232.879018756999 m\u00b3", "8.19e-19, error at most 2.5e-15", "by (0, 0, 0.35) m",
        "12 coefficients of face:1: it is trimmed", "3, largest gap 0 m", "isochor_report"}) {
    EXPECT_THAT(page, HasSubstr(text));
  }
}

TEST(HtmlReport, TextsFromOutsideAreEscaped) {
  const std::string page = format_html(one_edit());
  EXPECT_THAT(page, HasSubstr("wider &lt;b&gt; &amp; &quot;fuller&quot;"));
  EXPECT_THAT(page, HasSubstr("a&lt;b&gt;.step"));
  EXPECT_THAT(page, Not(HasSubstr("<b>")));
}

TEST(HtmlReport, ARefusalSaysWhy) {
  HtmlReport report = one_edit();
  report.outcome = report.edits[0].outcome = Outcome::kInfeasible;
  report.edits[0].reason = "nothing is free < here";
  report.refusal = "the file cannot hold it";
  const std::string page = format_html(report);
  expect_balanced(page);
  EXPECT_THAT(page, HasSubstr("nothing is free &lt; here"));
  EXPECT_THAT(page, HasSubstr("the file cannot hold it"));
  EXPECT_THAT(page, HasSubstr("class=\"no\">infeasible"));
  EXPECT_THAT(page, Not(HasSubstr("volume after")));
}

TEST(HtmlReport, StandsAlone) {
  HtmlReport report = one_edit();
  report.picture_png = "picture";
  report.checks = {"valid"};
  const std::string page = format_html(report);
  expect_balanced(page);
  EXPECT_THAT(page, HasSubstr("src=\"data:image/png;base64,cGljdHVyZQ==\""));
  EXPECT_THAT(page, HasSubstr("<li>valid</li>"));
  EXPECT_THAT(page, Not(HasSubstr("http")));
  EXPECT_THAT(format_html(one_edit()), Not(HasSubstr("<img")));
}

}  // namespace
}  // namespace isochor
