// Which part of a trimmed patch may move.
//
// Symbols: an element is a non-empty knot span times a non-empty knot span. Function (i, j) is
// B_i(u) B_j(v); its support is a block of elements.
//
// Laws:
//  (1) an element is crossed when one of the boxes around the trimming curves meets its interior;
//      every other element is wholly inside or wholly outside the kept region;
//  (2) a function is free only when its whole support is inside. Then moving its pole moves no
//      trimming curve, and the change of volume is exactly the untrimmed integral;
//  (3) inserting knots never locks more of the surface: the union of the free supports only grows.
#pragma once

#include <vector>

#include "isochor/bspline/patch_model.h"

namespace isochor {

enum class ElementKind { kInside, kOutside, kCrossed };

// The elements of a patch, u-major: index a * v_count + b for the a-th u span and the b-th v span.
struct ElementGrid {
  int u_count = 0;
  int v_count = 0;
  std::vector<ElementKind> kinds;
  ElementKind at(int a, int b) const { return kinds[static_cast<size_t>(a) * v_count + b]; }
};

// All inside for an empty trim. Cost O(#elements + #boxes + rows of elements * #loop points).
ElementGrid classify_elements(const Patch& patch);

enum class TrimState {
  kFree,        // the support is inside
  kNearTrim,    // the support meets a crossed element (or reaches from inside to outside)
  kTrimmedOff,  // the support is wholly outside
};

// The state of every function (i, j), in the order of the patch's points. Cost O(#points).
std::vector<TrimState> trim_states(const Patch& patch, const ElementGrid& elements);

// True when the point (u, v) lies in the kept region (by the polylines of the loops; no loops:
// yes).
bool inside_trim(const TrimRegion& trim, double u, double v);

}  // namespace isochor
