// Random constraint systems of every kind that verdicts can go wrong on, and verdicts by plain
// elimination over the rationals, to compare with.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "isochor/ecles/analysis.h"
#include "isochor/ecles/prime_field.h"

namespace isochor::testing {

using RationalRow = std::vector<Rational>;

// Rows in echelon form, one after another.
class RationalEchelon {
 public:
  // Whether the row is independent of those before it; only then it is kept.
  bool insert(RationalRow row) {
    for (const auto& [pivot, reduced] : rows_) {
      if (row[pivot].is_zero()) continue;
      const Rational factor = row[pivot];
      for (size_t j = 0; j < row.size(); ++j) row[j] -= factor * reduced[j];
    }
    const auto pivot =
        std::find_if(row.begin(), row.end(), [](const Rational& a) { return !a.is_zero(); });
    if (pivot == row.end()) return false;
    const Rational scale = Rational(1) / *pivot;
    for (Rational& a : row) a *= scale;
    const auto place = static_cast<size_t>(pivot - row.begin());
    rows_.emplace_back(place, std::move(row));
    return true;
  }
  int rank() const { return static_cast<int>(rows_.size()); }

 private:
  std::vector<std::pair<size_t, RationalRow>> rows_;
};

// The stored row i at the given parameters.
inline RationalRow restricted(const ConstraintMatrix& matrix, int i,
                              const std::vector<int>& parameters) {
  RationalRow row(parameters.size());
  for (const ConstraintTerm& term : matrix.row(i)) {
    for (size_t j = 0; j < parameters.size(); ++j) {
      if (parameters[j] == term.parameter) row[j] = Rational(term.coefficient);
    }
  }
  return row;
}

inline int rational_rank(const ConstraintMatrix& matrix, const std::vector<int>& rows,
                         const std::vector<int>& parameters) {
  RationalEchelon echelon;
  for (const int i : rows) echelon.insert(restricted(matrix, i, parameters));
  return echelon.rank();
}

// The first basis in the order of precedence, ascending by index.
inline std::vector<int> first_basis(const ConstraintMatrix& matrix, std::vector<int> rows,
                                    const std::vector<int>& derived,
                                    const std::vector<int>& precedence) {
  std::stable_sort(rows.begin(), rows.end(), [&](int a, int b) {
    return !precedence.empty() &&
           precedence[static_cast<size_t>(a)] < precedence[static_cast<size_t>(b)];
  });
  RationalEchelon echelon;
  std::vector<int> basis;
  for (const int i : rows) {
    if (echelon.insert(restricted(matrix, i, derived))) basis.push_back(i);
  }
  std::sort(basis.begin(), basis.end());
  return basis;
}

enum class SystemKind {
  kDense,
  kSparse,
  kLowRank,    // dependent rows are combinations of all others, some moved by a multiple of primes
  kLastPlace,  // by one unit in the last place of a double
  kModulus,    // coefficients are multiples of the primes that eliminations use
  kHuge,       // and tiny
  kRepeated,
  kHeavy  // a few long rows over many short ones
};
constexpr int kSystemKinds = 8;

struct RandomSystem {
  int parameters = 0;
  std::vector<RationalTerms> rows;
  Selection selection;
  std::vector<int> precedence;  // may be empty
  RationalRow solution;         // a point to make right-hand sides from
};

class SystemGenerator {
 public:
  explicit SystemGenerator(unsigned seed) : random_(seed) {}

  int number(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }

  RandomSystem next(SystemKind kind, int largest) {
    const bool heavy = kind == SystemKind::kHeavy;
    const int m = heavy ? number(10, 24) : number(0, largest);
    const int n = heavy ? number(30, 50) : number(0, largest);
    RandomSystem system;
    system.parameters = n;
    std::vector<RationalRow> dense(static_cast<size_t>(m), RationalRow(static_cast<size_t>(n)));
    for (RationalRow& row : dense) {
      const int others = heavy && number(0, 5) != 0 ? number(15, 40) : 0;
      for (Rational& a : row) a = number(0, others) < 2 ? entry(kind) : Rational(0);
    }
    make_dependent(kind, dense);
    for (const RationalRow& row : dense) {
      system.rows.emplace_back();
      for (int j = 0; j < n; ++j) {
        system.rows.back().emplace_back(j, row[static_cast<size_t>(j)]);
      }
    }
    std::shuffle(system.rows.begin(), system.rows.end(), random_);
    select(system);
    for (int j = 0; j < n; ++j) system.solution.push_back(Rational(number(-99, 99)));
    return system;
  }

 private:
  Rational entry(SystemKind kind) {
    switch (kind) {
      case SystemKind::kSparse:
      case SystemKind::kRepeated:
        return Rational(number(0, 3) == 0 ? number(-9, 9) : 0);
      case SystemKind::kLastPlace:  // sums and differences of a few are doubles
        return Rational(std::ldexp(number(1 << 20, (1 << 30) - 1), 18) + number(0, 1 << 18))
            .scaled_by_power_of_two(-40);
      case SystemKind::kModulus:
        return number(0, 1) == 0 ? Rational(number(-2, 2)) : Rational(number(-2, 2)) * modulus();
      case SystemKind::kHuge:
        return Rational(number(-999, 999)).scaled_by_power_of_two(number(-300, 300));
      default:
        return Rational(number(-99, 99));
    }
  }

  Rational modulus() {
    Integer product(1);
    for (int k = number(0, 2); k >= 0; --k) {
      product *= Integer(static_cast<long>(internal::elimination_prime(number(0, 2))));
    }
    return Rational(product);
  }

  // Some rows become combinations of others, some of those are then moved by very little.
  void make_dependent(SystemKind kind, std::vector<RationalRow>& rows) {
    const int m = static_cast<int>(rows.size());
    if (m < 2) return;
    const int basis = number(1, m);
    for (int i = basis; i < m; ++i) {
      RationalRow& row = rows[static_cast<size_t>(i)];
      for (Rational& a : row) a = Rational(0);
      const bool low_rank = kind == SystemKind::kLowRank;
      const int terms = kind == SystemKind::kRepeated ? 1 : number(1, std::min(basis, 3));
      for (int k = 0; k < (low_rank ? basis : terms); ++k) {
        const RationalRow& other = rows[static_cast<size_t>(low_rank ? k : number(0, basis - 1))];
        const Rational factor(low_rank ? number(1, 9) : (number(0, 1) == 0 ? 1 : -1));
        for (size_t j = 0; j < row.size(); ++j) row[j] += factor * other[j];
      }
      if (!row.empty() && number(0, 2) == 0) disturb(kind, row);
    }
  }

  void disturb(SystemKind kind, RationalRow& row) {
    Rational& a = row[static_cast<size_t>(number(0, static_cast<int>(row.size()) - 1))];
    if (kind == SystemKind::kLastPlace) {
      a = Rational(std::nextafter(a.to_double(), 1e300));
    } else if (kind == SystemKind::kModulus || kind == SystemKind::kLowRank) {
      a += modulus();
    } else {
      a += Rational(1);
    }
  }

  void select(RandomSystem& system) {
    const int anchors = number(0, 3);
    for (int j = 0; j < system.parameters; ++j) {
      const int choice = number(0, 9);
      if (choice < anchors) system.selection.anchors.push_back(j);
      if (choice >= 4) system.selection.derived.push_back(j);
    }
    std::shuffle(system.selection.derived.begin(), system.selection.derived.end(), random_);
    if (number(0, 1) == 0) return;
    for (size_t i = 0; i < system.rows.size(); ++i) system.precedence.push_back(number(0, 5));
  }

  std::mt19937 random_;
};

}  // namespace isochor::testing
