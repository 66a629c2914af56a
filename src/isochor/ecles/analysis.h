// What a choice of anchors and derived parameters can do, decided exactly.
//
// Symbols (Rodrigues 2017, ch. 2 and 5): A, D, E and F' as in relevant.h; R_ED is E's part on D. A
// *circuit* is a set of rows that is dependent on D while each proper subset is independent; its
// multipliers y, y^T R_ED = 0, are unique up to sign once they are integers without a common
// factor. "First" is meant in the order of `precedence`, ties broken by index.
//
// Laws (tests: analysis_test, verdicts_test and spline_verdicts_test in tests/ecles):
//  (1) basis:      `independent` is the first basis of E's rows on D: a row is left out exactly
//  when
//                  it depends on rows that come before it;
//  (2) circuits:   circuits[k] holds dependent[k] and independent rows that come before it: it is a
//                  minimal dependent set, and the circuits span every y with y^T R_ED = 0;
//  (3) solvable:   strongly solvable means rank [R_ED R_EA] == rank R_ED: every value of the
//  anchors
//                  can be met by the derived parameters alone;
//  (4) order:      rank and strong solvability do not depend on the order of rows and parameters;
//                  with a precedence that is a property of the rows, neither do the sets of (1)
//                  and (2);
//  (5) proof:      independence and each circuit are certified, see proof.h;
//  (6) locality:   the cost and `work` follow E, not the size of R.
// Never wrong: all decisions taken modulo a prime are proven or taken again with another prime.
#pragma once

#include <cstddef>
#include <vector>

#include "isochor/ecles/relevant.h"
#include "isochor/exact/integer.h"

namespace isochor {

struct Circuit {
  std::vector<int> rows;  // ascending
  std::vector<Integer>
      multipliers;  // of the stored rows; without common factor, the first positive
};

// The rows are independent on the columns: R[rows, columns], as many of each, is nonsingular modulo
// the prime. In an order that makes elimination row after row cheap.
struct MinorProof {
  unsigned long prime = 0;
  std::vector<int> rows, columns;
};

// Touched by one analysis: rows of E, their nonzeros, pivots of the elimination. Counted, not
// timed.
struct Work {
  size_t rows = 0;
  size_t nonzeros = 0;
  size_t pivots = 0;
};

struct Analysis {
  Relevance relevance;
  std::vector<int> independent;   // rows, ascending
  MinorProof independence;        // of those rows
  std::vector<int> dependent;     // the other rows of E, ascending
  std::vector<Circuit> circuits;  // circuits[k] belongs to dependent[k]
  std::vector<int> obstructions;  // the k with y^T R_EA != 0, ascending
  Work work;

  bool strongly_solvable() const { return obstructions.empty(); }
  int rank() const { return static_cast<int>(independent.size()); }
  // |D| - rank.
  int freedom_left(const Selection& selection) const {
    return static_cast<int>(selection.derived.size()) - rank();
  }
};

struct AnalysisOptions {
  // By row of R: rows with smaller numbers come first. Empty: the order of the rows.
  std::vector<int> precedence;
};

// PreconditionError as `relevant`, and when a precedence is given but not for every row.
Analysis analyse(const ConstraintMatrix& matrix, const Selection& selection,
                 const AnalysisOptions& options = {});

}  // namespace isochor
