// Splines in exact rational arithmetic: the reference that double precision is compared with.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "isochor/base/tolerance.h"
#include "isochor/bspline/knots.h"
#include "isochor/exact/rational.h"

namespace isochor::testing {

// |computed - exact| in unit roundoffs of `size`.
inline double roundoffs(double computed, const Rational& exact, const Rational& size) {
  const Rational error = (Rational(computed) - exact).abs();
  if (error.is_zero()) return 0.0;
  return (error / size).to_double() / kUnitRoundoff;
}

// The derivative of order r of the functions B_{span-d} .. B_{span} at u, on the polynomials of the
// span, by the recursion of Cox and de Boor with 0/0 = 0. `sizes`: all terms added up by their
// absolute values, which is what rounding errors are relative to.
inline std::vector<Rational> exact_basis(const KnotVector& knots, int span, const Rational& u,
                                         int r = 0, bool sizes = false) {
  const int d = knots.degree();
  const auto knot = [&](int i) { return Rational(knots[i]); };
  const auto term = [&](const Rational& x) { return sizes ? x.abs() : x; };
  // current[q][k]: derivative q of the function span - d + k of degree p.
  const auto width = static_cast<size_t>(d) + 2;
  std::vector<std::vector<Rational>> current(static_cast<size_t>(r) + 1,
                                             std::vector<Rational>(width));
  current[0][static_cast<size_t>(d)] = Rational(1);
  for (int p = 1; p <= d; ++p) {
    std::vector<std::vector<Rational>> next(current.size(), std::vector<Rational>(width));
    for (int i = span - p; i <= span; ++i) {
      const auto k = static_cast<size_t>(i - span + d);
      const Rational left = knot(i + p) - knot(i);
      const Rational right = knot(i + p + 1) - knot(i + 1);
      for (size_t q = 0; q < current.size(); ++q) {
        if (!left.is_zero()) {
          next[q][k] += q == 0 ? term((u - knot(i)) / left * current[0][k])
                               : term(Rational(p) * current[q - 1][k] / left);
        }
        if (!right.is_zero()) {
          next[q][k] += q == 0 ? term((knot(i + p + 1) - u) / right * current[0][k + 1])
                               : term(Rational(-p) * current[q - 1][k + 1] / right);
        }
      }
    }
    current = std::move(next);
  }
  current.back().pop_back();
  return current.back();
}

// Row i of an exact insertion map: one share for every coarse function.
using ExactRow = std::vector<Rational>;

// The insertion map by Boehm's formula, one knot after the other.
inline std::vector<ExactRow> exact_insertion(const KnotVector& coarse,
                                             const std::vector<double>& inserted) {
  const auto n = static_cast<size_t>(coarse.size());
  std::vector<ExactRow> rows(n, ExactRow(n));
  for (size_t i = 0; i < n; ++i) rows[i][i] = Rational(1);
  std::vector<double> knots = coarse.knots();
  const auto d = static_cast<size_t>(coarse.degree());
  for (double x : inserted) {
    const auto above = std::upper_bound(knots.begin(), knots.end(), x);
    const auto k = static_cast<size_t>(above - knots.begin()) - 1;
    std::vector<ExactRow> next;
    for (size_t i = 0; i <= rows.size(); ++i) {
      if (i + d <= k) {
        next.push_back(rows[i]);
      } else if (i > k) {
        next.push_back(rows[i - 1]);
      } else {
        const Rational share =
            (Rational(x) - Rational(knots[i])) / (Rational(knots[i + d]) - Rational(knots[i]));
        ExactRow row(n);
        for (size_t j = 0; j < n; ++j) {
          row[j] = (Rational(1) - share) * rows[i - 1][j] + share * rows[i][j];
        }
        next.push_back(std::move(row));
      }
    }
    rows = std::move(next);
    knots.insert(knots.begin() + static_cast<long>(k) + 1, x);
  }
  return rows;
}

}  // namespace isochor::testing
