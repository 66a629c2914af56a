// The difference of two surfaces of one face, and the face's boundary as seen from it. Internal.
#pragma once

#include <Geom_BSplineCurve.hxx>
#include <Geom_Curve.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <functional>
#include <optional>
#include <string>

#include "isochor/bspline/surface.h"

namespace isochor::internal {

// How an edge runs on its face: along an iso line, affinely in the edge's parameter.
struct IsoRun {
  bool along_v = false;  // true: u is constant
  double constant = 0.0;
  double slope = 1.0, offset = 0.0;  // running parameter = slope * t + offset
};

class Displacement {
 public:
  // `before` and `after` in the face's own coordinates. Throws InputError when the bases have
  // nothing in common.
  Displacement(const TopoDS_Face& face, const Surface& before, const Surface& after);

  // Where the differences are only rounding.
  bool is_noise(const Vec3& difference) const { return difference.norm() <= noise_; }
  // The largest displacement along an edge of the face.
  double along(const TopoDS_Edge& edge) const;
  // At the start (0) or the end (1) of the edge's own direction; zero when it is only noise.
  Vec3 at_end(const TopoDS_Edge& edge, int end) const;
  // At a fraction of the edge's range.
  Vec3 at(const TopoDS_Edge& edge, double fraction) const;
  // The largest distance of the new surface along the edge from a curve in the edge's parameter, in
  // the face's coordinates.
  double gap_to(const TopoDS_Edge& edge, const Geom_Curve& curve) const;
  // Empty when the edge does not run along an iso line, or not evenly.
  std::optional<IsoRun> iso_run(const TopoDS_Edge& edge) const;
  // The new curve of an edge on an iso line, in the edge's parameter and the face's coordinates.
  Handle(Geom_Curve) new_curve(const TopoDS_Edge& edge, const IsoRun& run) const;

 private:
  double snapped(double value, const KnotVector& knots) const;

  TopoDS_Face face_;
  TopLoc_Location location_;
  Surface after_, difference_;
  double noise_ = 0.0;
};

// The edge's curve plus `by` (of the fraction of its range), fitted with cubic splines to
// `tolerance` (of the displacement alone where the curve is a spline), in the coordinates of
// `location`. Null when a thousand spans do not suffice, or the edge is placed otherwise.
Handle(Geom_BSplineCurve) displaced_curve(const TopoDS_Edge& edge, const TopLoc_Location& location,
                                          const std::function<Vec3(double)>& by, double tolerance);

}  // namespace isochor::internal
