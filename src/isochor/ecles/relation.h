// The exact relation behind a row that elimination modulo a prime found dependent.
//
// Symbols: B are the rows of the elimination's pivots (from `first` on), independent because their
// minor is not zero modulo p; a is one more row, with a = y B modulo p. If a depends on B over the
// rationals, y has no p in its denominators, and its p-adic digits come one by one (Dixon 1982):
//   r_0 = a,  y_k = r_k B^-1 mod p,  r_{k+1} = (r_k - y_k B) / p,  y = sum y_k p^k.
// Fractions are recovered from their residues by Euclid's algorithm and multiplied out exactly; few
// digits are needed when the fractions are short, whatever the size of B. If a does not depend on
// B, some r_k is not a combination of B modulo p: then p misled, and another prime has to be taken.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "isochor/ecles/elimination.h"

namespace isochor::internal {

// sum multiplier row(r) = 0 on every column, integers without common factor, none zero.
using Relation = std::vector<std::pair<int, Integer>>;

class RelationFinder {
 public:
  explicit RelationFinder(Elimination& elimination) : elimination_(elimination) {}

  // The row was loaded and reduced to zero just now. Nothing when it is independent.
  std::optional<Relation> find(int row, int first, const std::vector<int>& columns);

 private:
  // The next digit of y; false when the residual is no combination.
  bool next_digit(int first, const std::vector<int>& columns);
  void divide_residual(int first, const std::vector<Residue>& digits,
                       const std::vector<int>& columns);
  std::optional<Relation> recovered(int row, int first) const;
  bool holds(const Relation& relation);

  Elimination& elimination_;
  std::vector<Integer> residual_, sums_;  // by column
  std::vector<Integer> y_;                // by pivot, modulo power_
  Integer power_;
};

}  // namespace isochor::internal
