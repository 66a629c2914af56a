// Rows keep the skin smooth: displacements that fulfil them, and some that do not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"
#include "isochor/bspline/smooth_relations.h"
#include "support/cut.h"
#include "support/models.h"
#include "support/revolved.h"
#include "support/smooth_rows.h"

namespace isochor {
namespace {

using ::isochor::testing::CoarseSpace;
using ::isochor::testing::cut_in_two;
using ::isochor::testing::finest_knots;
using ::isochor::testing::freedom;
using ::isochor::testing::joined;
using ::isochor::testing::Seams;
using ::isochor::testing::seams_of;
using ::testing::IsEmpty;

// Laws (1) and (2) on one model at one scale; returns the freedom.
int expect_rows_keep_the_skin(const PatchModel& model, const std::vector<CoarseKnots>& coarse,
                              double amount) {
  const auto relations = smooth_relations(model);
  EXPECT_FALSE(relations.empty());
  const ContinuityRows rows = continuity_rows(model, relations, coarse);
  EXPECT_THAT(rows.inexpressible, IsEmpty());
  for (const ContinuityRow& row : rows.rows) {
    Rational sum;
    for (const GridTerm& term : row.terms) sum += term.value;
    EXPECT_EQ(sum, Rational(0)) << relations[static_cast<size_t>(row.relation)].text;
  }
  const CoarseSpace space(model, coarse);
  const Seams before = seams_of(model, model.points);
  const auto ties = space.ties();
  const auto solution = space.random_solution(joined(ties, space.rows_of(rows.rows)), amount);
  EXPECT_GT(solution.norm(), 0.1 * amount);
  const Seams after = seams_of(model, space.moved(solution));
  EXPECT_NEAR(after.angle, before.angle, 1e-12);
  EXPECT_NEAR(after.curvature, before.curvature, 1e-9);
  EXPECT_NEAR(after.pole, before.pole, 1e-12);
  if (!rows.rows.empty()) {
    const Seams creased = seams_of(model, space.moved(space.random_solution(ties, amount)));
    EXPECT_GT(creased.angle + creased.curvature + creased.pole, 1e-3);
  }
  return freedom(space, rows.rows);
}

TEST(ContinuityRows, TwoPatchesOfACut) {
  std::mt19937 random(72);
  const KnotVector u = testing::random_clamped(random, 4, 4, 1);
  const KnotVector v = testing::random_clamped(random, 3, 3, 1);
  const PatchModel model =
      cut_in_two(testing::random_surface(random, u, v, false), u.interior()[2]);
  // Two rows of each column across the cut are given up.
  const int free = expect_rows_keep_the_skin(model, finest_knots(model), 0.1);
  const int points = static_cast<int>(model.points.size());
  EXPECT_EQ(free, points - 2 * v.size());
  // Coarser: no interior knots left across.
  std::vector<CoarseKnots> coarse = finest_knots(model);
  for (CoarseKnots& knots : coarse) {
    knots.u = KnotVector(4, [&] {
      std::vector<double> ends(5, knots.u.begin());
      ends.insert(ends.end(), 5, knots.u.end());
      return ends;
    }());
  }
  EXPECT_EQ(expect_rows_keep_the_skin(model, coarse, 0.1), (9 - 2) * v.size());
}

TEST(ContinuityRows, RationalTorus) {
  PatchModel model = testing::make_rational_torus(2.0, 0.5);
  model.joins = find_joins(model);
  // 8 x 8 poles, 4 x 4 free: each circle of eight poles gives up one for each of its four lines.
  EXPECT_EQ(expect_rows_keep_the_skin(model, finest_knots(model), 0.05), 16);
}

}  // namespace
}  // namespace isochor
