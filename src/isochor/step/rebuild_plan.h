// What must change in a shape when the poles of some faces have moved. Internal to `step`.
//
// A face's displacement D(u, v) = new surface - old surface, in one basis. Where D vanishes along
// an edge, the edge stays as it is. Else the edge must run along an iso line of the face, and its
// new curve is either the old one plus D (when both have the same basis, so that existing gaps
// stay) or the iso curve of the new surface, in the edge's own parameter. Vertices move by D at
// their parameters.
//
// Trimming edges move only when a tolerance for them is given, and with all their faces: parameter
// curves stay, the new curve is the old one plus the mean of the faces' displacements, fitted, and
// the edge's tolerance grows to the gap that is measured then; never beyond the one given.
#pragma once

#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <TopLoc_Location.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <gp_Pnt.hxx>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "isochor/bspline/surface.h"

namespace isochor::internal {

// New geometry of one face of a part, in the coordinates of the face's own surface (its location
// comes on top).
struct FaceChange {
  TopoDS_Face face;
  std::string handle;  // for messages
  Surface surface;
  // Of a face that was no B-spline and was converted, or that the reader changed.
  std::optional<Surface> before;
};

struct NewSurface {
  TopoDS_Face face;
  Handle(Geom_Surface) surface;
  std::string handle;
  bool converted = false;  // it was no B-spline
  Surface before, after;   // in the coordinates of the face's own surface
};
struct NewCurve {
  TopoDS_Shape edge;
  Handle(Geom_Curve) curve;
  TopLoc_Location location;
  double tolerance = 0.0;  // at least this for the edge: of a moved trim
};
struct NewPoint {
  TopoDS_Shape vertex;
  gp_Pnt point;
  double tolerance = 0.0;  // at least this for the vertex
};

struct RebuildPlan {
  std::vector<NewSurface> surfaces;
  std::vector<NewCurve> curves;
  std::vector<NewPoint> points;
  std::string refusal;  // why it cannot be done, in words; else empty
};

RebuildPlan plan_rebuild(const TopoDS_Shape& part, const std::vector<FaceChange>& changes,
                         double trim_tolerance = 0.0);

}  // namespace isochor::internal
