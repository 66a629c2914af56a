// Rows do not depend on how patches are run through, on the unit or on the place of the model.
#include <gtest/gtest.h>

#include <utility>

#include "isochor/bspline/joins.h"
#include "isochor/bspline/smooth_relations.h"
#include "support/cut.h"
#include "support/models.h"
#include "support/revolved.h"
#include "support/smooth_rows.h"

namespace isochor {
namespace {

using ::isochor::testing::expect_rows_keep_the_skin;
using ::isochor::testing::finest_knots;

// Patch q turned (how * q) mod 8: sides of all kinds meet, also against each other.
PatchModel turned(const PatchModel& cut, int how) {
  PatchModel model = cut;
  for (size_t q = 0; q < model.patches.size(); ++q) {
    model.patches[q] = testing::reoriented(cut.patches[q], how * static_cast<int>(q) % 8);
  }
  model.joins = find_joins(model);
  return model;
}

TEST(ContinuityRowsFrames, OrientationDoesNotMatter) {
  std::mt19937 random(43);
  const KnotVector u = testing::random_clamped(random, 3, 2, 1);
  const KnotVector v = testing::random_clamped(random, 3, 2, 1);
  std::vector<Vec3> poles;
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      poles.emplace_back(u.greville(i), v.greville(j), testing::uniform(random, -0.2, 0.2));
    }
  }
  const PatchModel cut = testing::cut_apart(testing::make_separate_model({Surface(u, v, poles)}),
                                            {u.interior()[0]}, {v.interior()[1]});
  int opposed = 0;
  for (int how = 0; how < 8; ++how) {
    SCOPED_TRACE(how);
    const PatchModel model = turned(cut, how);
    ASSERT_EQ(model.joins.size(), 4u);
    for (const Join& join : model.joins) opposed += join.opposed;
    EXPECT_EQ(smooth_relations(model).size(), 4u);
    EXPECT_EQ(expect_rows_keep_the_skin(model, finest_knots(model), 0.05), u.size() * v.size());
  }
  EXPECT_GT(opposed, 5);
}

TEST(ContinuityRowsFrames, OrientationDoesNotMatterAroundAPole) {
  PatchModel sphere = testing::make_sphere(1.0);
  sphere.joins = find_joins(sphere);
  const PatchModel cut = testing::cut_apart(sphere, {1.0, 2.0, 3.0}, {});
  for (int how : {1, 3, 5, 7}) {
    SCOPED_TRACE(how);
    const PatchModel model = turned(cut, how);
    EXPECT_EQ(expect_rows_keep_the_skin(model, finest_knots(model), 0.05), 6);
  }
}

TEST(ContinuityRowsFrames, UnitAndPlaceDoNotMatter) {
  PatchModel nose = testing::make_nose(1.0, 4.0);
  nose.joins = find_joins(nose);
  const auto expected = smooth_relations(nose);
  for (const auto& [scale, shift] :
       {std::make_pair(1e9, 0.0), std::make_pair(1e-9, 0.0), std::make_pair(1.0, 1e4)}) {
    SCOPED_TRACE(scale);
    PatchModel model = nose;
    testing::transform(model, scale * Eigen::Matrix3d::Identity());
    testing::translate(model, shift * Vec3(1.0, -1.0, 0.3));
    const auto relations = smooth_relations(model);
    ASSERT_EQ(relations.size(), expected.size());
    for (size_t k = 0; k < relations.size(); ++k) {
      // Far from the origin points have fewer digits, and factors too.
      EXPECT_NEAR(relations[k].lambda.to_double(), expected[k].lambda.to_double(), 1e-10);
      EXPECT_LT(relations[k].residual, 1e-10);
    }
    const auto rows = continuity_rows(model, relations, finest_knots(model)).rows;
    EXPECT_EQ(testing::freedom(testing::CoarseSpace(model, finest_knots(model)), rows),
              3 + 3 * 4 - 4);
  }
}

}  // namespace
}  // namespace isochor
