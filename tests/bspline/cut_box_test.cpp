#include "isochor/bspline/cut_box.h"

#include <gtest/gtest.h>

#include "isochor/base/error.h"
#include "support/splines.h"

namespace isochor {
namespace {

using testing::random_clamped;
using testing::random_surface;
using testing::random_unclamped;

void expect_same_shape(const Surface& whole, const Surface& part, const UvBox& box) {
  EXPECT_EQ(part.u_knots().begin(), box.u_min);
  EXPECT_EQ(part.u_knots().end(), box.u_max);
  EXPECT_EQ(part.v_knots().begin(), box.v_min);
  EXPECT_EQ(part.v_knots().end(), box.v_max);
  for (int i = 0; i <= 20; ++i) {
    for (int j = 0; j <= 20; ++j) {
      const double u = box.u_min + (box.u_max - box.u_min) * i / 20.0;
      const double v = box.v_min + (box.v_max - box.v_min) * j / 20.0;
      EXPECT_LT((part.point(u, v) - whole.point(u, v)).norm(), 1e-13) << u << ' ' << v;
    }
  }
}

TEST(CutBox, IsTheSameShapeInside) {
  std::mt19937 random(17);
  for (bool rational : {false, true}) {
    for (int degree : {1, 2, 3, 5}) {
      const KnotVector u = random_clamped(random, degree, 4);
      const KnotVector v = random_unclamped(random, 3, 5);
      const Surface whole = random_surface(random, u, v, rational);
      const auto at = [](const KnotVector& knots, double share) {
        return knots.begin() + share * (knots.end() - knots.begin());
      };
      const UvBox box{at(u, 0.21), at(u, 0.83), at(v, 0.37), at(v, 0.71)};
      const Surface part = cut_box(whole, box);
      expect_same_shape(whole, part, box);
      EXPECT_EQ(part.rational(), rational);
      EXPECT_TRUE(part.u_knots().clamped_begin() && part.v_knots().clamped_end());
      const UvBox to_knot{u.begin(), u.breaks()[1], v.begin(), at(v, 0.5)};
      expect_same_shape(whole, cut_box(whole, to_knot), to_knot);
    }
  }
}

TEST(CutBox, KeepsWhatTheBoxCovers) {
  std::mt19937 random(18);
  const KnotVector u = random_clamped(random, 3, 4);
  const KnotVector v = random_unclamped(random, 3, 5);
  const Surface whole = random_surface(random, u, v, false);
  const Surface all = cut_box(whole, {u.begin(), u.end(), v.begin(), v.end()});
  EXPECT_EQ(all.poles(), whole.poles());
  EXPECT_TRUE(all.v_knots() == v);
  const Surface half = cut_box(whole, {u.begin(), u.breaks()[2], v.begin(), v.end()});
  EXPECT_TRUE(half.v_knots() == v);
  EXPECT_LT(half.u_size(), whole.u_size());
}

TEST(CutBox, RefusesBoxesOutsideTheDomain) {
  std::mt19937 random(19);
  const KnotVector u = KnotVector::uniform(3, 2), v = KnotVector::uniform(2, 3);
  const Surface whole = random_surface(random, u, v, false);
  EXPECT_THROW(cut_box(whole, {-0.1, 0.5, 0.0, 1.0}), PreconditionError);
  EXPECT_THROW(cut_box(whole, {0.5, 0.5, 0.0, 1.0}), PreconditionError);
}

}  // namespace
}  // namespace isochor
