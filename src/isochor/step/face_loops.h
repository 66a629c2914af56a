// The boundary of a face as loops of parameter curves, in the order in which they are walked.
//
// Loops belong to the *forward* face: walked along them, the kept region lies to the left of the
// curve in the (u, v) plane. A reversed face has the same loops; only its normal is turned.
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include <Geom2d_Curve.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <gp_Pnt2d.hxx>
#include <vector>

namespace isochor::internal {

// One use of an edge by a loop of a face.
struct EdgeUse {
  TopoDS_Edge edge;            // oriented as in its wire
  Handle(Geom2d_Curve) curve;  // on the surface of the face; null: the file has none
  double first = 0.0, last = 0.0;
  bool reversed = false;     // the loop runs from `last` to `first`
  bool degenerated = false;  // the edge is one point of space
  double tolerance = 0.0;

  gp_Pnt2d start() const { return curve->Value(reversed ? last : first); }
  gp_Pnt2d finish() const { return curve->Value(reversed ? first : last); }
};

struct FaceLoop {
  std::vector<EdgeUse> uses;
  bool ordered = true;  // false: the edges of the wire could not be put into one closed chain
};

// Edges that only lie inside the face (internal, external) are left out.
std::vector<FaceLoop> face_loops(const TopoDS_Face& face);

}  // namespace isochor::internal
