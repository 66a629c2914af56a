#include "isochor/volume/contraction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "isochor/base/error.h"
#include "isochor/volume/exact_volume.h"
#include "isochor/volume/precise_volume.h"
#include "isochor/volume/volume_form.h"
#include "support/models.h"
#include "support/splines.h"
#include "support/worst.h"

namespace isochor {
namespace {

using testing::make_box_model;
using testing::make_cube_model;
using testing::make_periodic_torus;
using testing::random_clamped_knots;
using testing::random_closed_model;
using testing::Worst;

double largest(const std::vector<Vec3>& rows) {
  double norm = 0.0;
  for (const Vec3& row : rows) norm = std::max(norm, row.cwiseAbs().maxCoeff());
  return norm;
}

// The largest difference of two gradients, relative to the largest entry of the second.
double difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double worst = a.size() == b.size() ? 0.0 : 1e300;
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    worst = std::max(worst, (a[i] - b[i]).cwiseAbs().maxCoeff());
  }
  return worst / largest(b);
}

TEST(Tau, SymmetryAndPartition) {
  for (int degree : {1, 2, 3, 6, 13}) {
    const KnotVector knots = random_clamped_knots(70 + static_cast<unsigned>(degree), degree, 4);
    const TauTensor tau(knots);
    for (int j = 0; j + 1 < tau.size(); ++j) {
      double sum = 0.0;
      for (int i = 0; i < tau.size(); ++i) {
        for (int k = 0; k < tau.size(); ++k) {
          EXPECT_EQ(tau(i, k, j), tau(k, i, j));
          sum += tau(i, k, j);
        }
      }
      EXPECT_NEAR(sum, 1.0, 1e-13) << "degree " << degree << ", j " << j;
    }
  }
}

TEST(Tau, LinearSpanByHand) {
  // B_0 = 1 - t, B_1 = t and b_0 = 1 on [0, 1].
  const TauTensor tau(KnotVector::uniform(1, 1));
  EXPECT_DOUBLE_EQ(tau(0, 0, 0), 1.0 / 3);
  EXPECT_DOUBLE_EQ(tau(0, 1, 0), 1.0 / 6);
  EXPECT_DOUBLE_EQ(tau(1, 1, 0), 1.0 / 3);
}

TEST(Tau, VanishesOffTheBand) {
  const TauTensor tau(KnotVector::uniform(2, 6));
  EXPECT_EQ(tau(0, 3, 0), 0.0);
  EXPECT_EQ(tau(0, 0, 2), 0.0);
  EXPECT_EQ(tau(5, 5, 2), 0.0);
  EXPECT_NE(tau(5, 5, 3), 0.0);
}

TEST(Contraction, SecondMethod) {
  Worst value("contraction_value", 1e-14), gradient("contraction_gradient", 5e-14);
  std::mt19937 random(71);
  std::uniform_int_distribution<int> degree(1, 6);
  for (unsigned seed = 0; seed < 40; ++seed) {
    testing::RandomModelOptions options;
    for (int& d : options.degrees) d = degree(random);
    options.spans = 1 + static_cast<int>(seed % 4);
    const PatchModel model = random_closed_model(7000 + seed, options);
    const ValueAndGradient fast = VolumeContraction(model).value_and_gradient(model.points);
    const ValueAndGradient gauss = VolumeForm(model).value_and_gradient(model.points);
    EXPECT_TRUE(value.see(std::abs(fast.value - gauss.value) / std::abs(gauss.value))) << seed;
    EXPECT_TRUE(gradient.see(difference(fast.gradient, gauss.gradient))) << seed;
  }
}

TEST(Contraction, ExactRationals) {
  Worst value("contraction_exact_value", 5e-15), gradient("contraction_exact_gradient", 5e-15);
  for (unsigned seed = 0; seed < 12; ++seed) {
    testing::RandomModelOptions options;
    options.degrees[seed % 3] = 1 + static_cast<int>(seed % 6);
    options.spans = 2;
    const PatchModel model = random_closed_model(7100 + seed, options);
    const ExactVolume exact(model);
    const ValueAndGradient fast = VolumeContraction(model).value_and_gradient(model.points);
    const double volume = exact.value(model.points).to_double();
    EXPECT_TRUE(value.see(std::abs(fast.value - volume) / std::abs(volume))) << seed;
    std::vector<Vec3> rows;
    for (const ExactVec3& row : exact.gradient(model.points)) {
      rows.emplace_back(row[0].to_double(), row[1].to_double(), row[2].to_double());
    }
    EXPECT_TRUE(gradient.see(difference(fast.gradient, rows))) << seed;
  }
}

TEST(Contraction, HighAndUnequalDegrees) {
  for (const auto& [du, dv] : {std::pair(13, 7), std::pair(22, 1), std::pair(1, 25)}) {
    const PatchModel model =
        make_box_model(random_clamped_knots(72, du, 2), random_clamped_knots(73, dv, 2),
                       random_clamped_knots(74, 2, 3));
    const ValueAndGradient fast = VolumeContraction(model).value_and_gradient(model.points);
    EXPECT_NEAR(fast.value, 1.0, 1e-13);
    EXPECT_LT(difference(fast.gradient, VolumeForm(model).gradient(model.points)), 1e-12);
  }
}

TEST(Contraction, UnclampedPeriodicTorus) {
  const PatchModel model = make_periodic_torus(3, 2, 9, 7, 2.0, 0.5);
  const ValueAndGradient fast = VolumeContraction(model).value_and_gradient(model.points);
  const ValueAndGradient gauss = VolumeForm(model).value_and_gradient(model.points);
  EXPECT_NEAR(fast.value, gauss.value, 1e-14 * std::abs(gauss.value));
  EXPECT_LT(difference(fast.gradient, gauss.gradient), 1e-14);
}

TEST(Contraction, TranslationChangesNoBit) {
  PatchModel model = make_cube_model(3, 5);
  // Multiples of 2^-20, so that a shift by a power of two is exact.
  std::mt19937 random(75);
  for (Vec3& p : model.points) {
    for (int axis = 0; axis < 3; ++axis) {
      p[axis] = std::round((p[axis] + testing::uniform(random, -0.05, 0.05)) * 0x1p20) * 0x1p-20;
    }
  }
  const VolumeContraction contraction(model);
  const ValueAndGradient here = contraction.value_and_gradient(model.points);
  std::vector<Vec3> there = model.points;
  for (Vec3& p : there) p += Vec3(0x1p20, -0x1p22, 0x1p24);
  const ValueAndGradient far = contraction.value_and_gradient(there);
  EXPECT_EQ(far.gradient, here.gradient);
  EXPECT_EQ(far.value, here.value);
}

TEST(Contraction, GradientIsTheDerivative) {
  const PatchModel model = random_closed_model(76);
  const VolumeContraction contraction(model);
  const ValueAndGradient at = contraction.value_and_gradient(model.points);
  std::mt19937 random(77);
  std::vector<Vec3> direction(model.points.size());
  for (Vec3& d : direction) {
    for (int axis = 0; axis < 3; ++axis) d[axis] = testing::uniform(random, -1.0, 1.0);
  }
  double slope = 0.0;
  for (size_t i = 0; i < direction.size(); ++i) slope += direction[i].dot(at.gradient[i]);
  const auto moved = [&](double t) {
    std::vector<Vec3> points = model.points;
    for (size_t i = 0; i < points.size(); ++i) points[i] += t * direction[i];
    return contraction.value_and_gradient(points).value;
  };
  // Central differences of a cubic are wrong by t^2 times its third coefficient.
  const double t = 1e-4;
  EXPECT_NEAR((moved(t) - moved(-t)) / (2 * t), slope, 1e-6);
}

TEST(Contraction, OrientationAndErrors) {
  PatchModel model = make_cube_model(2, 3);
  for (Patch& patch : model.patches) patch.reversed = !patch.reversed;
  EXPECT_NEAR(VolumeContraction(model).value_and_gradient(model.points).value, -1.0, 1e-14);
  const VolumeContraction contraction(model);
  EXPECT_THROW((void)contraction.value_and_gradient({}), PreconditionError);
  EXPECT_THROW((void)contraction.gradient_column(model.points, 3), PreconditionError);
  EXPECT_THROW(VolumeContraction{testing::make_sphere(1.0)}, PreconditionError);
}

// Removes a face and lifts the model, so that every rim integral counts.
PatchModel open_model(unsigned seed) {
  testing::RandomModelOptions options;
  options.degrees[seed % 3] = 1 + static_cast<int>(seed % 5);
  PatchModel model = random_closed_model(seed, options);
  model.patches.erase(model.patches.begin() + seed % 6);
  for (Vec3& p : model.points) p.z() += 0.4;
  return model;
}

TEST(Contraction, OpenModelsHaveTheRimOnTop) {
  Worst gradient("contraction_open_gradient", 1e-14);
  for (unsigned seed = 7200; seed < 7212; ++seed) {
    const PatchModel model = open_model(seed);
    const VolumeContraction contraction(model);
    EXPECT_FALSE(contraction.closed());
    const ExactVolume exact(model);
    const ValueAndGradient fast = contraction.value_and_gradient(model.points);
    EXPECT_NEAR(fast.value, exact.value(model.points).to_double(), 1e-14);
    std::vector<Vec3> rows;
    for (const ExactVec3& row : exact.gradient(model.points)) {
      rows.emplace_back(row[0].to_double(), row[1].to_double(), row[2].to_double());
    }
    EXPECT_TRUE(gradient.see(difference(fast.gradient, rows))) << seed;
  }
}

TEST(Contraction, HeightsAreMeasuredFromThePlaneGiven) {
  PatchModel model = open_model(7220);
  const ValueAndGradient from = VolumeContraction(model).value_and_gradient(model.points, 0.7);
  for (Vec3& p : model.points) p.z() -= 0.7;
  const ValueAndGradient lowered = VolumeContraction(model).value_and_gradient(model.points);
  EXPECT_NEAR(from.value, lowered.value, 1e-14);
  EXPECT_LT(difference(from.gradient, lowered.gradient), 1e-14);
}

TEST(Contraction, UnclampedOpenPatch) {
  std::mt19937 random(78);
  const KnotVector u = testing::random_unclamped(random, 3),
                   v = testing::random_unclamped(random, 2);
  PatchModel model;
  Patch patch{"sheet", "face:1", u, v, {}, {}, true, {}, {}};
  for (int k = 0; k < u.size() * v.size(); ++k) patch.points.push_back(k);
  model.points = testing::random_points(random, patch.points.size());
  model.patches = {patch};
  const ValueAndGradient fast = VolumeContraction(model).value_and_gradient(model.points);
  const ExactVolume exact(model);
  EXPECT_NEAR(fast.value, exact.value(model.points).to_double(), 1e-13);
  std::vector<Vec3> rows;
  for (const ExactVec3& row : exact.gradient(model.points)) {
    rows.emplace_back(row[0].to_double(), row[1].to_double(), row[2].to_double());
  }
  EXPECT_LT(difference(fast.gradient, rows), 1e-13);
}

// Wide enough for several strips, tall enough for several tasks.
PatchModel wavy_sheet(int du, int dv, int rows, int columns) {
  PatchModel model;
  Patch patch{"sheet",
              "face:1",
              KnotVector::uniform(du, rows - du),
              KnotVector::uniform(dv, columns - dv),
              {},
              {},
              false,
              {},
              {}};
  std::mt19937 random(79);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      patch.points.push_back(static_cast<int>(model.points.size()));
      model.points.emplace_back(i + testing::uniform(random, -0.3, 0.3),
                                j + testing::uniform(random, -0.3, 0.3),
                                testing::uniform(random, 0.0, 1.0));
    }
  }
  model.patches = {patch};
  return model;
}

TEST(Contraction, ThreadsChangeNoBit) {
  for (InstructionSet set : {InstructionSet::kPortable, best_instruction_set()}) {
    for (const PatchModel& model : {wavy_sheet(3, 2, 530, 300), make_cube_model(3, 9)}) {
      const VolumeContraction contraction(model, set);
      const ValueAndGradient one = contraction.value_and_gradient(model.points, 0.0, 1);
      for (int threads : {2, 3, 8}) {
        const ValueAndGradient many = contraction.value_and_gradient(model.points, 0.0, threads);
        EXPECT_EQ(many.value, one.value) << threads;
        EXPECT_EQ(many.gradient, one.gradient) << threads;
        EXPECT_EQ(contraction.value(model.points, 0.0, threads), contraction.value(model.points));
      }
    }
  }
}

TEST(Contraction, InstructionSetsDifferByRounding) {
  for (int degree : {1, 2, 3, 4, 5, 6, 7}) {
    const PatchModel model = wavy_sheet(degree, 8 - degree, 23, 71);
    const auto portable =
        VolumeContraction(model, InstructionSet::kPortable).value_and_gradient(model.points);
    const auto best = VolumeContraction(model).value_and_gradient(model.points);
    EXPECT_NEAR(portable.value, best.value, 1e-13 * std::abs(best.value)) << degree;
    EXPECT_LT(difference(portable.gradient, best.gradient), 1e-14) << degree;
  }
}

TEST(Contraction, OneColumnAloneHasItsBits) {
  for (const PatchModel& model :
       {wavy_sheet(4, 3, 20, 140), make_cube_model(2, 6), open_model(3)}) {
    const VolumeContraction contraction(model);
    const ValueAndGradient all = contraction.value_and_gradient(model.points, 0.25);
    EXPECT_EQ(contraction.value(model.points, 0.25), all.value);
    for (int axis = 0; axis < 3; ++axis) {
      const std::vector<double> column = contraction.gradient_column(model.points, axis, 0.25);
      for (size_t i = 0; i < column.size(); ++i) EXPECT_EQ(column[i], all.gradient[i][axis]);
    }
  }
}

TEST(Contraction, PartsHaveTheBitsOfTheWhole) {
  const PatchModel model = wavy_sheet(3, 4, 40, 150);
  const VolumeContraction contraction(model);
  const ValueAndGradient all = contraction.value_and_gradient(model.points, 0.5);
  for (const auto& [i0, j0, i1, j1] :
       {std::array{10, 40, 15, 44}, std::array{0, 0, 1, 1}, std::array{35, 0, 40, 150}}) {
    std::vector<int> row_of(model.points.size(), -1);
    std::vector<int> chosen;
    for (int i = i0; i < i1; ++i) {
      for (int j = j0; j < j1; ++j) {
        row_of[static_cast<size_t>(i * 150 + j)] = static_cast<int>(chosen.size());
        chosen.push_back(i * 150 + j);
      }
    }
    std::vector<Vec3> rows(chosen.size(), Vec3::Zero());
    contraction.add_gradient(model.points, row_of, 0.5, rows);
    for (size_t k = 0; k < rows.size(); ++k) {
      EXPECT_EQ(rows[k], all.gradient[static_cast<size_t>(chosen[k])]) << i0 << ' ' << k;
    }
  }
}

TEST(Contraction, PointsOfNoPatchHaveNoGradient) {
  PatchModel model = make_cube_model(2, 2);
  const double volume = VolumeContraction(model).value(model.points);
  model.points.emplace_back(7.0, 8.0, 9.0);
  ValueAndGradient result;
  result.gradient.assign(3, Vec3(1, 2, 3));  // what was there is overwritten
  VolumeContraction(model).value_and_gradient(model.points, 0.0, 1, result);
  EXPECT_EQ(result.value, volume);
  EXPECT_EQ(result.gradient.back(), Vec3(0, 0, 0));
}

// The error grows with the number of poles a side at most like 4 eps m. The yardstick are the same
// sums in twice the precision, which PreciseVolume's tests hold against rationals.
TEST(Contraction, AThousandPolesASide) {
  const int side = 1000;
  const PatchModel model = wavy_sheet(3, 3, side, side);
  const auto exact = precise_areas(model.patches[0], model.points);
  double scale = 0.0;
  for (const auto& row : exact) {
    for (const DoubleDouble& entry : row) scale = std::max(scale, std::abs(entry.high()));
  }
  std::vector<int> inner(model.points.size(), -1);  // the others have the rim's share
  std::vector<size_t> chosen;
  for (int i = 1; i + 1 < side; ++i) {
    for (int j = 1; j + 1 < side; ++j) {
      inner[static_cast<size_t>(i * side + j)] = static_cast<int>(chosen.size());
      chosen.push_back(static_cast<size_t>(i * side + j));
    }
  }
  Worst worst("gradient_over_four_eps_m", 1.0);
  for (InstructionSet set : {InstructionSet::kPortable, best_instruction_set()}) {
    std::vector<Vec3> rows(chosen.size(), Vec3::Zero());
    VolumeContraction(model, set).add_gradient(model.points, inner, 0.0, rows);
    double error = 0.0;
    for (size_t k = 0; k < rows.size(); ++k) {
      for (size_t axis = 0; axis < 3; ++axis) {
        const DoubleDouble wanted = exact[chosen[k]][axis];
        const double entry = rows[k][static_cast<int>(axis)];
        error = std::max(error, std::abs(to_double(DoubleDouble(entry) - wanted)));
      }
    }
    EXPECT_TRUE(worst.see(error / scale / (4.0 * 0x1p-52 * side)));
  }
}

TEST(Contraction, UnitCubeAMillionAway) {
  Worst worst("unit_cube_a_million_away", 1e-13);
  for (int spans : {1, 5, 20}) {
    PatchModel model = make_cube_model(3, spans);
    testing::translate(model, Vec3(1e6, -1e6, 1e6));
    // The poles are rounded on the way out: by 1e-10, which moves the volume of the poles as they
    // are now.
    const double exact = ExactVolume(model).value(model.points).to_double();
    EXPECT_TRUE(worst.see(std::abs(VolumeContraction(model).value(model.points) - exact)));
    EXPECT_TRUE(worst.see(std::abs(VolumeForm(model).value(model.points) - exact)));
  }
}

}  // namespace
}  // namespace isochor
