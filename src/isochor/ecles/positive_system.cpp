#include "isochor/ecles/positive_system.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "isochor/base/error.h"
#include "isochor/exact/rational_matrix.h"

namespace isochor::internal {
namespace {

constexpr int kSmall = 6;       // up to here elimination beats lifting
constexpr int kDense = 24;      // beyond, p-adic lifting beats elimination
constexpr int kStepBits = 50;   // digits kept of one double solve
constexpr int kGuardBits = 20;  // of them, those that may be wrong
constexpr long kLeastGain = 8;  // bits per step below which lifting gives up

double scaled_double(const Integer& value, long exponent) {
  if (value.bits() < 900 && std::abs(exponent) < 900)
    return std::ldexp(value.to_double(), static_cast<int>(exponent));
  return Rational(value).scaled_by_power_of_two(exponent).to_double();
}

Integer divided_by_power_nearest(const Integer& value, unsigned long exponent) {
  return value.divided_nearest(Integer(1).shifted(exponent));
}

void reduce(CommonFractions& fractions) {
  Integer common = fractions.denominator;
  for (const Integer& n : fractions.numerators) common = gcd(common, n);
  if (common == Integer(1)) return;
  fractions.denominator = fractions.denominator.divided_exactly(common);
  for (Integer& n : fractions.numerators) n = n.divided_exactly(common);
}

// The smallest denominator d with |a / 2^digits - n / d| <= d error / 2^digits for some n, or
// nothing below 2^(digits / 2): the convergents of the continued fraction, by Euclid's remainders.
std::optional<Integer> denominator_of(const Integer& a, unsigned long digits,
                                      const Integer& error) {
  Integer high = Integer(1).shifted(digits), low = a.abs();
  Integer previous = 0, current = 1;
  while (current * error < low) {
    const Integer quotient = high.divided_floor(low);
    high.add_product(-quotient, low);
    std::swap(high, low);
    previous.add_product(quotient, current);
    std::swap(previous, current);
    if (2 * current.bits() > digits) return std::nullopt;
  }
  return current;
}

}  // namespace

struct PositiveSystem::State {
  SparseIntegerRows rows;
  SparseIntegerRows lifted;  // column j times 2^(largest exponent - exponent j)
  std::vector<int> exponents;
  int largest_exponent = 0;
  bool factored = false;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor;

  CommonFractions eliminate(const std::vector<Integer>& right) const;
  CommonFractions solve_densely(const std::vector<Integer>& right) const;
  std::optional<CommonFractions> lift(const std::vector<Integer>& right) const;
  std::optional<CommonFractions> reconstruct(const std::vector<Integer>& digits, long places,
                                             const std::vector<Integer>& right) const;
  bool solves(const CommonFractions& fractions, const std::vector<Integer>& right) const;
  bool step(std::vector<Integer>& rest, std::vector<Integer>& digits, long& places,
            std::optional<long>& reached) const;
};

PositiveSystem::PositiveSystem(SparseIntegerRows rows) {
  auto state = std::make_shared<State>();
  const int n = static_cast<int>(rows.size());
  for (int i = 0; i < n; ++i) {
    const auto& row = rows[static_cast<size_t>(i)];
    const auto diagonal = std::lower_bound(
        row.begin(), row.end(), i, [](const auto& entry, int j) { return entry.first < j; });
    ISOCHOR_REQUIRE(diagonal != row.end() && diagonal->first == i && diagonal->second.sign() > 0,
                    i);
    state->exponents.push_back(static_cast<int>(diagonal->second.bits() / 2));
    state->largest_exponent = std::max(state->largest_exponent, state->exponents.back());
  }
  std::vector<Eigen::Triplet<double>> entries;
  state->lifted = rows;
  for (int i = 0; i < n; ++i) {
    for (auto& [j, value] : state->lifted[static_cast<size_t>(i)]) {
      const int shift = state->exponents[static_cast<size_t>(j)];
      entries.emplace_back(
          i, j, scaled_double(value, -(state->exponents[static_cast<size_t>(i)] + shift)));
      value = value.shifted(static_cast<unsigned long>(state->largest_exponent - shift));
    }
  }
  if (n > 0) {
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    state->factor.compute(matrix);
    state->factored =
        state->factor.info() == Eigen::Success && state->factor.vectorD().minCoeff() > 0.0;
  }
  state->rows = std::move(rows);
  state_ = std::move(state);
}

int PositiveSystem::size() const { return static_cast<int>(state_->rows.size()); }
bool PositiveSystem::factored() const { return state_->factored; }
int PositiveSystem::exponent(int i) const { return state_->exponents[static_cast<size_t>(i)]; }

std::vector<double> PositiveSystem::solve_scaled(const std::vector<double>& right) const {
  ISOCHOR_REQUIRE(state_->factored);
  const Eigen::VectorXd solution = state_->factor.solve(
      Eigen::Map<const Eigen::VectorXd>(right.data(), static_cast<Eigen::Index>(right.size())));
  return {solution.data(), solution.data() + solution.size()};
}

std::optional<CommonFractions> PositiveSystem::solve(const std::vector<Integer>& right,
                                                     Rung rung) const {
  ISOCHOR_REQUIRE(right.size() == state_->rows.size(), right.size(), state_->rows.size());
  const bool lifts = rung == Rung::kLifting || (rung == Rung::kEither && size() > kSmall);
  if (lifts && state_->factored) {
    auto lifted = state_->lift(right);
    if (lifted || rung == Rung::kLifting) return lifted;
  }
  if (rung == Rung::kLifting) return std::nullopt;
  return size() > kDense && rung == Rung::kEither ? state_->solve_densely(right)
                                                  : state_->eliminate(right);
}

CommonFractions PositiveSystem::State::solve_densely(const std::vector<Integer>& right) const {
  const int n = static_cast<int>(rows.size());
  RationalMatrix matrix(n, n), column(n, 1);
  for (int i = 0; i < n; ++i) {
    for (const auto& [j, value] : rows[static_cast<size_t>(i)]) matrix.set(i, j, value);
    column.set(i, 0, right[static_cast<size_t>(i)]);
  }
  const auto solution = isochor::solve(matrix, column);
  ISOCHOR_REQUIRE(solution, "singular");
  CommonFractions result;
  for (int i = 0; i < n; ++i)
    result.denominator = lcm(result.denominator, solution->at(i, 0).denominator());
  for (int i = 0; i < n; ++i) {
    const Rational scaled = solution->at(i, 0) * Rational(result.denominator);
    result.numerators.push_back(scaled.numerator());
  }
  return result;
}

CommonFractions PositiveSystem::State::eliminate(const std::vector<Integer>& right) const {
  const size_t n = rows.size();
  std::vector<std::vector<Integer>> m(n, std::vector<Integer>(n + 1));
  for (size_t i = 0; i < n; ++i) {
    for (const auto& [j, value] : rows[i]) m[i][static_cast<size_t>(j)] = value;
    m[i][n] = right[i];
  }
  Integer previous = 1;
  for (size_t k = 0; k < n; ++k) {
    ISOCHOR_REQUIRE(m[k][k].sign() > 0, k);
    for (size_t i = k + 1; i < n; ++i) {
      for (size_t j = k + 1; j <= n; ++j) {
        Integer value = m[k][k] * m[i][j];
        value.add_product(-m[i][k], m[k][j]);
        m[i][j] = value.divided_exactly(previous);
      }
    }
    previous = m[k][k];
  }
  CommonFractions result{std::vector<Integer>(n), previous};
  for (size_t i = n; i-- > 0;) {
    Integer value = previous * m[i][n];
    for (size_t j = i + 1; j < n; ++j) value.add_product(-m[i][j], result.numerators[j]);
    result.numerators[i] = value.divided_exactly(m[i][i]);
  }
  reduce(result);
  return result;
}

// One double solve of the rest. `places`: binary places of the digits; `reached`: the place of the
// last digit that was right, which lies before the point as long as the solution is huge. False
// when too few digits were gained.
bool PositiveSystem::State::step(std::vector<Integer>& rest, std::vector<Integer>& digits,
                                 long& places, std::optional<long>& reached) const {
  const size_t n = rest.size();
  long magnitude = std::numeric_limits<long>::min();
  for (size_t i = 0; i < n; ++i)
    if (!rest[i].is_zero())
      magnitude = std::max(magnitude, static_cast<long>(rest[i].bits()) - exponents[i]);
  Eigen::VectorXd right(static_cast<Eigen::Index>(n));
  for (size_t i = 0; i < n; ++i)
    right[static_cast<Eigen::Index>(i)] = scaled_double(rest[i], -exponents[i] - magnitude);
  const Eigen::VectorXd solution = factor.solve(right);
  const double largest = solution.cwiseAbs().maxCoeff();
  if (!std::isfinite(largest) || largest == 0.0) return false;
  const int keep = kStepBits - 1 - std::ilogb(largest);
  const long place = places + keep - magnitude + largest_exponent;
  if (reached && place < *reached + kLeastGain) return false;
  reached = place;
  const auto gain = static_cast<unsigned long>(std::max(place - places, 0L));
  const auto excess = static_cast<unsigned long>(std::max(places - place, 0L));
  places += static_cast<long>(gain);
  std::vector<Integer> next(n);
  for (size_t j = 0; j < n; ++j) {
    next[j] = Integer(std::lround(std::ldexp(solution[static_cast<Eigen::Index>(j)], keep)));
    if (excess > 0) next[j] = next[j].shifted(excess);
    digits[j] = digits[j].shifted(gain) + next[j];
  }
  for (size_t i = 0; i < n; ++i) {
    Integer value = rest[i].shifted(gain);
    for (const auto& [j, entry] : lifted[i])
      value.add_product(-entry, next[static_cast<size_t>(j)]);
    rest[i] = std::move(value);
  }
  return true;
}

std::optional<CommonFractions> PositiveSystem::State::lift(
    const std::vector<Integer>& right) const {
  const size_t n = rows.size();
  std::vector<Integer> rest(n), digits(n);
  unsigned long determinant_bits = 0;  // Hadamard: det S <= product of the diagonal
  for (size_t i = 0; i < n; ++i) {
    rest[i] = right[i].shifted(static_cast<unsigned long>(largest_exponent));
    for (const auto& [j, value] : rows[i])
      if (j == static_cast<int>(i)) determinant_bits += value.bits();
  }
  const long limit = 2 * static_cast<long>(determinant_bits) + 8 * kStepBits;
  long places = 0, next_try = 2 * kStepBits;
  const auto is_zero = [](const Integer& value) { return value.is_zero(); };
  std::optional<long> reached;
  while (places <= limit) {
    if (std::all_of(rest.begin(), rest.end(), is_zero)) {
      CommonFractions exact{
          digits, Integer(1).shifted(static_cast<unsigned long>(places + largest_exponent))};
      for (size_t j = 0; j < n; ++j)
        exact.numerators[j] =
            digits[j].shifted(static_cast<unsigned long>(largest_exponent - exponents[j]));
      reduce(exact);
      return exact;
    }
    if (!step(rest, digits, places, reached)) return std::nullopt;
    if (*reached < next_try) continue;
    if (auto fractions = reconstruct(digits, places, right)) return fractions;
    next_try = places + places / 2;
  }
  return std::nullopt;
}

std::optional<CommonFractions> PositiveSystem::State::reconstruct(
    const std::vector<Integer>& digits, long places, const std::vector<Integer>& right) const {
  const size_t n = rows.size();
  CommonFractions result{std::vector<Integer>(n), 1};
  std::vector<Integer> denominators(n);  // the common one when the numerator was found
  for (size_t j = 0; j < n; ++j) {
    const auto point = static_cast<unsigned long>(places + exponents[j]);
    Integer scaled = digits[j] * result.denominator;
    Integer numerator = divided_by_power_nearest(scaled, point);
    Integer error = result.denominator.shifted(kGuardBits);
    Integer rest = scaled - numerator.shifted(point);
    if (error < rest.abs()) {
      const auto factor_of = denominator_of(rest, point, error);
      if (!factor_of) return std::nullopt;
      result.denominator *= *factor_of;
      if (2 * result.denominator.bits() + kGuardBits > point) return std::nullopt;
      numerator = divided_by_power_nearest(digits[j] * result.denominator, point);
    }
    result.numerators[j] = std::move(numerator);
    denominators[j] = result.denominator;
  }
  for (size_t j = 0; j < n; ++j)
    if (denominators[j] != result.denominator)
      result.numerators[j] *= result.denominator.divided_exactly(denominators[j]);
  if (!solves(result, right)) return std::nullopt;
  reduce(result);
  return result;
}

bool PositiveSystem::State::solves(const CommonFractions& fractions,
                                   const std::vector<Integer>& right) const {
  for (size_t i = 0; i < rows.size(); ++i) {
    Integer rest = -(fractions.denominator * right[i]);
    for (const auto& [j, value] : rows[i])
      rest.add_product(value, fractions.numerators[static_cast<size_t>(j)]);
    if (!rest.is_zero()) return false;
  }
  return true;
}

}  // namespace isochor::internal
