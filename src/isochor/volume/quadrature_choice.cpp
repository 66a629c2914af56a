#include "isochor/volume/quadrature_choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/volume/gauss_remainder.h"

namespace isochor::internal {
namespace {

static_assert(kMaxDepth <= kMaxHalvings);

// The cells of (a part of) a span, and what they miss on each net that crosses it.
struct Cut {
  SpanCells cells;
  std::vector<double> remainders;

  int points() const {
    int sum = 0;
    for (const Cell& cell : cells) sum += cell.gauss_points;
    return sum;
  }
};

Cut joined(Cut left, const Cut& right) {
  left.cells.insert(left.cells.end(), right.cells.begin(), right.cells.end());
  for (size_t k = 0; k < left.remainders.size(); ++k) left.remainders[k] += right.remainders[k];
  return left;
}

// The cheapest cut of [begin, end] of a span. `nets`: the weights over it, for each span across.
Cut cut_span(const std::vector<WeightNet>& nets, double begin, double end, int depth) {
  const int least = std::max(2, exact_gauss_points(nets[0].rows - 1));
  const int most = std::max(kMaxCellPoints, least);
  std::vector<GaussRemainder> remainders;
  int points = least;
  for (const WeightNet& net : nets) {
    remainders.emplace_back(net);
    points = std::max(points, remainders.back().points(kQuadratureShare, points, most));
  }
  const auto whole = [&](int count) {
    Cut cut;
    cut.cells = {{begin, end, count}};
    for (const GaussRemainder& each : remainders) cut.remainders.push_back(each.bound(count));
    return cut;
  };
  // Two halves need more than this together.
  if (points <= 2 * least + 6) return whole(points);
  if (depth == kMaxDepth) return whole(std::min(points, most));
  std::vector<WeightNet> left;
  std::vector<WeightNet> right;
  for (const WeightNet& net : nets) {
    auto [first, second] = halves(net);
    left.push_back(std::move(first));
    right.push_back(std::move(second));
  }
  const double middle = 0.5 * (begin + end);
  Cut cut =
      joined(cut_span(left, begin, middle, depth + 1), cut_span(right, middle, end, depth + 1));
  return points <= most && points <= cut.points() ? whole(points) : cut;
}

}  // namespace

std::shared_ptr<const SpanTable> TableCache::get(const KnotVector& knots, int gauss_points) {
  return get(knots, std::vector<SpanCells>(knots.spans().size(), {{0.0, 1.0, gauss_points}}));
}

std::shared_ptr<const SpanTable> TableCache::get(const KnotVector& knots,
                                                 const std::vector<SpanCells>& cells) {
  for (const auto& known : tables_) {
    if (known->cells() == cells && known->knots() == knots) return known;
  }
  tables_.push_back(std::make_shared<const SpanTable>(knots, cells));
  return tables_.back();
}

QuadratureChoice choose_quadrature(const KnotVector& u, const KnotVector& v,
                                   const std::vector<double>& weights) {
  const bool positive = std::all_of(weights.begin(), weights.end(),
                                    [](double w) { return w > 0.0 && std::isfinite(w); });
  ISOCHOR_REQUIRE(positive, weights.size());
  const size_t rows = u.spans().size();
  const size_t columns = v.spans().size();
  QuadratureChoice choice;
  choice.remainder.assign(rows * columns, 0.0);
  for (size_t su = 0; su < rows; ++su) {
    std::vector<WeightNet> nets;
    for (size_t sv = 0; sv < columns; ++sv) {
      nets.push_back(net_of(u, v, weights, static_cast<int>(su), static_cast<int>(sv)));
    }
    Cut cut = cut_span(nets, 0.0, 1.0, 0);
    choice.u.push_back(std::move(cut.cells));
    for (size_t sv = 0; sv < columns; ++sv) {
      choice.remainder[su * columns + sv] += cut.remainders[sv];
    }
  }
  for (size_t sv = 0; sv < columns; ++sv) {
    std::vector<WeightNet> nets;
    for (size_t su = 0; su < rows; ++su) {
      nets.push_back(transposed(net_of(u, v, weights, static_cast<int>(su), static_cast<int>(sv))));
    }
    Cut cut = cut_span(nets, 0.0, 1.0, 0);
    choice.v.push_back(std::move(cut.cells));
    for (size_t su = 0; su < rows; ++su) {
      choice.remainder[su * columns + sv] += cut.remainders[su];
    }
  }
  return choice;
}

void choose_rules(PatchForm& patch, TableCache& tables) {
  QuadratureChoice choice = choose_quadrature(patch.u->knots(), patch.v->knots(), patch.weights);
  patch.u = tables.get(patch.u->knots(), choice.u);
  patch.v = tables.get(patch.v->knots(), choice.v);
  patch.remainder = std::move(choice.remainder);
}

}  // namespace isochor::internal
