// The baselines are right: each agrees with the rational numbers and with VolumeForm.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fma_peak.h"
#include "gauss_simd.h"
#include "isochor/volume/exact_volume.h"
#include "isochor/volume/volume_form.h"
#include "published.h"
#include "reference.h"

namespace isochor::bench {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

// The rows of the gradient of a whole model by one baseline.
template <typename Make>
ValueAndGradient by_baseline(const PatchModel& model, const Make& make) {
  ValueAndGradient sum;
  sum.gradient.assign(model.points.size(), Vec3::Zero());
  for (int q = 0; q < static_cast<int>(model.patches.size()); ++q) {
    const PatchGrid grid = patch_grid(model, q);
    Columns areas;
    const double volume = make(grid)->run(grid, areas);
    sum.value += model.patches[static_cast<size_t>(q)].sign() * volume;
    const std::vector<Vec3> rows = point_rows(model, q, areas);
    for (size_t i = 0; i < rows.size(); ++i) sum.gradient[i] += rows[i];
  }
  return sum;
}

TEST(Reference, EqualsTheRationalGradientToItsOwnRounding) {
  for (int degree = 1; degree <= 4; ++degree) {
    const PatchModel model = bent_cube(degree, degree + 2);
    const Reference ours = reference(model);
    const ExactVolume exact(model);
    const double volume = exact.value(model.points).to_double();
    EXPECT_NEAR(static_cast<double>(ours.volume), volume, kEps * volume);
    const auto rows = exact.gradient(model.points);
    for (size_t i = 0; i < rows.size(); ++i) {
      for (size_t axis = 0; axis < 3; ++axis) {
        // Half a unit in the last place of `double` is all that the comparison itself can show.
        EXPECT_NEAR(static_cast<double>(ours.gradient[i][axis]), rows[i][axis].to_double(), kEps);
      }
    }
  }
}

TEST(Reference, SeesAWrongGradient) {
  const PatchModel model = bent_cube(2, 6);
  const Reference exact = reference(model);
  std::vector<Vec3> rows = VolumeForm(model).gradient(model.points);
  EXPECT_LE(relative_error(exact, rows), 100 * kEps);
  rows[7].y() *= 1.0 + 1e-6;
  EXPECT_GE(relative_error(exact, rows), 1e-9);
  rows[7].y() = std::nan("");
  EXPECT_TRUE(std::isnan(relative_error(exact, rows)));
}

TEST(Baselines, AgreeWithVolumeFormOnClosedModels) {
  if (!has_fma()) GTEST_SKIP() << "no AVX2 and FMA here";
  for (int degree = 1; degree <= 5; ++degree) {
    // Sides about and beyond one vector and one strip of the Gauss method.
    for (int side : {2 * degree + 3, 2 * degree + 4, 64 + 2 * degree, 65 + 2 * degree, 71}) {
      const PatchModel model = wavy_torus(degree, side);
      const ValueAndGradient form = VolumeForm(model).value_and_gradient(model.points);
      const Reference exact = reference(model);
      ASSERT_LE(relative_error(exact, form.gradient), 100 * kEps * side);
      const ValueAndGradient gauss = by_baseline(model, gauss_method);
      EXPECT_LE(relative_error(exact, gauss.gradient), 100 * kEps * side) << degree << " " << side;
      EXPECT_NEAR(gauss.value, form.value, 1e-12 * std::fabs(form.value));
      for (const auto make : {published_method, published_method_simd}) {
        const ValueAndGradient published = by_baseline(model, make);
        EXPECT_LE(relative_error(exact, published.gradient), 100 * kEps * side * side)
            << degree << " " << side;
        EXPECT_NEAR(published.value, form.value, 1e-10 * std::fabs(form.value));
      }
    }
  }
}

TEST(Baselines, AgreeOnClampedKnotsAndReversedPatches) {
  if (!has_fma()) GTEST_SKIP() << "no AVX2 and FMA here";
  for (int degree = 1; degree <= 5; ++degree) {
    for (int side : {degree + 1, degree + 7}) {
      PatchModel model = bent_cube(degree, side);
      for (Patch& patch : model.patches) patch.reversed = true;
      const Reference exact = reference(model);
      EXPECT_LT(exact.volume, 0.0L);
      EXPECT_LE(relative_error(exact, by_baseline(model, gauss_method).gradient), 1e-13);
      EXPECT_LE(relative_error(exact, by_baseline(model, published_method).gradient), 1e-12);
      EXPECT_LE(relative_error(exact, by_baseline(model, published_method_simd).gradient), 1e-12);
    }
  }
}

TEST(FmaPeak, IsPlausible) {
  if (!has_fma()) GTEST_SKIP() << "no AVX2 and FMA here";
  EXPECT_GT(fma_peak_gflops(), 2.0);
  EXPECT_LT(fma_peak_gflops(), 1000.0);
}

}  // namespace
}  // namespace isochor::bench
