// Maps between spline spaces by least squares on samples: a second method for everything that the
// library does by knot insertion.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "isochor/bspline/basis.h"
#include "support/splines.h"

namespace isochor::testing {

// Row k: all functions at samples[k].
inline Eigen::MatrixXd collocation(const KnotVector& knots, const std::vector<double>& samples) {
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(static_cast<long>(samples.size()), knots.size());
  for (size_t k = 0; k < samples.size(); ++k) {
    const BasisValues b = evaluate_basis(knots, samples[k]);
    for (int j = 0; j <= b.degree; ++j) values(static_cast<long>(k), b.first + j) = b.value(0, j);
  }
  return values;
}

// From coarse coefficients to fine ones; exact up to rounding when the spaces are nested.
inline Eigen::MatrixXd fitted_map(const KnotVector& coarse, const KnotVector& fine) {
  const std::vector<double> samples = sample_parameters(fine, fine.degree() + 2);
  return collocation(fine, samples).colPivHouseholderQr().solve(collocation(coarse, samples));
}

}  // namespace isochor::testing
