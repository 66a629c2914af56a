#include "isochor/bspline/basis.h"

#include <algorithm>

#include "isochor/base/error.h"

namespace isochor {

BasisValues evaluate_basis(const KnotVector& knots, double u, int order) {
  return evaluate_basis_on_span(knots, knots.span_of(u), u, order);
}

BasisValues evaluate_basis_on_span(const KnotVector& knots, int span, double u, int order) {
  ISOCHOR_REQUIRE(0 <= order && order <= BasisValues::kMaxOrder, order);
  ISOCHOR_REQUIRE(knots.degree() <= span && span < knots.size(), span);
  ISOCHOR_REQUIRE(knots[span] < knots[span + 1], span, knots[span]);
  const int d = knots.degree();
  BasisValues result;
  result.first = span - d;
  result.degree = d;

  // lower[p][j]: the functions of degree p that live on the span, B_{span-p+j,p}(u). Only the last
  // `order` + 1 degrees are kept, which is all that derivatives need.
  // Only what is used is set: most degrees are far below the largest.
  std::array<std::array<double, kMaxDegree + 1>, BasisValues::kMaxOrder + 1> lower;
  std::array<double, kMaxDegree + 1> current;
  current[0] = 1.0;
  const auto keep = [&](int p) {
    const int derivative = d - p;
    if (derivative > order) return;
    std::copy_n(current.begin(), p + 1, lower[static_cast<size_t>(derivative)].begin());
  };
  keep(0);
  for (int p = 1; p <= d; ++p) {
    double carried = 0.0;
    for (int j = 0; j < p; ++j) {
      const double left = knots[span - p + 1 + j];
      const double right = knots[span + 1 + j];
      const double share = current[static_cast<size_t>(j)] / (right - left);
      current[static_cast<size_t>(j)] = carried + (right - u) * share;
      carried = (u - left) * share;
    }
    current[static_cast<size_t>(p)] = carried;
    keep(p);
  }

  // r-th derivatives: differentiate the degree d-r functions upwards, one degree at a time, with
  // B'_{i,p} = p (B_{i,p-1} / (t_{i+p} - t_i) - B_{i+1,p-1} / (t_{i+p+1} - t_{i+1})).
  for (int r = 0; r <= order; ++r) {
    if (r > d) {
      for (int j = 0; j <= d; ++j) result.value(r, j) = 0.0;
      continue;
    }
    auto& values = lower[static_cast<size_t>(r)];
    for (int p = d - r + 1; p <= d; ++p) {
      double carried = 0.0;
      for (int j = 0; j < p; ++j) {
        const double left = knots[span - p + 1 + j];
        const double right = knots[span + 1 + j];
        const double slope = p * values[static_cast<size_t>(j)] / (right - left);
        values[static_cast<size_t>(j)] = carried - slope;
        carried = slope;
      }
      values[static_cast<size_t>(p)] = carried;
    }
    for (int j = 0; j <= d; ++j) result.value(r, j) = values[static_cast<size_t>(j)];
  }
  return result;
}

}  // namespace isochor
