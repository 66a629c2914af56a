// Cells and Gauss points for a patch with weights, and what they can miss.
#pragma once

#include <memory>
#include <vector>

#include "isochor/volume/element_fields.h"

namespace isochor::internal {

// Tables shared by all patches with the same knots and rules.
class TableCache {
 public:
  std::shared_ptr<const SpanTable> get(const KnotVector& knots, int gauss_points);
  std::shared_ptr<const SpanTable> get(const KnotVector& knots,
                                       const std::vector<SpanCells>& cells);

 private:
  std::vector<std::shared_ptr<const SpanTable>> tables_;
};

// No cell gets more points than this, unless its degree alone asks for more; no span is halved more
// often than that. Together they limit what extreme weights may cost: beyond ratios of about 1e5
// between neighbours the bounds grow instead (they stay true).
inline constexpr int kMaxCellPoints = 32;
inline constexpr int kMaxDepth = 14;

struct QuadratureChoice {
  std::vector<SpanCells> u, v;  // per span
  // Per element, u-major: the quadrature of z (x_u y_v - x_v y_u) misses the integral by at most
  // this times r_x r_y r_z, whatever the poles: r_z is the largest |z| of the element's poles, r_x
  // and r_y those of x and y measured from anywhere. (Rounding apart.)
  std::vector<double> remainder;
};

// The cheapest choice found, from knots and weights alone, for which each cell misses at most
// kQuadratureShare. Where W does not change along a direction, that direction keeps the exact rule.
// PreconditionError when a weight is not positive and finite. Cost: some ten microseconds per
// element and cell.
QuadratureChoice choose_quadrature(const KnotVector& u, const KnotVector& v,
                                   const std::vector<double>& weights);

// Gives a patch with weights its tables and remainders.
void choose_rules(PatchForm& patch, TableCache& tables);

}  // namespace isochor::internal
