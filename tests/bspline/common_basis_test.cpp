#include "isochor/bspline/common_basis.h"

#include <gtest/gtest.h>

#include <cmath>

#include "isochor/base/error.h"
#include "isochor/bspline/exact_basis.h"
#include "isochor/bspline/joins.h"
#include "support/different_bases.h"
#include "support/smooth_rows.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::CoarseSpace;
using ::isochor::testing::exact_rank;
using ::isochor::testing::finest_knots;
using ::isochor::testing::joined;
using ::isochor::testing::junction;
using ::isochor::testing::make_separate_model;
using ::isochor::testing::pair_of;
using ::isochor::testing::sheet;

// sum_j c_j b_j(t), exactly.
Rational value(const KnotVector& knots, const std::vector<Rational>& c, double t) {
  const ExactBasisValues basis = evaluate_exact_basis(knots, t);
  Rational sum;
  for (size_t k = 0; k < basis.values.size(); ++k) {
    sum += basis.values[k] * c[static_cast<size_t>(basis.first) + k];
  }
  return sum;
}

// Law (2) for one side: knots and samples are dyadic, so doubles hold every number.
void expect_same_curve(const CommonSide& side, const CommonBasis& basis, int s) {
  std::vector<double> rounded;
  for (const Rational& x : basis.knots()) {
    rounded.push_back(x.to_double());
    ASSERT_EQ(Rational(rounded.back()), x);
  }
  const KnotVector common(basis.degree(), rounded);
  ASSERT_EQ(common.size(), basis.size());
  std::vector<Rational> own;
  for (int j = 0; j < side.knots.size(); ++j) own.emplace_back((7 * j * j) % 11 - 4);
  const ExactMap map = basis.map(s);
  std::vector<Rational> refined;
  for (const ExactMapRow& row : map) {
    Rational sum, total;
    for (size_t k = 0; k < row.coefficients.size(); ++k) {
      sum += row.coefficients[k] * own[static_cast<size_t>(row.first) + k];
      total += row.coefficients[k];
    }
    EXPECT_EQ(total, Rational(1));
    refined.push_back(sum);
  }
  const double from = side.part.whole() ? side.fine.begin() : side.part.from;
  const double to = side.part.whole() ? side.fine.end() : side.part.to;
  for (int k = 0; k <= 32; ++k) {
    const double x = k / 32.0;
    const double t = from + (side.flipped ? 1.0 - x : x) * (to - from);
    EXPECT_EQ(value(common, refined, x), value(side.knots, own, t)) << k;
  }
}

void expect_laws(const CommonSide& a, const CommonSide& b) {
  const CommonBasis basis(a, b);
  expect_same_curve(a, basis, 0);
  expect_same_curve(b, basis, 1);
}

CommonSide whole(const KnotVector& knots, bool flipped = false) {
  return {knots, knots, {}, flipped};
}

TEST(CommonBasis, HoldsBothCurvesExactly) {
  const KnotVector cubic(3, {0, 0, 0, 0, 0.5, 1, 1, 1, 1});
  const KnotVector quadratic(2, {0, 0, 0, 0.25, 0.75, 0.75, 1, 1, 1});
  const KnotVector rescaled(3, {4, 4, 4, 4, 5, 6, 10, 12, 12, 12, 12});
  const KnotVector unclamped(2, {-0.5, -0.25, 0, 0.25, 0.5, 1, 1.5, 2});
  const KnotVector high = KnotVector::uniform(9, 2);
  expect_laws(whole(cubic), whole(quadratic));
  expect_laws(whole(cubic), whole(quadratic, true));
  expect_laws(whole(rescaled), whole(cubic, true));
  expect_laws(whole(unclamped), whole(cubic));
  expect_laws(whole(high), whole(quadratic));
  expect_laws(whole(KnotVector::uniform(1, 4)), whole(high, true));
}

TEST(CommonBasis, CutsOutParts) {
  const KnotVector longer(3, {0, 0, 0, 0, 0.5, 0.5, 1.25, 2, 2, 2, 2});
  const KnotVector shorter(2, {0, 0, 0, 0.5, 1, 1, 1});
  for (const SidePart& part : {SidePart{0.0, 0.5}, {0.5, 2.0}, {0.375, 1.375}, {1.25, 1.5}}) {
    expect_laws({longer, longer, part, false}, whole(shorter, true));
    expect_laws({longer, longer, part, true}, {shorter, shorter, {0.25, 0.75}, false});
  }
}

TEST(CommonBasis, IsTheCoarsestThatHoldsBoth) {
  const CommonBasis basis(whole(KnotVector(3, {0, 0, 0, 0, 0.5, 1, 1, 1, 1})),
                          whole(KnotVector(2, {0, 0, 0, 0.5, 0.75, 1, 1, 1})));
  std::vector<double> knots;
  for (const Rational& x : basis.knots()) knots.push_back(x.to_double());
  EXPECT_EQ(knots, (std::vector<double>{0, 0, 0, 0, 0.5, 0.5, 0.75, 0.75, 1, 1, 1, 1}));
}

TEST(CommonBasis, SameKnotsGiveUnitRowsAlsoWhenRounded) {
  const KnotVector a(3, {0, 0, 0, 0, 1.0 / 3.0, 1, 1, 1, 1});
  const KnotVector b(3, {1, 1, 1, 1, 1.6666666666667, 2, 2, 2, 2});
  const CommonBasis basis(whole(a), whole(b, true));
  EXPECT_EQ(basis.size(), 5);
  for (int s : {0, 1}) {
    const ExactMap map = basis.map(s);
    for (int i = 0; i < 5; ++i) {
      EXPECT_EQ(map[static_cast<size_t>(i)].first, s == 0 ? i : 4 - i);
      ASSERT_EQ(map[static_cast<size_t>(i)].coefficients.size(), 1u);
      EXPECT_EQ(map[static_cast<size_t>(i)].coefficients[0], Rational(1));
    }
  }
  EXPECT_THROW(basis.map(2), PreconditionError);
  EXPECT_THROW(CommonBasis({a, a, {0.75, 0.25}, false}, whole(b)), PreconditionError);
}

// The gap between the curves at equal y, sampled on the surfaces, relative to how far they moved;
// the angle between the normals there.
struct Meeting {
  double gap = 0.0, angle = 0.0;
};
Meeting meeting_of(const PatchModel& model, const std::vector<Vec3>& at) {
  Meeting worst;
  for (const Join& join : model.joins) {
    const Surface a = model.surface(0, at);
    const Surface b = model.surface(join.b.patch, at);
    const double from = join.part_a.whole() ? 0.0 : join.part_a.from;
    const double to = join.part_a.whole() ? 1.0 : join.part_a.to;
    for (int k = 0; k <= 200; ++k) {
      const double x = k / 200.0;
      const KnotVector& v = b.v_knots();
      const double there = v.begin() + (join.opposed ? 1.0 - x : x) * (v.end() - v.begin());
      const SurfaceDerivatives da = a.derivatives(a.u_knots().end(), from + x * (to - from), 1);
      const SurfaceDerivatives db = b.derivatives(b.u_knots().begin(), there, 1);
      worst.gap = std::max(worst.gap, (da.s - db.s).norm());
      const Vec3 na = da.su.cross(da.sv).normalized();
      const Vec3 nb = (join.opposed ? -1.0 : 1.0) * db.su.cross(db.sv).normalized();
      worst.angle = std::max(worst.angle, na.cross(nb).norm());
    }
  }
  return worst;
}

// Returns how many coefficients the rows leave free.
int expect_edge_kept(PatchModel model, bool smooth) {
  for (const Join& join : model.joins) {
    EXPECT_TRUE(join.common) << join.mismatch;
    EXPECT_LT(join.max_gap, 1e-14);
    EXPECT_GE(join.smoothness, Smoothness::kTangent);
    if (!smooth) const_cast<Join&>(join).smoothness = Smoothness::kSharp;
  }
  const auto relations = smooth_relations(model);
  EXPECT_EQ(relations.size(), model.joins.size() * (smooth ? 2 : 1));
  for (const SmoothRelation& relation : relations) {
    EXPECT_EQ(relation.kind == SmoothRelation::Kind::kTie, relation.order == 0);
  }
  const ContinuityRows rows = continuity_rows(model, relations, finest_knots(model));
  EXPECT_TRUE(rows.inexpressible.empty());
  for (const ContinuityRow& row : rows.rows) {
    Rational sum;
    for (const GridTerm& term : row.terms) sum += term.value;
    EXPECT_EQ(sum, Rational(0));
  }
  const CoarseSpace space(model, finest_knots(model));
  const auto equations = space.rows_of(rows.rows);
  const std::vector<Vec3> moved = space.moved(space.random_solution(equations, 0.1));
  const Meeting before = meeting_of(model, model.points);
  const Meeting after = meeting_of(model, moved);
  EXPECT_LT(before.gap, 1e-14);
  EXPECT_LT(after.gap, 1e-14);
  if (smooth) {
    EXPECT_LT(after.angle, before.angle + 1e-12);
  }
  const Meeting torn = meeting_of(model, space.moved(space.random_solution({}, 0.1)));
  EXPECT_GT(torn.gap, 1e-3);
  const int rank = exact_rank(equations);
  derive_locks(model);
  EXPECT_TRUE(model.locks.empty());
  return space.size() - rank;
}

TEST(CommonJoins, KeepTheEdgeWhateverTheKnots) {
  const KnotVector half = KnotVector::uniform(3, 2);
  const KnotVector third(3, {0, 0, 0, 0, 1.0 / 3.0, 1, 1, 1, 1});
  const KnotVector quadratic = KnotVector::uniform(2, 2, 3, 10);
  const KnotVector fine = KnotVector::uniform(3, 4, -1, 1);
  const int across = 2 * 5;
  for (bool opposed : {false, true}) {
    // Only cubic polynomials are in both bases: 4 coefficients along the edge.
    EXPECT_EQ(expect_edge_kept(pair_of(half, third, opposed), false), across * 5 - 10 + 4);
    // C1 quadratics with a knot at 1/2 are in both after elevation only as single quadratics
    // joined C2: 3 coefficients.
    EXPECT_EQ(expect_edge_kept(pair_of(half, quadratic, opposed), false),
              5 * 5 + 5 * 4 - 5 - 4 + 3);
    // Subset: as free as the coarser side.
    EXPECT_EQ(expect_edge_kept(pair_of(half, fine, opposed), false), 5 * 5 + 5 * 7 - 5 - 7 + 5);
  }
}

TEST(CommonJoins, KeepTangentsWhateverTheKnots) {
  for (bool opposed : {false, true}) {
    PatchModel model = pair_of(KnotVector::uniform(3, 2), KnotVector::uniform(3, 3), opposed);
    EXPECT_EQ(model.joins[0].smoothness, Smoothness::kCurvature);
    EXPECT_GT(expect_edge_kept(model, true), 20);
    expect_edge_kept(pair_of(KnotVector::uniform(3, 2), KnotVector::uniform(4, 2, 0, 3), opposed),
                     true);
  }
}

TEST(CommonJoins, SeveralFacesAlongOneSideKeepIt) {
  for (double at : {0.5, 1.0 / 3.0, 0.3141592653589793}) {
    EXPECT_GT(expect_edge_kept(junction(at), false), 30);
    EXPECT_GT(expect_edge_kept(junction(at), true), 10);
  }
}

TEST(CommonJoins, WeightsThatAreOneFunctionTieTheNumerators) {
  const KnotVector u = KnotVector::uniform(2, 1);
  const KnotVector coarse = KnotVector::uniform(2, 1);
  const KnotVector fine = KnotVector::uniform(2, 2);
  std::mt19937 random(8);
  const Surface arc(u, coarse, testing::random_points(random, 9),
                    {1, 0.5, 1, 1, 0.5, 1, 1, 0.5, 1});
  std::vector<Vec3> poles = arc.poles();
  for (size_t j = 0; j < 3; ++j) {
    poles[j] = arc.poles()[6 + j];
    poles[6 + j] = arc.poles()[j];
  }
  const Surface other = refine(Surface(u, coarse, poles, arc.weights()), u, fine);
  PatchModel model = make_separate_model({arc, other});
  model.joins = {joined(model, {}, 1, false)};
  ASSERT_TRUE(model.joins[0].common) << model.joins[0].mismatch;
  model.joins[0].smoothness = Smoothness::kSharp;
  const ContinuityRows rows = continuity_rows(model, smooth_relations(model), finest_knots(model));
  const CoarseSpace space(model, finest_knots(model));
  const auto equations = space.rows_of(rows.rows);
  EXPECT_EQ(exact_rank(equations), 4);
  EXPECT_LT(meeting_of(model, space.moved(space.random_solution(equations, 0.1))).gap, 1e-14);

  std::vector<double> weights = other.weights();
  weights[1] *= 1.01;
  PatchModel uneven = make_separate_model({arc, Surface(u, fine, other.poles(), weights)});
  const Join refused = joined(uneven, {}, 1, false);
  EXPECT_FALSE(refused.common);
  EXPECT_NE(refused.mismatch.find("weight"), std::string::npos) << refused.mismatch;
}

TEST(CommonJoins, OtherCurvesAreNotTied) {
  const KnotVector u = KnotVector::uniform(3, 2);
  const Surface a = sheet(u, KnotVector::uniform(3, 2), 0, 1, 0, 1);
  Surface b = sheet(u, KnotVector::uniform(3, 3), 1, 2, 0, 1);
  std::vector<Vec3> poles = b.poles();
  poles[2] += Vec3(0, 0, 1e-3);
  PatchModel model = make_separate_model({a, Surface(u, b.v_knots(), poles)});
  const Join join = joined(model, {}, 1, false);
  EXPECT_FALSE(join.common);
  EXPECT_NE(join.mismatch.find("apart"), std::string::npos) << join.mismatch;
  model.joins = {join};
  derive_locks(model);
  EXPECT_EQ(model.locks.size(), 2u * (5u + 6u));  // almost smooth: the next rows, too
}

TEST(CommonJoins, ScalesKeepTheEdgeToo) {
  const KnotVector v_a = KnotVector::uniform(3, 4);
  const KnotVector v_b = KnotVector::uniform(3, 8);
  PatchModel model = pair_of(v_a, v_b, false);
  const auto relations = smooth_relations(model);
  std::vector<CoarseKnots> coarse = finest_knots(model);
  coarse[0].v = KnotVector::uniform(3, 2);
  coarse[1].v = KnotVector::uniform(3, 4);
  const ContinuityRows rows = continuity_rows(model, relations, coarse);
  EXPECT_TRUE(rows.inexpressible.empty());
  const CoarseSpace space(model, coarse);
  const auto moved = space.moved(space.random_solution(space.rows_of(rows.rows), 0.1));
  EXPECT_LT(meeting_of(model, moved).gap, 1e-14);
  EXPECT_LT(meeting_of(model, moved).angle, 1e-12);
}

TEST(CommonJoins, AreMeasuredInTheirCommonBasis) {
  PatchModel model = junction(0.5);
  std::vector<Vec3> at = model.points;
  const Patch& small = model.patches[1];
  at[static_cast<size_t>(small.point(0, 2))] += Vec3(0, 0, 0.01);
  EXPECT_NEAR(join_gap(model, at, model.joins[0]), 0.01, 0.007);
  EXPECT_LT(join_gap(model, at, model.joins[1]), 1e-14);
  EXPECT_FALSE(closure(model).closed);
  EXPECT_TRUE(closure(model).overused_sides.empty());
}

}  // namespace
}  // namespace isochor
