#include "isochor/ecles/relation.h"

#include <numeric>

namespace isochor::internal {
namespace {

size_t index(int i) { return static_cast<size_t>(i); }

struct Fraction {
  Integer numerator, denominator;
};

// The fraction n / d = residue modulo m with n and d of at most `bits` binary digits, from the
// first short remainder of Euclid's algorithm; d is zero when it finds none.
Fraction short_fraction(const Integer& residue, const Integer& modulus, unsigned long bits) {
  Integer larger = modulus, smaller = residue, before(0), coefficient(1);
  while (smaller.bits() > bits) {
    const Integer quotient = larger.divided_floor(smaller);
    Integer rest = larger - quotient * smaller;
    Integer next = before - quotient * coefficient;
    larger = std::move(smaller);
    smaller = std::move(rest);
    before = std::move(coefficient);
    coefficient = std::move(next);
  }
  if (coefficient.sign() < 0) {
    coefficient = -coefficient;
    smaller = -smaller;
  }
  if (coefficient.bits() > bits) coefficient = Integer(0);
  return {std::move(smaller), std::move(coefficient)};
}

// In (-m/2, m/2].
Integer symmetric(const Integer& value, const Integer& modulus) {
  return value - value.divided_nearest(modulus) * modulus;
}

void remove_content(Relation& relation) {
  Integer content;
  for (const auto& term : relation) content = gcd(content, term.second);
  if (content == Integer(1)) return;
  for (auto& term : relation) term.second = term.second.divided_exactly(content);
}

}  // namespace

std::optional<Relation> RelationFinder::find(int row, int first, const std::vector<int>& columns) {
  const std::vector<Residue> digits = elimination_.combination(first);
  y_.assign(digits.size(), Integer());
  for (size_t k = 0; k < digits.size(); ++k) y_[k] = Integer(static_cast<long>(digits[k]));
  const Integer prime(static_cast<long>(elimination_.field().prime()));
  power_ = prime;
  residual_.resize(index(elimination_.system().columns));
  sums_.resize(residual_.size());
  for (const LocalTerm& term : elimination_.system().row(row)) {
    residual_[index(term.column)] = *term.value;
  }
  divide_residual(first, digits, columns);
  std::optional<Relation> result = recovered(row, first);
  bool dependent = true;
  for (int known = 1, wanted = 2; dependent && !(result && holds(*result)); wanted += wanted / 2) {
    for (; dependent && known < wanted; ++known) dependent = next_digit(first, columns);
    result = dependent ? recovered(row, first) : std::nullopt;
  }
  for (const int column : columns) residual_[index(column)] = Integer();
  return result;
}

bool RelationFinder::next_digit(int first, const std::vector<int>& columns) {
  std::vector<Residue>& vector = elimination_.vector();
  for (const int column : columns) {
    vector[index(column)] = elimination_.field().of(residual_[index(column)]);
  }
  elimination_.reduce(first);
  if (elimination_.nonzero_column(columns) >= 0) {
    for (const int column : columns) vector[index(column)] = 0;
    return false;
  }
  const std::vector<Residue> digits = elimination_.combination(first);
  for (size_t k = 0; k < digits.size(); ++k) {
    if (digits[k] != 0) y_[k].add_product(power_, static_cast<long>(digits[k]));
  }
  power_ *= Integer(static_cast<long>(elimination_.field().prime()));
  divide_residual(first, digits, columns);
  return true;
}

void RelationFinder::divide_residual(int first, const std::vector<Residue>& digits,
                                     const std::vector<int>& columns) {
  for (size_t k = 0; k < digits.size(); ++k) {
    if (digits[k] == 0) continue;
    const int pivot_row = elimination_.row(first + static_cast<int>(k));
    for (const LocalTerm& term : elimination_.system().row(pivot_row)) {
      residual_[index(term.column)].add_product(*term.value, -static_cast<long>(digits[k]));
    }
  }
  const Integer prime(static_cast<long>(elimination_.field().prime()));
  for (const int column : columns) {
    Integer& value = residual_[index(column)];
    if (!value.is_zero()) value = value.divided_exactly(prime);
  }
}

std::optional<Relation> RelationFinder::recovered(int row, int first) const {
  const unsigned long bits = power_.bits() / 2 - 1;
  Integer denominator(1);
  for (const Integer& y : y_) {
    if (y.is_zero()) continue;
    const Integer scaled = symmetric(y * denominator, power_);
    if (scaled.bits() <= bits) continue;
    const Integer residue = scaled.sign() < 0 ? scaled + power_ : scaled;
    const Fraction fraction = short_fraction(residue, power_, bits);
    denominator *= fraction.denominator;
    if (denominator.is_zero() || denominator.bits() > bits) return std::nullopt;
  }
  Relation relation{{row, denominator}};
  for (size_t k = 0; k < y_.size(); ++k) {
    if (y_[k].is_zero()) continue;
    const Integer scaled = symmetric(y_[k] * denominator, power_);
    relation.emplace_back(elimination_.row(first + static_cast<int>(k)), -scaled);
  }
  remove_content(relation);
  return relation;
}

bool RelationFinder::holds(const Relation& relation) {
  std::vector<int> touched;
  for (const auto& [row, multiplier] : relation) {
    for (const LocalTerm& term : elimination_.system().row(row)) {
      sums_[index(term.column)].add_product(*term.value, multiplier);
      touched.push_back(term.column);
    }
  }
  bool zero = true;
  for (const int column : touched) {
    zero = zero && sums_[index(column)].is_zero();
    sums_[index(column)] = Integer();
  }
  return zero;
}

}  // namespace isochor::internal
