// The coarse grids of a model beside its own knots. A detail of smooth_relations.h.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "isochor/bspline/exact_refinement.h"
#include "isochor/bspline/smooth_relations.h"

namespace isochor::internal {

inline Direction other(Direction direction) {
  return direction == Direction::kU ? Direction::kV : Direction::kU;
}

class CoarseGrids {
 public:
  // PreconditionError unless there is one grid for each patch. Both must outlive this object.
  CoarseGrids(const PatchModel& model, const std::vector<CoarseKnots>& coarse);

  const KnotVector& fine(int q, Direction direction) const;
  const KnotVector& coarse(int q, Direction direction) const;

  // Coarse rows that wrap: from the period on, row i is row i - period. 0: the direction does not.
  int period(int q, Direction direction) const;
  // The row that stands for row i.
  int wrapped(int q, Direction direction, int i) const;

  // Coarse coefficients to fine ones, computed on first use. PreconditionError when the coarse
  // knots are not part of the fine ones.
  const ExactMap& map(int q, Direction direction);

 private:
  const PatchModel& model_;
  const std::vector<CoarseKnots>& coarse_;
  PointClasses classes_;
  std::map<std::pair<int, Direction>, ExactMap> maps_;
};

}  // namespace isochor::internal
