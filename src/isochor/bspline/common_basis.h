// Two curves in different bases, written in one.
//
// Symbols: two sides (or parts of sides) run along the same curve; x in [0, 1] is the parameter
// they share, affine in the running parameter of each, and backwards in the second when the join is
// opposed. Side s has the functions b^s_j. The common basis C_i over [0, 1] is the coarsest that
// holds both: the larger degree d, each knot with the multiplicity m_s + d - d_s of the side that
// needs more. Then b^s_j = sum_i M^s(i,j) C_i, and two displacements sum a_j b^1_j, sum c_j b^2_j
// are the same curve exactly when M^1 a = M^2 c.
//
// Row i of M^s is the blossom of b^s at the knots x_{i+1} .. x_{i+d} of C_i; for a lower degree d_s
// the mean of its blossoms over all choices of d_s of them: degree elevation, knot insertion and
// the restriction to a part in one formula, without rounding.
//
// Laws:
//  (1) the rows add up to exactly 1;
//  (2) C with the coefficients M^s a is the curve with the coefficients a, as rational numbers;
//  (3) sides with the same knots get unit rows.
//
// Knots of the two sides that differ by at most kSameSide (in x) count as one.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "isochor/bspline/exact_refinement.h"
#include "isochor/bspline/knots.h"
#include "isochor/bspline/patch_model.h"
#include "isochor/exact/rational.h"

namespace isochor {

// One side of a join, seen along its curve.
struct CommonSide {
  KnotVector knots;  // of its displacements: `fine` or a coarser scale of it
  KnotVector fine;
  SidePart part;         // of the running parameter
  bool flipped = false;  // x runs against it
};

class CommonBasis {
 public:
  CommonBasis(const CommonSide& first, const CommonSide& second);

  int degree() const { return degree_; }
  int size() const { return static_cast<int>(knots_.size()) - degree_ - 1; }
  // x_0 .. x_{size + degree}.
  const std::vector<Rational>& knots() const { return knots_; }
  // M^s in the side's own numbering, s = 0 or 1. Cost O(size d d_s^2) rational operations.
  ExactMap map(int s) const;

 private:
  struct Curve {
    int degree = 0;
    bool flipped = false;
    std::vector<Rational> knots;  // in x, ascending
  };
  ExactMapRow row_of(const Curve& curve, int i) const;

  Curve curves_[2];
  int degree_ = 0;
  std::vector<Rational> knots_;
};

// The surface on other knots along one direction, its homogeneous poles combined by `map`.
Surface refined_along(const Surface& surface, Direction along, const ExactMap& map,
                      const KnotVector& knots);

// The common basis of a join at a scale: `first`, `second` are the knots along its sides.
CommonBasis common_basis(const PatchModel& model, const Join& join, const KnotVector& first,
                         const KnotVector& second);

// The two patches of a join, each refined along the join to the common basis and cut to the part
// that takes part in it; x runs forwards in both. Nothing across the join changes.
struct CommonPair {
  PatchModel model;  // two patches, no joins
  SideRef a, b;
};
// Empty when doubles cannot tell the knots of the common basis apart.
std::optional<CommonPair> common_pair(const PatchModel& model, const std::vector<Vec3>& at,
                                      const Join& join);

}  // namespace isochor
