#include "isochor/edit/suggestion.h"

#include <gtest/gtest.h>

#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"
#include "support/models.h"

namespace isochor {
namespace {

PatchModel prepared(PatchModel model) {
  model.joins = find_joins(model);
  derive_locks(model);
  return model;
}

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

TEST(Suggestion, RefinesWhenNothingIsFreeEnough) {
  const PatchModel coarse = prepared(testing::make_sphere(1.0));
  const std::optional<Edit> edit = suggest_edit(coarse, {});
  ASSERT_TRUE(edit.has_value());
  EXPECT_EQ(edit->refine.kind, Refine::Kind::kSpans);
}

TEST(Suggestion, SaysWhenEverythingIsLocked) {
  PatchModel cube = prepared(testing::make_cube_model(3, 4));
  for (size_t i = 0; i < cube.points.size(); ++i) cube.lock(static_cast<int>(i), "fixed", false);
  // Locks are derived anew after refinement, so only the model as it is can be held like this.
  SuggestionOptions options;
  options.most_spans = 0;
  EXPECT_FALSE(suggest_edit(cube, {}, options).has_value());
}

}  // namespace
}  // namespace isochor
