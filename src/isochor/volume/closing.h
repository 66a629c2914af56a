// Where a model is open, and which planes close it.
//
// An *open edge* is a curve that only one face has. A model is closed by planes when each of its
// open edges lies in one of them within a tolerance; the caps themselves are never made.
//
// Laws (tests of those names in tests/volume/closing_test.cpp):
//  (1) the planes that planes_of finds, with nothing left over, close the model;
//  (2) an edge that lies in no plane is listed with its distance from the nearest.
#pragma once

#include <string>
#include <vector>

#include "isochor/bspline/joins.h"
#include "isochor/bspline/patch_model.h"
#include "isochor/volume/flux_field.h"

namespace isochor {

struct OpenEdge {
  std::string label;         // "side v1 of face:3", "edge:7 (of face:3)"
  std::vector<Vec3> points;  // along it, both ends included
};

// The open sides of a model, each at degree + 1 points a span: for sides without weights a distance
// that vanishes at all of them vanishes along the side.
std::vector<OpenEdge> open_edges(const PatchModel& model, const Closure& closure);

struct ClosingCheck {
  bool closed = false;
  std::string why_open;   // the edges that lie in none of the planes, with their distances
  double farthest = 0.0;  // largest distance of an open edge from its plane (length)
};
ClosingCheck check_closing(const std::vector<OpenEdge>& edges,
                           const std::vector<ClosingPlane>& planes, double tolerance);

// Planes that hold open edges, the one with most edges first; coordinate planes are preferred, and
// offsets are given with no more digits than the tolerance needs.
struct OpenPlanes {
  struct Group {
    ClosingPlane plane;
    int edges = 0;
  };
  std::vector<Group> groups;
  std::vector<std::string> left_over;  // labels of edges that lie in no plane
};
OpenPlanes planes_of(const std::vector<OpenEdge>& edges, double tolerance);

// "open along 12 edges, all in the plane y = 0: --close y=0 closes it"; empty without open edges.
std::string opening_text(const std::vector<OpenEdge>& edges, double tolerance);

}  // namespace isochor
