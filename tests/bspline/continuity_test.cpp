#include "isochor/bspline/continuity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "isochor/bspline/joins.h"
#include "isochor/bspline/refinement.h"
#include "support/cut.h"
#include "support/locks.h"
#include "support/models.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::cut_in_two;
using ::isochor::testing::locked_points;
using ::isochor::testing::shaken;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

double largest_move(const PatchModel& model, const std::vector<Vec3>& at) {
  double largest = 0.0;
  for (size_t i = 0; i < at.size(); ++i) {
    largest = std::max(largest, (at[i] - model.points[i]).norm());
  }
  return largest;
}

TEST(Continuity, SmoothJoinsStaySmooth) {
  std::mt19937 random(72);
  for (bool rational : {false, true}) {
    const KnotVector u = testing::random_clamped(random, 4, 9, 1);
    const KnotVector v = testing::random_clamped(random, 3, 3, 1);
    PatchModel model = cut_in_two(testing::random_surface(random, u, v, rational), u.interior()[4]);
    ASSERT_EQ(model.joins.size(), 1u);
    ASSERT_EQ(model.joins[0].smoothness, Smoothness::kCurvature);
    derive_locks(model, {});
    const PatchModel& locked = model;
    EXPECT_EQ(locked_points(locked, true).size(), 5u * static_cast<size_t>(v.size()));
    EXPECT_THAT(locked_points(locked, false), IsEmpty());
    EXPECT_THAT(locked.lock_reasons[0].text,
                AllOf(HasSubstr("face:1 (\"fore\") and face:2 (\"aft\") meet smoothly (G2)")));
    const auto at = shaken(locked, 0.3);
    EXPECT_GT(largest_move(locked, at), 0.1);
    const Join& join = locked.joins[0];
    const Join after = measure_join(locked, at, join.a, join.b, join.opposed);
    EXPECT_EQ(after.smoothness, Smoothness::kCurvature);
    // With the smoothness given up, the same shake makes a crease: the locks are needed.
    const Join free =
        measure_join(locked, shaken(locked, 0.3, false), join.a, join.b, join.opposed);
    EXPECT_EQ(free.smoothness, Smoothness::kSharp);
    EXPECT_LT(free.max_gap, 1e-13);
  }
}

TEST(Continuity, ACubeIsFree) {
  PatchModel model = testing::make_cube_model(3, 4);
  model.joins = find_joins(model);
  derive_locks(model, {});
  EXPECT_THAT(model.locks, IsEmpty());
  EXPECT_THAT(model.lock_reasons, IsEmpty());
  // Flat quadratic faces are curvature continuous, but their degree cannot keep that: not frozen.
  PatchModel quadratic = testing::make_cube_model(2, 4);
  quadratic.joins = find_joins(quadratic);
  derive_locks(quadratic, {});
  EXPECT_THAT(quadratic.locks, IsEmpty());
}

TEST(Continuity, PeriodicTorusIsFree) {
  PatchModel model = testing::make_periodic_torus(3, 3, 8, 9);
  model.joins = find_joins(model);
  derive_locks(model, {});
  EXPECT_THAT(model.locks, IsEmpty());
  const auto at = shaken(model, 0.02);
  for (const Join& join : model.joins) {
    EXPECT_EQ(measure_join(model, at, join.a, join.b, join.opposed).smoothness,
              Smoothness::kCurvature);
  }
}

// Converted circles: double knots that are smooth only by the accident of their poles.
TEST(Continuity, KnotLinesOfAConvertedSphereStaySmooth) {
  PatchModel sphere = testing::make_sphere(1.0);
  // The same sphere with three simple knots in every span, as points of their own.
  const Surface coarse = sphere.surface(0);
  const Surface fine =
      refine(coarse, refined_to_spans(coarse.u_knots(), 16), refined_to_spans(coarse.v_knots(), 8));
  PatchModel model;
  model.points = fine.poles();
  Patch patch{"", "face:1", fine.u_knots(), fine.v_knots(), {}, fine.weights(), false, {}, {}};
  for (size_t i = 0; i < fine.poles().size(); ++i) patch.points.push_back(static_cast<int>(i));
  for (size_t i = 0; i < model.points.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      if ((model.points[i] - model.points[j]).norm() < 1e-9) {
        model.ties.emplace_back(j, i);
        break;
      }
    }
  }
  model.patches.push_back(patch);
  model.joins = find_joins(model);
  ASSERT_EQ(model.joins.size(), 1u);
  derive_locks(model, {});

  const auto at = shaken(model, 0.05);
  EXPECT_GT(largest_move(model, at), 0.01) << "some freedom is left between the knot lines";
  const Surface after = model.surface(0, at);
  for (Direction direction : {Direction::kU, Direction::kV}) {
    const auto before_lines = interior_smoothness(fine, direction, 3.0);
    const auto after_lines = interior_smoothness(after, direction, 3.0);
    for (size_t i = 0; i < before_lines.size(); ++i) {
      if (before_lines[i].multiplicity < 2) continue;
      EXPECT_EQ(before_lines[i].measured, Smoothness::kCurvature);
      // Quadratic: tangents are protected, curvature cannot be.
      EXPECT_GE(after_lines[i].measured, Smoothness::kTangent) << after_lines[i].max_angle_rad;
    }
  }
  const Join seam = measure_join(model, at, model.joins[0].a, model.joins[0].b, false);
  EXPECT_EQ(seam.smoothness, Smoothness::kCurvature);
  for (Side side : kSides) {
    const PoleSide pole = pole_side(after, side, 3.0);
    if (pole_side(fine, side, 3.0).collapsed) {
      EXPECT_TRUE(pole.collapsed);
      EXPECT_EQ(pole.smoothness, Smoothness::kTangent);
    }
  }
  std::string all;
  for (const LockReason& reason : model.lock_reasons) {
    EXPECT_TRUE(reason.continuity) << reason.text;
    all += reason.text + "\n";
  }
  EXPECT_THAT(all, AllOf(HasSubstr("inner knot lines of u"), HasSubstr("inner knot lines of v"),
                         HasSubstr("is one point with a tangent plane"), HasSubstr("at its seam")));
}

TEST(Continuity, FunctionsRoughAtAKnotDoNotVanishThere) {
  std::mt19937 random(73);
  for (int degree : {1, 2, 3, 5}) {
    const KnotVector knots = testing::random_clamped(random, degree, 5);
    for (double knot : knots.breaks()) {
      if (knot == knots.begin() || knot == knots.end()) continue;
      for (int order = 0; order <= std::min(2, degree - 1); ++order) {
        const auto rough = functions_rough_at(knots, knot, order);
        const int span = knots.span_of(knot);
        int below = span;
        while (!(knots[below] < knots[below + 1] && knots[below + 1] == knot)) --below;
        std::set<int> nonzero;
        for (int side : {span, below}) {
          const BasisValues b = evaluate_basis_on_span(knots, side, knot, order);
          for (int r = 0; r <= order; ++r) {
            for (int j = 0; j <= degree; ++j) {
              if (std::abs(b.value(r, j)) > 1e-9) nonzero.insert(b.first + j);
            }
          }
        }
        // A superset of those that do not vanish would be safe; it is that set or, at simple
        // knots where all functions are smooth enough, empty.
        if (order > degree - knots.multiplicity(knot)) {
          EXPECT_THAT(rough, ::testing::ElementsAreArray(nonzero)) << degree << ' ' << order;
        } else {
          EXPECT_THAT(rough, IsEmpty());
        }
      }
    }
  }
}

TEST(Continuity, BoundaryRowsAreTheFunctionsThatDoNotVanish) {
  std::mt19937 random(74);
  const KnotVector partly(3, {-2, 0, 0, 0, 1, 2, 3, 3.5, 4, 5, 6});  // triple, then simple
  for (const KnotVector& knots :
       {testing::random_clamped(random, 4), partly, testing::random_unclamped(random, 3)}) {
    for (int order = 0; order <= 2; ++order) {
      for (bool begin : {true, false}) {
        const int span = begin ? knots.spans().front() : knots.spans().back();
        const BasisValues b =
            evaluate_basis_on_span(knots, span, begin ? knots.begin() : knots.end(), order);
        int rows = 0;
        for (int j = 0; j <= knots.degree(); ++j) {
          for (int r = 0; r <= order; ++r) {
            const int row = begin ? b.first + j : knots.size() - 1 - b.first - j;
            if (std::abs(b.value(r, j)) > 1e-12) rows = std::max(rows, row + 1);
          }
        }
        EXPECT_EQ(boundary_rows(knots, begin, order), rows) << knots.degree() << ' ' << order;
      }
    }
  }
}

TEST(Continuity, LockedSidesAndMismatchesHaveTheirReasons) {
  std::mt19937 random(75);
  const KnotVector knots = KnotVector::uniform(3, 5);
  const Surface surface = testing::random_surface(random, knots, knots, false);
  const Surface finer = refine(surface, knots, refined_to_spans(knots, 7));
  PatchModel model = testing::make_separate_model({surface, finer});
  model.patches[0].name = "hull";
  model.joins = {measure_join(model, {0, Side::kUEnd}, {1, Side::kUEnd}, false)};
  model.locked_sides = {{{0, Side::kVBegin},
                         "shares an edge with face:5 (plane), which is not edited",
                         Smoothness::kTangent}};
  derive_locks(model, {});
  ASSERT_EQ(model.lock_reasons.size(), 4u);
  EXPECT_EQ(model.lock_reasons[0].text,
            "face:1 (\"hull\") shares an edge with face:5 (plane), which is not edited");
  EXPECT_FALSE(model.lock_reasons[0].continuity);
  EXPECT_THAT(model.lock_reasons[1].text, HasSubstr("they meet smoothly (G1)"));
  EXPECT_TRUE(model.lock_reasons[1].continuity);
  EXPECT_EQ(model.lock_reasons[2].text,
            "face:1 (\"hull\") and face:2 share an edge whose poles do not correspond (8 poles "
            "against 13)");
  EXPECT_FALSE(model.lock_reasons[2].continuity);
  EXPECT_TRUE(model.lock_reasons[3].continuity);
  // Positions only: row v0 of face 1, rows u1 of both.
  EXPECT_EQ(locked_points(model, false).size(), 8u + 8u - 1u + 13u);

  const auto locks = model.locks.size();
  const auto reasons = model.lock_reasons.size();
  derive_locks(model, {});
  EXPECT_EQ(model.locks.size(), locks);
  EXPECT_EQ(model.lock_reasons.size(), reasons);
}

TEST(Continuity, TrimmedPolesStay) {
  PatchModel model = testing::make_cube_model(3, 8);
  model.joins = find_joins(model);
  model.patches[0].trim.loops = {{{0, 0}, {0.4, 0}, {0.4, 1}, {0, 1}}};
  model.patches[0].trim.boundary = {{0.4, 0.4, 0.0, 1.0}};
  derive_locks(model, {});
  std::set<std::string> texts;
  for (const LockReason& reason : model.lock_reasons) {
    EXPECT_FALSE(reason.continuity);
    texts.insert(reason.text);
  }
  EXPECT_EQ(texts.size(), 2u);
  EXPECT_THAT(*texts.begin(), HasSubstr("is trimmed: this pole"));
  const auto at = shaken(model, 0.2);
  const Surface before = model.surface(0);
  const Surface after = model.surface(0, at);
  for (double v : {0.0, 0.3, 1.0}) {
    EXPECT_EQ(before.point(0.4, v), after.point(0.4, v));
    EXPECT_EQ(before.point(0.7, v), after.point(0.7, v));
  }
  EXPECT_GT((before.point(0.1, 0.5) - after.point(0.1, 0.5)).norm(), 1e-3);
}

TEST(Continuity, UntiedPoleSidesAreHeld) {
  const PatchModel sphere = testing::make_sphere(1.0);
  PatchModel model = sphere;
  // Give every pole a point of its own: nothing is tied any more.
  Patch& patch = model.patches[0];
  model.points.clear();
  for (int& id : patch.points) {
    model.points.push_back(sphere.points[static_cast<size_t>(id)]);
    id = static_cast<int>(model.points.size()) - 1;
  }
  model.joins.clear();
  derive_locks(model, {});
  std::string all;
  for (const LockReason& reason : model.lock_reasons) all += reason.text + "\n";
  EXPECT_THAT(all, HasSubstr("is one point, but its poles are not tied to each other"));
}

}  // namespace
}  // namespace isochor
