// How far the parts of a boundary representation are from meeting. Internal to `step`.
//
// OpenCASCADE trusts the tolerances that are stored in a shape; these are the distances themselves,
// sampled densely: between an edge's curve and its curves on the surfaces, and between a vertex and
// the ends of all of these.
#pragma once

#include <TopoDS_Shape.hxx>
#include <vector>

namespace isochor::internal {

struct Gaps {
  // The largest distance between the edge's curve and its curves on the faces, at equal fractions
  // of their ranges; for a degenerated edge, the distance of the surface from the vertex. In the
  // order of TopExp::MapShapes(shape, TopAbs_EDGE).
  std::vector<double> edges;
  std::vector<double> vertices;  // likewise, TopAbs_VERTEX
};
Gaps measure_gaps(const TopoDS_Shape& shape);

}  // namespace isochor::internal
