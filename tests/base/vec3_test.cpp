#include "isochor/base/vec3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace isochor {
namespace {

TEST(Vec3, IsThreeDoublesInARow) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  const Vec3 point(1.0, 2.0, 3.0);
  EXPECT_EQ(point.data()[2], 3.0);
}

TEST(Uv, StartsAtTheOrigin) { EXPECT_TRUE((Uv() == Uv{0.0, 0.0})); }

TEST(Uv, ComparesBothCoordinatesExactly) {
  const Uv a{0.25, 0.5};
  EXPECT_TRUE((a == Uv{0.25, 0.5}));
  EXPECT_FALSE((a == Uv{std::nextafter(0.25, 1.0), 0.5}));
  EXPECT_FALSE((a == Uv{0.25, std::nextafter(0.5, 0.0)}));
}

TEST(Uv, NaNEqualsNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE((Uv{nan, 0.0} == Uv{nan, 0.0}));
}

}  // namespace
}  // namespace isochor
