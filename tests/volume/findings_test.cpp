#include "isochor/volume/findings.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "isochor/bspline/joins.h"
#include "support/models.h"

namespace isochor {
namespace {

using testing::make_cube_model;

std::vector<Finding> of_kind(const std::vector<Finding>& all, const std::string& kind) {
  std::vector<Finding> found;
  std::copy_if(all.begin(), all.end(), std::back_inserter(found),
               [&](const Finding& f) { return f.kind == kind; });
  return found;
}

CheckedModel sound_cube() {
  PatchModel cube = make_cube_model(3, 2);
  cube.joins = find_joins(cube);
  CheckedModel model = checked(cube);
  model.volume = 1.0;
  return model;
}

TEST(Findings, SoundModelHasNoFault) {
  const CheckedModel model = sound_cube();
  EXPECT_TRUE(model.closed);
  EXPECT_EQ(model.edges.size(), 12u);
  EXPECT_TRUE(findings_of(model).empty());
}

TEST(Findings, FreeEdgesAreFaultsUnlessPlanesCloseThem) {
  PatchModel open = make_cube_model(3, 2);
  open.patches.erase(open.patches.begin() + 1);  // "bottom"
  open.joins = find_joins(open);
  CheckedModel model = checked(open);
  model.why_open = "four sides";
  const auto found = findings_of(model);
  ASSERT_EQ(of_kind(found, "free edge").size(), 4u);
  EXPECT_TRUE(of_kind(found, "open").empty()) << "the edges say it";
  for (const Finding& f : of_kind(found, "free edge")) {
    EXPECT_EQ(f.severity, Severity::kFault);
    ASSERT_TRUE(f.at.has_value());
    EXPECT_NEAR(f.at->z(), 0.0, 1e-12);
    EXPECT_EQ(model.edges[static_cast<size_t>(f.edge)].uses, 1);
  }
  model.closed = true;
  model.volume = 1.0;
  EXPECT_TRUE(findings_of(model).empty());
}

TEST(Findings, NameEntitiesOfTheFile) {
  CheckedModel model = sound_cube();
  model.closed = false;
  model.defects = {"face:2: edge: invalid curve on surface", "face:20: not there"};
  model.faces[0].entity = "#10";
  model.faces[1].entity = "#11";
  model.edges[3].uses = 1;
  model.edges[3].entity = "#77";
  model.edges[3].faces = {0, 1};
  model.edges[4].uses = 1;
  model.edges[4].faces = {1, 2};
  const auto found = findings_of(model);
  const auto free = of_kind(found, "free edge");
  ASSERT_EQ(free.size(), 2u);
  EXPECT_EQ(free[0].entity, "#77");
  EXPECT_EQ(free[0].face_entities, (std::vector<std::string>{"#10", "#11"}));
  EXPECT_NE(free[0].text.find(" [#77; faces #10, #11]"), std::string::npos) << free[0].text;
  EXPECT_NE(free[1].text.find(" [face #11]"), std::string::npos) << "the other has no number";
  const auto invalid = of_kind(found, "invalid");
  ASSERT_EQ(invalid.size(), 2u);
  EXPECT_EQ(invalid[0].entity, "#11");
  EXPECT_EQ(invalid[1].entity, "") << invalid[1].text;
  EXPECT_EQ(invalid[1].text, "face:20: not there");
}

TEST(Findings, FacesThatCutThroughEachOtherAreFaultsOfABody) {
  CheckedModel model = sound_cube();
  model.faces[0].entity = "#10";
  model.faces[1].entity = "#11";
  model.crossings = {{0, 1, Vec3(1, 2, 3), 0.5, 1e-6, true},
                     {1, 2, Vec3(0, 0, 1), 0.1, 1e-6, false}};
  const auto found = of_kind(findings_of(model), "self-intersection");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].severity, Severity::kFault);
  EXPECT_EQ(found[0].at, Vec3(1, 2, 3));
  EXPECT_EQ(found[0].face_entities, (std::vector<std::string>{"#10", "#11"}));
  EXPECT_EQ(found[0].place, model.faces[0].label + " and " + model.faces[1].label);
  EXPECT_GT(*found[0].value, *found[0].limit);
  EXPECT_NE(found[0].text.find("cut through each other at (1 2 3) by 0.5"), std::string::npos)
      << found[0].text;
  EXPECT_EQ(found[1].severity, Severity::kWarning) << "two solids may be meant to overlap";
  EXPECT_NE(found[1].text.find("of two solids [face #11]"), std::string::npos) << found[1].text;
}

TEST(Findings, WhatAReaderDidIsNoFaultWhatItLostIs) {
  CheckedModel model = sound_cube();
  model.import_warnings = {"sewn within 1e-06"};
  const auto warned = findings_of(model);
  ASSERT_EQ(warned.size(), 1u);
  EXPECT_EQ(warned[0].kind, "import");
  EXPECT_EQ(warned[0].severity, Severity::kWarning);
  EXPECT_EQ(warned[0].text, "sewn within 1e-06");
  model.import_faults = {"face lost"};
  const auto found = findings_of(model);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].severity, Severity::kFault);
}

TEST(Findings, ValuesAreBeyondTheirLimits) {
  CheckedModel model = sound_cube();
  model.volume = -1.0;
  model.defects = {"face:2: edge: invalid curve on surface"};
  for (CheckedEdge& edge : model.edges) edge.tolerance = 1e-6;
  model.edges[0].gap = 2e-6;
  model.edges[1].length = 3e-6;
  model.edges[2].tolerance = 1e-3;
  model.edges[3].smoothness = Smoothness::kAlmost;
  model.edges[3].angle_deg = 2.0;
  model.edges[4].uses = 3;
  model.edges[5].angle_deg = 179.0;
  model.faces[1] = {"face:2", 1e-7, 1.0, 1e-6, ""};
  const auto found = findings_of(model);
  for (const char* kind : {"invalid", "orientation", "gap", "tiny edge", "tiny face",
                           "large tolerance", "almost smooth", "multiple edge", "fold"}) {
    EXPECT_EQ(of_kind(found, kind).size(), 1u) << kind;
  }
  EXPECT_EQ(found.size(), 9u);
  for (const Finding& f : found) {
    EXPECT_FALSE(f.text.empty());
    EXPECT_EQ(f.value.has_value(), f.limit.has_value()) << f.kind;
    if (f.value) {
      EXPECT_GT(*f.value, *f.limit) << f.kind;
    }
  }
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end(), [](const Finding& a, const Finding& b) {
    return a.severity > b.severity;
  }));
  EXPECT_EQ(of_kind(found, "invalid")[0].place, "face:2");
}

TEST(Findings, HistogramCountsEachEdgeBetweenTwoFacesOnce) {
  CheckedModel model = sound_cube();
  model.edges[0].angle_deg = 0.0;
  model.edges[1].angle_deg = 2.0;
  model.edges[2].uses = 1;
  int sum = 0;
  const auto bins = angle_histogram(model);
  for (const AngleBin& bin : bins) sum += bin.edges;
  EXPECT_EQ(sum, 11);
  EXPECT_EQ(bins.front().edges, 1);
  EXPECT_EQ(bins[3].edges, 1);
}

}  // namespace
}  // namespace isochor
