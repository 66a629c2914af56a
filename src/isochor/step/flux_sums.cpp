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

void FluxKind::add(const SurfacePoint& at, double w, FluxSums& sums) const {
  const Vec3& c = field.slope;
  const Vec3& b = field.direction;
  const double height = (c.x() * at.p.X() + c.y() * at.p.Y() + c.z() * at.p.Z() - field.level) - z0;
  const double jacobian = b.x() * (at.du.Y() * at.dv.Z() - at.dv.Y() * at.du.Z()) +
                          b.y() * (at.du.Z() * at.dv.X() - at.dv.Z() * at.du.X()) +
                          b.z() * (at.du.X() * at.dv.Y() - at.dv.X() * at.du.Y());
  sums.flux += w * height * jacobian;
  sums.projected += w * jacobian;
  sums.area += w * at.du.Crossed(at.dv).Magnitude();
  const double mixed = std::abs(w) * (at.noisy_u * at.speed_v + at.noisy_v * at.speed_u);
  sums.size += std::abs(w * height * jacobian);
  sums.noise += std::abs(height) * mixed + c.norm() * at.reach * std::abs(w * jacobian);
  sums.projected_noise += mixed;
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

void MomentKind::add(const SurfacePoint& at, double w, MomentSums& sums) const {
  const Vec3 r = (Vec3(at.p.X(), at.p.Y(), at.p.Z()) - origin) / length;
  const gp_Vec cross = at.du.Crossed(at.dv);
  const Vec3 normal(cross.X(), cross.Y(), cross.Z());
  const double flux = w * r.dot(normal);
  const double slip = at.reach / length;  // what an error of the position is relative to
  // The error of r.N; then f(r) changes by its slope, at most twice |r|, times that of r.
  const double noise =
      std::abs(w) *
      (r.norm() * (at.noisy_u * at.speed_v + at.noisy_v * at.speed_u) + slip * normal.norm());
  const MomentArray f = monomials(r);
  for (size_t k = 0; k < kMomentCount; ++k) {
    const double slope = k == 0 ? 0.0 : k < 4 ? 1.0 : 2.0 * r.norm();
    sums.value[k] += f[k] * flux;
    sums.noise[k] += std::abs(f[k]) * noise + slope * slip * std::abs(flux);
  }
  sums.size += std::abs(flux);
}

}  // namespace isochor::internal
