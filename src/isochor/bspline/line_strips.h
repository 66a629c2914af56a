// Two strips of surface that meet along a curve: how they meet, measured, and the equations that
// keep them meeting so. A detail of smooth_relations.h, whose symbols apply.
#pragma once

#include <array>
#include <vector>

#include "isochor/bspline/smooth_relations.h"

namespace isochor::internal {

// The poles on one side of the curve that matter, and the derivatives across it.
struct Strip {
  int patch = 0;
  Direction across = Direction::kU;
  bool flipped = false;  // runs against the first strip
  int first = 0;         // the pole row of derivatives[r][0]
  // [r][i]: share of pole row first + i in the derivative of order r with respect to n.
  std::array<std::vector<Rational>, 3> derivatives;
  std::array<std::vector<double>, 3> rounded;  // the same
};

// The factors of a model's relations, each once: simple numbers that occur again and again.
class KnownFactors {
 public:
  // The first one that was added of those in [low, high].
  const Rational* find(const Rational& low, const Rational& high) const;
  // Does nothing when `factor` is known.
  void add(const Rational& factor);
  size_t size() const { return factors_.size(); }
  void shrink_to(size_t size);  // forgets those added last

 private:
  std::vector<Rational> factors_;
  std::vector<double> rounded_;  // tell most of them apart at little cost
};

struct Line {
  Strip strips[2];
  int count = 0;  // poles along the curve
  // Wrapped direction: pole rows from `period` on are the rows from 0 on. 0: not wrapped.
  int period = 0;
  // Joins: the boundary rows of the two strips, tied to each other; -1: strips of one patch.
  int boundary[2] = {-1, -1};
};

// The lines of a join that matches, of a wrap and of an interior knot.
Line join_line(const PatchModel& model, const Join& join);
Line wrap_line(const PatchModel& model, const Join& join);
Line knot_line(const PatchModel& model, int patch, Direction across, double knot, int period);

// Grid indices of pole j of a row of a strip; the second strip counts j along the first.
std::pair<int, int> grid_index(const Patch& patch, const Strip& strip, int row, int j);

// Fits lambda, mu up to relation->order and sets them, the residual and the equations.
// `known_factors`: values met before, used again when they lie within the noise; new ones are
// added. False when no constant factors fit; then neither is changed.
bool fit_relation(const PatchModel& model, const Line& line, SmoothRelation* relation,
                  KnownFactors* known_factors);

}  // namespace isochor::internal
