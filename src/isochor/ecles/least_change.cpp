#include "isochor/ecles/least_change.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_map>

#include "isochor/base/double_double.h"
#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/ecles/positive_system.h"

namespace isochor {
namespace {

// The double factor of a block is used while its weights stay within this many binary orders.
constexpr long kWeightRange = 200;

struct Term {
  int index = 0;  // a derived parameter of the block, or a parameter of the matrix
  Integer coefficient;
  DoubleDouble approximate;  // 2^-exponent times the coefficient
};

struct Row {
  int row = 0;  // of the matrix
  Rational scale;
  DoubleDouble approximate_scale;
  double largest_unscaled = 0.0;   // 2^exponent / scale, rounded up
  std::vector<Term> inner, outer;  // on the block's derived parameters, on all others
};

DoubleDouble twice_rounded(const Rational& value) {
  const double high = value.to_double();
  return DoubleDouble(high) + DoubleDouble((value - Rational(high)).to_double());
}

struct Block {
  std::vector<int> columns;  // positions in derived
  std::vector<Integer> inverse_weights;
  std::vector<double> approximate_inverse_weights;
  std::vector<Row> rows;
  bool approximable = false;
  internal::PositiveSystem system{internal::SparseIntegerRows{}};
};

// Union of the positions of D that share a row.
class Groups {
 public:
  explicit Groups(size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int root(int i) {
    while (parent_[static_cast<size_t>(i)] != i)
      i = parent_[static_cast<size_t>(i)] =
          parent_[static_cast<size_t>(parent_[static_cast<size_t>(i)])];
    return i;
  }
  void join(int i, int j) { parent_[static_cast<size_t>(root(i))] = root(j); }

 private:
  std::vector<int> parent_;
};

// Inverse weights as integers: a common factor changes no minimum.
void set_inverse_weights(Block& block, const std::vector<Rational>& weights) {
  Integer numerators = 1, common;
  for (const int c : block.columns)
    if (!weights.empty()) numerators = lcm(numerators, weights[static_cast<size_t>(c)].numerator());
  for (const int c : block.columns) {
    const Rational inverse =
        weights.empty() ? Rational(1) : Rational(numerators) / weights[static_cast<size_t>(c)];
    block.inverse_weights.push_back(inverse.numerator());
    common = gcd(common, block.inverse_weights.back());
  }
  for (Integer& u : block.inverse_weights) {
    u = u.divided_exactly(common);
    block.approximate_inverse_weights.push_back(u.to_double());
  }
}

internal::SparseIntegerRows normal_matrix(const Block& block) {
  std::vector<std::vector<std::pair<int, const Integer*>>> by_column(block.columns.size());
  for (size_t i = 0; i < block.rows.size(); ++i)
    for (const Term& term : block.rows[i].inner)
      by_column[static_cast<size_t>(term.index)].emplace_back(static_cast<int>(i),
                                                              &term.coefficient);
  internal::SparseIntegerRows result;
  for (const Row& row : block.rows) {
    std::map<int, Integer> entries;
    for (const Term& term : row.inner) {
      const Integer weighted =
          term.coefficient * block.inverse_weights[static_cast<size_t>(term.index)];
      for (const auto& [other, coefficient] : by_column[static_cast<size_t>(term.index)])
        entries[other].add_product(weighted, *coefficient);
    }
    result.emplace_back(entries.begin(), entries.end());
  }
  return result;
}

void set_approximations(Block& block) {
  block.approximable = block.system.factored();
  for (const Integer& u : block.inverse_weights)
    block.approximable = block.approximable && u.bits() < kWeightRange;
  for (size_t i = 0; i < block.rows.size(); ++i) {
    Row& row = block.rows[i];
    const long exponent = block.system.exponent(static_cast<int>(i));
    const auto scaled = [&](const Rational& value) {
      return twice_rounded(value.scaled_by_power_of_two(-exponent));
    };
    for (auto* terms : {&row.inner, &row.outer})
      for (Term& term : *terms) term.approximate = scaled(Rational(term.coefficient));
    row.approximate_scale = scaled(row.scale);
    row.largest_unscaled =
        (Rational(1) / row.scale).scaled_by_power_of_two(exponent).enclosure().high;
    block.approximable = block.approximable && std::isfinite(row.largest_unscaled) &&
                         row.largest_unscaled > 0x1p-900 && row.largest_unscaled < 0x1p900;
  }
}

// A sum in twice the precision, with the sum of its absolute terms for the error bound.
struct Sum {
  DoubleDouble value;
  double magnitude = 0.0;
  int terms = 0;
  void subtract(const DoubleDouble& a, double b) {
    const DoubleDouble product = a * DoubleDouble(b);
    value -= product;
    magnitude += std::fabs(product.high());
    ++terms;
  }
  // Conversions, products and additions each err below kUnit, relative; subnormal products by less
  // than the smallest normal number.
  double error() const {
    return (terms + 4) * (2 * DoubleDouble::kUnit * magnitude + std::numeric_limits<double>::min());
  }
};

}  // namespace

struct LeastChange::State {
  std::vector<int> derived, rows;
  std::vector<Block> blocks;
};

namespace {

Row copy_row(const ConstraintMatrix& matrix, int i, const std::unordered_map<int, int>& position,
             const std::vector<int>& place_in_block) {
  Row row;
  row.row = i;
  row.scale = matrix.scale(i);
  for (const ConstraintTerm& term : matrix.row(i)) {
    const auto found = position.find(term.parameter);
    if (found == position.end())
      row.outer.push_back({term.parameter, term.coefficient, {}});
    else
      row.inner.push_back(
          {place_in_block[static_cast<size_t>(found->second)], term.coefficient, {}});
  }
  return row;
}

// b - A x of one row, exactly.
template <typename Number>
Rational exact_rest(const Row& row, const std::vector<Number>& right_sides,
                    const std::vector<Number>& values, const std::vector<Rational>& x) {
  Rational rest = row.scale * Rational(right_sides[static_cast<size_t>(row.row)]);
  for (const Term& term : row.outer)
    rest -= Rational(term.coefficient) * Rational(values[static_cast<size_t>(term.index)]);
  for (const Term& term : row.inner)
    rest -= Rational(term.coefficient) * x[static_cast<size_t>(term.index)];
  return rest;
}

// Adds U A^T y of one block to the hints x of its columns.
// False, and nothing added, when only elimination would help and the block is larger than allowed.
bool add_change(const Block& block, int most_eliminated, const std::vector<Rational>& rests,
                std::vector<Rational>& x) {
  Integer common = 1;
  for (const Rational& rest : rests) common = lcm(common, rest.denominator());
  std::vector<Integer> right;
  for (const Rational& rest : rests)
    right.push_back(rest.numerator() * common.divided_exactly(rest.denominator()));
  using Rung = internal::PositiveSystem::Rung;
  const bool small = block.system.size() <= most_eliminated;
  if (!small && !block.system.factored()) return false;
  const auto solved = block.system.solve(right, small ? Rung::kEither : Rung::kLifting);
  if (!solved) return false;
  const internal::CommonFractions& y = *solved;
  std::vector<Integer> change(block.columns.size());
  for (size_t i = 0; i < block.rows.size(); ++i)
    for (const Term& term : block.rows[i].inner)
      change[static_cast<size_t>(term.index)].add_product(term.coefficient, y.numerators[i]);
  const Integer denominator = y.denominator * common;
  for (size_t j = 0; j < change.size(); ++j)
    x[j] += Rational(change[j] * block.inverse_weights[j], denominator);
  return true;
}

// The rest of a row in doubles at the values x of its block; `fixed` is b.
Sum rest_of(const Row& row, const Sum& fixed, const std::vector<double>& x) {
  Sum rest = fixed;
  for (const Term& term : row.inner)
    rest.subtract(term.approximate, x[static_cast<size_t>(term.index)]);
  return rest;
}

Sum fixed_part(const Row& row, const std::vector<double>& right_sides,
               const std::vector<double>& values) {
  Sum fixed;
  fixed.subtract(-row.approximate_scale, right_sides[static_cast<size_t>(row.row)]);
  for (const Term& term : row.outer)
    fixed.subtract(term.approximate, values[static_cast<size_t>(term.index)]);
  return fixed;
}

// The same in plain doubles: enough for a first guess.
double rough_rest_of(const Row& row, const Sum& fixed, const std::vector<double>& x) {
  double rest = fixed.value.high();
  for (const Term& term : row.inner)
    rest -= term.approximate.high() * x[static_cast<size_t>(term.index)];
  return rest;
}

// x += U A^T S^-1 (b - A x); returns the largest change.
double refine(const Block& block, const std::vector<Sum>& fixed, bool rough,
              std::vector<double>& x) {
  std::vector<double> rests;
  for (size_t i = 0; i < block.rows.size(); ++i)
    rests.push_back(rough ? rough_rest_of(block.rows[i], fixed[i], x)
                          : rest_of(block.rows[i], fixed[i], x).value.high());
  const std::vector<double> y = block.system.solve_scaled(rests);
  std::vector<double> change(x.size());
  for (size_t i = 0; i < block.rows.size(); ++i)
    for (const Term& term : block.rows[i].inner)
      change[static_cast<size_t>(term.index)] += term.approximate.high() * y[i];
  double largest = 0.0;
  for (size_t j = 0; j < x.size(); ++j) {
    change[j] *= block.approximate_inverse_weights[j];
    x[j] += change[j];
    largest = std::max(largest, std::fabs(change[j]));
  }
  return largest;
}

// What overflowed is enclosed by infinity.
void widen(Enclosure& worst, double residual, double error, double unscaled) {
  if (!std::isfinite(residual) || !std::isfinite(error)) {
    worst.high = std::numeric_limits<double>::infinity();
    return;
  }
  const double up = 1.0 + 4 * std::numeric_limits<double>::epsilon();
  worst.low = std::max(worst.low, (std::fabs(residual) - error) * unscaled / up / up);
  worst.high = std::max(worst.high, (std::fabs(residual) + error) * unscaled * up);
}

// The exact solution of one block at hints x, each value rounded to the nearest double.
void solve_rounded(const Block& block, const std::vector<double>& right_sides,
                   const std::vector<double>& values, std::vector<double>& x) {
  std::vector<Rational> exact(x.begin(), x.end()), rests;
  for (const Row& row : block.rows) rests.push_back(exact_rest(row, right_sides, values, exact));
  add_change(block, std::numeric_limits<int>::max(), rests, exact);
  for (size_t k = 0; k < x.size(); ++k) x[k] = exact[k].to_double();
}

}  // namespace

LeastChange::LeastChange(const ConstraintMatrix& matrix, std::vector<int> derived,
                         std::vector<int> rows, const std::vector<Rational>& weights) {
  ISOCHOR_REQUIRE(weights.empty() || weights.size() == derived.size(), weights.size());
  for (const Rational& weight : weights) ISOCHOR_REQUIRE(weight.sign() > 0, weight.to_string());
  std::unordered_map<int, int> position;
  for (size_t k = 0; k < derived.size(); ++k) {
    ISOCHOR_REQUIRE(derived[k] >= 0 && derived[k] < matrix.parameters(), derived[k]);
    ISOCHOR_REQUIRE(position.emplace(derived[k], static_cast<int>(k)).second, derived[k]);
  }
  Groups groups(derived.size());
  std::vector<int> first_of_row;
  for (const int i : rows) {
    int first = -1;
    for (const ConstraintTerm& term : matrix.row(i)) {
      const auto found = position.find(term.parameter);
      if (found == position.end()) continue;
      if (first < 0) first = found->second;
      groups.join(first, found->second);
    }
    ISOCHOR_REQUIRE(first >= 0, i);
    first_of_row.push_back(first);
  }
  auto state = std::make_shared<State>();
  std::vector<int> block_of_root(derived.size(), -1), place(derived.size());
  for (const int first : first_of_row) {
    int& block = block_of_root[static_cast<size_t>(groups.root(first))];
    if (block >= 0) continue;
    block = static_cast<int>(state->blocks.size());
    state->blocks.emplace_back();
  }
  for (size_t k = 0; k < derived.size(); ++k) {
    const int b = block_of_root[static_cast<size_t>(groups.root(static_cast<int>(k)))];
    if (b < 0) continue;
    auto& columns = state->blocks[static_cast<size_t>(b)].columns;
    place[k] = static_cast<int>(columns.size());
    columns.push_back(static_cast<int>(k));
  }
  for (size_t r = 0; r < rows.size(); ++r) {
    const int b = block_of_root[static_cast<size_t>(groups.root(first_of_row[r]))];
    state->blocks[static_cast<size_t>(b)].rows.push_back(
        copy_row(matrix, rows[r], position, place));
  }
  for (Block& block : state->blocks) {
    set_inverse_weights(block, weights);
    block.system = internal::PositiveSystem(normal_matrix(block));
    set_approximations(block);
  }
  state->derived = std::move(derived);
  state->rows = std::move(rows);
  state_ = std::move(state);
}

const std::vector<int>& LeastChange::derived() const { return state_->derived; }
const std::vector<int>& LeastChange::rows() const { return state_->rows; }
int LeastChange::blocks() const { return static_cast<int>(state_->blocks.size()); }

std::vector<Rational> LeastChange::solve(const std::vector<Rational>& right_sides,
                                         const std::vector<Rational>& values) const {
  return *solve_within(std::numeric_limits<int>::max(), right_sides, values);
}

std::optional<std::vector<Rational>> LeastChange::solve_within(
    int most_eliminated, const std::vector<Rational>& right_sides,
    const std::vector<Rational>& values) const {
  std::vector<Rational> result;
  for (const int j : state_->derived) result.push_back(values.at(static_cast<size_t>(j)));
  for (const Block& block : state_->blocks) {
    std::vector<Rational> x, rests;
    for (const int c : block.columns) x.push_back(result[static_cast<size_t>(c)]);
    for (const Row& row : block.rows) rests.push_back(exact_rest(row, right_sides, values, x));
    if (!add_change(block, most_eliminated, rests, x)) return std::nullopt;
    for (size_t k = 0; k < x.size(); ++k)
      result[static_cast<size_t>(block.columns[k])] = std::move(x[k]);
  }
  return result;
}

LeastChange::Digits LeastChange::most_digits() const {
  Digits digits;
  for (const Block& block : state_->blocks) {
    double determinant = 0.0;  // a positive definite one is at most the product of its diagonal
    for (const Row& row : block.rows) {
      Integer norm;
      for (const Term& term : row.inner)
        norm.add_product(term.coefficient * term.coefficient,
                         block.inverse_weights[static_cast<size_t>(term.index)]);
      determinant += static_cast<double>(norm.bits());
    }
    digits.longest = std::max(digits.longest, determinant);
    digits.together += determinant * static_cast<double>(block.columns.size());
  }
  return digits;
}

LeastChange::Approximation LeastChange::approximate(const std::vector<double>& right_sides,
                                                    const std::vector<double>& values) const {
  Approximation result;
  double largest = 0.0;
  for (const int j : state_->derived) result.derived.push_back(values.at(static_cast<size_t>(j)));
  for (const Block& block : state_->blocks) {
    std::vector<Sum> fixed;
    std::vector<double> x;
    for (const int c : block.columns) x.push_back(result.derived[static_cast<size_t>(c)]);
    for (const Row& row : block.rows) fixed.push_back(fixed_part(row, right_sides, values));
    if (block.approximable) {
      refine(block, fixed, true, x);
      refine(block, fixed, false, x);
      result.last_change = std::max(result.last_change, refine(block, fixed, false, x));
    } else {
      solve_rounded(block, right_sides, values, x);
    }
    for (size_t k = 0; k < x.size(); ++k) {
      result.derived[static_cast<size_t>(block.columns[k])] = x[k];
      largest = std::max(largest, std::fabs(x[k]));
    }
    for (size_t i = 0; i < block.rows.size(); ++i) {
      const Sum rest = rest_of(block.rows[i], fixed[i], x);
      widen(result.residual, rest.value.high(), rest.error(), block.rows[i].largest_unscaled);
    }
  }
  result.last_change += 2 * kUnitRoundoff * largest;
  return result;
}

}  // namespace isochor
