// Two strips of surface that meet along a curve: how they meet, measured, and the equations that
// keep them meeting so. A detail of smooth_relations.h, whose symbols apply.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <vector>

#include "isochor/bspline/smooth_relations.h"

namespace isochor::internal {

// [r][i]: share of the i-th pole row in the derivative of order r with respect to n.
struct RowShares {
  std::array<std::vector<Rational>, 3> derivatives;
  std::array<std::vector<double>, 3> rounded;  // the same
};

// The shares at the knots of a model. They depend on the few knots nearby alone, and most patches
// repeat those of another one, so each is computed once.
class KnownShares {
 public:
  // At `knot`, on a span that ends or begins there; `backwards`: n runs against the parameter.
  std::shared_ptr<const RowShares> at(const KnotVector& knots, int span, double knot,
                                      bool backwards);

 private:
  std::map<std::vector<double>, std::shared_ptr<const RowShares>> shares_;
};

// The poles on one side of the curve that matter, and the derivatives across it.
struct Strip {
  int patch = 0;
  Direction across = Direction::kU;
  bool flipped = false;  // runs against the first strip
  int first = 0;         // the pole row of the first share
  std::shared_ptr<const RowShares> shares;

  const std::vector<Rational>& derivative(int r) const {
    return shares->derivatives[static_cast<size_t>(r)];
  }
  const std::vector<double>& rounded(int r) const {
    return shares->rounded[static_cast<size_t>(r)];
  }
};

// The factors of a model's relations, each once: simple numbers that occur again and again.
class KnownFactors {
 public:
  // The first one that was added of those in [value - noise, value + noise], ends exact.
  const Rational* find(double value, double noise) const;
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
Line join_line(const PatchModel& model, const Join& join, KnownShares* known);
Line wrap_line(const PatchModel& model, const Join& join, KnownShares* known);
Line knot_line(const PatchModel& model, int patch, Direction across, double knot, int period,
               KnownShares* known);

// Grid indices of pole j of a row of a strip; the second strip counts j along the first.
std::pair<int, int> grid_index(const Patch& patch, const Strip& strip, int row, int j);

// Fits lambda, mu up to relation->order and sets them, the residual and the equations.
// `known_factors`: values met before, used again when they lie within the noise; new ones are
// added. False when no constant factors fit; then neither is changed.
bool fit_relation(const PatchModel& model, const Line& line, SmoothRelation* relation,
                  KnownFactors* known_factors);

}  // namespace isochor::internal
