#include "isochor/volume/theta.h"

#include <gtest/gtest.h>

#include "isochor/base/error.h"
#include "isochor/bspline/basis.h"
#include "isochor/volume/volume_form.h"
#include "support/models.h"

namespace isochor {
namespace {

using testing::random_clamped_knots;

TEST(Theta, Symmetry) {
  const ThetaTensor theta(random_clamped_knots(61, 3, 4));
  for (int i = 0; i < theta.size(); ++i) {
    for (int j = 0; j < theta.size(); ++j) {
      for (int k = 0; k < theta.size(); ++k) EXPECT_EQ(theta(i, j, k), theta(j, i, k));
    }
  }
}

TEST(Theta, Product) {
  const KnotVector clamped = random_clamped_knots(62, 2, 3);
  const KnotVector open(3, {-1.0, -0.5, 0.0, 0.1, 0.5, 0.7, 1.0, 1.4, 2.0, 2.5});
  for (const KnotVector& knots : {clamped, open}) {
    const ThetaTensor theta(knots);
    const BasisValues begin = evaluate_basis(knots, knots.begin());
    const BasisValues end = evaluate_basis(knots, knots.end());
    const auto value = [](const BasisValues& b, int i) {
      const int j = i - b.first;
      return j < 0 || j > b.degree ? 0.0 : b.value(0, j);
    };
    for (int i = 0; i < theta.size(); ++i) {
      for (int j = 0; j < theta.size(); ++j) {
        for (int k = 0; k < theta.size(); ++k) {
          const double ends = value(end, i) * value(end, j) * value(end, k) -
                              value(begin, i) * value(begin, j) * value(begin, k);
          EXPECT_NEAR(theta(i, j, k) + theta(j, k, i) + theta(k, i, j), ends, 1e-15);
        }
      }
    }
  }
}

TEST(Theta, Partition) {
  const ThetaTensor theta(random_clamped_knots(63, 4, 3));
  for (int i = 0; i < theta.size(); ++i) {
    for (int j = 0; j < theta.size(); ++j) {
      double sum = 0.0;
      for (int k = 0; k < theta.size(); ++k) sum += theta(i, j, k);
      EXPECT_NEAR(sum, 0.0, 1e-15);
    }
  }
}

TEST(Theta, LinearSpanByHand) {
  // B_0 = 1 - t, B_1 = t on [0, 1].
  const ThetaTensor theta(KnotVector::uniform(1, 1));
  EXPECT_DOUBLE_EQ(theta(0, 0, 0), -1.0 / 3);
  EXPECT_DOUBLE_EQ(theta(0, 1, 1), 1.0 / 6);
  EXPECT_DOUBLE_EQ(theta(1, 1, 1), 1.0 / 3);
  EXPECT_EQ(theta(0, 0, 2), 0.0);
}

// The second method: both ways to the same numbers.
TEST(Theta, AgreesWithGaussPerElement) {
  testing::RandomModelOptions options;
  options.degrees[0] = 1;
  options.degrees[1] = 4;
  std::vector<PatchModel> models = {testing::random_closed_model(64, options),
                                    testing::random_open_patch(65, 2, 3, 3, true),
                                    testing::make_periodic_torus(2, 3, 5, 6)};
  models[1].patches[0].reversed = true;
  for (const PatchModel& model : models) {
    const VolumeForm form(model);
    EXPECT_NEAR(theta_volume(model, model.points), form.value(model.points), 2e-13);
    const auto by_theta = theta_gradient(model, model.points);
    const auto by_gauss = form.gradient(model.points);
    for (size_t i = 0; i < by_theta.size(); ++i) {
      EXPECT_LT((by_theta[i] - by_gauss[i]).norm(), 1e-14);
    }
  }
}

TEST(Theta, RefusesWeights) {
  const PatchModel sphere = testing::make_sphere(1.0);
  EXPECT_THROW(static_cast<void>(theta_volume(sphere, sphere.points)), PreconditionError);
}

}  // namespace
}  // namespace isochor
