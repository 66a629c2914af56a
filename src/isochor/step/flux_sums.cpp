#include <cmath>

#include "isochor/step/flux_integrand.h"

namespace isochor::internal {

void FluxSums::add(const FluxSums& other, double factor) {
  const double weight = std::abs(factor);
  flux += other.flux * factor;
  projected += other.projected * factor;
  area += other.area * factor;
  size += other.size * weight;
  noise += other.noise * weight;
  projected_noise += other.projected_noise * weight;
}

double FluxSums::distance(const FluxSums& other) const {
  return std::abs(static_cast<double>(flux - other.flux));
}

void FluxSums::add_distances(const FluxSums& a, const FluxSums& b) {
  flux += std::abs(a.flux - b.flux);
  projected += std::abs(a.projected - b.projected);
}

void MomentSums::add(const MomentSums& other, double factor) {
  for (size_t k = 0; k < kMomentCount; ++k) {
    value[k] += other.value[k] * factor;
    noise[k] += other.noise[k] * std::abs(factor);
  }
  size += other.size * std::abs(factor);
}

double MomentSums::distance(const MomentSums& other) const {
  double largest = 0.0;
  for (size_t k = 0; k < kMomentCount; ++k) {
    largest = std::max(largest, std::abs(static_cast<double>(value[k] - other.value[k])));
  }
  return largest;
}

void MomentSums::add_distances(const MomentSums& a, const MomentSums& b) {
  for (size_t k = 0; k < kMomentCount; ++k) value[k] += std::abs(a.value[k] - b.value[k]);
}

}  // namespace isochor::internal
