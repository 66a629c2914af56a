// Trims against brute force: winding by angles, elements by sampling, functions by their supports.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "isochor/bspline/trims.h"
#include "support/splines.h"

namespace isochor {
namespace {

using Loop = std::vector<Uv>;

Patch patch_with(const KnotVector& u, const KnotVector& v) {
  Patch patch{"", "face:1", u, v, {}, {}, false, {}, {}};
  patch.points.resize(static_cast<size_t>(u.size()) * static_cast<size_t>(v.size()));
  return patch;
}

// How often a loop winds around a point, by adding up angles.
int winding(const Loop& loop, const Uv& at) {
  double turned = 0.0;
  for (size_t i = 0; i < loop.size(); ++i) {
    const Uv& p = loop[i];
    const Uv& q = loop[(i + 1) % loop.size()];
    const double px = p.u - at.u, py = p.v - at.v;
    const double qx = q.u - at.u, qy = q.v - at.v;
    turned += std::atan2(px * qy - py * qx, px * qx + py * qy);
  }
  return static_cast<int>(std::lround(turned / (2 * M_PI)));
}

Loop random_star(std::mt19937& random, const Uv& centre, double low, double high, int corners) {
  Loop loop;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * M_PI * (k + testing::uniform(random, -0.3, 0.3)) / corners;
    const double radius = testing::uniform(random, low, high);
    loop.push_back({centre.u + radius * std::cos(angle), centre.v + radius * std::sin(angle)});
  }
  return loop;
}

TEST(TrimsBruteForce, InsideIsAnOddNumberOfTurns) {
  std::mt19937 random(391);
  for (int round = 0; round < 20; ++round) {
    TrimRegion trim;
    // An outer loop, a hole in it, an island in the hole; each in either sense.
    for (double reach : {0.9, 0.6, 0.3}) {
      trim.loops.push_back(random_star(random, {0, 0}, 0.7 * reach, reach, 5 + round));
      if (round % 3 == 1) std::reverse(trim.loops.back().begin(), trim.loops.back().end());
    }
    for (int k = 0; k < 300; ++k) {
      const Uv at{testing::uniform(random, -1, 1), testing::uniform(random, -1, 1)};
      int turns = 0;
      for (const Loop& loop : trim.loops) turns += std::abs(winding(loop, at));
      EXPECT_EQ(inside_trim(trim, at.u, at.v), turns % 2 == 1) << at.u << ' ' << at.v;
    }
  }
}

TEST(TrimsBruteForce, CornersOnTheLineCountOnce) {
  // A diamond: lines through its corners, where two edges meet in one point.
  TrimRegion trim;
  trim.loops = {{{0, -1}, {1, 0}, {0, 1}, {-1, 0}}};
  EXPECT_TRUE(inside_trim(trim, 0.0, 0.0)) << "the line v = 0 runs through two corners";
  EXPECT_FALSE(inside_trim(trim, 1.5, 0.0));
  EXPECT_FALSE(inside_trim(trim, -1.5, 0.0));
  EXPECT_FALSE(inside_trim(trim, -0.5, 1.0)) << "the line v = 1 touches one corner";
  EXPECT_FALSE(inside_trim(trim, -0.5, -1.0));
  // Horizontal edges belong to no crossing.
  trim.loops = {{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}};
  EXPECT_TRUE(inside_trim(trim, 0.5, 1.0));
  EXPECT_FALSE(inside_trim(trim, 2.5, 1.0));
  EXPECT_FALSE(inside_trim(trim, -0.5, 1.0));
  EXPECT_TRUE(inside_trim(trim, 1.5, 0.5));
  EXPECT_FALSE(inside_trim(trim, 1.5, 1.5));
  // A loop without area encloses nothing.
  trim.loops = {{{0, 0}, {1, 1}}};
  EXPECT_FALSE(inside_trim(trim, 0.5, 0.4));
  EXPECT_FALSE(inside_trim(trim, -0.5, 0.5));
}

// An element is crossed exactly when a box meets its interior; boxes are all there is to it.
TEST(TrimsBruteForce, ElementsAreCrossedWhereABoxMeetsTheirInterior) {
  std::mt19937 random(392);
  for (int round = 0; round < 20; ++round) {
    Patch patch =
        patch_with(testing::random_clamped(random, 2, 5), testing::random_unclamped(random, 3, 4));
    const auto u = patch.u_knots.breaks();
    const auto v = patch.v_knots.breaks();
    for (int k = 0; k < 4; ++k) {
      const auto interval = [&](const std::vector<double>& breaks) {
        std::pair<double, double> ends;
        for (double* end : {&ends.first, &ends.second}) {
          // Breaks, points between them and points outside the domain.
          const size_t at = random() % breaks.size();
          *end = random() % 3 == 0
                     ? breaks[at]
                     : testing::uniform(random, breaks.front() - 0.5, breaks.back() + 0.5);
        }
        if (random() % 4 == 0) ends.second = ends.first;
        return std::pair(std::min(ends.first, ends.second), std::max(ends.first, ends.second));
      };
      const auto [u_low, u_high] = interval(u);
      const auto [v_low, v_high] = interval(v);
      patch.trim.boundary.push_back({u_low, u_high, v_low, v_high});
    }
    const ElementGrid grid = classify_elements(patch);
    for (size_t a = 0; a + 1 < u.size(); ++a) {
      for (size_t b = 0; b + 1 < v.size(); ++b) {
        const bool met = std::any_of(patch.trim.boundary.begin(), patch.trim.boundary.end(),
                                     [&](const UvBox& box) {
                                       return box.u_min < u[a + 1] && box.u_max > u[a] &&
                                              box.v_min < v[b + 1] && box.v_max > v[b];
                                     });
        EXPECT_EQ(grid.at(static_cast<int>(a), static_cast<int>(b)),
                  met ? ElementKind::kCrossed : ElementKind::kInside)
            << round << ' ' << a << ' ' << b;
      }
    }
  }
}

// Law (2), over all small knot vectors: the state of a function by looking at each element on which
// it lives.
TEST(TrimsBruteForce, StatesFollowFromTheElementsOfTheSupport) {
  std::mt19937 random(393);
  for (int degree : {1, 2}) {
    for (const KnotVector& u : testing::all_small_knots(degree, 2 * degree + 4)) {
      const Patch patch = patch_with(u, KnotVector::clamped(1, {0, 1, 2}));
      ElementGrid grid;
      grid.u_count = static_cast<int>(u.spans().size());
      grid.v_count = 2;
      for (int k = 0; k < grid.u_count * 2; ++k) {
        grid.kinds.push_back(static_cast<ElementKind>(random() % 3));
      }
      const auto states = trim_states(patch, grid);
      for (int i = 0; i < patch.u_size(); ++i) {
        for (int j = 0; j < patch.v_size(); ++j) {
          int inside = 0;
          int outside = 0;
          int all = 0;
          for (int a = 0; a < grid.u_count; ++a) {
            for (int b = 0; b < grid.v_count; ++b) {
              const int span_u = u.spans()[static_cast<size_t>(a)];
              const int span_v = patch.v_knots.spans()[static_cast<size_t>(b)];
              if (i < span_u - degree || i > span_u || j < span_v - 1 || j > span_v) continue;
              ++all;
              inside += grid.at(a, b) == ElementKind::kInside;
              outside += grid.at(a, b) == ElementKind::kOutside;
            }
          }
          const TrimState expected = inside == all    ? TrimState::kFree
                                     : outside == all ? TrimState::kTrimmedOff
                                                      : TrimState::kNearTrim;
          EXPECT_EQ(states[static_cast<size_t>(i) * patch.v_size() + j], expected)
              << ::testing::PrintToString(u.knots()) << ' ' << i << ' ' << j;
        }
      }
    }
  }
}

}  // namespace
}  // namespace isochor
