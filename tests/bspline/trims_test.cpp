#include "isochor/bspline/trims.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "isochor/bspline/refinement.h"
#include "support/models.h"
#include "support/splines.h"

namespace isochor {
namespace {

// A circle as a loop and as the boxes of its chords. `hole`: adds the outer rectangle.
TrimRegion circle_trim(Uv centre, double radius, int points, const Patch& patch, bool hole) {
  TrimRegion trim;
  std::vector<Uv> loop;
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * M_PI * i / points;
    loop.push_back({centre.u + radius * std::cos(angle), centre.v + radius * std::sin(angle)});
  }
  for (size_t i = 0; i < loop.size(); ++i) {
    const Uv& p = loop[i];
    const Uv& q = loop[(i + 1) % loop.size()];
    trim.boundary.push_back(
        {std::min(p.u, q.u), std::max(p.u, q.u), std::min(p.v, q.v), std::max(p.v, q.v)});
  }
  trim.loops.push_back(loop);
  if (hole) {
    const auto& u = patch.u_knots;
    const auto& v = patch.v_knots;
    trim.loops.push_back(
        {{u.begin(), v.begin()}, {u.end(), v.begin()}, {u.end(), v.end()}, {u.begin(), v.end()}});
  }
  return trim;
}

Patch patch_with(const KnotVector& u, const KnotVector& v) {
  Patch patch{"", "face:1", u, v, {}, {}, false, {}, {}};
  patch.points.resize(static_cast<size_t>(u.size()) * static_cast<size_t>(v.size()));
  return patch;
}

double basis_at(const Patch& patch, int i, int j, const Uv& at) {
  const BasisValues u = evaluate_basis(patch.u_knots, at.u);
  const BasisValues v = evaluate_basis(patch.v_knots, at.v);
  const bool in =
      0 <= i - u.first && i - u.first <= u.degree && 0 <= j - v.first && j - v.first <= v.degree;
  return in ? u.value(0, i - u.first) * v.value(0, j - v.first) : 0.0;
}

std::vector<Uv> grid_points(const Patch& patch, int count) {
  std::vector<Uv> points;
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b < count; ++b) {
      const double s = (a + 0.41) / count;
      const double t = (b + 0.59) / count;
      points.push_back({patch.u_knots.begin() + s * (patch.u_knots.end() - patch.u_knots.begin()),
                        patch.v_knots.begin() + t * (patch.v_knots.end() - patch.v_knots.begin())});
    }
  }
  return points;
}

TEST(Trims, FreeFunctionsVanishOnTrimmingCurvesAndOutside) {
  std::mt19937 random(61);
  for (bool hole : {false, true}) {
    Patch patch = patch_with(testing::random_clamped(random, 3, 9, 2),
                             testing::random_unclamped(random, 2, 12));
    const Uv centre{0.5 * (patch.u_knots.begin() + patch.u_knots.end()),
                    0.5 * (patch.v_knots.begin() + patch.v_knots.end())};
    const double reach = std::min(patch.u_knots.end() - centre.u, patch.v_knots.end() - centre.v);
    patch.trim = circle_trim(centre, (hole ? 0.3 : 0.95) * reach, 300, patch, hole);
    const auto states = trim_states(patch, classify_elements(patch));
    int free = 0;
    int locked = 0;
    int off = 0;
    for (int i = 0; i < patch.u_size(); ++i) {
      for (int j = 0; j < patch.v_size(); ++j) {
        const TrimState state = states[static_cast<size_t>(i) * patch.v_size() + j];
        double on_loop = 0.0;
        for (const Uv& p : patch.trim.loops[0]) {
          on_loop = std::max(on_loop, basis_at(patch, i, j, p));
        }
        double outside = 0.0;
        double inside = 0.0;
        for (const Uv& p : grid_points(patch, 16)) {
          double& sum = inside_trim(patch.trim, p.u, p.v) ? inside : outside;
          sum = std::max(sum, basis_at(patch, i, j, p));
        }
        if (state == TrimState::kFree) {
          ++free;
          EXPECT_EQ(on_loop, 0.0);
          EXPECT_EQ(outside, 0.0);
        } else if (state == TrimState::kTrimmedOff) {
          ++off;
          EXPECT_EQ(on_loop, 0.0);
          EXPECT_EQ(inside, 0.0);
        } else {
          ++locked;
          EXPECT_GT(on_loop, 0.0) << i << ' ' << j;
        }
      }
    }
    EXPECT_GT(free, 0);
    EXPECT_GT(locked, 0);
    if (!hole) {
      EXPECT_GT(off, 0);
    }
  }
}

TEST(Trims, ElementsAgreeWithPoints) {
  Patch patch = patch_with(KnotVector::uniform(2, 20), KnotVector::uniform(3, 20));
  patch.trim = circle_trim({0.5, 0.5}, 0.33, 500, patch, true);
  const ElementGrid grid = classify_elements(patch);
  for (int a = 0; a < 20; ++a) {
    for (int b = 0; b < 20; ++b) {
      // Distance of the element's nearest and farthest points from the centre of the circle.
      const double cx = std::abs((a + 0.5) / 20 - 0.5);
      const double cy = std::abs((b + 0.5) / 20 - 0.5);
      const double near = std::hypot(std::max(0.0, cx - 0.025), std::max(0.0, cy - 0.025));
      const double far = std::hypot(cx + 0.025, cy + 0.025);
      const ElementKind expected = far < 0.33    ? ElementKind::kOutside
                                   : near > 0.33 ? ElementKind::kInside
                                                 : ElementKind::kCrossed;
      EXPECT_EQ(grid.at(a, b), expected) << a << ' ' << b;
    }
  }
}

TEST(Trims, NoTrimIsAllFree) {
  const Patch patch = patch_with(KnotVector::uniform(3, 5), KnotVector::uniform(2, 4));
  for (TrimState state : trim_states(patch, classify_elements(patch))) {
    EXPECT_EQ(state, TrimState::kFree);
  }
  EXPECT_TRUE(inside_trim(patch.trim, 7.0, -3.0));
}

// A trimming edge along the knot line u = 0.5, kept to the left: no element is crossed, yet
// functions that reach over the line must stay.
TEST(Trims, ATrimAlongAKnotLineSeparatesElements) {
  Patch patch = patch_with(KnotVector::uniform(3, 10), KnotVector::uniform(3, 10));
  patch.trim.loops = {{{0, 0}, {0.5, 0}, {0.5, 1}, {0, 1}}};
  patch.trim.boundary = {{0.5, 0.5, 0.0, 1.0}};
  const ElementGrid grid = classify_elements(patch);
  EXPECT_EQ(std::count(grid.kinds.begin(), grid.kinds.end(), ElementKind::kCrossed), 0);
  EXPECT_EQ(grid.at(4, 3), ElementKind::kInside);
  EXPECT_EQ(grid.at(5, 3), ElementKind::kOutside);
  const auto states = trim_states(patch, grid);
  for (int i = 0; i < patch.u_size(); ++i) {
    const TrimState expected = patch.u_knots[i + 4] <= 0.5 ? TrimState::kFree
                               : patch.u_knots[i] >= 0.5   ? TrimState::kTrimmedOff
                                                           : TrimState::kNearTrim;
    EXPECT_EQ(states[static_cast<size_t>(i) * patch.v_size() + 4], expected) << i;
  }
}

TEST(Trims, ReleasedBoxesLockNothingButOthersStillDo) {
  Patch patch = patch_with(KnotVector::uniform(3, 16), KnotVector::uniform(3, 16));
  patch.trim = circle_trim({0.3, 0.3}, 0.11, 80, patch, true);
  const TrimRegion other = circle_trim({0.75, 0.75}, 0.11, 80, patch, false);
  patch.trim.boundary.insert(patch.trim.boundary.end(), other.boundary.begin(),
                             other.boundary.end());
  patch.trim.loops.push_back(other.loops.front());
  const auto locked = trim_states(patch, classify_elements(patch));
  const auto states = trim_states(patch, classify_elements(patch, {{0, 80}}));
  int freed = 0;
  for (int i = 0; i < patch.u_size(); ++i) {
    for (int j = 0; j < patch.v_size(); ++j) {
      const size_t k = static_cast<size_t>(i) * patch.v_size() + j;
      bool meets_first = false, meets_other = false;
      for (size_t b = 0; b < patch.trim.boundary.size(); ++b) {
        const UvBox& box = patch.trim.boundary[b];
        const double value =
            basis_at(patch, i, j, {0.5 * (box.u_min + box.u_max), 0.5 * (box.v_min + box.v_max)});
        (b < 80 ? meets_first : meets_other) |= value > 0.0;
      }
      if (meets_other) {
        EXPECT_EQ(states[k], TrimState::kNearTrim) << i << " " << j;
      }
      if (meets_first && !meets_other && states[k] == TrimState::kFree) ++freed;
      if (locked[k] == TrimState::kFree) {
        EXPECT_EQ(states[k], TrimState::kFree);
      }
    }
  }
  EXPECT_GT(freed, 20);
}

TEST(Trims, RefinementOnlyWidensTheFreeRegion) {
  std::mt19937 random(62);
  Patch coarse = patch_with(KnotVector::uniform(3, 7), KnotVector::uniform(3, 7));
  coarse.trim = circle_trim({0.45, 0.5}, 0.17, 200, coarse, true);
  Patch fine =
      patch_with(refined_to_spans(coarse.u_knots, 23), refined_to_spans(coarse.v_knots, 29));
  fine.trim = coarse.trim;
  const auto coarse_states = trim_states(coarse, classify_elements(coarse));
  const auto fine_states = trim_states(fine, classify_elements(fine));
  const auto covered = [](const Patch& patch, const std::vector<TrimState>& states, const Uv& p) {
    for (int i = 0; i < patch.u_size(); ++i) {
      for (int j = 0; j < patch.v_size(); ++j) {
        if (states[static_cast<size_t>(i) * patch.v_size() + j] == TrimState::kFree &&
            basis_at(patch, i, j, p) > 0.0) {
          return true;
        }
      }
    }
    return false;
  };
  int before = 0;
  int after = 0;
  for (const Uv& p : grid_points(coarse, 16)) {
    const bool was = covered(coarse, coarse_states, p);
    const bool is = covered(fine, fine_states, p);
    before += was;
    after += is;
    EXPECT_TRUE(!was || is) << p.u << ' ' << p.v;
  }
  EXPECT_GT(before, 0);
  EXPECT_GT(after, before);
}

}  // namespace
}  // namespace isochor
