// What keeps the skin smooth: linear equations on displacements.
//
// Symbols: H = (N, W) = (sum w p B, sum w B) is the surface in homogeneous coordinates (W = 1
// without weights). Two strips of surface meet along a curve with a common basis b_j along it: at a
// join, an interior knot line, or a seam that wraps. n is the parameter across, running from the
// first strip into the second; - and + mark derivatives taken in the first and in the second. The
// pole index across is i, along it is j.
//
// G1:  H_n+  = lambda H_n- + rho H             G2: H_nn+ = lambda^2 H_nn- + mu H_n- + sigma H
// with constant lambda, mu, rho, sigma. A displacement whose numerator sum w delta B obeys the same
// relations leaves their residuals as they are, and with them the angle and the curvature jump.
// Coefficient by coefficient in b_j that is one equation per j and relation:
//     sum_i k_i w_ij delta_ij = 0.
// Where the strips have different bases along the line (joins that are `common`), the numerators
// are written in the common basis C_c first: sum_i k_i sum_j M(c,j) w_ij delta_ij = 0 for each c.
// The positions of the two sides then need equations, too (Kind::kTie): the same with k = 1 for the
// one boundary row and k = -1 for the other. lambda and mu are geometry: measured on the poles and
// taken as the simplest rationals within the noise. rho and sigma follow from the weights, so that
// sum_i k_i w_ij = 0 exactly.
//
// At a pole with a tangent plane the second row must stay an affine image of itself (see
// continuity_rows).
//
// Laws:
//  (1) translations fulfil every row exactly; linear maps of the model to its residual;
//  (2) a displacement that fulfils the rows leaves the angle and (order 2) the jump of the normal
//      curvature across the curve as they were, up to rounding; at a pole the tangent plane's
//      angle;
//  (3) rows that depend on each other in exact arithmetic do so as stored: factors, knots and
//      weights that agree within noise give identical rows;
//  (4) where no constant factor fits within kSmoothResidual there is no relation.
#pragma once

#include <string>
#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/bspline/smoothness.h"
#include "isochor/exact/rational.h"

namespace isochor {

// The relations that fit: for each join in a common basis its tie; for each smooth join that
// matches or has a common basis, each knot line and wrap that is smoother than its basis, each pole
// with a tangent plane. Uses model.joins as they are.
std::vector<SmoothRelation> smooth_relations(const PatchModel& model);

// The points that have to stay when the relation has no rows (what derive_locks locks for it).
std::vector<int> points_locking(const PatchModel& model, const SmoothRelation& relation);

// The grid of coarse coefficients of one patch.
struct CoarseKnots {
  KnotVector u, v;
};

struct GridTerm {
  int patch = 0, i = 0, j = 0;  // index on the coarse grid of the patch
  Rational value;
};

// sum value * displacement = 0, on each axis.
struct ContinuityRow {
  std::vector<GridTerm> terms;
  int relation = 0;  // index into the relations
};

struct ContinuityRows {
  std::vector<ContinuityRow> rows;
  std::vector<int> inexpressible;  // relations that this scale cannot state: lock them
};

// The rows on coarse displacements c, with fine displacements delta = U c V^T. `coarse`: for each
// patch its own knots or a subset of them (wrapped ones rebuilt as by keep_flagged).
//
// With g_a = sum_i k_i w_i U_ia the fine rows hold for all j when g . c_b = 0 for each coarse b
// along the line: one row for each b. Relations that the coarse functions fulfil by themselves give
// none. Where weights do not separate, the line must not be coarsened along its own direction. In a
// common basis the rows are those of the coarse functions, where weights along the line are
// constant. PreconditionError when `coarse` does not fit the model.
ContinuityRows continuity_rows(const PatchModel& model,
                               const std::vector<SmoothRelation>& relations,
                               const std::vector<CoarseKnots>& coarse);

}  // namespace isochor
