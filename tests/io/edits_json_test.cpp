#include "isochor/io/edits_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "isochor/base/error.h"

namespace isochor {
namespace {

using ::testing::HasSubstr;

// The text of one edit inside a script.
std::string script_of(const std::string& keys) {
  return R"({"isochor_edits": 1, "edits": [{"metric": "coefficients")" +
         (keys.empty() ? "" : ", " + keys) + "}]}";
}

std::string error_of(const std::string& text) {
  try {
    parse_edits(text, "e.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(EditsJson, EveryKeyOfTheContract) {
  const EditScript script = parse_edits(script_of(R"(
    "name": "raise the crown", "scale": {"every": 4}, "refine": {"spans": [8, 9]},
    "extent": {"radius": "5/2"},
    "move": [{"patch": "top", "uv": [0.7, 0.8], "by": [0.2, "1/5", "0.9"]},
             {"near": [1, 2, 3], "to": [1, 2, 4], "drag": [[1, 2, 3.5]]},
             {"patch": "face:2", "pole": [3, 4], "by": [0, 0, 1]},
             {"patch": "face:2", "uv01": [0, 1], "by": [0, 0, 1]}],
    "hold": [{"patch": "top", "uv": [0.1, 0.5]}, {"symmetry": "y"}, {"edge": ["a", "b"]}],
    "continuity": "C0", "volume": {"factor": 1.5}, "method": "axis", "axis_order": "zxy",
    "open": true, "sink": {"direction": [0, 0, 1]})"),
                                        "e.json");
  ASSERT_EQ(script.edits.size(), 1u);
  const Edit& edit = script.edits[0];
  EXPECT_EQ(edit.name, "raise the crown");
  EXPECT_EQ(edit.scale.every, 4);
  EXPECT_EQ(edit.refine.spans, (std::array<int, 2>{8, 9}));
  EXPECT_EQ(edit.extent.radius, 2.5);
  ASSERT_EQ(edit.moves.size(), 4u);
  EXPECT_EQ(edit.moves[0].vector, Vec3(0.2, 0.2, 0.9));  // exact strings and decimals agree
  EXPECT_FALSE(edit.moves[1].relative);
  EXPECT_EQ(edit.moves[1].drag[0], Vec3(1, 2, 3.5));
  EXPECT_EQ(edit.moves[2].place.kind, Place::Kind::kCoefficient);
  EXPECT_TRUE(edit.moves[3].place.normalised);
  EXPECT_EQ(edit.holds[1].axis, 1);
  EXPECT_EQ(edit.holds[2].edge[1], "b");
  EXPECT_EQ(edit.continuity, Continuity::kC0);
  EXPECT_EQ(edit.volume.kind, VolumeGoal::Kind::kFactor);
  EXPECT_EQ(edit.method, Method::kAxis);
  EXPECT_EQ(edit.axis_order, (std::array<int, 3>{2, 0, 1}));
  EXPECT_TRUE(edit.open);
  EXPECT_EQ(edit.sink.direction, Vec3(0, 0, 1));
}

TEST(EditsJson, DefaultsOfTheContract) {
  const Edit edit = parse_edits(script_of(""), "e.json").edits[0];
  EXPECT_EQ(edit.extent.kind, Extent::Kind::kRings);
  EXPECT_EQ(edit.extent.rings, 4);
  EXPECT_EQ(edit.method, Method::kIsotropic);
  EXPECT_EQ(edit.continuity, Continuity::kMeasured);
  EXPECT_EQ(edit.volume.kind, VolumeGoal::Kind::kKeep);
  EXPECT_EQ(edit.scale.kind, Scale::Kind::kFinest);
}

TEST(EditsJson, FormatThenParseIsTheSame) {
  for (const char* keys :
       {R"("extent": {"loop": {"patch": "a", "uv": [[0,0],[1,0],[0,1]]}})",
        R"("extent": {"poles": {"a": [[1,2],[3,4]]}}, "sink": {"faces": ["b"]})",
        R"("extent": {"box": {"patch": "a", "u": [0, 0.1], "v": [0.25, 1]}})",
        R"("extent": "all", "scale": {"knots": {"a": [[0.1], [0.2, 0.3]]}})",
        R"("extent": {"points": [3, 1]}, "refine": {"length": 0.1}, "volume": {"change": -2e-3})",
        R"("hold": [{"plane": {"point": [0, 0, 1], "normal": [1, 0, 0]}}], "continuity": "G1")",
        R"("hold": [{"near": [0, 0, 1], "normal": true}])", R"("refine": "auto")",
        R"("continuity": {"edges": [{"edge": ["a", "b"], "keep": "measured"}]})",
        R"("move": [{"near": [0.1, 0.2, 0.3], "to": [1, 2, 3]}], "method": "taylor")"}) {
    const std::string once = format_edits(parse_edits(script_of(keys), "e.json"));
    EXPECT_EQ(once, format_edits(parse_edits(once, "e.json"))) << keys;
  }
}

TEST(EditsJson, RefineIsAWordOrANumber) {
  const EditScript script = parse_edits(script_of(R"("refine": "auto")"), "e.json");
  EXPECT_EQ(script.edits[0].refine.kind, Refine::Kind::kAuto);
  EXPECT_THAT(format_edits(script), HasSubstr("\"refine\": \"auto\""));
  EXPECT_THAT(error_of(script_of(R"("refine": "fine")")),
              HasSubstr("edits[0].refine: expected \"auto\", found \"fine\""));
}

TEST(EditsJson, FollowersAreNamedWithATolerance) {
  const EditScript script = parse_edits(
      script_of(R"("follow": {"faces": ["canopy", "face:7"], "tolerance": 1e-5})"), "e.json");
  const Follow& follow = script.edits[0].follow;
  EXPECT_EQ(follow.faces, (std::vector<std::string>{"canopy", "face:7"}));
  EXPECT_EQ(follow.tolerance, 1e-5);
  EXPECT_EQ(parse_edits(format_edits(script), "f.json").edits[0].follow.faces, follow.faces);
  EXPECT_THAT(error_of(script_of(R"("follow": {"faces": ["canopy"]})")), HasSubstr("tolerance"));
  EXPECT_THAT(error_of(script_of(R"("follow": {"faces": [], "tolerance": 1e-5})")),
              HasSubstr("edits[0].follow.faces: the list is empty"));
  EXPECT_THAT(error_of(script_of(R"("follow": {"faces": ["a"], "tolerance": -1})")),
              HasSubstr("edits[0].follow.tolerance"));
}

TEST(EditsJson, MistakesNameThePlaceAndTheValue) {
  EXPECT_THAT(error_of(script_of(R"("exent": {"rings": 3})")),
              HasSubstr("e.json: edits[0]: unknown key \"exent\""));
  EXPECT_THAT(error_of(script_of(R"("extent": {"radus": 3})")),
              HasSubstr("edits[0].extent: unknown key \"radus\""));
  EXPECT_THAT(error_of(script_of(R"("extent": {"radius": -3})")), HasSubstr("must be positive"));
  EXPECT_THAT(error_of(script_of(R"("move": [{"patch": "a", "uv": [0, "NaN"], "by": [0,0,1]}])")),
              HasSubstr("edits[0].move[0].uv[1]"));
  EXPECT_THAT(error_of(script_of(R"("move": [{"patch": "a", "uv": [0, 1]}])")),
              HasSubstr("exactly one of \"by\""));
  EXPECT_THAT(error_of(script_of(R"("move": [{"patch": "a", "by": [0, 1, 2]}])")),
              HasSubstr("exactly one of \"uv\""));
  EXPECT_THAT(error_of(script_of(R"("method": "newton")")), HasSubstr("\"newton\""));
  EXPECT_THAT(error_of(script_of(R"("axis_order": "xxy")")), HasSubstr("order of the axes"));
  EXPECT_THAT(error_of("{\"isochor_edits\": 1, \"edits\": [}"),
              HasSubstr("e.json: not valid JSON"));
  EXPECT_THAT(error_of("{\"isochor_edits\": 1, \"edits\": [], \"edits\": []}"),
              HasSubstr("occurs twice"));
  EXPECT_THAT(error_of("{\"isochor_edits\": 7, \"edits\": []}"), HasSubstr("version 7"));
  EXPECT_THAT(error_of("{\"edits\": []}"), HasSubstr("not an isochor_edits file"));
  EXPECT_THAT(error_of("{\"isochor_edits\": 1, \"requires\": [\"warp\"], \"edits\": []}"),
              HasSubstr("requires \"warp\""));
  EXPECT_THAT(error_of(script_of(R"("move": [{"patch": "a", "uv": [0, 1e999], "by": [0,0,1]}])")),
              HasSubstr("e.json"));
}

TEST(EditsJson, ClosingPlanes) {
  const std::string planes =
      R"([{"symmetry": "y"}, {"plane": {"normal": [0, 0, 2], "offset": 5}}])";
  const std::string edit = R"({"name": "a", "metric": "coefficients"})";
  const EditScript script = parse_edits(
      R"({"isochor_edits": 1, "close": )" + planes + R"(, "edits": [)" + edit + "]}", "f");
  ASSERT_EQ(script.close.size(), 2u);
  EXPECT_TRUE(script.close[0].mirror);
  EXPECT_EQ(script.close[0].normal, Vec3::UnitY());
  EXPECT_FALSE(script.close[1].mirror);
  EXPECT_EQ(script.close[1].offset, 2.5);
  const EditScript again = parse_edits(format_edits(script), "f");
  ASSERT_EQ(again.close.size(), 2u);
  EXPECT_TRUE(again.close[0].mirror);
  EXPECT_EQ(again.close[1].offset, 2.5);
  for (const char* bad :
       {R"([{"symmetry": "w"}])", R"([{"mirror": "y"}])", R"([{"symmetry": "y", "offset": 1}])",
        R"([{"plane": {"normal": [0, 0, 0], "offset": 1}}])",
        R"([{"plane": {"normal": [0, 0, 1]}}])"}) {
    EXPECT_THROW(
        parse_edits(R"({"isochor_edits": 1, "close": )" + std::string(bad) + R"(, "edits": []})",
                    "f"),
        InputError)
        << bad;
  }
}

TEST(EditsJson, LaterFeaturesAreRefusedByName) {
  EXPECT_THAT(error_of(R"({"isochor_edits": 1, "edits": [{}]})"), HasSubstr("coefficients"));
  EXPECT_THAT(error_of(R"({"isochor_edits": 1, "edits": [{"metric": "energy"}]})"),
              HasSubstr("\"energy\" is not available in this version"));
  EXPECT_THAT(error_of(script_of(R"("scale": {"level": 1.5})")), HasSubstr("wavelet level"));
}

TEST(EditsJson, HoldsOfNormalsAndPlanesAndContinuityByEdge) {
  const Edit edit = parse_edits(script_of(R"(
    "hold": [{"patch": "a", "uv": [0, 0], "normal": true}, {"patch": "a", "uv": [0, 0], "normal": false},
             {"plane": {"point": [0, 0, 1], "normal": [0, "1/2", 0]}}],
    "continuity": {"default": "G1", "edges": [{"edge": ["a", "b"], "keep": "C0"}]})"),
                                "e.json")
                        .edits[0];
  EXPECT_EQ(edit.holds[0].kind, Hold::Kind::kNormal);
  EXPECT_EQ(edit.holds[1].kind, Hold::Kind::kPlace);
  EXPECT_EQ(edit.holds[2].kind, Hold::Kind::kPlane);
  EXPECT_EQ(edit.holds[2].plane_normal, Vec3(0, 0.5, 0));
  EXPECT_EQ(edit.continuity, Continuity::kTangent);
  ASSERT_EQ(edit.edge_continuity.size(), 1u);
  EXPECT_EQ(edit.edge_continuity[0].edge[1], "b");
  EXPECT_EQ(edit.edge_continuity[0].keep, Continuity::kC0);
  EXPECT_THAT(error_of(script_of(R"("hold": [{"plane": {}}])")),
              HasSubstr("edits[0].hold[0].plane"));
  EXPECT_THAT(error_of(script_of(R"("hold": [{"plane": {"point": [0,0,0], "normal": [0,0,0]}}])")),
              HasSubstr("the normal is zero"));
  EXPECT_THAT(error_of(script_of(R"("hold": [{"patch": "a", "pole": [0,0], "normal": true}])")),
              HasSubstr("a coefficient has no normal"));
  EXPECT_THAT(error_of(script_of(R"("continuity": "G3")")), HasSubstr("found \"G3\""));
  EXPECT_THAT(error_of(script_of(R"("continuity": {"edges": [{"edge": ["a"], "keep": "C0"}]})")),
              HasSubstr("named by its two faces"));
}

}  // namespace
}  // namespace isochor
