// The relevant constraints on the derived parameters, renumbered from 0, and their structure: what
// can be said about rank before any arithmetic.
//
// A derived parameter that only one row involves makes that row independent of all others: it takes
// part in no relation y^T R_ED = 0. Taking such rows away one after another (*peeling*) leaves a
// core, which falls into connected *blocks*. Rows much longer than usual (*heavy*) would tie
// everything together; they are set aside and reduced last.
#pragma once

#include <vector>

#include "isochor/ecles/relevant.h"

namespace isochor::internal {

struct LocalTerm {
  int column = 0;
  bool is_word = false;
  long word = 0;  // the value, where it fits
  const Integer* value = nullptr;
};

struct LocalSystem {
  // matrix outlives the system.
  LocalSystem(const ConstraintMatrix& matrix, const std::vector<int>& relevant_rows,
              const std::vector<int>& derived);

  int rows() const { return static_cast<int>(row_begin.size()) - 1; }
  ArrayView<LocalTerm> row(int i) const {
    return {terms.data() + row_begin[static_cast<size_t>(i)],
            terms.data() + row_begin[static_cast<size_t>(i) + 1]};
  }

  int columns = 0;
  std::vector<size_t> row_begin{0};
  std::vector<LocalTerm> terms;
};

struct Block {
  std::vector<int> rows;  // in the given order
  std::vector<int> columns;
};

struct Structure {
  struct Peeled {
    int row = 0;
    int column = 0;  // no later row, no block and no empty row involves it
    const Integer* coefficient = nullptr;
  };
  std::vector<Peeled> peeled;
  std::vector<int> empty;  // rows without a derived parameter
  std::vector<Block> blocks;
  std::vector<int> heavy;  // in the given order
};

// `order` holds each row once: the order of rows within blocks and of heavy ones.
Structure structure(const LocalSystem& system, const std::vector<int>& order);

}  // namespace isochor::internal
