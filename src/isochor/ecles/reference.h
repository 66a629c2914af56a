// Editing by constrained least squares as the thesis does it (Rodrigues 2017, chapters 2, 5, 8, 9):
// everything dense and in rationals.
//
// The reference that the sparse engine (analysis.h, least_change.h) is held against, and the
// baseline of its speed. Its numbers grow without bound when results are fed back as values.
//
// Symbols: R p = q, m constraints on n parameters of d components each; A anchors, D derived, the
// rest fixed; E the constraints with a nonzero coefficient on A u D, F' the fixed parameters in
// them. p are the current values, p' the anchors' new values and the derived parameters' hints, p''
// the result; w the weights, M = diag(2 w); A^ the r independent rows of R_ED, B^ their right
// sides.
//
// Laws (tests/ecles/reference_test.cpp):
//  (1) constraints: R_E p'' == q_E, exactly, whenever update() gives a result
//  (2) verdicts:    strongly_solvable() iff rank [R_ED R_EA] == rank R_ED; weakly_solvable() iff
//  some
//                   values of D satisfy all of E with these anchors
//  (3) optimality:  M (p'' - p'_D) == -A^^T multipliers (eq. 9.4): no feasible change of D lowers
//                   sum w_s |p''_s - p'_s|^2
//  (4) idempotence: update() starts from p, never from an earlier result
// Not a law: strongly solvable systems are weakly solvable. They are when p satisfies E.
#pragma once

#include <optional>
#include <vector>

#include "isochor/ecles/constraint_matrix.h"
#include "isochor/ecles/ldu.h"
#include "isochor/ecles/relevant.h"
#include "isochor/exact/rational_matrix.h"

namespace isochor {

// ECLES.ExtractRelevant (Algorithm 2) with the condition it lacks, a nonzero coefficient. Reads all
// of the matrix; relevant() reads the chosen columns only. PreconditionError when a parameter is
// out of range or chosen twice.
Relevance extract_relevant(const ConstraintMatrix& matrix, const Selection& selection);

struct ReferenceSolution {
  RationalMatrix derived;  // p''_D, |D| x d, in the order of the selection
  // Lambda of eq. (9.6), r x d, of the rows independent(); empty when r == |D|, where D is
  // determined and nothing is minimised.
  RationalMatrix multipliers;
};

class ReferenceEditor {
 public:
  // ECLES.Initialize (Algorithm 1). `right_sides`, m x d, belong to the constraints as given,
  // before the matrix scaled them; `values`, n x d, need not satisfy them. Cost: that of
  // factor_ldu() on |E| x |D|. PreconditionError when sizes disagree, or as extract_relevant()
  // does.
  ReferenceEditor(const ConstraintMatrix& matrix, const RationalMatrix& right_sides,
                  const RationalMatrix& values, const Selection& selection,
                  Simplification simplification = Simplification::kGcd);

  const Relevance& relevance() const { return relevance_; }
  const LduFactoring& factoring() const { return factoring_; }  // of R_ED, rows scaled to integers
  int rank() const { return factoring_.rank(); }
  // The constraints of A^, in the order of their pivots, and the other constraints of E, ascending.
  const std::vector<int>& independent() const { return independent_; }
  const std::vector<int>& redundant() const { return redundant_; }

  // Whether D can follow any values of A: L~ L^^-1 K^ == K~ for K = R_EA (eq. 8.16). It does not
  // depend on the values; eq. (8.15), which does, is values_are_feasible()'s business.
  bool strongly_solvable() const;
  // Whether p satisfies the constraints E.
  bool values_are_feasible() const { return feasible_; }
  // Whether D can follow these values, |A| x d (eq. 8.10). PreconditionError when sizes disagree.
  bool weakly_solvable(const RationalMatrix& anchor_values) const;

  // ECLES.Update (Algorithms 4 and 15): the least change from `hints`, |D| x d, with the anchors at
  // `anchor_values`, |A| x d. `weights`: one for each derived parameter, or none for ones. Nothing
  // when not weakly solvable. Cost O(r^2 |D|) products of rationals and one dense exact solve of
  // r x r, each time. PreconditionError when sizes disagree or a weight is not positive.
  std::optional<ReferenceSolution> update(const RationalMatrix& anchor_values,
                                          const RationalMatrix& hints,
                                          const std::vector<Rational>& weights = {}) const;

 private:
  RationalMatrix right_sides_at(const RationalMatrix& anchor_values) const;
  ReferenceSolution least_squares(const RationalMatrix& right, const RationalMatrix& hints,
                                  const std::vector<Rational>& weights) const;

  Relevance relevance_;
  RationalMatrix derived_columns_;  // R_ED
  RationalMatrix anchor_columns_;   // R_EA
  RationalMatrix constant_;         // q_E - R_EF' p_F'
  LduFactoring factoring_;
  std::vector<int> independent_, redundant_;
  bool feasible_ = false;
};

}  // namespace isochor
