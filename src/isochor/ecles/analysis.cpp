#include "isochor/ecles/analysis.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "isochor/base/error.h"
#include "isochor/ecles/exchange.h"
#include "isochor/ecles/index_map.h"
#include "isochor/ecles/relation.h"
#include "isochor/ecles/sparse_order.h"

namespace isochor {
namespace {

using internal::Block;
using internal::Elimination;
using internal::LocalSystem;
using internal::Relation;
using internal::Structure;

// Numbers that the elimination of a block may store before its rows are put into another order: so
// many in any case, and so many times its coefficients.
constexpr size_t kFreeFill = 2000;
constexpr size_t kFill = 32;

size_t index(int i) { return static_cast<size_t>(i); }

// Everything in the numbering of LocalSystem.
struct Decision {
  unsigned long prime = 0;
  std::vector<int> rows, columns;  // of the minor
  std::vector<internal::DependentRow> dependents;
};

// One pass with one prime: all of it certain, or nothing.
class Attempt {
 public:
  Attempt(const LocalSystem& system, const Structure& structure, unsigned long prime)
      : system_(system),
        structure_(structure),
        field_(prime),
        elimination_(system, field_),
        relations_(elimination_) {
    decision_.prime = prime;
  }

  std::optional<Decision> run() {
    if (!take_peeled()) return std::nullopt;
    for (const int row : structure_.empty) {
      decision_.dependents.push_back({row, {{row, Integer(1)}}});
    }
    for (const Block& block : structure_.blocks) {
      if (!take_block(block)) return std::nullopt;
    }
    if (!structure_.heavy.empty()) {
      std::vector<int> columns(index(system_.columns));
      std::iota(columns.begin(), columns.end(), 0);
      for (const int row : structure_.heavy) {
        if (!take_row({row, -1}, 0, columns)) return std::nullopt;
      }
    }
    for (int k = 0; k < elimination_.pivots(); ++k) {
      decision_.rows.push_back(elimination_.row(k));
      decision_.columns.push_back(elimination_.column(k));
    }
    return std::move(decision_);
  }

 private:
  // Peeled rows take part in the elimination only when there are heavy rows to reduce by them.
  bool take_peeled() {
    std::vector<int> columns;
    for (const Structure::Peeled& peeled : structure_.peeled) {
      if (field_.of(*peeled.coefficient) == 0) return false;
      if (structure_.heavy.empty()) {
        decision_.rows.push_back(peeled.row);
        decision_.columns.push_back(peeled.column);
        continue;
      }
      columns.clear();
      for (const internal::LocalTerm& term : system_.row(peeled.row)) {
        columns.push_back(term.column);
      }
      elimination_.load(peeled.row);
      elimination_.add_pivot(peeled.row, peeled.column, elimination_.pivots(), columns);
    }
    return true;
  }

  // In the order of precedence, which gives the first basis at once, unless that fills in too much.
  bool take_block(const Block& block) {
    const int first = elimination_.pivots();
    const size_t stored = elimination_.stored(), dependents = decision_.dependents.size();
    size_t limit = stored + kFreeFill;
    for (const int row : block.rows) limit += kFill * system_.row(row).size();
    for (const int row : block.rows) {
      if (!take_row({row, -1}, first, block.columns)) return false;
      if (elimination_.stored() <= limit) continue;
      elimination_.keep(first);
      decision_.dependents.resize(dependents);
      return take_planned(block);
    }
    return true;
  }

  // Once to learn which rows are the first basis, once more for those rows and then the others.
  bool take_planned(const Block& block) {
    const int first = elimination_.pivots();
    const std::vector<internal::PlannedPivot> plan = internal::sparse_order(system_, block);
    std::vector<internal::ModularRelation> relations;
    for (const internal::PlannedPivot& planned : plan) {
      if (!take_pivot(planned, first, block.columns)) {
        relations.push_back(modular_relation(planned.row, first));
      }
    }
    if (relations.empty()) return true;
    const std::vector<int> dependent =
        internal::dependent_on_first(field_, block.rows, std::move(relations));
    elimination_.keep(first);
    for (const internal::PlannedPivot& planned : plan) {
      if (std::binary_search(dependent.begin(), dependent.end(), planned.row)) continue;
      if (!take_row(planned, first, block.columns)) return false;
    }
    for (const int row : dependent) {
      if (!take_row({row, -1}, first, block.columns)) return false;
    }
    return true;
  }

  internal::ModularRelation modular_relation(int row, int first) {
    internal::ModularRelation relation{{row, field_.negative(1)}};
    const std::vector<internal::Residue>& y = elimination_.combination(first);
    for (size_t k = 0; k < y.size(); ++k) {
      if (y[k] != 0) relation.emplace_back(elimination_.row(first + static_cast<int>(k)), y[k]);
    }
    return relation;
  }

  // Whether the row, reduced, has a pivot; else the elimination is left as it was.
  bool take_pivot(const internal::PlannedPivot& planned, int first,
                  const std::vector<int>& columns) {
    elimination_.load(planned.row);
    elimination_.reduce(first);
    int column = planned.column;
    if (column < 0 || elimination_.vector()[index(column)] == 0) {
      column = elimination_.nonzero_column(columns);
    }
    if (column >= 0) elimination_.add_pivot(planned.row, column, first, columns);
    return column >= 0;
  }

  bool take_row(const internal::PlannedPivot& planned, int first, const std::vector<int>& columns) {
    if (take_pivot(planned, first, columns)) return true;
    std::optional<Relation> relation = relations_.find(planned.row, first, columns);
    if (!relation) return false;
    decision_.dependents.push_back({planned.row, std::move(*relation)});
    return true;
  }

  const LocalSystem& system_;
  const Structure& structure_;
  internal::PrimeField field_;
  Elimination elimination_;
  internal::RelationFinder relations_;
  Decision decision_;
};

Decision decide(const LocalSystem& system, const Structure& structure,
                const std::vector<int>& order) {
  for (int trial = 0;; ++trial) {
    const unsigned long prime = internal::elimination_prime(trial);
    std::optional<Decision> decision = Attempt(system, structure, prime).run();
    if (decision &&
        internal::exchange_to_first(order, prime, decision->dependents, decision->rows)) {
      return std::move(*decision);
    }
  }
}

// The rows of E, numbered from 0, in the order of precedence.
std::vector<int> rows_in_order(const std::vector<int>& rows, const std::vector<int>& precedence) {
  std::vector<int> order(rows.size());
  std::iota(order.begin(), order.end(), 0);
  if (precedence.empty()) return order;
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return precedence[index(rows[index(a)])] < precedence[index(rows[index(b)])];
  });
  return order;
}

Circuit circuit_of(Relation relation, const std::vector<int>& rows) {
  std::sort(relation.begin(), relation.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  const bool flip = relation.front().second.sign() < 0;
  Circuit circuit;
  for (auto& [row, multiplier] : relation) {
    circuit.rows.push_back(rows[index(row)]);
    circuit.multipliers.push_back(flip ? -multiplier : std::move(multiplier));
  }
  return circuit;
}

void name_rows(Decision decision, const Selection& selection, Analysis& analysis) {
  const std::vector<int>& rows = analysis.relevance.rows;
  std::vector<bool> is_dependent(rows.size());
  std::sort(decision.dependents.begin(), decision.dependents.end(),
            [](const auto& a, const auto& b) { return a.row < b.row; });
  for (internal::DependentRow& dependent : decision.dependents) {
    is_dependent[index(dependent.row)] = true;
    analysis.dependent.push_back(rows[index(dependent.row)]);
    analysis.circuits.push_back(circuit_of(std::move(dependent.relation), rows));
  }
  for (size_t i = 0; i < rows.size(); ++i) {
    if (!is_dependent[i]) analysis.independent.push_back(rows[i]);
  }
  analysis.independence.prime = decision.prime;
  for (const int row : decision.rows) analysis.independence.rows.push_back(rows[index(row)]);
  for (const int column : decision.columns) {
    analysis.independence.columns.push_back(selection.derived[index(column)]);
  }
}

// Whether y^T R_EA is not zero.
bool moves_with_anchors(const Circuit& circuit, const ConstraintMatrix& matrix,
                        const internal::IndexMap& anchors) {
  std::vector<std::pair<int, Integer>> sums;
  for (size_t k = 0; k < circuit.rows.size(); ++k) {
    for (const ConstraintTerm& term : matrix.row(circuit.rows[k])) {
      if (!anchors.contains(term.parameter)) continue;
      sums.emplace_back(term.parameter, term.coefficient * circuit.multipliers[k]);
    }
  }
  std::sort(sums.begin(), sums.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  for (size_t k = 0; k < sums.size();) {
    const int parameter = sums[k].first;
    Integer sum;
    for (; k < sums.size() && sums[k].first == parameter; ++k) sum += sums[k].second;
    if (!sum.is_zero()) return true;
  }
  return false;
}

}  // namespace

Analysis analyse(const ConstraintMatrix& matrix, const Selection& selection,
                 const AnalysisOptions& options) {
  ISOCHOR_REQUIRE(options.precedence.empty() || options.precedence.size() == index(matrix.rows()),
                  options.precedence.size(), matrix.rows());
  Analysis analysis;
  analysis.relevance = relevant(matrix, selection);
  const LocalSystem system(matrix, analysis.relevance.rows, selection.derived);
  const std::vector<int> order = rows_in_order(analysis.relevance.rows, options.precedence);
  const Structure structure = internal::structure(system, order);
  name_rows(decide(system, structure, order), selection, analysis);

  const internal::IndexMap anchors(selection.anchors);
  for (size_t k = 0; k < analysis.circuits.size(); ++k) {
    if (moves_with_anchors(analysis.circuits[k], matrix, anchors)) {
      analysis.obstructions.push_back(static_cast<int>(k));
    }
  }
  analysis.work.rows = analysis.relevance.rows.size();
  for (const int row : analysis.relevance.rows) analysis.work.nonzeros += matrix.row(row).size();
  analysis.work.pivots = analysis.independent.size();
  return analysis;
}

}  // namespace isochor
