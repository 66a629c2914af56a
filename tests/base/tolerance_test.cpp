// The relations between the tolerances on which the code relies.
#include "isochor/base/tolerance.h"

#include <gtest/gtest.h>

#include <cmath>

namespace isochor {
namespace {

TEST(Tolerance, UnitRoundoffIsTheLargestRelativeErrorOfOneOperation) {
  EXPECT_EQ(kUnitRoundoff, std::ldexp(1.0, -53));
  EXPECT_EQ(1.0 + kUnitRoundoff, 1.0) << "half an ulp rounds to even";
  EXPECT_GT(1.0 + std::nextafter(kUnitRoundoff, 1.0), 1.0);
}

TEST(Tolerance, PromisesLieAboveRounding) {
  EXPECT_GT(kReached, 1000 * kUnitRoundoff);
  EXPECT_GT(kVolumeKept, 100 * kUnitRoundoff);
  EXPECT_LT(kVolumeKept, kReached) << "the volume is the stricter promise";
}

TEST(Tolerance, ClassesOfSmoothnessAreNested) {
  EXPECT_LT(0.0, kSmoothAngle);
  EXPECT_LT(kSmoothAngle, kAlmostSmoothAngle);
  EXPECT_NEAR(kAlmostSmoothAngle, std::acos(-1.0) / 36, 5e-4) << "five degrees";
}

TEST(Tolerance, MeasuredNoiseIsFarAbovePromises) {
  EXPECT_GT(kCoincident, 1e5 * kReached);
  EXPECT_LT(kCoincident, kSameCurvature);
}

TEST(Tolerance, ADependentPivotIsAboveTheSquareOfRounding) {
  EXPECT_GT(kDependentPivot, std::pow(64 * kUnitRoundoff, 2));
  EXPECT_LT(kDependentPivot, kUnitRoundoff);
}

}  // namespace
}  // namespace isochor
