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
//  (3) inserting knots never locks more of the surface: the union of the free supports only grows;
//  (4) released boxes lock nothing: a function that meets no other box is free as soon as a part of
//      its support is not trimmed off.
#pragma once

#include <utility>
#include <vector>

#include "isochor/bspline/patch_model.h"

namespace isochor {

// kReleased: crossed, but only by trimming curves that may move.
enum class ElementKind { kInside, kOutside, kCrossed, kReleased };

// The elements of a patch, u-major: index a * v_count + b for the a-th u span and the b-th v span.
struct ElementGrid {
  int u_count = 0;
  int v_count = 0;
  std::vector<ElementKind> kinds;
  ElementKind at(int a, int b) const { return kinds[static_cast<size_t>(a) * v_count + b]; }
};

// Ranges [first, second) of the boxes of a trim.
using BoxRanges = std::vector<std::pair<int, int>>;

// All inside for an empty trim. Cost O(#elements + #boxes + rows of elements * #loop points).
ElementGrid classify_elements(const Patch& patch, const BoxRanges& released = {});

// The boxes of patch q that belong to trims released for it.
BoxRanges released_boxes(const PatchModel& model, int q);
bool contains(const BoxRanges& ranges, int box);
// Whether a trim released for its patch runs along this locked side (index into
// model.locked_sides), or a released trim ends at this fixed point (index into model.fixed_points).
bool side_is_released(const PatchModel& model, int locked_side);
bool corner_is_released(const PatchModel& model, int fixed_point);

enum class TrimState {
  kFree,        // the support is inside, or meets no trimming curves but released ones
  kNearTrim,    // the support meets a crossed element (or reaches from inside to outside)
  kTrimmedOff,  // the support is wholly outside
};

// The state of every function (i, j), in the order of the patch's points. Cost O(#points).
std::vector<TrimState> trim_states(const Patch& patch, const ElementGrid& elements);

// True when the point (u, v) lies in the kept region (by the polylines of the loops; no loops:
// yes).
bool inside_trim(const TrimRegion& trim, double u, double v);

}  // namespace isochor
