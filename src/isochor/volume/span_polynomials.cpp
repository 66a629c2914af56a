#include "isochor/volume/span_polynomials.h"

#include <utility>

#include "isochor/exact/rational.h"

namespace isochor::internal {
namespace {

using Polynomial = std::vector<Rational>;  // ascending powers of t

// target += (constant + slope t) p.
void add_linear_times(const Rational& constant, const Rational& slope, const Polynomial& p,
                      Polynomial& target) {
  for (size_t k = 0; k < p.size(); ++k) {
    target[k] += constant * p[k];
    if (k + 1 < target.size()) target[k + 1] += slope * p[k];
  }
}

}  // namespace

SpanPolynomials::SpanPolynomials(KnotVector knots) : knots_(std::move(knots)) {
  const int d = degree();
  const auto size = static_cast<size_t>(d) + 1;
  for (int span : knots_.spans()) {
    const Rational begin(knots_[span]);
    const Rational width = Rational(knots_[span + 1]) - begin;
    std::vector<Polynomial> row(1, Polynomial(1, Rational(1)));
    for (int p = 1; p <= d; ++p) {
      const auto terms = static_cast<size_t>(p) + 1;
      std::vector<Polynomial> next(terms, Polynomial(terms));
      for (int j = 0; j < p; ++j) {
        // Function j of degree p - 1 goes, with (right - u) / (right - left), to function j of
        // degree p and, with (u - left) / (right - left), to function j + 1; u = begin + width t.
        const Rational left(knots_[span - p + 1 + j]);
        const Rational right(knots_[span + 1 + j]);
        const Rational length = right - left;
        const Rational slope = width / length;
        const auto ji = static_cast<size_t>(j);
        add_linear_times((right - begin) / length, -slope, row[ji], next[ji]);
        add_linear_times((begin - left) / length, slope, row[ji], next[ji + 1]);
      }
      row = std::move(next);
    }
    Span entry;
    entry.denominator = 1;
    for (const Polynomial& polynomial : row) {
      for (const Rational& c : polynomial) {
        entry.denominator = lcm(entry.denominator, c.denominator());
      }
    }
    entry.coefficients.reserve(size * size);
    for (const Polynomial& polynomial : row) {
      for (const Rational& c : polynomial) {
        const Integer factor = entry.denominator.divided_exactly(c.denominator());
        entry.coefficients.push_back(c.numerator() * factor);
      }
    }
    spans_.push_back(std::move(entry));
  }
}

}  // namespace isochor::internal
