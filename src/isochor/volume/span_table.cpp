#include "isochor/volume/span_table.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "isochor/base/error.h"

namespace isochor {
namespace {

std::vector<SpanCells> whole_spans(const KnotVector& knots, int gauss_points) {
  return std::vector<SpanCells>(knots.spans().size(), {{0.0, 1.0, gauss_points}});
}

void require_cover(const SpanCells& cells) {
  double reached = 0.0;
  for (const Cell& cell : cells) {
    ISOCHOR_REQUIRE(cell.begin == reached && cell.begin < cell.end, cell.begin, cell.end, reached);
    reached = cell.end;
  }
  ISOCHOR_REQUIRE(reached == 1.0, reached);
}

}  // namespace

SpanTable::SpanTable(KnotVector knots, int gauss_points)
    : SpanTable(knots, whole_spans(knots, gauss_points)) {}

SpanTable::SpanTable(KnotVector knots, std::vector<SpanCells> cells)
    : knots_(std::move(knots)), cells_(std::move(cells)) {
  ISOCHOR_REQUIRE(cells_.size() == knots_.spans().size(), cells_.size(), knots_.spans().size());
  start_.push_back(0);
  for (const SpanCells& span : cells_) {
    require_cover(span);
    size_t count = 0;
    for (const Cell& cell : span) count += static_cast<size_t>(cell.gauss_points);
    start_.push_back(start_.back() + count);
    most_points_ = std::max(most_points_, static_cast<int>(count));
  }
  const size_t count = start_.back() * static_cast<size_t>(degree() + 1);
  weights_.resize(start_.back());
  values_.resize(count);
  slopes_.resize(count);
  slope_sizes_.resize(count);
  steps_.resize(start_.back() * static_cast<size_t>(degree()));
  std::map<int, LongGaussRule> rules;
  for (int s = 0; s < spans(); ++s) {
    size_t offset = 0;
    for (const Cell& cell : cells_[static_cast<size_t>(s)]) {
      LongGaussRule& rule = rules[cell.gauss_points];
      if (rule.nodes.empty()) rule = long_gauss_legendre(cell.gauss_points);
      tabulate(s, cell, rule, offset);
      offset += static_cast<size_t>(cell.gauss_points);
    }
  }
}

void SpanTable::tabulate(int s, const Cell& cell, const LongGaussRule& rule, size_t offset) {
  const int d = degree();
  const int span = knots_.spans()[static_cast<size_t>(s)];
  const long double begin = knots_[span];
  const long double end = knots_[span + 1];
  const long double width = end - begin;
  const long double share_of_span = cell.end - cell.begin;
  for (size_t k = 0; k < rule.nodes.size(); ++k) {
    const size_t gi = offset + k;
    weights_[start_[static_cast<size_t>(s)] + gi] =
        static_cast<double>(rule.weights[k] * share_of_span * width);
    // Cox-de Boor on distances to knots; each distance is a sum of two non-negative terms.
    const long double ahead = width * ((1.0L - cell.end) + share_of_span * rule.from_end[k]);
    const long double behind = width * (cell.begin + share_of_span * rule.nodes[k]);
    std::array<long double, kMaxDegree + 1> row{};
    row[0] = 1.0L;
    // slope[j + 1]: the positive terms of the derivative.
    std::array<long double, kMaxDegree + 2> slope{};
    for (int p = 1; p <= d; ++p) {
      long double carried = 0.0L;
      for (int j = 0; j < p; ++j) {
        const auto ji = static_cast<size_t>(j);
        const long double left = knots_[span - p + 1 + j];
        const long double right = knots_[span + 1 + j];
        const long double share = row[ji] / (right - left);
        if (p == d) slope[ji + 1] = d * share;
        row[ji] = carried + ((right - end) + ahead) * share;
        carried = ((begin - left) + behind) * share;
      }
      row[static_cast<size_t>(p)] = carried;
    }
    for (int j = 0; j <= d; ++j) {
      // slope[j] belongs to the function that B_j shares with its left neighbour.
      const auto ji = static_cast<size_t>(j);
      values_[at(s, j) + gi] = static_cast<double>(row[ji]);
      const long double right_term = j < d ? slope[ji + 1] : 0.0L;
      slopes_[at(s, j) + gi] = static_cast<double>(slope[ji] - right_term);
      slope_sizes_[at(s, j) + gi] = static_cast<double>(slope[ji] + right_term);
      if (j < d) steps_[step_at(s, j) + gi] = static_cast<double>(right_term);
    }
  }
}

}  // namespace isochor
