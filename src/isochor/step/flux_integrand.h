// The inner integrals of flux.h: Q(u, v) and its companions, along u at a fixed v.
//
// B-spline surfaces are contracted with the basis functions of v once per line, so that a line
// costs about as much as a curve; other surfaces are evaluated point by point.
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include <Geom_Surface.hxx>
#include <gp_Pnt.hxx>
#include <gp_Vec.hxx>
#include <optional>
#include <vector>

#include "isochor/bspline/surface.h"
#include "isochor/step/trim_region.h"

namespace isochor::internal {

// A Gauss-Legendre rule on [0, 1], 1 <= count <= 61.
struct UnitRule {
  std::vector<double> nodes, weights;
};
UnitRule unit_rule(int count);

// Integrals of the flux and its companions. `size` and the noises are integrals of absolute values:
// what rounding errors of the terms and of the derivatives scale with.
struct FluxSums {
  long double flux = 0.0, projected = 0.0, area = 0.0;
  long double size = 0.0, noise = 0.0, projected_noise = 0.0;

  void add(const FluxSums& other, double factor);
};

class FluxIntegrand {
 public:
  FluxIntegrand(const Handle(Geom_Surface) & surface, double z0);

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
  FluxSums inner(double u, double v, bool fine) const;

 private:
  struct Line;  // a B-spline surface contracted at one v
  // Basis functions of u at the Gauss points of every span.
  struct Table {
    UnitRule rule;
    std::vector<double> values, slopes;  // [span][point][function]
  };

  Table table_of(int points) const;
  void choose_rules(double u_end, double v_low, double v_high);
  FluxSums line(double u, double v, const Table& table) const;
  void add_span(const Line& line, int ordinal, double from, double to, double sign,
                const Table& table, FluxSums& sums) const;
  void add_piece(double from, double to, double v, const UnitRule& rule, double sign,
                 FluxSums& sums) const;
  void add_point(const gp_Pnt& p, const gp_Vec& du, const gp_Vec& dv, double weight,
                 FluxSums& sums) const;

  Handle(Geom_Surface) surface_;
  double z0_;
  double start_ = 0.0;
  bool polynomial_ = false, plane_ = false, angular_u_ = false;
  int u_degree_ = 0, v_degree_ = 0;
  double least_u_step_ = 0.0, least_v_step_ = 0.0;
  SurfaceBreaks breaks_;
  std::optional<Surface> spline_;  // set when the surface is a B-spline that is not periodic
  Table rule_, fine_rule_;
};

}  // namespace isochor::internal
