// Extents against brute force over all grid entries and all pairs of coefficients.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "edit/fixtures.h"
#include "isochor/base/error.h"
#include "isochor/edit/extent_selection.h"
#include "isochor/edit/names.h"
#include "support/messages.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::testing::AllOf;
using testing::at_scale;
using ::testing::HasSubstr;
using testing::message_of;
using testing::small_cube;
using testing::uniform;

struct Grid {
  PatchModel model;
  DisplacementSpace space;
  explicit Grid(PatchModel m, int k = 1) : model(std::move(m)), space(model, at_scale(k)) {}

  ExtentSeed seed(int patch, Uv uv) const {
    return {model.surface(patch).point(uv.u, uv.v),
            space.surface_row(model, patch, uv).coefficient};
  }
  std::vector<char> select(const Extent& extent, const std::vector<ExtentSeed>& seeds = {}) const {
    return select_extent(model, space, extent, seeds);
  }
  // Coefficients with a grid entry of patch q at which `wanted(u, v)` holds.
  template <typename Wanted>
  std::vector<char> where(int q, Wanted wanted) const {
    std::vector<char> mask(static_cast<size_t>(space.size()), 0);
    for (int i = 0; i < space.u_knots(q).size(); ++i) {
      for (int j = 0; j < space.v_knots(q).size(); ++j) {
        if (!wanted(space.u_knots(q).greville(i), space.v_knots(q).greville(j))) continue;
        mask[static_cast<size_t>(space.coefficient(q, i, j))] = 1;
      }
    }
    return mask;
  }
};

int count(const std::vector<char>& mask) {
  return static_cast<int>(std::count(mask.begin(), mask.end(), 1));
}

Extent rings(int n) {
  Extent extent;
  extent.rings = n;
  return extent;
}

Extent loop(const std::string& patch, const std::vector<Uv>& corners) {
  Extent extent;
  extent.kind = Extent::Kind::kLoop;
  extent.patch = patch;
  extent.loop = corners;
  return extent;
}

Extent box(const std::string& patch, std::array<double, 2> u, std::array<double, 2> v) {
  Extent extent;
  extent.kind = Extent::Kind::kBox;
  extent.patch = patch;
  extent.u = u;
  extent.v = v;
  return extent;
}

TEST(ExtentOracle, RingsAreBreadthFirstSteps) {
  for (int k : {1, 2}) {
    const Grid grid(testing::bent_cube(71), k);
    const ExtentSeed seed = grid.seed(0, {0.3, 0.95});
    std::vector<char> expected(static_cast<size_t>(grid.space.size()), 0);
    for (int c : seed.coefficients) expected[static_cast<size_t>(c)] = 1;
    for (int n = 0; n < 6; ++n) {
      EXPECT_EQ(grid.select(rings(n), {seed}), expected) << n;
      std::vector<char> grown = expected;
      for (int c = 0; c < grid.space.size(); ++c) {
        for (int other : grid.space.neighbours(c)) {
          if (expected[static_cast<size_t>(other)]) grown[static_cast<size_t>(c)] = 1;
        }
      }
      expected = grown;
    }
  }
}

// Bellman-Ford instead of Dijkstra.
std::vector<char> ball_by_relaxation(const Grid& grid, const ExtentSeed& seed, double radius) {
  const auto n = static_cast<size_t>(grid.space.size());
  const auto from_seed = [&](size_t c) {
    return (grid.space.place(static_cast<int>(c)) - seed.position).norm();
  };
  std::vector<double> path(n, std::numeric_limits<double>::infinity());
  for (int c : seed.coefficients) path[static_cast<size_t>(c)] = from_seed(static_cast<size_t>(c));
  for (bool changed = true; changed;) {
    changed = false;
    for (size_t c = 0; c < n; ++c) {
      for (int other : grid.space.neighbours(static_cast<int>(c))) {
        const double step =
            (grid.space.place(static_cast<int>(c)) - grid.space.place(other)).norm();
        const double through = path[static_cast<size_t>(other)] + step;
        if (through < path[c] - 1e-12) {
          path[c] = through;
          changed = true;
        }
      }
    }
  }
  std::vector<char> mask(n, 0);
  for (size_t c = 0; c < n; ++c) mask[c] = from_seed(c) <= radius && path[c] <= 1.6 * radius;
  return mask;
}

TEST(ExtentOracle, BallsAreShortestPaths) {
  const Grid grid(testing::bent_cube(72, 1.0, 0.1));
  std::mt19937 random(73);
  for (int round = 0; round < 12; ++round) {
    const ExtentSeed a = grid.seed(round % 6, {uniform(random, 0, 1), uniform(random, 0, 1)});
    const ExtentSeed b = grid.seed(0, {uniform(random, 0, 1), uniform(random, 0, 1)});
    const double radius = uniform(random, 0.2, 1.2);
    std::vector<char> expected = ball_by_relaxation(grid, a, radius);
    EXPECT_EQ(grid.select(testing::ball(radius), {a}), expected) << round;
    const std::vector<char> other = ball_by_relaxation(grid, b, radius);
    for (size_t c = 0; c < expected.size(); ++c) expected[c] = expected[c] || other[c];
    EXPECT_EQ(grid.select(testing::ball(radius), {a, b}), expected) << "two seeds are a union";
  }
}

TEST(ExtentOracle, LargerIsNeverLess) {
  const Grid grid(testing::bent_cube(74));
  const ExtentSeed seed = grid.seed(2, {0.4, 0.4});
  std::vector<char> last(static_cast<size_t>(grid.space.size()), 0);
  for (double radius = 0.05; radius < 2.5; radius *= 1.3) {
    const std::vector<char> mask = grid.select(testing::ball(radius), {seed});
    for (size_t c = 0; c < mask.size(); ++c) EXPECT_LE(last[c], mask[c]);
    last = mask;
  }
  EXPECT_EQ(count(last), grid.space.size());
}

TEST(ExtentOracle, BoxesAndLoopsLookAtGrevilleAbscissae) {
  for (int k : {1, 2}) {
    const Grid grid(testing::bent_cube(75), k);
    EXPECT_EQ(grid.select(box("back", {0.2, 0.7}, {0.0, 0.5})),
              grid.where(4, [](double u, double v) {
                return 0.2 <= u && u <= 0.7 && 0.0 <= v && v <= 0.5;
              }));
    // A quadrilateral as four half planes, in both senses and with any first corner.
    std::vector<Uv> corners = {{0.1, 0.2}, {0.83, 0.07}, {0.91, 0.77}, {0.33, 0.93}};
    const auto inside = grid.where(4, [&](double u, double v) {
      for (size_t c = 0; c < 4; ++c) {
        const Uv& a = corners[c];
        const Uv& b = corners[(c + 1) % 4];
        if ((b.u - a.u) * (v - a.v) - (b.v - a.v) * (u - a.u) < 0.0) return false;
      }
      return true;
    });
    ASSERT_GT(count(inside), 0);
    std::vector<Uv> turned = corners;
    for (int turn = 0; turn < 4; ++turn) {
      std::rotate(turned.begin(), turned.begin() + 1, turned.end());
      EXPECT_EQ(grid.select(loop("back", turned)), inside);
      std::vector<Uv> back(turned.rbegin(), turned.rend());
      EXPECT_EQ(grid.select(loop("back", back)), inside);
      back.push_back(back.front());  // closed explicitly
      EXPECT_EQ(grid.select(loop("back", back)), inside);
    }
  }
}

TEST(ExtentOracle, EmptyExtentsAreEmpty) {
  const Grid grid(small_cube());
  EXPECT_EQ(count(grid.select(rings(4))), 0) << "no seed";
  EXPECT_EQ(count(grid.select(testing::ball(1.0))), 0) << "no seed";
  EXPECT_EQ(count(grid.select(loop("top", {}))), 0);
  EXPECT_EQ(count(grid.select(loop("top", {{0.1, 0.1}, {0.9, 0.9}}))), 0) << "no area";
  EXPECT_EQ(count(grid.select(box("top", {0.9, 0.1}, {0.0, 1.0}))), 0) << "turned round";
  EXPECT_EQ(count(grid.select(testing::faces({}))), 0);
  EXPECT_EQ(count(grid.select(testing::poles("top", {}))), 0);
}

TEST(ExtentOracle, PolesReachTheirJoinedTwins) {
  const Grid grid(testing::prepared(testing::make_periodic_torus(3, 2, 7, 6)));
  const auto one = grid.select(testing::poles("torus", {{0, 0}}));
  EXPECT_EQ(count(one), 1);
  EXPECT_EQ(grid.select(testing::poles("torus", {{7, 6}})), one) << "the wrapped copy";
  EXPECT_EQ(grid.select(testing::poles("face:1", {{7, 0}, {0, 6}})), one);
}

TEST(ExtentOracle, IndicesOutsideTheGridAreNamed) {
  const Grid grid(small_cube(2, 4), 2);
  const auto message = [&](int i, int j) {
    return message_of<InputError>([&] { grid.select(testing::poles("top", {{i, j}})); });
  };
  for (const auto& [i, j] : {std::pair<int, int>{4, 0}, {0, 4}, {-1, 2}, {2, -3}}) {
    EXPECT_THAT(message(i, j),
                AllOf(HasSubstr("extent.poles.top: index [" + std::to_string(i) + ", " +
                                std::to_string(j) + "]"),
                      HasSubstr("outside the grid of 4 x 4 coefficients of the chosen scale")));
  }
  EXPECT_THAT(message_of<InputError>([&] {
                grid.select(testing::poles("lid", {{0, 0}}));
              }),
              HasSubstr("\"lid\""));
  EXPECT_THAT(message_of<InputError>([&] {
                grid.select(box("lid", {0, 1}, {0, 1}));
              }),
              HasSubstr("\"lid\""));
  EXPECT_THAT(message_of<InputError>([&] { grid.select(loop("lid", {})); }), HasSubstr("\"lid\""));
  Extent points;
  points.kind = Extent::Kind::kPoints;
  points.points = {-1};
  EXPECT_THAT(message_of<InputError>([&] { Grid(small_cube()).select(points); }),
              HasSubstr("extent.points: no point -1 in the table of"));
}

// Names.

PatchModel named_sheets() {
  PatchModel model = small_cube();
  model.patches[0].name = "skin";
  model.patches[1].name = "skin";
  model.patches[2].name = "";
  model.patches[3].name = "face:6";  // the name of one is the handle of another
  model.patches[4].aliases = {"#1234", "wing/face:3"};
  return model;
}

TEST(Names, HandleNameAndAlias) {
  const PatchModel model = named_sheets();
  EXPECT_EQ(find_patch(model, "face:1"), 0);
  EXPECT_EQ(find_patch(model, "face:2"), 1);
  EXPECT_EQ(find_patch(model, "face:6"), 5) << "handles come first";
  EXPECT_EQ(find_patch(model, "back"), 4);
  EXPECT_EQ(find_patch(model, "#1234"), 4);
  EXPECT_EQ(find_patch(model, "wing/face:3"), 4);
}

TEST(Names, AmbiguousNamesListTheCandidatesOnly) {
  const PatchModel model = named_sheets();
  const std::string message = message_of<InputError>([&] { find_patch(model, "skin"); });
  EXPECT_THAT(message, HasSubstr("the name is ambiguous, use one of: face:1 (\"skin\"), face:2"));
  EXPECT_THAT(message, ::testing::Not(HasSubstr("face:3")));
}

TEST(Names, UnknownNamesListWhatThereIs) {
  PatchModel model = named_sheets();
  EXPECT_THAT(message_of<InputError>([&] { find_patch(model, "Skin"); }),
              AllOf(HasSubstr("patch \"Skin\": no such patch; there are: face:1 (\"skin\")"),
                    HasSubstr("face:6 (\"front\")")));
  EXPECT_THAT(message_of<InputError>([&] { find_patch(model, ""); }), HasSubstr("no such patch"))
      << "a patch without a name is not called by it";
  for (int k = 7; k < 30; ++k) {
    model.patches.push_back(model.patches[2]);
    model.patches.back().handle = "face:" + std::to_string(k);
  }
  EXPECT_THAT(
      message_of<InputError>([&] { find_patch(model, "x"); }),
      AllOf(HasSubstr("face:12"), HasSubstr(", ..."), ::testing::Not(HasSubstr("face:13"))));
}

TEST(Names, WordsOfTheScript) {
  EXPECT_STREQ(name_of(Method::kIsotropic), "isotropic");
  EXPECT_STREQ(name_of(Method::kAxis), "axis");
  EXPECT_STREQ(name_of(Method::kTaylor), "taylor");
  EXPECT_STREQ(name_of(Method(17)), "?");
  EXPECT_STREQ(name_of(Continuity::kMeasured), "measured");
  EXPECT_STREQ(name_of(Continuity::kC0), "C0");
}

}  // namespace
}  // namespace isochor
