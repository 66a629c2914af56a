// How far the parts of a boundary representation are from meeting. Internal to `step`.
//
// OpenCASCADE trusts the tolerances that are stored in a shape; these are the distances themselves,
// sampled densely: between an edge's curve and its curves on the surfaces, and between a vertex and
// the ends of all of these.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <vector>

namespace isochor::internal {

// The largest distance between the edge's curve and its curve on one face, at equal fractions of
// their ranges; for a degenerated edge, the distance of the surface from the vertex. `edge` with
// the orientation it has in the face (a seam has two curves).
double edge_gap(const TopoDS_Edge& edge, const TopoDS_Face& face);

struct Gaps {
  std::vector<double> edges;     // in the order of TopExp::MapShapes(shape, TopAbs_EDGE)
  std::vector<double> vertices;  // likewise
};
Gaps measure_gaps(const TopoDS_Shape& shape);

}  // namespace isochor::internal
