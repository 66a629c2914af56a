#include "isochor/ecles/constraint_matrix.h"

#include <algorithm>

#include "isochor/base/error.h"

namespace isochor {
namespace {

// Sorted by parameter, repeated parameters added, zeros dropped.
RationalTerms collected(RationalTerms terms) {
  std::stable_sort(terms.begin(), terms.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  RationalTerms result;
  for (auto& term : terms) {
    if (!result.empty() && result.back().first == term.first) {
      result.back().second += term.second;
    } else {
      result.push_back(std::move(term));
    }
  }
  result.erase(std::remove_if(result.begin(), result.end(),
                              [](const auto& term) { return term.second.is_zero(); }),
               result.end());
  return result;
}

// What makes the entries integers without a common factor; 1 for a row of zeros.
Rational scale_of(const RationalTerms& terms) {
  Integer denominators(1);
  for (const auto& term : terms) denominators = lcm(denominators, term.second.denominator());
  Integer content;
  for (const auto& term : terms) {
    content = gcd(content, (term.second * Rational(denominators)).numerator());
  }
  return content.is_zero() ? Rational(1) : Rational(denominators, content);
}

}  // namespace

ConstraintMatrix::ConstraintMatrix(int parameters, const std::vector<RationalTerms>& rows)
    : row_begin_{0}, column_begin_(static_cast<size_t>(parameters) + 1, 0) {
  ISOCHOR_REQUIRE(parameters >= 0, parameters);
  for (const RationalTerms& given : rows) {
    const RationalTerms row = collected(given);
    scales_.push_back(scale_of(row));
    for (const auto& [parameter, value] : row) {
      ISOCHOR_REQUIRE(0 <= parameter && parameter < parameters, parameter, parameters);
      terms_.push_back({parameter, (value * scales_.back()).numerator()});
      ++column_begin_[static_cast<size_t>(parameter) + 1];
    }
    row_begin_.push_back(terms_.size());
  }
  for (size_t j = 1; j < column_begin_.size(); ++j) column_begin_[j] += column_begin_[j - 1];
  column_rows_.resize(terms_.size());
  std::vector<size_t> next(column_begin_.begin(), column_begin_.end() - 1);
  for (int i = 0; i < this->rows(); ++i) {
    for (const ConstraintTerm& term : row(i)) {
      column_rows_[next[static_cast<size_t>(term.parameter)]++] = i;
    }
  }
}

}  // namespace isochor
