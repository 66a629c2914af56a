#include "isochor/ecles/reference.h"

#include <algorithm>
#include <utility>

#include "isochor/base/error.h"

namespace isochor {
namespace {

// Where each parameter stands among the chosen ones; -1 elsewhere.
std::vector<int> positions_of(const std::vector<int>& chosen, int parameters) {
  std::vector<int> result(static_cast<size_t>(parameters), -1);
  for (size_t k = 0; k < chosen.size(); ++k) {
    result[static_cast<size_t>(chosen[k])] = static_cast<int>(k);
  }
  return result;
}

std::vector<char> chosen_parameters(const ConstraintMatrix& matrix, const Selection& selection) {
  std::vector<char> result(static_cast<size_t>(matrix.parameters()), 0);
  for (const auto* chosen : {&selection.anchors, &selection.derived}) {
    for (const int parameter : *chosen) {
      ISOCHOR_REQUIRE(0 <= parameter && parameter < matrix.parameters(), parameter);
      char& mark = result[static_cast<size_t>(parameter)];
      ISOCHOR_REQUIRE(mark == 0, parameter);
      mark = 1;
    }
  }
  return result;
}

// R_EY, dense.
IntegerMatrix columns_of(const ConstraintMatrix& matrix, const std::vector<int>& rows,
                         const std::vector<int>& chosen) {
  const std::vector<int> position = positions_of(chosen, matrix.parameters());
  IntegerMatrix result(static_cast<int>(rows.size()), static_cast<int>(chosen.size()));
  for (int i = 0; i < result.rows(); ++i) {
    for (const ConstraintTerm& term : matrix.row(rows[static_cast<size_t>(i)])) {
      const int column = position[static_cast<size_t>(term.parameter)];
      if (column >= 0) result.set(i, column, term.coefficient);
    }
  }
  return result;
}

RationalMatrix rows_of(const RationalMatrix& matrix, const std::vector<int>& rows) {
  RationalMatrix result(static_cast<int>(rows.size()), matrix.columns());
  for (int i = 0; i < result.rows(); ++i) {
    for (int c = 0; c < result.columns(); ++c) {
      result.set(i, c, matrix.at(rows[static_cast<size_t>(i)], c));
    }
  }
  return result;
}

}  // namespace

Relevance extract_relevant(const ConstraintMatrix& matrix, const Selection& selection) {
  const std::vector<char> chosen = chosen_parameters(matrix, selection);
  std::vector<char> in_use(chosen.size(), 0);
  Relevance result;
  for (int i = 0; i < matrix.rows(); ++i) {
    const auto row = matrix.row(i);
    const auto is_chosen = [&](const ConstraintTerm& term) {
      return chosen[static_cast<size_t>(term.parameter)] != 0;
    };
    if (std::none_of(row.begin(), row.end(), is_chosen)) continue;
    result.rows.push_back(i);
    for (const ConstraintTerm& term : row) in_use[static_cast<size_t>(term.parameter)] = 1;
  }
  for (int j = 0; j < matrix.parameters(); ++j) {
    const auto parameter = static_cast<size_t>(j);
    if (in_use[parameter] != 0 && chosen[parameter] == 0) result.fixed.push_back(j);
  }
  return result;
}

ReferenceEditor::ReferenceEditor(const ConstraintMatrix& matrix, const RationalMatrix& right_sides,
                                 const RationalMatrix& values, const Selection& selection,
                                 Simplification simplification)
    : relevance_(extract_relevant(matrix, selection)) {
  ISOCHOR_REQUIRE(right_sides.rows() == matrix.rows(), right_sides.rows(), matrix.rows());
  ISOCHOR_REQUIRE(values.rows() == matrix.parameters(), values.rows(), matrix.parameters());
  ISOCHOR_REQUIRE(values.columns() == right_sides.columns(), values.columns(),
                  right_sides.columns());
  const IntegerMatrix derived = columns_of(matrix, relevance_.rows, selection.derived);
  derived_columns_ = derived;
  anchor_columns_ = columns_of(matrix, relevance_.rows, selection.anchors);
  constant_ = rows_of(right_sides, relevance_.rows);
  for (int i = 0; i < constant_.rows(); ++i) {
    const Rational& scale = matrix.scale(relevance_.rows[static_cast<size_t>(i)]);
    for (int c = 0; c < constant_.columns(); ++c) constant_.at(i, c) *= scale;
  }
  constant_ -= RationalMatrix(columns_of(matrix, relevance_.rows, relevance_.fixed)) *
               rows_of(values, relevance_.fixed);
  feasible_ = derived_columns_ * rows_of(values, selection.derived) ==
              right_sides_at(rows_of(values, selection.anchors));

  factoring_ = factor_ldu(derived, simplification);
  for (size_t k = 0; k < factoring_.row_order.size(); ++k) {
    const int constraint = relevance_.rows[static_cast<size_t>(factoring_.row_order[k])];
    (static_cast<int>(k) < rank() ? independent_ : redundant_).push_back(constraint);
  }
  std::sort(redundant_.begin(), redundant_.end());
}

bool ReferenceEditor::strongly_solvable() const { return reaches(factoring_, anchor_columns_); }

RationalMatrix ReferenceEditor::right_sides_at(const RationalMatrix& anchor_values) const {
  ISOCHOR_REQUIRE(anchor_values.rows() == anchor_columns_.columns(), anchor_values.rows(),
                  anchor_columns_.columns());
  ISOCHOR_REQUIRE(anchor_values.columns() == constant_.columns(), anchor_values.columns(),
                  constant_.columns());
  return constant_ - anchor_columns_ * anchor_values;
}

bool ReferenceEditor::weakly_solvable(const RationalMatrix& anchor_values) const {
  return reaches(factoring_, right_sides_at(anchor_values));
}

std::optional<ReferenceSolution> ReferenceEditor::update(
    const RationalMatrix& anchor_values, const RationalMatrix& hints,
    const std::vector<Rational>& weights) const {
  const int derived = derived_columns_.columns();
  ISOCHOR_REQUIRE(hints.rows() == derived, hints.rows(), derived);
  ISOCHOR_REQUIRE(hints.columns() == constant_.columns(), hints.columns(), constant_.columns());
  ISOCHOR_REQUIRE(weights.empty() || static_cast<int>(weights.size()) == derived, weights.size());
  for (const Rational& weight : weights) {
    ISOCHOR_REQUIRE(weight.sign() > 0, weight.to_string());
  }
  const RationalMatrix right = right_sides_at(anchor_values);
  if (!reaches(factoring_, right)) return std::nullopt;
  if (rank() == derived) {
    return ReferenceSolution{particular_solution(factoring_, right),
                             RationalMatrix(0, constant_.columns())};
  }
  return least_squares(right, hints, weights);
}

ReferenceSolution ReferenceEditor::least_squares(const RationalMatrix& right,
                                                 const RationalMatrix& hints,
                                                 const std::vector<Rational>& weights) const {
  const std::vector<int> pivot_rows(factoring_.row_order.begin(),
                                    factoring_.row_order.begin() + rank());
  const RationalMatrix independent = rows_of(derived_columns_, pivot_rows);  // A^
  RationalMatrix weighted = independent.transpose();                         // M^-1 A^^T
  for (int s = 0; s < weighted.rows(); ++s) {
    const Rational twice =
        weights.empty() ? Rational(2) : weights[static_cast<size_t>(s)] * Rational(2);
    for (int k = 0; k < weighted.columns(); ++k) {
      if (!weighted.at(s, k).is_zero()) weighted.at(s, k) /= twice;
    }
  }
  const RationalMatrix residual = independent * hints - rows_of(right, pivot_rows);
  // Regular: the rows of A^ are independent and M is positive.
  RationalMatrix multipliers = solve(independent * weighted, residual).value();  // (9.6)
  return {hints - weighted * multipliers, std::move(multipliers)};               // (9.8)
}

}  // namespace isochor
