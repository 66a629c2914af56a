#include "isochor/edit/nearest_root.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "isochor/base/tolerance.h"

namespace isochor {

double nearest_root(const LineCubic& c, double target) {
  // Real roots of cubic s^3 + quadratic s^2 + linear s - target, in closed form, then polished by
  // Newton's method on the original coefficients.
  std::vector<double> roots;
  const double scale = std::max({std::abs(c.linear), std::abs(c.quadratic), std::abs(c.cubic)});
  if (scale == 0.0) return target == 0.0 ? 0.0 : std::numeric_limits<double>::quiet_NaN();
  const auto quadratic_roots = [&](double a, double b, double k) {
    if (a == 0.0) {
      if (b != 0.0) roots.push_back(-k / b);
      return;
    }
    const double discriminant = b * b - 4.0 * a * k;
    if (discriminant < 0.0) return;
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    roots.push_back(q / a);
    if (q != 0.0) roots.push_back(k / q);
  };
  if (c.cubic == 0.0) {
    quadratic_roots(c.quadratic, c.linear, -target);
  } else {
    const double a = c.quadratic / c.cubic, b = c.linear / c.cubic, k = -target / c.cubic;
    const double q = (a * a - 3.0 * b) / 9.0;
    const double r = (2.0 * a * a * a - 9.0 * a * b + 27.0 * k) / 54.0;
    if (r * r < q * q * q) {
      const double theta = std::acos(std::clamp(r / std::sqrt(q * q * q), -1.0, 1.0));
      constexpr double kTurn = 2.0943951023931957;  // 2 pi / 3
      for (int m = -1; m <= 1; ++m) {
        roots.push_back(-2.0 * std::sqrt(q) * std::cos(theta / 3.0 + m * kTurn) - a / 3.0);
      }
    } else {
      const double big = -std::copysign(std::cbrt(std::abs(r) + std::sqrt(r * r - q * q * q)), r);
      roots.push_back(big + (big == 0.0 ? 0.0 : q / big) - a / 3.0);
    }
    // When the cubic term is tiny the closed form loses the small roots: Newton from the linear and
    // quadratic models finds them again.
    if (c.linear != 0.0) roots.push_back(target / c.linear);
    quadratic_roots(c.quadratic, c.linear, -target);
  }
  double best = std::numeric_limits<double>::quiet_NaN();
  for (double root : roots) {
    if (!std::isfinite(root)) continue;
    for (int k = 0; k < 60; ++k) {
      const double slope = c.slope(root);
      if (slope == 0.0) break;
      const double step = (c.change(root) - target) / slope;
      root -= step;
      if (std::abs(step) <= kUnitRoundoff * std::abs(root)) break;
    }
    const double residual = std::abs(c.change(root) - target);
    const double size = std::abs(target) + std::abs(c.linear * root) +
                        std::abs(c.quadratic * root * root) +
                        std::abs(c.cubic * root * root * root);
    if (!(residual <= 64.0 * kUnitRoundoff * size)) continue;
    if (std::isnan(best) || std::abs(root) < std::abs(best)) best = root;
  }
  return best;
}

}  // namespace isochor
