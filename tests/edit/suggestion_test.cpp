#include "isochor/edit/suggestion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "edit/fixtures.h"
#include "support/revolved.h"

namespace isochor {
namespace {

using testing::prepared;

TEST(Suggestion, TheEditWorksAndPullsOutwards) {
  const PatchModel cube = prepared(testing::make_cube_model(3, 8));
  const std::optional<Edit> edit = suggest_edit(cube, {});
  ASSERT_TRUE(edit.has_value());
  EditSession session(cube);
  const Certificate done = session.apply(*edit);
  EXPECT_EQ(done.outcome, Outcome::kDone) << done.reason;
  EXPECT_TRUE(done.volume.kept);
  EXPECT_NEAR(done.moves[0].got.norm(), 0.01 * diagonal(cube), 1e-12);
}

// A window in every corner of every span leaves no room until there are more knots.
TEST(Suggestion, RefinesWhenNothingIsFreeEnough) {
  PatchModel coarse = testing::make_cube_model(3, 2);
  for (const Patch& patch : coarse.patches) {
    coarse.fixed_points.emplace_back(patch.point(0, 0), "held");
    coarse.fixed_points.emplace_back(patch.point(4, 4), "held");
  }
  const std::optional<Edit> edit = suggest_edit(prepared(coarse), {});
  ASSERT_TRUE(edit.has_value());
  EXPECT_EQ(edit->refine.kind, Refine::Kind::kSpans);
}

// Bodies whose smoothness is an accident of their poles are free as they are: equations keep it.
TEST(Suggestion, ConvertedBodiesStaySmooth) {
  for (const PatchModel& body :
       {prepared(testing::make_sphere(1.0)), prepared(testing::make_rational_torus(3.0, 1.0)),
        prepared(testing::make_cylinder(1.0, 4.0))}) {
    const std::optional<Edit> edit = suggest_edit(body, {});
    ASSERT_TRUE(edit.has_value());
    EditSession session(body);
    const Certificate done = session.apply(*edit);
    ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
    EXPECT_GT(done.skin.relations, 0);
    EXPECT_LE(done.skin.change.angle_rad, 1e-12);
    EXPECT_LE(std::abs(done.volume.relative_change), 1e-13);
  }
}

// Faces of degree 1 bend at knot lines only: nothing is free between fixed corners but creases.
TEST(Suggestion, CreasesOnlyWhereTheyAreAllowed) {
  PatchModel cube = testing::make_cube_model(1, 1);
  for (const Patch& patch : cube.patches) {
    for (int point : patch.points) cube.fixed_points.emplace_back(point, "held");
  }
  cube = prepared(cube);
  SuggestionOptions options;
  options.most_spans = 12;
  EXPECT_FALSE(suggest_edit(cube, {}, options).has_value());
  options.continuity = Continuity::kC0;
  const std::optional<Edit> edit = suggest_edit(cube, {}, options);
  ASSERT_TRUE(edit.has_value());
  EXPECT_EQ(edit->continuity, Continuity::kC0);
  EditSession session(cube);
  const Certificate done = session.apply(*edit);
  EXPECT_EQ(done.outcome, Outcome::kDone) << done.reason;
  EXPECT_TRUE(done.volume.kept);
}

TEST(Suggestion, SaysWhenEverythingIsLocked) {
  PatchModel cube = prepared(testing::make_cube_model(3, 4));
  for (size_t i = 0; i < cube.points.size(); ++i) cube.lock(static_cast<int>(i), "fixed", false);
  // Locks are derived anew after refinement, so only the model as it is can be held like this.
  SuggestionOptions options;
  options.most_spans = 0;
  EXPECT_FALSE(suggest_edit(cube, {}, options).has_value());
}

// Whatever the model, what is suggested can be done as it stands, and keeps what it should keep.
TEST(Suggestion, EverySuggestionIsDone) {
  std::vector<PatchModel> models = {testing::paper_cube(), testing::bent_cube(81),
                                    testing::bent_cube(82, 3.0),
                                    prepared(testing::make_periodic_torus(3, 3, 12, 10))};
  models.push_back(testing::paper_cube());  // a window in the middle of the largest faces
  for (int q = 0; q < 6; ++q) {
    const Patch& patch = models.back().patches[static_cast<size_t>(q)];
    const int middle = patch.point(7, 7);
    models.back().fixed_points.emplace_back(middle, "a window is here");
    models.back().lock(middle, "a window is here", false);
  }
  for (size_t m = 0; m < models.size(); ++m) {
    const PatchModel& model = models[m];
    const std::optional<Edit> edit = suggest_edit(model, {});
    ASSERT_TRUE(edit.has_value()) << m;
    EditSession session(model);
    const Certificate done = session.apply(*edit);
    ASSERT_EQ(done.outcome, Outcome::kDone) << m << ": " << done.reason;
    EXPECT_TRUE(done.volume.kept) << m;
    EXPECT_NEAR(done.moves[0].got.norm(), 0.01 * diagonal(model), 1e-9) << m;
    EXPECT_LE(done.joins.angle_change_rad, 1e-6) << m << ": smooth joins stay smooth";
    for (const auto& [point, reason] : model.fixed_points) {
      const auto at = static_cast<size_t>(point);
      EXPECT_EQ(session.model().points[at], model.points[at]);
    }
  }
}

// A sharp cone that is held at its rim: the tip is the freest place, but it has no normal.
TEST(Suggestion, NotAtASharpTip) {
  PatchModel cone = testing::make_cube_model(3, 12);
  cone.patches.erase(cone.patches.begin() + 1, cone.patches.end());
  Patch& patch = cone.patches[0];
  for (int i = 0; i < patch.u_size(); ++i) {
    for (int j = 0; j < patch.v_size(); ++j) {
      Vec3& p = cone.points[static_cast<size_t>(patch.point(i, j))];
      p = Vec3(p.x() * std::cos(p.y()), p.x() * std::sin(p.y()), -p.x());
      if (i >= 6) cone.fixed_points.emplace_back(patch.point(i, j), "held");
    }
  }
  for (int j = 0; j < patch.v_size(); ++j) patch.points[static_cast<size_t>(j)] = patch.point(0, 0);
  cone = prepared(cone);
  const Surroundings open{false, "three free edges", 0.0, 0.0};
  SuggestionOptions options;
  options.most_spans = 0;
  const std::optional<Edit> edit = suggest_edit(cone, open, options);
  ASSERT_TRUE(edit.has_value());
  EXPECT_NEAR(edit->moves[0].vector.norm(), 0.01 * diagonal(cone), 1e-12);
}

TEST(Suggestion, PullsOutwardsWhateverTheOrientation) {
  PatchModel model = testing::paper_cube();
  const Vec3 centre = Vec3::Constant(0.5);
  for (bool reversed : {false, true}) {
    for (Patch& patch : model.patches) patch.reversed = reversed;
    const std::optional<Edit> edit = suggest_edit(model, {});
    ASSERT_TRUE(edit.has_value());
    EditSession session(model);
    const Certificate done = session.apply(*edit);
    ASSERT_EQ(done.outcome, Outcome::kDone);
    const double outwards = done.moves[0].got.dot(done.moves[0].from - centre);
    EXPECT_GT(reversed ? -outwards : outwards, 0.0) << "outwards is where the normal points";
  }
}

TEST(Suggestion, OpenModelsGetAFreeVolume) {
  PatchModel sheet = testing::make_cube_model(3, 12);
  sheet.patches.erase(sheet.patches.begin() + 1, sheet.patches.end());
  const Surroundings open{false, "four free edges", 0.0, 0.0};
  const std::optional<Edit> edit = suggest_edit(prepared(sheet), open);
  ASSERT_TRUE(edit.has_value());
  EXPECT_EQ(edit->volume.kind, VolumeGoal::Kind::kFree);
  EditSession session(prepared(sheet), open);
  EXPECT_EQ(session.apply(*edit).outcome, Outcome::kDone);
}

TEST(Suggestion, OptionsAreObeyed) {
  SuggestionOptions options;
  options.relative_pull = 0.05;
  options.enough_rings = 5;
  const PatchModel cube = testing::paper_cube();
  const std::optional<Edit> edit = suggest_edit(cube, {}, options);
  ASSERT_TRUE(edit.has_value());
  EXPECT_NEAR(edit->moves[0].vector.norm(), 0.05 * diagonal(cube), 1e-14);
  EXPECT_GE(edit->extent.rings, 5);
  EXPECT_FALSE(suggest_edit(PatchModel{}, {}).has_value()) << "nothing to edit";
}

}  // namespace
}  // namespace isochor
