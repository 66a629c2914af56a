#include "isochor/multires/model_scale.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "isochor/base/error.h"
#include "isochor/bspline/joins.h"
#include "support/messages.h"
#include "support/models.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::isochor::testing::message_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A box whose knots are not symmetric, so that opposed joins matter.
PatchModel uneven_box() {
  return testing::make_box_model(KnotVector::clamped(3, {0, 0.1, 0.3, 0.4, 0.7, 1}),
                                 KnotVector::clamped(2, {0, 0.5, 0.6, 1}),
                                 KnotVector::clamped(3, {0, 0.2, 0.25, 0.8, 1}));
}

// The coarse model: same joins, coarse grids, whose points are the classes that coarse
// coefficients along matching joins must form.
void expect_joins_match(const PatchModel& model, const std::vector<PatchScale>& scales) {
  for (const Join& join : find_joins(model)) {
    const auto coarse = [&](const SideRef& ref) {
      const PatchScale& scale = scales[static_cast<size_t>(ref.patch)];
      return is_u_side(ref.side) ? scale.v.coarse : scale.u.coarse;
    };
    const KnotVector a = coarse(join.a);
    const KnotVector b = coarse(join.b);
    ASSERT_EQ(a.size(), b.size());
    const int count = static_cast<int>(a.knots().size());
    for (int i = 0; i < count; ++i) {
      const double first = (a[i] - a.begin()) / (a.end() - a.begin());
      double second = (b[join.opposed ? count - 1 - i : i] - b.begin()) / (b.end() - b.begin());
      if (join.opposed) second = 1.0 - second;
      EXPECT_NEAR(first, second, 1e-15);
    }
  }
}

// Reverses the u direction of one patch without changing the surface.
void reverse_u(PatchModel* model, int q) {
  Patch& patch = model->patches[static_cast<size_t>(q)];
  std::vector<double> knots;
  for (auto it = patch.u_knots.knots().rbegin(); it != patch.u_knots.knots().rend(); ++it) {
    knots.push_back(patch.u_knots.begin() + patch.u_knots.end() - *it);
  }
  patch.u_knots = KnotVector(patch.u_knots.degree(), knots);
  std::vector<int> points;
  for (int i = patch.u_size() - 1; i >= 0; --i) {
    for (int j = 0; j < patch.v_size(); ++j) {
      points.push_back(patch.points[static_cast<size_t>(i * patch.v_size() + j)]);
    }
  }
  patch.points = points;
  patch.reversed = !patch.reversed;
}

TEST(ModelScale, KeepEveryIsConsistentAlongJoins) {
  PatchModel model = uneven_box();
  for (int k : {1, 2, 3, 9}) expect_joins_match(model, keep_every(model, k));
  reverse_u(&model, 0);
  reverse_u(&model, 3);
  ASSERT_TRUE(closure(model).closed);
  for (int k : {1, 2, 3, 9}) expect_joins_match(model, keep_every(model, k));
}

TEST(ModelScale, KeepingAllIsTheIdentity) {
  const PatchModel model = uneven_box();
  for (const auto& scales : {finest_scale(model), keep_every(model, 1)}) {
    for (size_t q = 0; q < scales.size(); ++q) {
      EXPECT_EQ(scales[q].u.coarse, model.patches[q].u_knots);
      for (int i = 0; i < scales[q].v.map.size_fine(); ++i) {
        EXPECT_TRUE(scales[q].v.map.row(i).unit());
      }
    }
  }
}

TEST(ModelScale, ListsTravelAlongJoinsAndStopThere) {
  const PatchModel model = uneven_box();
  // "top" runs along (x, y): its lists reach every x and y direction, no z direction.
  const auto scales = keep_knots(model, {{0, {0.3}, {0.6}}});
  expect_joins_match(model, scales);
  int x_directions = 0;
  int z_directions = 0;
  for (const PatchScale& scale : scales) {
    for (const TwoScale* one : {&scale.u, &scale.v}) {
      const auto interior = one->coarse.interior();
      x_directions += interior == std::vector<double>{0.3};
      z_directions += interior == std::vector<double>{0.2, 0.25, 0.8};
    }
  }
  EXPECT_EQ(x_directions, 4);
  EXPECT_EQ(z_directions, 4);
}

TEST(ModelScale, TorusKeepsWrapping) {
  const PatchModel model = testing::make_periodic_torus(3, 2, 8, 6);
  const auto scales = keep_every(model, 2);
  EXPECT_EQ(wrapped_poles(scales[0].u.coarse), 3);
  EXPECT_EQ(wrapped_poles(scales[0].v.coarse), 2);
  EXPECT_LT(scales[0].u.coarse.size(), model.patches[0].u_size());
}

TEST(ModelScale, ErrorsNameThePatch) {
  const PatchModel model = uneven_box();
  EXPECT_THAT(message_of<InputError>([&] {
                (void)keep_knots(model, {{2, {0.55}, {}}});
              }),
              HasSubstr("face:3"));
  // Top and bottom share their x knots through front and back.
  const std::string contradiction = message_of<InputError>([&] {
    (void)keep_knots(model, {{0, {0.3}, {}}, {1, {}, {0.7}}});
  });
  EXPECT_THAT(contradiction, HasSubstr("scale.knots of face:1 (\"top\"): u knot 0.7 is left out "
                                       "here but kept by the list of face:2 (\"bottom\")"));
  EXPECT_THAT(message_of<InputError>([&] { (void)keep_every(model, 0); }), HasSubstr("at least 1"));
}

}  // namespace
}  // namespace isochor
