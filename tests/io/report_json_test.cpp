#include "isochor/io/report_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "isochor/base/error.h"
#include "isochor/base/instruction_set.h"

namespace isochor {
namespace {

using ::testing::HasSubstr;

TEST(Value, PrintsJsonThatKeepsEveryBitAndTheOrderOfKeys) {
  Value value = Value::object();
  value.set("z", 0.1).set("a", Value::list().push(1).push(true).push("x\"y").push(Value()));
  EXPECT_EQ(to_json(value, -1), "{\"z\":0.1,\"a\":[1,true,\"x\\\"y\",null]}\n");
  EXPECT_EQ(to_json(Value(Vec3(1, 0.5, -2)), -1), "[1.0,0.5,-2.0]\n");
  EXPECT_EQ(to_json(Value(std::numeric_limits<double>::infinity()), -1), "null\n");
  EXPECT_THROW(Value(1).push(2), PreconditionError);
  EXPECT_THROW(Value::list().set("a", 2), PreconditionError);
}

TEST(Report, HasTheKeysOfTheContract) {
  Certificate certificate;
  certificate.name = "raise the crown";
  certificate.outcome = Outcome::kInfeasible;
  certificate.reason = "why";
  certificate.conflicting = {"move[0]", "volume"};
  certificate.locked = {{"face:1", "a trim", 3}};
  const std::string text =
      format_report({certificate}, Outcome::kInfeasible, {{"output", Value("x.step")}});
  for (const char* key : {"\"isochor_report\": 1",
                          "\"outcome\": \"infeasible\"",
                          "\"relative_change\"",
                          "\"bound\"",
                          "\"max_gap\"",
                          "\"max_angle_rad\"",
                          "\"max_curvature_jump\"",
                          "\"rank\"",
                          "\"redundant\": []",
                          "\"conflicting\"",
                          "\"freedom_left\"",
                          "\"poles\"",
                          "\"max_distance\"",
                          "\"coefficients\": 3",
                          "\"energy\"",
                          "\"timings_ms\"",
                          "\"resolved\"",
                          to_string(best_instruction_set()),
                          "\"output\": \"x.step\"",
                          "\"metric\": \"coefficients\""}) {
    EXPECT_THAT(text, HasSubstr(key));
  }
}

TEST(Report, TheFirstEditThatIsNotDoneDecides) {
  Certificate done;
  Certificate no;
  no.outcome = Outcome::kUndecided;
  EXPECT_EQ(overall_outcome({done, done}), Outcome::kDone);
  EXPECT_EQ(overall_outcome({done, no, done}), Outcome::kUndecided);
}

}  // namespace
}  // namespace isochor
