// The inner integrals of solid_section.h and solid_below.h: what lies below the plane Z = 0 of a
// line v = const.
//
// Symbols: (X, Y, Z) the coordinates of a surface that stands in the plane's frame, J = X_u Y_v -
// X_v Y_u. Q(u, v) is the integral of f J over the part of the line from a fixed u = a to u where
// Z < -noise, with f = 1, X, Y; or, with a field, of the lanes of below_cells.h. Along a line Q is
// smooth between the roots of Z, which are searched for between samples; along a curve in (u, v) it
// is smooth but where the curve passes the plane, or where the section turns back. Contour cuts at
// the first and halves towards the second.
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include <Geom_Surface.hxx>
#include <array>
#include <gp_Pnt2d.hxx>
#include <optional>
#include <vector>

#include "isochor/bspline/surface.h"
#include "isochor/step/trim_region.h"
#include "isochor/volume/below_cells.h"

namespace isochor::internal {

struct SectionSums {
  std::array<long double, 4> value{};  // of J, X J, Y J, and nothing; or of the field's lanes
  long double size = 0.0;              // of the first, absolutely
  // Of |S_u| |S_v|, which the rounding of J is relative to; with a field, times |T| and its slips.
  long double noise = 0.0;
  double lever = 0.0;  // with a field: a length, to compare the other lanes by as well

  void add(const SectionSums& other, double factor);
  double distance(const SectionSums& other) const;
  void add_distances(const SectionSums& a, const SectionSums& b);
  // In units of the unit roundoff.
  double largest_noise() const { return 256.0 * static_cast<double>(noise); }
};

class SectionIntegrand {
 public:
  using Sums = SectionSums;
  static constexpr int kFactors = 3;
  static constexpr int kLeastPoints = 3;
  static constexpr int kMaxHalvings = 26;
  static constexpr int kHalvings = 4000;  // a second or so for one face
  static constexpr double kConverged = 1e-13;
  static constexpr bool kHasLevel = true;

  // Heights within `noise` of the plane count as above it.
  SectionIntegrand(const Handle(Geom_Surface) & surface, double noise,
                   const std::optional<FrameField>& field = {});

  bool polynomial() const { return false; }  // no rule is exact across the plane
  bool plane() const { return false; }
  int u_degree() const { return u_degree_; }
  int v_degree() const { return v_degree_; }
  const std::vector<double>& u_breaks() const { return breaks_.u; }
  const std::vector<double>& v_breaks() const { return breaks_.v; }
  double level(const gp_Pnt2d& at) const;
  // All poles of a B-spline, or a plane as a whole, are within the noise of Z = 0.
  bool coplanar() const;
  // All poles of a B-spline are above: the face adds nothing.
  bool above() const;

  void prepare(double low, double high, double v_low, double v_high);
  void prepare_at(double start, double u_end, double v_low, double v_high);
  SectionSums inner(double u, double v, bool fine) const;

 private:
  class Line;
  void add_piece(const Line& line, double from, double to, double sign, SectionSums& sums) const;

  Handle(Geom_Surface) surface_;
  double noise_;
  std::optional<FrameField> field_;
  double start_ = 0.0;
  int u_degree_ = 0, v_degree_ = 0, points_ = 0;
  bool angular_u_ = false;
  SurfaceBreaks breaks_;
  std::optional<Surface> spline_;  // set when the surface is a B-spline that is not periodic
};

}  // namespace isochor::internal
