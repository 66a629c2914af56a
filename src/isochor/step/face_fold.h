// Whether a face cuts through itself.
//
// Symbols: C_u and C_v are cones that hold all S_u and all S_v over a rectangle R of parameters
// (hulls of differences of Bezier poles; see face_fold.cpp for weights).
//
// Laws (tests of those names in tests/step/self_intersections_test.cpp):
//  (1) injective: when no line of C_u lies in C_v, S takes no point twice over R, because
//      S(x) - S(y) = a (x_u - y_u) + b (x_v - y_v) with a in C_u and b in C_v;
//  (2) two cells whose bounds are disjoint have no point in common.
// The search divides until every pair of cells falls under one of the two, or lies within a strip
// along seams and collapsed sides.
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include <optional>

#include "isochor/step/cell_pairs.h"
#include "isochor/step/crossing_point.h"

namespace isochor::internal {

enum class FoldAnswer { kFree, kCrossing, kUndecided };

struct FoldSearch {
  FoldAnswer answer = FoldAnswer::kUndecided;
  std::optional<CrossingPoint> found;
  long tests = 0;
};

// `shared`: the seams and collapsed sides of the face. `limit` as for crossing_near; at most `most`
// tests.
FoldSearch search_fold(FaceCells& face, const Shared& shared, double strip, double limit,
                       double diagonal, long most);

}  // namespace isochor::internal
