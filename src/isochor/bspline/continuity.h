// Which points of a model must not move, and why.
//
// Smoothness is kept by equations where they exist (smooth_relations.h), else by holding still
// every pole that could break it. A function that vanishes at a curve together with its first k
// derivatives keeps the surface's own smoothness of order k there, polynomial or rational: poles of
// such functions may move, all others are locked.
//
// Laws:
//  (1) moving only unlocked points (tied points together) keeps every join and every knot line as
//      smooth as it was measured, every locked side and every trimming curve where it was;
//  (2) locks that are there for smoothness only have `continuity` set; with them lifted, positions
//      are still kept;
//  (3) the result depends on trim, locked_sides, joins and geometry only: deriving twice gives the
//      same locks.
#pragma once

#include <vector>

#include "isochor/bspline/patch_model.h"

namespace isochor {

// Replaces model.relations by those that fit, and model.locks and model.lock_reasons. Uses
// model.joins as they are (the reader fills them, or find_joins). What is locked:
//  - fixed points: as the reader said;
//  - trim: functions whose support is not wholly inside (trims.h);
//  - locked sides: the boundary row, or what shapes the part that is locked; further rows by their
//    smoothness (continuity);
// and, where no relation keeps the smoothness:
//  - joins that do not match, nor in a common basis: the boundary rows of both sides; smooth joins:
//  rows
//    0..1 for tangents and almost tangents, rows 0..2 for curvature (continuity);
//  - knot lines smoother than their basis, wraps included: functions_rough_at (continuity);
//  - collapsed sides with a tangent plane, or nearly: rows 0..1 (continuity). A pole's curvature is
//    not measured and not kept. Collapsed sides whose points are not tied: row 0.
void derive_locks(PatchModel& model);
// The same with chosen relations; none: all smoothness is kept by locks.
void derive_locks(PatchModel& model, std::vector<SmoothRelation> relations);

// The pole rows, counted from the side, that influence derivatives of order 0..order across it:
// 0 .. order for clamped knots, more for unclamped ones.
int boundary_rows(const KnotVector& across, bool begin_side, int order);

// The functions that do not vanish to order `order` at `knot` (an interior knot, or an end of a
// wrapped direction): those with more than degree - order copies of it among their own knots.
std::vector<int> functions_rough_at(const KnotVector& knots, double knot, int order);

// The order of derivatives that a smoothness class is about: 0, 1, 1, 2.
int order_of(Smoothness smoothness);

// The order to protect at a knot line measured as `measured`: never more than simple knots of that
// degree could keep, so that a flat quadratic patch is not frozen for the sake of its curvature.
// At least 1 for smooth lines: piecewise linear directions cannot bend without a crease.
int protected_order(Smoothness measured, int degree);

}  // namespace isochor
