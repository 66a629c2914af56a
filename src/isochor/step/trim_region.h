// Which part of its surface a face keeps: sides of the parameter rectangle, boxes along the
// trimming curves, polylines for the inside test.
//
// Laws:
//  (1) cover: every point of every trimming curve lies in one of the boxes, except on edges that
//      run along a covered side;
//  (2) a face whose four sides are covered, and that has no other edges, is `kNatural` and its
//      region is empty;
//  (3) inside: the loops cross a ray an odd number of times exactly from points inside the face
//      (points nearer to the boundary than the loops' chord error left aside).
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include <Geom_Surface.hxx>
#include <TopoDS_Face.hxx>
#include <array>
#include <utility>
#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/step/face_loops.h"
#include "isochor/step/solid_model.h"

namespace isochor::internal {

// One place in the loops of a face.
struct UseRef {
  int loop = 0;
  int use = 0;
};

// The edges along one side of the parameter rectangle.
struct SideCover {
  std::vector<UseRef> uses;  // edges that run along the side (degenerated ones too)
  bool covered = false;      // together they cover it
  bool collapsed = false;    // the side is one point of space
  // Covered by exactly one edge: the neighbour there is the neighbour of the whole side.
  bool whole() const { return covered && uses.size() == 1; }
};

struct FaceTrim {
  TrimKind kind = TrimKind::kTrimmed;
  UvBox domain;                    // of the surface; infinite sides are +-1e100 or more
  std::array<SideCover, 4> sides;  // in the order of kSides
  TrimRegion region;
  // By loop and use: the boxes of the region that cover it, [first, second).
  std::vector<std::vector<std::pair<int, int>>> boxes;
};

// Tests sides of the surface's own domain. `distance`: a curve runs along a side when it stays
// nearer than this to the side in space, or within the tolerance of its edge.
FaceTrim classify_trim(const Handle(Geom_Surface) & surface, const std::vector<FaceLoop>& loops,
                       double distance);

// The same without the region's boxes and polylines, which cost the most.
FaceTrim classify_sides(const Handle(Geom_Surface) & surface, const std::vector<FaceLoop>& loops,
                        double distance);

// The distinct knots (or other breaks of smoothness) inside the domain of a surface.
struct SurfaceBreaks {
  std::vector<double> u, v;
};
SurfaceBreaks surface_breaks(const Handle(Geom_Surface) & surface);

}  // namespace isochor::internal
