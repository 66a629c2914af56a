// The inner integrals of flux.h: Q(u, v) and its companions, along u at a fixed v.
//
// B-spline surfaces are contracted with the basis functions of v once per line, so that a line
// costs about as much as a curve; other surfaces are evaluated point by point.
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include <Geom_Surface.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <gp_Pnt.hxx>
#include <gp_Vec.hxx>
#include <optional>
#include <vector>

#include "isochor/bspline/surface.h"
#include "isochor/step/trim_region.h"
#include "isochor/volume/flux_field.h"
#include "isochor/volume/moments.h"

namespace isochor::internal {

// A Gauss-Legendre rule on [0, 1], 1 <= count <= 61.
struct UnitRule {
  std::vector<double> nodes, weights;
};
UnitRule unit_rule(int count);

// A homogeneous point, with or without weight.
struct Homogeneous {
  double x = 0.0, y = 0.0, z = 0.0, w = 0.0;
  void add(double factor, const Homogeneous& h) {
    x += factor * h.x;
    y += factor * h.y;
    z += factor * h.z;
    w += factor * h.w;
  }
};

// A point of the surface with what its rounding errors are relative to: `reach` for the position,
// the noisy speeds, which hold it too, for the derivatives.
struct SurfacePoint {
  gp_Pnt p;
  gp_Vec du, dv;
  double speed_u = 0.0, speed_v = 0.0;  // |du|, |dv|
  double reach = 0.0, noisy_u = 0.0, noisy_v = 0.0;
};

// Integrals of the flux and its companions. `size` and the noises are integrals of absolute values:
// what rounding errors of the terms and of the derivatives scale with.
struct FluxSums {
  long double flux = 0.0, projected = 0.0, area = 0.0;
  long double size = 0.0, noise = 0.0, projected_noise = 0.0;

  void add(const FluxSums& other, double factor);
  double distance(const FluxSums& other) const;
  void add_distances(const FluxSums& a, const FluxSums& b);
  double largest_noise() const { return static_cast<double>(noise); }
};

// The flux of field - (a shift of its level by z0); without a field, of (0, 0, z - z0).
struct FluxKind {
  using Sums = FluxSums;
  static constexpr int kFactors = 3;      // the integrand has degree 3d - 1
  static constexpr int kLeastPoints = 6;  // areas are not polynomial: a few more than flux needs

  double z0 = 0.0;
  FluxField field = {};
  double steepness = field.slope.norm();
  void add(const SurfacePoint& at, double weight, FluxSums& sums) const;
};

// The integrals of f(r) r.N of moments.h, r = (S - origin) / length, N = S_u x S_v.
struct MomentSums {
  std::array<long double, kMomentCount> value{};
  std::array<double, kMomentCount> noise{};
  long double size = 0.0;  // of |r.N|

  void add(const MomentSums& other, double factor);
  double distance(const MomentSums& other) const;
  void add_distances(const MomentSums& a, const MomentSums& b);
  double largest_noise() const { return *std::max_element(noise.begin(), noise.end()); }
};

// `length` is about as large as the body, so that all ten have numbers of one size.
struct MomentKind {
  using Sums = MomentSums;
  static constexpr int kFactors = 5;
  static constexpr int kLeastPoints = 3;

  Vec3 origin = Vec3::Zero();
  double length = 1.0;
  void add(const SurfacePoint& at, double weight, MomentSums& sums) const;
};

// Here, so that they become part of the loops over points.
inline void FluxKind::add(const SurfacePoint& at, double w, FluxSums& sums) const {
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
  sums.noise += std::abs(height) * mixed + steepness * at.reach * std::abs(w * jacobian);
  sums.projected_noise += mixed;
}

inline void MomentKind::add(const SurfacePoint& at, double w, MomentSums& sums) const {
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

// Instantiated for the two kinds.
template <typename Kind>
class FluxIntegrand {
 public:
  using Sums = typename Kind::Sums;
  // What Contour needs to know.
  static constexpr int kFactors = Kind::kFactors;
  static constexpr int kLeastPoints = Kind::kLeastPoints;
  static constexpr int kMaxHalvings = 8;       // of a piece of a curve
  static constexpr int kHalvings = 1 << 30;    // of all pieces together
  static constexpr double kConverged = 1e-15;  // what a halving may change, see contour.cpp
  static constexpr bool kHasLevel = false;     // no place where the integrand is not smooth
  FluxIntegrand(const Handle(Geom_Surface) & surface, const Kind& kind);

  // All rules are exact; false: pieces must be tested.
  bool polynomial() const { return polynomial_; }
  bool plane() const { return plane_; }
  int u_degree() const { return u_degree_; }
  int v_degree() const { return v_degree_; }
  const std::vector<double>& u_breaks() const { return breaks_.u; }
  const std::vector<double>& v_breaks() const { return breaks_.v; }

  // Chooses where Q starts: near the middle of [low, high]; then the size of the rules.
  void prepare(double low, double high, double v_low, double v_high);
  // Q starts exactly here.
  void prepare_at(double start, double u_end, double v_low, double v_high);

  // Q and its companions at (u, v). `fine`: with a larger rule, to see what the rule is worth.
  Sums inner(double u, double v, bool fine) const;

 private:
  struct Line;  // a B-spline surface contracted at one v
  // Basis functions of u at the Gauss points of every span.
  struct Table {
    UnitRule rule;
    std::vector<double> values, slopes;  // [span][function][point]
  };
  static constexpr size_t kMostPoints = 64;
  using Coordinates = std::array<std::array<double, kMostPoints>, 4>;  // x, y, z, w of points

  int exact_points() const { return (Kind::kFactors * u_degree_ + 1) / 2; }
  Table table_of(int points) const;
  static Table partial_table(const KnotVector& knots, int span, double from, double to,
                             const UnitRule& rule);
  static void contract(const double* basis, const Homogeneous* poles, size_t functions,
                       size_t points, bool rational, Coordinates& out);
  void choose_rules(double u_end, double v_low, double v_high);
  Sums line(double u, double v, const Table& table) const;
  void add_span(const Line& line, int ordinal, double from, double to, double sign,
                const Table& table, Sums& sums) const;
  void add_piece(double from, double to, double v, const UnitRule& rule, double sign,
                 Sums& sums) const;
  void add_point(const gp_Pnt& p, const gp_Vec& du, const gp_Vec& dv, double weight,
                 Sums& sums) const;

  Handle(Geom_Surface) surface_;
  Kind kind_;
  double start_ = 0.0;
  bool polynomial_ = false, plane_ = false, angular_u_ = false;
  int u_degree_ = 0, v_degree_ = 0;
  double least_u_step_ = 0.0, least_v_step_ = 0.0;
  SurfaceBreaks breaks_;
  std::optional<Surface> spline_;  // set when the surface is a B-spline that is not periodic
  Table rule_, fine_rule_;
};

}  // namespace isochor::internal
