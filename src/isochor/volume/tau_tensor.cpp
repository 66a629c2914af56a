#include "isochor/volume/tau_tensor.h"

#include <array>

#include "isochor/base/double_double.h"
#include "isochor/volume/gauss.h"
#include "isochor/volume/span_table.h"

namespace isochor {
namespace {

// A Gauss rule on [0, 1]: the nodes, their distances from 1, and the weights.
template <typename Number>
struct Rule {
  std::vector<Number> nodes, from_end, weights;
};

// P_n(1 - y) and its derivative with respect to y by the recursion on differences P_k - P_{k-1},
// which loses nothing for small y: (k + 1)(P_{k+1} - P_k) = k (P_k - P_{k-1}) - (2k + 1) y P_k.
template <typename Number>
std::array<Number, 2> legendre(int n, const Number& y) {
  Number p(1.0), difference(0.0), slope(0.0), slope_difference(0.0);
  for (int k = 0; k < n; ++k) {
    const Number factor(2.0 * k + 1.0), order(static_cast<double>(k)), next(k + 1.0);
    slope_difference = (order * slope_difference - factor * (p + y * slope)) / next;
    difference = (order * difference - factor * y * p) / next;
    slope += slope_difference;
    p += difference;
  }
  return {p, slope};
}

// Newton's steps double the digits of the rule in double.
template <typename Number>
Rule<Number> gauss_rule(int count) {
  const GaussRule start = gauss_legendre(count);
  Rule<Number> rule;
  for (size_t i = 0; i < start.nodes.size(); ++i) {
    // On [-1, 1] the node nearest to the same end has distance y from it.
    const bool left = start.nodes[i] <= 0.5;
    Number y(2.0 * (left ? start.nodes[i] : start.from_end[i]));
    if (2 * i + 1 == start.nodes.size()) {
      y = Number(1.0);
    } else {
      for (int step = 0; step < 2; ++step) {
        const auto [value, slope] = legendre(count, y);
        y -= value / slope;
      }
    }
    const Number slope = legendre(count, y)[1];
    const Number near = Number(0.5) * y;
    const Number far = Number(1.0) - near;
    rule.nodes.push_back(left ? near : far);
    rule.from_end.push_back(left ? far : near);
    rule.weights.push_back(Number(1.0) / (y * (Number(2.0) - y) * slope * slope));
  }
  return rule;
}

template <>
Rule<double> gauss_rule(int count) {
  GaussRule rule = gauss_legendre(count);
  return {std::move(rule.nodes), std::move(rule.from_end), std::move(rule.weights)};
}

// The difference of two knots; exact but for the rounding of Number.
template <typename Number>
Number distance(double from, double to) {
  return Number(to) - Number(from);
}

// B_{span-d} .. B_span and b_{span-d} .. b_{span-1} at one place of a knot span.
template <typename Number>
struct Basis {
  std::array<Number, kMaxDegree + 1> values;
  std::array<Number, kMaxDegree + 1> slopes;
};

// By the recursion of Cox and de Boor on distances to knots, sums of non-negative terms only. The
// shares N / (t_right - t_left) of its last step, times d, are the b_j.
template <typename Number>
Basis<Number> basis_at(const KnotVector& knots, int span, const Number& behind,
                       const Number& ahead) {
  const int d = knots.degree();
  Basis<Number> basis;
  basis.values[0] = Number(1.0);
  for (int p = 1; p <= d; ++p) {
    Number carried(0.0);
    for (int j = 0; j < p; ++j) {
      const auto ji = static_cast<size_t>(j);
      const double left = knots[span - p + 1 + j];
      const double right = knots[span + 1 + j];
      const Number share = basis.values[ji] / distance<Number>(left, right);
      if (p == d) basis.slopes[ji] = Number(static_cast<double>(d)) * share;
      basis.values[ji] = carried + (distance<Number>(knots[span + 1], right) + ahead) * share;
      carried = (distance<Number>(left, knots[span]) + behind) * share;
    }
    basis.values[static_cast<size_t>(p)] = carried;
  }
  return basis;
}

}  // namespace

template <typename Number>
BasicTauTensor<Number>::BasicTauTensor(const KnotVector& knots)
    : degree_(knots.degree()),
      size_(knots.size()),
      band_(static_cast<size_t>(size_) * 2 * degree_ * (2 * degree_ + 1), Number(0.0)) {
  const Rule<Number> rule = gauss_rule<Number>(exact_gauss_points(degree_));
  for (int span : knots.spans()) {
    const Number width = distance<Number>(knots[span], knots[span + 1]);
    const auto first = static_cast<size_t>(span - degree_);
    for (size_t g = 0; g < rule.nodes.size(); ++g) {
      const Basis<Number> basis =
          basis_at<Number>(knots, span, width * rule.nodes[g], width * rule.from_end[g]);
      const Number weight = width * rule.weights[g];
      for (int c = 0; c < degree_; ++c) {
        const Number factor = weight * basis.slopes[static_cast<size_t>(c)];
        for (int a = 0; a <= degree_; ++a) {
          for (int b = 0; b <= degree_; ++b) {
            // The product of the two values first: then law (1) holds bit by bit.
            band_[at(b - a + degree_, c - a + degree_) + first + static_cast<size_t>(a)] +=
                factor *
                (basis.values[static_cast<size_t>(a)] * basis.values[static_cast<size_t>(b)]);
          }
        }
      }
    }
  }
}

template class BasicTauTensor<double>;
template class BasicTauTensor<DoubleDouble>;

}  // namespace isochor
