// The exact relation behind a row that elimination modulo a prime found dependent.
//
// Symbols: B are the rows of the elimination's pivots (from `first` on), independent because their
// minor is not zero modulo p; a is one more row, with a = y B modulo p. If a depends on B over the
// rationals, y has no p in its denominators, and its p-adic digits come one by one (Dixon 1982):
//   r_0 = a,  y_k = r_k B^-1 mod p,  r_{k+1} = (r_k - y_k B) / p,  y = sum y_k p^k.
// A relation of few rows is sooner found over the integers at once; where all numbers fit machine
// words, y_0 alone is enough. Fractions are recovered from their residues by Euclid's algorithm and
// multiplied out exactly; few digits are needed when the fractions are short, whatever the size of
// B. If a does not depend on B, some r_k is not a combination of B modulo p: then p misled, and
// another prime has to be taken.
#pragma once

#include <optional>
#include <vector>

#include "isochor/ecles/elimination.h"
#include "isochor/ecles/small_relation.h"
#include "isochor/exact/rational.h"

namespace isochor::internal {

class RelationFinder {
 public:
  explicit RelationFinder(Elimination& elimination) : elimination_(elimination) {}

  // The row was loaded and reduced to zero just now. Nothing when it is independent.
  std::optional<Relation> find(int row, int first, const std::vector<int>& columns);

 private:
  __extension__ using WideSum = __int128;

  // Of a few rows, over the integers.
  std::optional<Relation> from_support(int row, int first, const std::vector<Residue>& digits);
  // In machine words, where coefficients and multipliers are short; else nothing.
  std::optional<Relation> from_first_digit(int row, int first, const std::vector<Residue>& digits);
  bool holds_in_words(const std::vector<std::pair<int, long>>& relation);
  // Digit by digit; nothing when the row is independent.
  std::optional<Relation> from_many_digits(int row, int first, const std::vector<int>& columns,
                                           std::vector<Residue> digits);
  void add_digits(int first, const std::vector<Residue>& digits, const std::vector<int>& columns);
  bool next_digits(int first, const std::vector<int>& columns, std::vector<Residue>& digits);
  int likely_digits(int row, int first) const;
  std::optional<Relation> recovered(int row, int first) const;
  bool holds(const Relation& relation);

  Elimination& elimination_;
  std::vector<WideSum> wide_sums_;        // by column, zeros between uses
  std::vector<Integer> residual_, sums_;  // by column, zeros between uses
  std::vector<int> touched_;
  std::vector<Integer> y_;  // by pivot from `first` on, modulo power_
  Integer power_;
};

}  // namespace isochor::internal
