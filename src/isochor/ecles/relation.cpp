#include "isochor/ecles/relation.h"

#include <algorithm>
#include <numeric>

namespace isochor::internal {
namespace {

size_t index(int i) { return static_cast<size_t>(i); }

// Of numerators and denominators in machine words: about the square root of half a prime.
constexpr Residue kShort = Residue{1} << 30;
// Multipliers in machine words: products with words, summed 2^30 times, stay in 128 bits.
constexpr Residue kLongest = Residue{1} << 31;

// Rows whose relation is found over the integers at once.
constexpr size_t kFewRows = 12;

// In (-p / 2, p / 2].
long symmetric(Residue value, Residue prime) {
  return value > prime / 2 ? -static_cast<long>(prime - value) : static_cast<long>(value);
}

Residue magnitude(long value) {
  return value < 0 ? static_cast<Residue>(-value) : static_cast<Residue>(value);
}

// In (-m / 2, m / 2].
Integer symmetric(const Integer& value, const Integer& modulus) {
  return value - value.divided_nearest(modulus) * modulus;
}

// The d of the first n == d residue modulo p with |n| <= kShort that Euclid's algorithm meets.
Residue short_denominator(Residue residue, Residue prime) {
  Residue larger = prime, smaller = residue, before = 0, denominator = 1;  // signs alternate
  while (smaller > kShort) {
    const Residue quotient = larger / smaller;
    std::swap(larger, smaller);
    smaller -= quotient * larger;
    before += quotient * denominator;
    std::swap(before, denominator);
  }
  return denominator;
}

void remove_content(Relation& relation) {
  Integer content;
  for (const auto& term : relation) content = gcd(content, term.second);
  if (content == Integer(1)) return;
  for (auto& term : relation) term.second = term.second.divided_exactly(content);
}

}  // namespace

std::optional<Relation> RelationFinder::find(int row, int first, const std::vector<int>& columns) {
  const std::vector<Residue>& digits = elimination_.combination(first);
  std::optional<Relation> result = from_first_digit(row, first, digits);
  if (!result) result = from_support(row, first, digits);
  return result ? result : from_many_digits(row, first, columns, digits);
}

std::optional<Relation> RelationFinder::from_support(int row, int first,
                                                     const std::vector<Residue>& digits) {
  std::vector<int> rows{row};
  for (size_t k = 0; k < digits.size() && rows.size() <= kFewRows; ++k) {
    if (digits[k] != 0) rows.push_back(elimination_.row(first + static_cast<int>(k)));
  }
  if (rows.size() > kFewRows) return std::nullopt;
  return small_relation(elimination_.system(), rows);
}

std::optional<Relation> RelationFinder::from_first_digit(int row, int first,
                                                         const std::vector<Residue>& digits) {
  const PrimeField& field = elimination_.field();
  Residue denominator = 1;
  for (const Residue y : digits) {
    if (y == 0) continue;
    const Residue scaled = field.multiply(y, denominator);
    if (magnitude(symmetric(scaled, field.prime())) <= kShort) continue;
    const Residue factor = short_denominator(scaled, field.prime());
    if (factor > kShort / denominator) return std::nullopt;
    denominator *= factor;
  }
  std::vector<std::pair<int, long>> words{{row, static_cast<long>(denominator)}};
  long content = words[0].second;
  for (size_t k = 0; k < digits.size(); ++k) {
    if (digits[k] == 0) continue;
    const long multiplier = -symmetric(field.multiply(digits[k], denominator), field.prime());
    if (magnitude(multiplier) > kLongest) return std::nullopt;
    words.emplace_back(elimination_.row(first + static_cast<int>(k)), multiplier);
    content = std::gcd(content, multiplier);
  }
  if (!holds_in_words(words)) return std::nullopt;
  Relation relation;
  relation.reserve(words.size());
  for (const auto& [member, multiplier] : words)
    relation.emplace_back(member, multiplier / content);
  return relation;
}

bool RelationFinder::holds_in_words(const std::vector<std::pair<int, long>>& relation) {
  wide_sums_.resize(index(elimination_.system().columns));
  touched_.clear();
  bool holds = true;
  for (const auto& [row, multiplier] : relation) {
    for (const LocalTerm& term : elimination_.system().row(row)) {
      holds = holds && term.is_word;
      wide_sums_[index(term.column)] += static_cast<WideSum>(term.word) * multiplier;
      touched_.push_back(term.column);
    }
  }
  for (const int column : touched_) {
    holds = holds && wide_sums_[index(column)] == 0;
    wide_sums_[index(column)] = 0;
  }
  return holds;
}

std::optional<Relation> RelationFinder::from_many_digits(int row, int first,
                                                         const std::vector<int>& columns,
                                                         std::vector<Residue> digits) {
  residual_.resize(index(elimination_.system().columns));
  sums_.resize(residual_.size());
  for (const LocalTerm& term : elimination_.system().row(row)) {
    residual_[index(term.column)] = *term.value;
  }
  y_.assign(digits.size(), Integer());
  power_ = Integer(1);
  add_digits(first, digits, columns);
  std::optional<Relation> result;
  bool dependent = true;
  for (int known = 1, wanted = likely_digits(row, first); dependent; wanted += (wanted + 1) / 2) {
    for (; dependent && known < wanted; ++known) {
      dependent = next_digits(first, columns, digits);
      if (dependent) add_digits(first, digits, columns);
    }
    if (dependent) result = recovered(row, first);
    if (result && holds(*result)) break;
    result.reset();
  }
  for (const int column : columns) residual_[index(column)] = Integer();
  return result;
}

// As many as multipliers need that are as long as the longest coefficient.
int RelationFinder::likely_digits(int row, int first) const {
  unsigned long bits = 1;
  const auto look_at = [&](int member) {
    for (const LocalTerm& term : elimination_.system().row(member)) {
      bits = std::max(bits, term.value->bits());
    }
  };
  look_at(row);
  for (size_t k = 0; k < y_.size(); ++k) {
    if (!y_[k].is_zero()) look_at(elimination_.row(first + static_cast<int>(k)));
  }
  return std::max(2, static_cast<int>((2 * bits + 4) / 60 + 1));
}

// The digits of the residual; false when it is no combination of the rows.
bool RelationFinder::next_digits(int first, const std::vector<int>& columns,
                                 std::vector<Residue>& digits) {
  std::vector<Residue>& vector = elimination_.vector();
  for (const int column : columns) {
    vector[index(column)] = elimination_.field().of(residual_[index(column)]);
  }
  elimination_.reduce(first);
  if (elimination_.nonzero_column(columns) >= 0) {
    for (const int column : columns) vector[index(column)] = 0;
    return false;
  }
  digits = elimination_.combination(first);
  return true;
}

// y += digits power; residual -= digits rows, over p; power *= p.
void RelationFinder::add_digits(int first, const std::vector<Residue>& digits,
                                const std::vector<int>& columns) {
  for (size_t k = 0; k < digits.size(); ++k) {
    if (digits[k] == 0) continue;
    const auto digit = static_cast<long>(digits[k]);
    y_[k].add_product(power_, digit);
    for (const LocalTerm& term :
         elimination_.system().row(elimination_.row(first + static_cast<int>(k)))) {
      residual_[index(term.column)].add_product(*term.value, -digit);
    }
  }
  const Integer prime(static_cast<long>(elimination_.field().prime()));
  for (const int column : columns) {
    Integer& value = residual_[index(column)];
    if (!value.is_zero()) value = value.divided_exactly(prime);
  }
  power_ *= prime;
}

std::optional<Relation> RelationFinder::recovered(int row, int first) const {
  const unsigned long bits = power_.bits() / 2 - 1;
  Integer denominator(1);
  for (const Integer& y : y_) {
    if (y.is_zero()) continue;
    Integer scaled = symmetric(y * denominator, power_);
    if (scaled.bits() <= bits) continue;
    if (scaled.sign() < 0) scaled += power_;
    const std::optional<Rational> fraction = Rational::reconstruct(scaled, power_);
    if (!fraction) return std::nullopt;
    denominator *= fraction->denominator();
    if (denominator.bits() > bits) return std::nullopt;
  }
  Relation relation{{row, denominator}};
  for (size_t k = 0; k < y_.size(); ++k) {
    if (y_[k].is_zero()) continue;
    Integer multiplier = -symmetric(y_[k] * denominator, power_);
    relation.emplace_back(elimination_.row(first + static_cast<int>(k)), std::move(multiplier));
  }
  remove_content(relation);
  return relation;
}

bool RelationFinder::holds(const Relation& relation) {
  touched_.clear();
  for (const auto& [row, multiplier] : relation) {
    for (const LocalTerm& term : elimination_.system().row(row)) {
      sums_[index(term.column)].add_product(*term.value, multiplier);
      touched_.push_back(term.column);
    }
  }
  bool zero = true;
  for (const int column : touched_) {
    zero = zero && sums_[index(column)].is_zero();
    sums_[index(column)] = Integer();
  }
  return zero;
}

}  // namespace isochor::internal
