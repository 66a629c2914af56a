#include "isochor/io/model_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "isochor/base/error.h"
#include "isochor/bspline/joins.h"
#include "support/models.h"

namespace isochor {
namespace {

using ::testing::HasSubstr;

const char* const kBilinear = R"({"isochor_model": 1, "unit": "mm",
  "points": [[0,0,0],[1,0,0],["1/3",1,0],["0.1",1,1e-3]],
  "patches": [{"name": "sheet", "degree": [1,1], "knots": [[0,0,1,1],[0,0,1,1]],
               "poles": [[0,1],[2,3]], "weights": null, "reversed": true}]})";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string error_of(const std::string& text) {
  try {
    parse_model(text, "m.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ModelJson, ReadsTheContractsExample) {
  const PatchModel model = parse_model(kBilinear, "m.json");
  EXPECT_EQ(model.unit, "mm");
  EXPECT_EQ(model.points[2].x(), 1.0 / 3.0);
  EXPECT_EQ(model.points[3].x(), 0.1);
  ASSERT_EQ(model.patches.size(), 1u);
  EXPECT_EQ(model.patches[0].handle, "face:1");
  EXPECT_TRUE(model.patches[0].reversed);
}

TEST(ModelJson, WriteThenReadIsTheSameBits) {
  testing::RandomModelOptions options;
  options.weight_ratio = 3.0;
  PatchModel model = testing::random_closed_model(17, options);
  model.unit = "inch";
  model.ties.emplace_back(0, 0);
  const PatchModel again = parse_model(format_model(model), "m.json");
  EXPECT_EQ(again.points, model.points);
  EXPECT_EQ(again.ties, model.ties);
  EXPECT_EQ(again.unit, model.unit);
  ASSERT_EQ(again.patches.size(), model.patches.size());
  for (size_t q = 0; q < model.patches.size(); ++q) {
    EXPECT_EQ(again.patches[q].points, model.patches[q].points);
    EXPECT_EQ(again.patches[q].weights, model.patches[q].weights);
    EXPECT_EQ(again.patches[q].u_knots, model.patches[q].u_knots);
    EXPECT_EQ(again.patches[q].v_knots, model.patches[q].v_knots);
    EXPECT_EQ(again.patches[q].name, model.patches[q].name);
  }
  EXPECT_TRUE(closure(again).closed);
  EXPECT_EQ(format_model(again), format_model(model));
}

TEST(ModelJson, MistakesNameThePlaceAndTheValue) {
  const std::string good = kBilinear;
  EXPECT_THAT(error_of(replaced(good, "\"unit\"", "\"units\"")),
              HasSubstr("unknown key \"units\""));
  EXPECT_THAT(error_of(replaced(good, "[[0,1],[2,3]]", "[[0,1],[2,9]]")),
              HasSubstr("m.json: patches[0].poles[1][1]: no point 9 in the table of 4"));
  EXPECT_THAT(error_of(replaced(good, "[[0,1],[2,3]]", "[[0,1],[2]]")),
              HasSubstr("expected 2 entries"));
  EXPECT_THAT(error_of(replaced(good, "[[0,0,1,1],", "[[0,1,0,1],")),
              HasSubstr("patches[0].knots[0]: knot 2 decreases"));
  EXPECT_THAT(error_of(replaced(good, "[1,1]", "[1,99]")), HasSubstr("degree 99"));
  EXPECT_THAT(error_of(replaced(good, "null", "[[1,1],[1,-2]]")), HasSubstr("must be positive"));
  EXPECT_THAT(error_of(replaced(good, "[1,0,0]", "[1,0]")),
              HasSubstr("points[1]: expected [x, y, z]"));
  EXPECT_THAT(error_of(replaced(good, "[1,0,0]", "[1,0,null]")),
              HasSubstr("points[1][2]: expected a number"));
  EXPECT_THAT(error_of(replaced(good, "[1,0,0]", "[1,0,NaN]")),
              HasSubstr("m.json: not valid JSON"));
  EXPECT_THAT(error_of(replaced(good, "\"isochor_model\": 1", "\"isochor_model\": 2")),
              HasSubstr("version 2 is not known"));
}

}  // namespace
}  // namespace isochor
