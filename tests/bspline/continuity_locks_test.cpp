// Which rows and functions are locked: against the basis, over all small knot vectors, and on
// constructed models.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"
#include "isochor/bspline/refinement.h"
#include "support/exact_splines.h"
#include "support/locks.h"
#include "support/models.h"
#include "support/revolved.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::all_small_knots;
using ::isochor::testing::exact_basis;
using ::isochor::testing::locked_points;
using ::isochor::testing::shaken;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// The functions of which some derivative up to `order` is not zero at `t`, seen from one span.
std::set<int> nonzero_at(const KnotVector& knots, int span, double t, int order) {
  std::set<int> nonzero;
  for (int r = 0; r <= std::min(order, knots.degree()); ++r) {
    const auto values = exact_basis(knots, span, Rational(t), r);
    for (size_t j = 0; j < values.size(); ++j) {
      if (!values[j].is_zero()) nonzero.insert(span - knots.degree() + static_cast<int>(j));
    }
  }
  return nonzero;
}

TEST(ContinuityLocks, BoundaryRowsOfAllSmallVectors) {
  for (int degree : {1, 2, 3}) {
    for (int count : {2 * degree + 2, 2 * degree + 4}) {
      for (const KnotVector& knots : all_small_knots(degree, count)) {
        for (int order = 0; order <= std::min(2, degree); ++order) {
          const auto low = nonzero_at(knots, knots.spans().front(), knots.begin(), order);
          const auto high = nonzero_at(knots, knots.spans().back(), knots.end(), order);
          EXPECT_EQ(boundary_rows(knots, true, order), *low.rbegin() + 1)
              << degree << ' ' << order << ' ' << ::testing::PrintToString(knots.knots());
          EXPECT_EQ(boundary_rows(knots, false, order), knots.size() - *high.begin())
              << degree << ' ' << order << ' ' << ::testing::PrintToString(knots.knots());
        }
      }
    }
  }
}

// A function that is not rough at a knot is smooth there: no derivative up to the order is left.
TEST(ContinuityLocks, FunctionsRoughAtAKnotOfAllSmallVectors) {
  for (int degree : {1, 2, 3}) {
    for (const KnotVector& knots : all_small_knots(degree, 2 * degree + 4)) {
      for (int s = 1; s < static_cast<int>(knots.spans().size()); ++s) {
        const int above = knots.spans()[static_cast<size_t>(s)];
        const int below = knots.spans()[static_cast<size_t>(s) - 1];
        const double knot = knots[above];
        for (int order = 1; order <= degree; ++order) {
          const auto rough = functions_rough_at(knots, knot, order);
          for (int i = 0; i < knots.size(); ++i) {
            bool jumps = false;
            for (int r = 0; r <= order; ++r) {
              const auto value = [&](int span) {
                const int j = i - span + degree;
                if (j < 0 || j > degree) return Rational();
                return exact_basis(knots, span, Rational(knot), r)[static_cast<size_t>(j)];
              };
              jumps = jumps || value(above) != value(below);
            }
            EXPECT_EQ(std::count(rough.begin(), rough.end(), i), jumps ? 1 : 0)
                << i << " at " << knot << ' ' << order << ' '
                << ::testing::PrintToString(knots.knots());
          }
        }
      }
    }
  }
}

TEST(ContinuityLocks, OrdersToProtect) {
  EXPECT_EQ(order_of(Smoothness::kSharp), 0);
  EXPECT_EQ(order_of(Smoothness::kAlmost), 1);
  EXPECT_EQ(order_of(Smoothness::kTangent), 1);
  EXPECT_EQ(order_of(Smoothness::kCurvature), 2);
  EXPECT_EQ(protected_order(Smoothness::kSharp, 3), 0);
  EXPECT_EQ(protected_order(Smoothness::kCurvature, 1), 1);
  EXPECT_EQ(protected_order(Smoothness::kCurvature, 2), 1);
  EXPECT_EQ(protected_order(Smoothness::kCurvature, 3), 2);
  EXPECT_EQ(protected_order(Smoothness::kTangent, 25), 1);
}

std::vector<std::string> reason_texts(const PatchModel& model) {
  std::vector<std::string> texts;
  for (const LockReason& reason : model.lock_reasons) texts.push_back(reason.text);
  return texts;
}

// A full cylinder whose direction around is periodic: double knots throughout, the seam included.
PatchModel periodic_cylinder(int spans_between) {
  const PatchModel clamped =
      testing::make_revolved(KnotVector::uniform(1, 1), {{1.0, 0.0}, {1.0, 2.0}});
  PatchModel model = clamped;
  Patch& patch = model.patches[0];
  patch.u_knots = KnotVector(2, {-1, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5});
  if (spans_between > 1) {
    const Surface coarse = model.surface(0);
    std::vector<double> inserted;
    for (int span = 0; span < 4; ++span) {
      for (int k = 1; k < spans_between; ++k) {
        inserted.push_back(span + static_cast<double>(k) / spans_between);
      }
    }
    const KnotVector fine = wrapped_with_knots(patch.u_knots, inserted);
    const Surface surface = refine(coarse, fine, wrapped_insertion_map(patch.u_knots, fine),
                                   patch.v_knots, BandedMap::identity(2));
    model = testing::make_separate_model({surface});
    // Poles that wrap share their points.
    const int period = fine.size() - wrapped_poles(fine);
    for (int i = period; i < fine.size(); ++i) {
      for (int j = 0; j < 2; ++j) {
        model.ties.emplace_back(2 * (i - period) + j, 2 * i + j);
      }
    }
  }
  model.joins = find_joins(model);
  return model;
}

TEST(ContinuityLocks, PeriodicSeamsWithRoughKnotsKeepTheirTangents) {
  PatchModel model = periodic_cylinder(4);
  ASSERT_EQ(model.joins.size(), 1u);
  EXPECT_TRUE(is_wrap(model, model.joins[0], point_classes(model)));
  EXPECT_EQ(model.joins[0].smoothness, Smoothness::kCurvature);
  derive_locks(model, {});
  EXPECT_THAT(reason_texts(model),
              ::testing::Contains(HasSubstr("closes on itself smoothly (G2) at its seam, where its "
                                            "knots would allow a crease")));
  const auto at = shaken(model, 0.1);
  EXPECT_NE(at, model.points);
  const Join& seam = model.joins[0];
  const Join after = measure_join(model, at, seam.a, seam.b, seam.opposed);
  EXPECT_GE(after.smoothness, Smoothness::kTangent) << after.max_angle_rad;
  EXPECT_EQ(after.max_gap, 0.0);
  for (const KnotLine& line : interior_smoothness(model.surface(0, at), Direction::kU, 3.0)) {
    EXPECT_GE(line.measured, Smoothness::kTangent) << line.knot;
  }
  // Without the seam's own locks it would crease: they are not idle.
  PatchModel without = model;
  without.joins.clear();
  derive_locks(without, {});
  const Join creased = measure_join(model, shaken(without, 0.1), seam.a, seam.b, seam.opposed);
  EXPECT_LT(creased.smoothness, Smoothness::kTangent);
}

TEST(ContinuityLocks, TipsAreFreeAndRoundPolesAreNot) {
  // A cone's tip is sharp: its poles may move (they are one point). The pole of a dome may not.
  PatchModel cone = testing::make_revolved(KnotVector::uniform(1, 1), {{1, 0}, {0, 2}});
  derive_locks(cone, {});
  for (const std::string& text : reason_texts(cone)) {
    EXPECT_THAT(text, ::testing::Not(HasSubstr("is one point")));
  }
  const double w = std::sqrt(0.5);
  PatchModel dome =
      testing::make_revolved(KnotVector::uniform(2, 1), {{1, 0}, {1, 1}, {0, 1}}, {1, w, 1});
  derive_locks(dome, {});
  EXPECT_THAT(reason_texts(dome),
              ::testing::Contains("side v1 of face:1 is one point with a tangent plane: the poles "
                                  "around it stay so that no tip appears"));
}

TEST(ContinuityLocks, SmoothnessOfLockedSidesDecidesTheRows) {
  for (const auto& [smoothness, rows] :
       {std::pair{Smoothness::kSharp, 1}, std::pair{Smoothness::kAlmost, 2},
        std::pair{Smoothness::kTangent, 2}, std::pair{Smoothness::kCurvature, 3}}) {
    PatchModel model = testing::make_cube_model(3, 3);
    while (model.patches.size() > 1) model.patches.pop_back();
    model.locked_sides = {{{0, Side::kVEnd}, "is cut there", smoothness}};
    derive_locks(model, {});
    std::set<int> expected;
    for (int row = 0; row < rows; ++row) {
      for (const auto& [i, j] : side_indices(model.patches[0], Side::kVEnd, row)) {
        expected.insert(model.patches[0].point(i, j));
      }
    }
    EXPECT_EQ(locked_points(model), expected) << name_of(smoothness);
    EXPECT_EQ(model.lock_reasons[0].text, "face:1 (\"top\") is cut there");
    EXPECT_EQ(model.lock_reasons.size(), rows == 1 ? 1u : 2u);
    if (smoothness == Smoothness::kAlmost) {
      EXPECT_THAT(model.lock_reasons[1].text, HasSubstr("they meet almost smoothly, so"));
    }
  }
}

TEST(ContinuityLocks, RowsNeverGoBeyondThePatch) {
  // Two rows of poles, three to be locked: all of them, and nothing else.
  const KnotVector line = KnotVector::uniform(1, 1);
  PatchModel model = testing::make_separate_model(
      {Surface(line, line, {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}})});
  model.locked_sides = {{{0, Side::kUBegin}, "is held", Smoothness::kCurvature}};
  derive_locks(model, {});
  EXPECT_THAT(locked_points(model), ElementsAre(0, 1, 2, 3));
}

TEST(ContinuityLocks, FixedPointsKeepTheirWordsAndCountOnce) {
  PatchModel model = testing::make_cube_model(2, 2);
  model.fixed_points = {{3, "bolted down"}, {5, "bolted down"}, {3, "bolted down"}, {3, "glued"}};
  derive_locks(model, {});
  EXPECT_THAT(reason_texts(model), ElementsAre("bolted down", "glued"));
  EXPECT_EQ(model.locks.size(), 3u);
  EXPECT_FALSE(model.lock_reasons[0].continuity);
  // Law (3): what was there before does not matter.
  PatchModel again = model;
  again.lock(7, "left over", true);
  derive_locks(again, {});
  EXPECT_EQ(again.locks.size(), model.locks.size());
  EXPECT_EQ(reason_texts(again), reason_texts(model));
  model.fixed_points.clear();
  derive_locks(model, {});
  EXPECT_THAT(model.locks, IsEmpty());
}

TEST(ContinuityLocks, SeamsSayThatThePatchMeetsItself) {
  PatchModel model = testing::make_sphere(1.0);
  model.joins = find_joins(model);
  derive_locks(model, {});
  EXPECT_THAT(reason_texts(model), ::testing::Contains(HasSubstr(
                                       "meets itself smoothly (G2) at its seam: the poles next "
                                       "to that edge stay so that no crease appears")));
  model.joins[0].matching = false;
  model.joins[0].mismatch = "9 poles against 8";
  derive_locks(model, {});
  EXPECT_THAT(reason_texts(model),
              ::testing::Contains(HasSubstr("meets itself at a seam whose poles do not correspond "
                                            "(9 poles against 8)")));
}

}  // namespace
}  // namespace isochor
