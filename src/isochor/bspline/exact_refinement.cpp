#include "isochor/bspline/exact_refinement.h"

#include <algorithm>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/bspline/refinement.h"

namespace isochor {
namespace {

std::vector<Rational> exact_knots(const std::vector<double>& knots) {
  std::vector<Rational> exact;
  exact.reserve(knots.size());
  for (double t : knots) exact.emplace_back(t);
  return exact;
}

ExactMapRow unit_row(int column) { return {column, {Rational(1)}}; }

// Oslo: the functions of span `mu`, blossomed at x[1] .. x[d]. Functions beyond the first and last
// knots only feed each other and are left out.
ExactMapRow oslo_row(const std::vector<Rational>& t, int d, int mu, const Rational* x) {
  const int last = static_cast<int>(t.size()) - 1;
  std::vector<Rational> current(static_cast<size_t>(d) + 1);
  current[0] = Rational(1);
  for (int p = 1; p <= d; ++p) {
    Rational carried;
    for (int j = 0; j < p; ++j) {
      const int left = mu - p + 1 + j;
      const int right = mu + 1 + j;
      Rational& value = current[static_cast<size_t>(j)];
      if (left < 0 || right > last || value.is_zero()) {
        value = std::exchange(carried, Rational());
        continue;
      }
      const Rational& low = t[static_cast<size_t>(left)];
      const Rational share = (x[p] - low) / (t[static_cast<size_t>(right)] - low);
      Rational moved = value * share;
      value = carried + (value - moved);
      carried = std::move(moved);
    }
    current[static_cast<size_t>(p)] = std::move(carried);
  }
  int low = std::max(0, d - mu);
  int high = std::min(d, last - d - 1 - mu + d);
  while (low < high && current[static_cast<size_t>(low)].is_zero()) ++low;
  while (low < high && current[static_cast<size_t>(high)].is_zero()) --high;
  return {mu - d + low, std::vector<Rational>(current.begin() + low, current.begin() + high + 1)};
}

int knot_index(const std::vector<Rational>& t, const Rational& x) {
  return static_cast<int>(std::upper_bound(t.begin(), t.end(), x) - t.begin()) - 1;
}

// The knots of one period, from begin() on, and where its first copy stands in the vector.
struct Period {
  std::vector<Rational> knots;
  Rational length;
  int origin = 0;

  Rational at(int i) const {
    const int count = static_cast<int>(knots.size());
    int turn = (i - origin) / count;
    int rest = (i - origin) % count;
    if (rest < 0) {
      rest += count;
      --turn;
    }
    return knots[static_cast<size_t>(rest)] + Rational(turn) * length;
  }
};

Period period_of(const KnotVector& knots) {
  Period period;
  period.length = Rational(knots.end()) - Rational(knots.begin());
  for (double t : knots.knots()) {
    if (t < knots.begin()) ++period.origin;
    if (knots.begin() <= t && t < knots.end()) period.knots.emplace_back(t);
  }
  return period;
}

}  // namespace

ExactMap exact_insertion_map(const KnotVector& coarse, const KnotVector& fine) {
  ISOCHOR_REQUIRE(fine == with_knots(coarse, inserted_knots(coarse, fine)),
                  "knots outside the domain differ between the two vectors");
  ExactMap rows;
  if (coarse == fine) {
    for (int i = 0; i < fine.size(); ++i) rows.push_back(unit_row(i));
    return rows;
  }
  const std::vector<Rational> t = exact_knots(coarse.knots());
  const std::vector<Rational> s = exact_knots(fine.knots());
  for (int i = 0; i < fine.size(); ++i) {
    const auto at = static_cast<size_t>(i);
    rows.push_back(oslo_row(t, coarse.degree(), knot_index(t, s[at]), &s[at]));
  }
  return rows;
}

ExactMap exact_wrapped_insertion_map(const KnotVector& coarse, const KnotVector& fine) {
  (void)inserted_knots(coarse, fine);  // `fine` must contain `coarse`
  ISOCHOR_REQUIRE(wrapped_poles(coarse) > 0 && wrapped_poles(coarse) == wrapped_poles(fine),
                  wrapped_poles(coarse), wrapped_poles(fine));
  ExactMap rows;
  const int d = coarse.degree();
  const Period few = period_of(coarse);
  Period many = period_of(fine);
  many.origin = few.origin;
  const int period = static_cast<int>(few.knots.size());
  const int margin = (d / period + 2) * period;
  std::vector<Rational> extended;
  for (int i = -margin; i < coarse.size() + d + 1 + margin; ++i) extended.push_back(few.at(i));
  std::vector<Rational> arguments(static_cast<size_t>(d) + 1);
  for (int i = 0; i < fine.size(); ++i) {
    if (rows.size() >= many.knots.size()) {
      rows.push_back(rows[rows.size() - many.knots.size()]);
      continue;
    }
    for (int k = 0; k <= d; ++k) arguments[static_cast<size_t>(k)] = many.at(i + k);
    const int mu = knot_index(extended, arguments[0]);
    ExactMapRow row = oslo_row(extended, d, mu, arguments.data());
    // Shift by whole periods until the span lies in the domain; its d + 1 functions then exist.
    int inside = mu - margin;
    while (inside < d) inside += period;
    while (inside >= d + period) inside -= period;
    row.first += inside - mu;
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<Rational> exact_derivatives(const KnotVector& knots, int span, double t, int r) {
  const int d = knots.degree();
  ISOCHOR_REQUIRE(d <= span && span < knots.size() && knots[span] < knots[span + 1], span);
  ISOCHOR_REQUIRE(0 <= r, r);
  const auto count = static_cast<size_t>(d) + 1;
  if (r > d) return std::vector<Rational>(count);
  const Rational x(t);
  // The functions of degree d - r at x, by their values on the span.
  std::vector<Rational> values = {Rational(1)};
  const auto width = [&](int left, int right) {
    return Rational(knots[right]) - Rational(knots[left]);
  };
  for (int p = 1; p <= d; ++p) {
    // values[k]: function span - p + 1 + k of degree p - 1.
    std::vector<Rational> next(static_cast<size_t>(p) + 1);
    for (int k = 0; k < p; ++k) {
      const int i = span - p + 1 + k;
      const Rational share = values[static_cast<size_t>(k)] / width(i, i + p);
      // Function i of degree p - 1 feeds function i with rising and function i - 1 with falling
      // factors; in the last r steps derivatives of those factors take their place.
      const bool derive = p > d - r;
      const Rational rising = derive ? Rational(p) : x - Rational(knots[i]);
      const Rational falling = derive ? Rational(-p) : Rational(knots[i + p]) - x;
      next[static_cast<size_t>(k) + 1] += share * rising;
      next[static_cast<size_t>(k)] += share * falling;
    }
    values = std::move(next);
  }
  return values;
}

}  // namespace isochor
