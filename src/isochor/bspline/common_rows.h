// Equations across a line, written out along it in the common basis of its two sides. A detail of
// smooth_relations.h, whose symbols apply.
#pragma once

#include <array>
#include <vector>

#include "isochor/bspline/coarse_grids.h"
#include "isochor/bspline/smooth_relations.h"

namespace isochor::internal {

class CommonRows {
 public:
  // `grids` must outlive this object.
  CommonRows(const PatchModel& model, const Join& join, CoarseGrids* grids);

  // Functions of the common basis.
  int size() const { return static_cast<int>(shares_[0].size()); }

  // Equation c: the terms' rows are coarse ones. Values are multiples of 2^-64 of the largest where
  // exact ones are longer; they add up to exactly the sum of the equation's values.
  std::vector<GridTerm> row(const LineEquation& equation, int c) const;

 private:
  // The share of each coarse coefficient along side s in each function; shares add up to 1.
  void fill(size_t s, const ExactMap& map, bool coarse_map, const std::vector<Rational>& weights,
            CoarseGrids* grids);

  std::array<SideRef, 2> sides_;
  std::array<std::vector<ExactMapRow>, 2> shares_;
};

}  // namespace isochor::internal
