#include "isochor/ecles/lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "isochor/base/error.h"

namespace isochor::internal {
namespace {

using Words = std::vector<std::vector<long>>;

constexpr double kLovasz = 0.99;            // the usual strength of the reduction
constexpr unsigned long kFastBits = 40;     // larger entries are reduced exactly
constexpr int kRoundingPasses = 16;         // targets far away lose digits in the first ones
constexpr double kRoundingRoom = 1 + 1e-6;  // of the bound, for the doubles that choose planes

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

bool to_words(const IntegerVectors& vectors, Words& words) {
  words.clear();
  for (const auto& vector : vectors) {
    words.emplace_back();
    for (const Integer& entry : vector) {
      const auto word = entry.to_long();
      if (!word) return false;
      words.back().push_back(*word);
    }
  }
  return true;
}

// Reduction in doubles over words. Every step is unimodular, so doubles decide only how short the
// basis gets; false when it does not settle or leaves the words' range.
class FastReduction {
 public:
  explicit FastReduction(Words& basis)
      : basis_(basis), real_(basis.size()), r_(basis.size()), mu_(basis.size()) {}

  bool run() {
    const size_t n = basis_.size();
    for (size_t k = 0; k < n; ++k) {
      real_[k].assign(basis_[k].begin(), basis_[k].end());
      r_[k].assign(n, 0.0);
      mu_[k].assign(n, 0.0);
    }
    if (n > 0) orthogonalise(0);
    size_t steps = 400 * (n + 1) * (n + 1);
    for (size_t k = 1; k < n;) {
      if (steps-- == 0 || !reduce_size(k)) return false;
      const double needed = (kLovasz - mu_[k][k - 1] * mu_[k][k - 1]) * r_[k - 1][k - 1];
      if (r_[k][k] >= needed) {
        ++k;
        continue;
      }
      std::swap(basis_[k], basis_[k - 1]);
      std::swap(real_[k], real_[k - 1]);
      orthogonalise(k - 1);
      k = std::max<size_t>(k - 1, 1);
    }
    return true;
  }

 private:
  void orthogonalise(size_t k) {
    for (size_t j = 0; j <= k; ++j) {
      double value = dot(real_[k], real_[j]);
      for (size_t i = 0; i < j; ++i) value -= mu_[j][i] * r_[k][i];
      r_[k][j] = value;
      if (j < k) mu_[k][j] = value / r_[j][j];
    }
  }

  bool reduce_size(size_t k) {
    for (int pass = 0; pass < 64; ++pass) {
      orthogonalise(k);
      bool changed = false;
      for (size_t j = k; j-- > 0;) {
        const double quotient = std::nearbyint(mu_[k][j]);
        if (!(std::fabs(quotient) < 0x1p50)) return false;
        if (quotient == 0.0 || std::fabs(mu_[k][j]) <= 0.51) continue;
        changed = true;
        for (size_t i = 0; i <= j; ++i) mu_[k][i] -= quotient * (i == j ? 1.0 : mu_[j][i]);
        for (size_t i = 0; i < basis_[k].size(); ++i) {
          Wide entry = basis_[k][i];
          if (!add_product(entry, -static_cast<Wide>(quotient), basis_[j][i])) return false;
          if (entry > (Wide{1} << 52) || entry < -(Wide{1} << 52)) return false;
          basis_[k][i] = static_cast<long>(entry);
          real_[k][i] = static_cast<double>(entry);
        }
      }
      if (!changed) return true;
    }
    return false;
  }

  Words& basis_;
  std::vector<std::vector<double>> real_, r_, mu_;
};

// column -= quotient other
void subtract(std::vector<Integer>& column, const Integer& quotient,
              const std::vector<Integer>& other) {
  const Integer minus = -quotient;
  for (size_t i = 0; i < column.size(); ++i) column[i].add_product(minus, other[i]);
}

Integer product_of_row(const IntegerMatrix& a, int i, const std::vector<Integer>& column) {
  Integer sum;
  for (int j = 0; j < a.columns(); ++j)
    if (!a.at(i, j).is_zero()) sum.add_product(a.at(i, j), column[static_cast<size_t>(j)]);
  return sum;
}

// Combines the free columns so that one of them has the gcd of the row's products and the others
// zero; takes that one out and returns it. Those of the others that took part are reduced.
std::vector<Integer> take_pivot(const IntegerMatrix& a, int row, IntegerVectors& free) {
  std::vector<Integer> products;
  for (const auto& column : free) products.push_back(product_of_row(a, row, column));
  std::vector<char> touched;
  for (const Integer& product : products) touched.push_back(!product.is_zero());
  for (;;) {
    size_t pivot = free.size(), others = 0;
    for (size_t c = 0; c < free.size(); ++c) {
      if (products[c].is_zero()) continue;
      ++others;
      if (pivot == free.size() || products[c].abs() < products[pivot].abs()) pivot = c;
    }
    ISOCHOR_REQUIRE(pivot < free.size(), "rows are dependent", row);
    if (others == 1) {
      std::vector<Integer> result = std::move(free[pivot]);
      if (products[pivot].sign() < 0)
        for (Integer& entry : result) entry = -entry;
      IntegerVectors part;
      for (size_t c = 0; c < free.size(); ++c)
        if (touched[c] && c != pivot) part.push_back(std::move(free[c]));
      reduce_basis(part);
      for (size_t c = 0, next = 0; c < free.size(); ++c)
        if (touched[c] && c != pivot) free[c] = std::move(part[next++]);
      free.erase(free.begin() + static_cast<std::ptrdiff_t>(pivot));
      return result;
    }
    for (size_t c = 0; c < free.size(); ++c) {
      if (c == pivot || products[c].is_zero()) continue;
      const Integer quotient = products[c].divided_nearest(products[pivot]);
      subtract(free[c], quotient, free[pivot]);
      products[c].add_product(-quotient, products[pivot]);
    }
  }
}

}  // namespace

void reduce_basis(IntegerVectors& basis) {
  if (basis.empty()) return;
  unsigned long bits = 0;
  for (const auto& vector : basis)
    for (const Integer& entry : vector) bits = std::max(bits, entry.bits());
  Words words;
  if (bits <= kFastBits && to_words(basis, words) && FastReduction(words).run()) {
    for (size_t k = 0; k < basis.size(); ++k) basis[k].assign(words[k].begin(), words[k].end());
    return;
  }
  const int rows = static_cast<int>(basis.size()), columns = static_cast<int>(basis[0].size());
  IntegerMatrix matrix(rows, columns);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j)
      matrix.set(i, j, basis[static_cast<size_t>(i)][static_cast<size_t>(j)]);
  const IntegerMatrix reduced = matrix.lll_reduced();
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j)
      basis[static_cast<size_t>(i)][static_cast<size_t>(j)] = reduced.at(i, j);
}

NearestPlane::NearestPlane(const IntegerVectors& basis) {
  ISOCHOR_REQUIRE(to_words(basis, basis_), "basis beyond 64 bits");
  for (const auto& vector : basis_) {
    std::vector<double> rest(vector.begin(), vector.end());
    for (int pass = 0; pass < 2; ++pass) {  // twice: orthogonal to rounding
      for (size_t i = 0; i < absolute_.size(); ++i) {
        const double share = dot(rest, orthogonal_[i]);
        for (size_t j = 0; j < rest.size(); ++j) rest[j] -= share * absolute_[i][j];
      }
    }
    const double square = dot(rest, rest);
    absolute_.push_back(rest);
    for (double& entry : rest) entry /= square;
    orthogonal_.push_back(std::move(rest));
  }
}

std::vector<double> NearestPlane::bound() const {
  std::vector<double> result(basis_.empty() ? 0 : basis_[0].size());
  for (const auto& vector : absolute_)
    for (size_t j = 0; j < result.size(); ++j) result[j] += std::fabs(vector[j]) / 2;
  for (double& entry : result) entry *= kRoundingRoom;
  return result;
}

bool NearestPlane::round(const std::vector<double>& target, std::vector<Wide>& x) const {
  std::vector<double> rest(x.size());
  for (int pass = 0; pass < kRoundingPasses; ++pass) {
    for (size_t j = 0; j < x.size(); ++j) rest[j] = target[j] - static_cast<double>(x[j]);
    bool changed = false;
    for (size_t i = basis_.size(); i-- > 0;) {
      const double share = dot(rest, orthogonal_[i]);
      const double steps = std::nearbyint(share);
      if (!(std::fabs(steps) < 0x1p100)) return false;
      if (steps == 0.0 || std::fabs(share) <= 0.5 * kRoundingRoom) continue;
      changed = true;
      for (size_t j = 0; j < x.size(); ++j) {
        rest[j] -= steps * static_cast<double>(basis_[i][j]);
        if (!add_product(x[j], static_cast<Wide>(steps), basis_[i][j])) return false;
      }
    }
    if (!changed) return true;
  }
  return true;
}

void NearestPlane::shorten(std::vector<Integer>& x) const {
  unsigned long before = std::numeric_limits<unsigned long>::max();
  for (;;) {
    unsigned long bits = 0;
    for (const Integer& entry : x) bits = std::max(bits, entry.bits());
    if (bits >= before) return;
    before = bits;
    const unsigned long shift = bits > 60 ? bits - 60 : 0;  // the leading digits choose
    const Integer scale = Integer(1).shifted(shift);
    std::vector<double> rest;
    for (const Integer& entry : x) rest.push_back(entry.divided_floor(scale).to_double());
    for (size_t i = basis_.size(); i-- > 0;) {
      const double steps = std::nearbyint(dot(rest, orthogonal_[i]));
      if (steps == 0.0 || !(std::fabs(steps) < 0x1p62)) continue;
      const Integer factor = Integer(-static_cast<long>(steps)).shifted(shift);
      for (size_t j = 0; j < x.size(); ++j) {
        rest[j] -= steps * static_cast<double>(basis_[i][j]);
        x[j].add_product(factor, basis_[i][j]);
      }
    }
  }
}

SolutionLattice::SolutionLattice(const IntegerMatrix& a, const std::vector<Integer>& multipliers)
    : columns_(a.columns()) {
  ISOCHOR_REQUIRE(multipliers.size() == static_cast<size_t>(columns_), multipliers.size());
  const auto n = static_cast<size_t>(columns_);
  kernel_.assign(n, std::vector<Integer>(n));
  for (size_t j = 0; j < n; ++j) {
    ISOCHOR_REQUIRE(multipliers[j].sign() > 0, multipliers[j].to_string());
    kernel_[j][j] = multipliers[j];
  }
  for (int i = 0; i < a.rows(); ++i) {
    std::vector<Integer> pivot = take_pivot(a, i, kernel_);
    const Integer diagonal = product_of_row(a, i, pivot);
    hermite_.emplace_back();
    for (auto& earlier : particular_) {
      const Integer entry = product_of_row(a, i, earlier);
      const Integer quotient = entry.divided_floor(diagonal);
      if (!quotient.is_zero()) subtract(earlier, quotient, pivot);
      hermite_.back().push_back(entry - quotient * diagonal);
    }
    hermite_.back().push_back(diagonal);
    particular_.push_back(std::move(pivot));
  }
  reduce_basis(kernel_);
  Words kernel_words;
  fits_ = to_words(kernel_, kernel_words) && to_words(hermite_, hermite_words_);
  if (!fits_) return;
  rounding_ = NearestPlane(kernel_);
  for (auto& vector : particular_) rounding_.shorten(vector);
  fits_ = to_words(particular_, particular_words_);
}

Integer SolutionLattice::index() const {
  Integer product = 1;
  for (const auto& row : hermite_) product *= row.back();
  return product;
}

std::optional<LatticeObstacle> SolutionLattice::obstacle(const std::vector<Integer>& s) const {
  const size_t m = hermite_.size();
  ISOCHOR_REQUIRE(s.size() == m, s.size(), m);
  std::vector<Integer> w(m);
  for (size_t i = 0; i < m; ++i) {
    Integer rest = s[i];
    for (size_t k = 0; k < i; ++k) rest.add_product(-hermite_[i][k], w[k]);
    if (rest.is_multiple_of(hermite_[i][i])) {
      w[i] = rest.divided_exactly(hermite_[i][i]);
      continue;
    }
    LatticeObstacle result{std::vector<Rational>(m), Rational(rest, hermite_[i][i])};
    // Row i of H^-1: y H = e_i, from the right.
    for (size_t k = i + 1; k-- > 0;) {
      Rational value = k == i ? Rational(1) : Rational(0);
      for (size_t l = k + 1; l <= i; ++l) value -= result.multipliers[l] * Rational(hermite_[l][k]);
      result.multipliers[k] = value / Rational(hermite_[k][k]);
    }
    return result;
  }
  return std::nullopt;
}

bool SolutionLattice::nearest(const std::vector<Wide>& s, const std::vector<double>& target,
                              std::vector<Wide>& x) const {
  ISOCHOR_REQUIRE(fits_);
  x.assign(static_cast<size_t>(columns_), 0);
  std::vector<Wide> w(s.size());
  for (size_t i = 0; i < s.size(); ++i) {
    Wide rest = s[i];
    for (size_t k = 0; k < i; ++k)
      if (!add_product(rest, -w[k], hermite_words_[i][k])) return false;
    if (rest % hermite_words_[i][i] != 0) return false;
    w[i] = rest / hermite_words_[i][i];
    for (size_t j = 0; j < x.size() && w[i] != 0; ++j)
      if (!add_product(x[j], w[i], particular_words_[i][j])) return false;
  }
  return rounding_.round(target, x);
}

}  // namespace isochor::internal
