// Fraction-free LDU factoring with full pivoting, as Rodrigues 2017 (chapters 4, 6, 7, 8) has it.
//
// The reference that faster paths are held against, and the baseline of their speed. Dense: for a
// verdict about a sparse system use analyse().
//
// Symbols: A is m x n of integers and rank r; A = Pi_R L D^-1 U Pi_C (eq. 4.1) with L m x r whose
// first r rows are lower triangular (L^), D r x r diagonal, U r x n whose first r columns are upper
// triangular (U^), all three integer, and two permutations. The pivot of a step is the nonzero
// entry of least magnitude left, the first such row by row.
//
// Laws (tests/ecles/ldu_test.cpp):
//  (1) factors:   product(factor_ldu(A, s)) == A for every A and simplification s
//  (2) rank:      r is the rank; the rows row_order[0..r) of A are independent
//  (3) Turner:    with pivots p_k, the entries are minors of A: D = diag(p1, p1 p2, p2 p3, ...),
//  and
//                 for square A the last pivot is the determinant up to sign
//  (4) solution:  A particular_solution(F, B) == B exactly when reaches(F, B)
// Not laws: that two simplifications pivot alike, or that r rows in their given order are chosen.
//
// The thesis' pseudo-code does not satisfy (1); docs/ecles_thesis.md lists what is corrected.
#pragma once

#include <functional>
#include <vector>

#include "isochor/exact/integer_matrix.h"
#include "isochor/exact/rational_matrix.h"

namespace isochor {

// How common factors leave the rows after each step (7.1, 7.2, 7.3).
enum class Simplification {
  kNone,    // not at all: bits double with each step
  kGcd,     // each row of U and each column of L by its greatest common divisor
  kTurner,  // each row of U by the pivot before the last, which always divides (Bareiss)
};

// The binary digits of the largest entries after one step, rows still to be eliminated included.
struct LduStep {
  int step = 0;  // 1, 2, ..., r
  unsigned long upper_bits = 0;
  unsigned long lower_bits = 0;
  unsigned long diagonal_bits = 0;
};
using LduObserver = std::function<void(const LduStep&)>;

struct LduFactoring {
  std::vector<int> row_order;     // row k of L D^-1 U is row row_order[k] of A; all m of them
  std::vector<int> column_order;  // column k of U is column column_order[k] of A; all n of them
  IntegerMatrix lower;            // L, m x r
  std::vector<Integer> diagonal;  // D, r entries, none zero
  IntegerMatrix upper;            // U, r x n

  int rank() const { return static_cast<int>(diagonal.size()); }
  int rows() const { return lower.rows(); }
  int columns() const { return upper.columns(); }
};

// LinSys.LDUFactor (Algorithms 6 to 13). Cost O(m n r) multiplications of integers whose bits grow
// linearly with the step for kGcd and kTurner. The observer, if any, sees every step; looking at
// every entry, it costs O(m n) more per step.
LduFactoring factor_ldu(IntegerMatrix a, Simplification simplification,
                        const LduObserver& observer = nullptr);

// A again: Pi_R L D^-1 U Pi_C.
RationalMatrix product(const LduFactoring& factoring);

// Whether each column of B is a combination of A's columns: L~ L^^-1 B^ == B~ (eq. 8.10). With the
// right side of one edit this is weak solvability; with the anchors' columns it is (8.16), strong
// solvability. PreconditionError unless B has A's rows.
bool reaches(const LduFactoring& factoring, const RationalMatrix& b);

// LinSys.Solve (Algorithm 14): P with A P == B whose free parameters, those after the first r of
// column_order, are zero. Only the first r rows of row_order are looked at: ask reaches() about the
// others. PreconditionError unless B has A's rows.
RationalMatrix particular_solution(const LduFactoring& factoring, const RationalMatrix& b);

}  // namespace isochor
