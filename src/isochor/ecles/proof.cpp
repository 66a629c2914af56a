#include "isochor/ecles/proof.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <set>

namespace isochor {
namespace {

using Number = std::uint64_t;
__extension__ using Product = unsigned __int128;
using SparseRow = std::map<int, Number>;

Number times(Number a, Number b, Number m) { return static_cast<Number>(Product(a) * b % m); }

// Nothing when a has no inverse modulo m.
std::optional<Number> inverse(Number a, Number m) {
  __extension__ __int128 larger = m, smaller = a, before = 0, coefficient = 1;
  while (smaller != 0) {
    const auto quotient = larger / smaller;
    larger -= quotient * smaller;
    before -= quotient * coefficient;
    std::swap(larger, smaller);
    std::swap(before, coefficient);
  }
  if (larger != 1) return std::nullopt;
  return static_cast<Number>(before < 0 ? before + m : before);
}

// Whether elimination modulo m, row after row, finds an invertible pivot in each row. Then some
// minor is invertible modulo m, so that it is not zero and the rows are independent.
bool independent_modulo(const ConstraintMatrix& matrix, const std::vector<int>& rows,
                        const std::set<int>& columns, Number m) {
  std::vector<SparseRow> reduced;        // each with 1 at its pivot
  std::vector<int> pivot_of;             // its column
  std::map<int, size_t> row_with_pivot;  // by column
  for (const int i : rows) {
    SparseRow row;
    std::set<size_t> ahead;  // rows to subtract, the first first
    const auto set = [&](int column, Number value) {
      row[column] = value;
      const auto pivot = row_with_pivot.find(column);
      if (pivot != row_with_pivot.end()) ahead.insert(pivot->second);
    };
    for (const ConstraintTerm& term : matrix.row(i)) {
      if (columns.count(term.parameter) != 0) set(term.parameter, term.coefficient.modulo(m));
    }
    while (!ahead.empty()) {
      const size_t k = *ahead.begin();
      ahead.erase(ahead.begin());
      const Number factor = row[pivot_of[k]];
      if (factor == 0) continue;
      for (const auto& [column, value] : reduced[k]) {
        const auto old = row.find(column);
        const Number sum = (old == row.end() ? 0 : old->second) + m - times(factor, value, m);
        set(column, sum % m);
      }
      ahead.erase(k);
    }
    std::optional<Number> scale;
    for (const auto& [column, value] : row) {
      if (value == 0 || row_with_pivot.count(column) != 0) continue;
      scale = inverse(value, m);
      if (!scale) continue;
      row_with_pivot[column] = reduced.size();
      pivot_of.push_back(column);
      break;
    }
    if (!scale) return false;
    SparseRow scaled;
    for (const auto& [column, value] : row) {
      if (value != 0) scaled[column] = times(value, *scale, m);
    }
    reduced.push_back(std::move(scaled));
  }
  return true;
}

bool ascending(const std::vector<int>& numbers) {
  return std::adjacent_find(numbers.begin(), numbers.end(), std::greater_equal<>()) ==
         numbers.end();
}

bool in_range(const std::vector<int>& numbers, int end) {
  return std::all_of(numbers.begin(), numbers.end(), [&](int i) { return 0 <= i && i < end; });
}

// y^T R, without zeros.
std::map<int, Integer> combination(const Circuit& circuit, const ConstraintMatrix& matrix) {
  std::map<int, Integer> sums;
  for (size_t k = 0; k < circuit.rows.size(); ++k) {
    for (const ConstraintTerm& term : matrix.row(circuit.rows[k])) {
      sums[term.parameter] += circuit.multipliers[k] * term.coefficient;
    }
  }
  for (auto sum = sums.begin(); sum != sums.end();) {
    sum = sum->second.is_zero() ? sums.erase(sum) : std::next(sum);
  }
  return sums;
}

bool touches(const std::map<int, Integer>& sums, const std::vector<int>& parameters) {
  return std::any_of(parameters.begin(), parameters.end(),
                     [&](int j) { return sums.count(j) != 0; });
}

Number next_prime(Number n) {
  for (++n;; ++n) {
    bool prime = n > 1;
    for (Number divisor = 2; prime && divisor * divisor <= n; ++divisor) prime = n % divisor != 0;
    if (prime) return n;
  }
}

// No minor of the rows has more binary digits (Hadamard: the product of the rows' lengths).
unsigned long minor_bits(const ConstraintMatrix& matrix, const std::vector<int>& rows) {
  unsigned long bits = 0;
  for (const int i : rows) {
    Integer square;
    for (const ConstraintTerm& term : matrix.row(i)) {
      square.add_product(term.coefficient, term.coefficient);
    }
    bits += square.bits() / 2 + 1;
  }
  return bits;
}

// E and F' of the selection, straight from their definition.
bool right_relevance(const Relevance& relevance, const ConstraintMatrix& matrix,
                     const Selection& selection) {
  std::set<int> chosen(selection.anchors.begin(), selection.anchors.end());
  chosen.insert(selection.derived.begin(), selection.derived.end());
  std::set<int> rows, fixed;
  for (int i = 0; i < matrix.rows(); ++i) {
    const ArrayView<ConstraintTerm> row = matrix.row(i);
    if (std::none_of(row.begin(), row.end(), [&](const ConstraintTerm& term) {
          return chosen.count(term.parameter) != 0;
        })) {
      continue;
    }
    rows.insert(i);
    for (const ConstraintTerm& term : row) {
      if (chosen.count(term.parameter) == 0) fixed.insert(term.parameter);
    }
  }
  return std::vector<int>(rows.begin(), rows.end()) == relevance.rows &&
         std::vector<int>(fixed.begin(), fixed.end()) == relevance.fixed;
}

// The rows of E are the independent ones and the dependent ones, each once.
bool partition(const Analysis& analysis) {
  std::vector<int> all = analysis.independent;
  all.insert(all.end(), analysis.dependent.begin(), analysis.dependent.end());
  std::sort(all.begin(), all.end());
  return all == analysis.relevance.rows && ascending(analysis.independent) &&
         ascending(analysis.dependent) && analysis.circuits.size() == analysis.dependent.size();
}

bool right_circuit(const Analysis& analysis, size_t k, const std::set<int>& independent,
                   const ConstraintMatrix& matrix, const Selection& selection) {
  const Circuit& circuit = analysis.circuits[k];
  bool has_its_row = false;
  for (const int row : circuit.rows) {
    has_its_row = has_its_row || row == analysis.dependent[k];
    if (row != analysis.dependent[k] && independent.count(row) == 0) return false;
  }
  if (!has_its_row || !verify_dependent(circuit, matrix, selection.derived)) return false;
  const bool obstructs = std::binary_search(analysis.obstructions.begin(),
                                            analysis.obstructions.end(), static_cast<int>(k));
  return obstructs == touches(combination(circuit, matrix), selection.anchors);
}

}  // namespace

bool verify(const MinorProof& proof, const ConstraintMatrix& matrix) {
  const std::set<int> columns(proof.columns.begin(), proof.columns.end());
  const std::set<int> rows(proof.rows.begin(), proof.rows.end());
  return proof.prime > 1 && proof.prime < (1ul << 62) && rows.size() == proof.rows.size() &&
         columns.size() == proof.columns.size() && rows.size() == columns.size() &&
         in_range(proof.rows, matrix.rows()) &&
         independent_modulo(matrix, proof.rows, columns, proof.prime);
}

bool verify_dependent(const Circuit& circuit, const ConstraintMatrix& matrix,
                      const std::vector<int>& derived) {
  return !circuit.rows.empty() && circuit.rows.size() == circuit.multipliers.size() &&
         ascending(circuit.rows) && in_range(circuit.rows, matrix.rows()) &&
         std::none_of(circuit.multipliers.begin(), circuit.multipliers.end(),
                      [](const Integer& y) { return y.is_zero(); }) &&
         !touches(combination(circuit, matrix), derived);
}

bool verify_minimal(const Circuit& circuit, const ConstraintMatrix& matrix,
                    const std::vector<int>& derived) {
  if (circuit.rows.empty() || !in_range(circuit.rows, matrix.rows())) return false;
  const std::vector<int> rows(circuit.rows.begin() + 1, circuit.rows.end());
  const std::set<int> columns(derived.begin(), derived.end());
  // Dependent modulo primes whose product exceeds every minor: dependent.
  Number prime = Number{1} << 31;
  for (unsigned long bits = minor_bits(matrix, rows) + 1, done = 0; done <= bits; done += 31) {
    prime = next_prime(prime);
    if (independent_modulo(matrix, rows, columns, prime)) return true;
  }
  return false;
}

bool verify_conflict(const Circuit& circuit, const Conflict& conflict,
                     const ConstraintMatrix& matrix, const Selection& selection,
                     const std::vector<std::vector<Rational>>& right_sides,
                     const std::vector<std::vector<Rational>>& values) {
  const auto component = static_cast<size_t>(conflict.component);
  if (conflict.component < 0 || component >= right_sides.size() || component >= values.size() ||
      conflict.residual.is_zero() || !verify_dependent(circuit, matrix, selection.derived)) {
    return false;
  }
  Rational rest;
  for (size_t k = 0; k < circuit.rows.size(); ++k) {
    const int row = circuit.rows[k];
    rest += Rational(circuit.multipliers[k]) * matrix.scale(row) *
            right_sides[component][static_cast<size_t>(row)];
  }
  for (const auto& [parameter, sum] : combination(circuit, matrix)) {
    rest -= Rational(sum) * values[component][static_cast<size_t>(parameter)];
  }
  return rest == conflict.residual;
}

bool verify(const Analysis& analysis, const ConstraintMatrix& matrix, const Selection& selection) {
  if (!right_relevance(analysis.relevance, matrix, selection) || !partition(analysis)) return false;
  std::vector<int> rows = analysis.independence.rows;
  std::sort(rows.begin(), rows.end());
  const std::set<int> derived(selection.derived.begin(), selection.derived.end());
  for (const int column : analysis.independence.columns) {
    if (derived.count(column) == 0) return false;
  }
  if (rows != analysis.independent || !verify(analysis.independence, matrix)) return false;
  const std::set<int> independent(rows.begin(), rows.end());
  for (size_t k = 0; k < analysis.circuits.size(); ++k) {
    if (!right_circuit(analysis, k, independent, matrix, selection)) return false;
  }
  return ascending(analysis.obstructions) &&
         in_range(analysis.obstructions, static_cast<int>(analysis.circuits.size()));
}

}  // namespace isochor
