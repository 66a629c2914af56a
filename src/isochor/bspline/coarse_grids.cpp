#include "isochor/bspline/coarse_grids.h"

#include "isochor/base/error.h"
#include "isochor/bspline/joins.h"

namespace isochor::internal {

CoarseGrids::CoarseGrids(const PatchModel& model, const std::vector<CoarseKnots>& coarse)
    : model_(model), coarse_(coarse), classes_(point_classes(model)) {
  ISOCHOR_REQUIRE(coarse.size() == model.patches.size(), coarse.size(), model.patches.size());
}

const KnotVector& CoarseGrids::fine(int q, Direction direction) const {
  return knots_of(model_.patches[static_cast<size_t>(q)], direction);
}

const KnotVector& CoarseGrids::coarse(int q, Direction direction) const {
  const CoarseKnots& knots = coarse_[static_cast<size_t>(q)];
  return direction == Direction::kU ? knots.u : knots.v;
}

int CoarseGrids::period(int q, Direction direction) const {
  const int rows = wrapped_rows(model_.patches[static_cast<size_t>(q)], direction, classes_);
  return rows > 0 ? coarse(q, direction).size() - rows : 0;
}

int CoarseGrids::wrapped(int q, Direction direction, int i) const {
  const int rows = period(q, direction);
  return rows > 0 && i >= rows ? i - rows : i;
}

const ExactMap& CoarseGrids::map(int q, Direction direction) {
  ExactMap& known = maps_[{q, direction}];
  if (known.empty()) {
    known = period(q, direction) > 0
                ? exact_wrapped_insertion_map(coarse(q, direction), fine(q, direction))
                : exact_insertion_map(coarse(q, direction), fine(q, direction));
  }
  return known;
}

}  // namespace isochor::internal
