#include "isochor/volume/span_table.h"

#include <array>
#include <utility>

namespace isochor {

SpanTable::SpanTable(KnotVector knots, int gauss_points)
    : knots_(std::move(knots)), points_(gauss_points) {
  const GaussRule rule = gauss_legendre(gauss_points);
  const size_t per_span = static_cast<size_t>(gauss_points);
  const size_t count = static_cast<size_t>(spans()) * static_cast<size_t>(degree() + 1) * per_span;
  weights_.resize(static_cast<size_t>(spans()) * per_span);
  values_.resize(count);
  slopes_.resize(count);
  slope_sizes_.resize(count);
  for (int s = 0; s < spans(); ++s) tabulate(s, rule);
}

void SpanTable::tabulate(int s, const GaussRule& rule) {
  const int d = degree();
  const int span = knots_.spans()[static_cast<size_t>(s)];
  const double begin = knots_[span];
  const double end = knots_[span + 1];
  const double width = end - begin;
  for (int g = 0; g < points_; ++g) {
    const auto gi = static_cast<size_t>(g);
    weights_[static_cast<size_t>(s) * points_ + gi] = rule.weights[gi] * width;
    // Cox-de Boor on distances to knots; each distance is a sum of two non-negative terms.
    const double ahead = width * rule.from_end[gi];
    const double behind = width * rule.nodes[gi];
    std::array<double, kMaxDegree + 1> row{};
    row[0] = 1.0;
    std::array<double, kMaxDegree + 2> slope{};  // slope[j + 1] of the derivative's positive terms
    for (int p = 1; p <= d; ++p) {
      double carried = 0.0;
      for (int j = 0; j < p; ++j) {
        const auto ji = static_cast<size_t>(j);
        const double left = knots_[span - p + 1 + j];
        const double right = knots_[span + 1 + j];
        const double share = row[ji] / (right - left);
        if (p == d) slope[ji + 1] = d * share;
        row[ji] = carried + ((right - end) + ahead) * share;
        carried = ((begin - left) + behind) * share;
      }
      row[static_cast<size_t>(p)] = carried;
    }
    for (int j = 0; j <= d; ++j) {
      // slope[j] belongs to the function that B_j shares with its left neighbour.
      const auto ji = static_cast<size_t>(j);
      values_[at(s, j) + gi] = row[ji];
      const double right_term = j < d ? slope[ji + 1] : 0.0;
      slopes_[at(s, j) + gi] = slope[ji] - right_term;
      slope_sizes_[at(s, j) + gi] = slope[ji] + right_term;
    }
  }
}

}  // namespace isochor
