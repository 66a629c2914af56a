#include "isochor/bspline/common_rows.h"

#include <algorithm>
#include <map>
#include <utility>

#include "isochor/bspline/common_basis.h"

namespace isochor::internal {
namespace {

// The weights along a side; empty when they are all the same.
std::vector<Rational> weights_along(const PatchModel& model, const SideRef& ref) {
  const Patch& patch = model.patches[static_cast<size_t>(ref.patch)];
  std::vector<Rational> weights;
  bool constant = true;
  if (patch.weights.empty()) return weights;
  for (const auto& [i, j] : side_indices(patch, ref.side)) {
    weights.emplace_back(patch.weights[static_cast<size_t>(i * patch.v_size() + j)]);
    constant = constant && weights.back() == weights.front();
  }
  if (constant) weights.clear();
  return weights;
}

// Long fractions become whole multiples of 2^-64 of the largest one, which takes up the difference.
void shorten(std::vector<GridTerm>* terms) {
  constexpr unsigned long kBits = 64;
  if (terms->empty()) return;
  Integer common(1);
  for (const GridTerm& term : *terms) common = lcm(common, term.value.denominator());
  if (common.bits() <= kBits) return;
  const auto largest = std::max_element(
      terms->begin(), terms->end(),
      [](const GridTerm& a, const GridTerm& b) { return a.value.abs() < b.value.abs(); });
  Rational sum;
  for (const GridTerm& term : *terms) sum += term.value;
  const Rational scale = largest->value;
  Rational rest = sum / scale;
  for (auto term = terms->begin(); term != terms->end(); ++term) {
    if (term == largest) continue;
    const Rational share = term->value / scale;
    const Integer steps = share.numerator().shifted(kBits).divided_nearest(share.denominator());
    term->value = Rational(steps).scaled_by_power_of_two(-static_cast<long>(kBits));
    rest -= term->value;
  }
  largest->value = rest;
  const auto gone = [](const GridTerm& term) { return term.value.is_zero(); };
  terms->erase(std::remove_if(terms->begin(), terms->end(), gone), terms->end());
}

}  // namespace

CommonRows::CommonRows(const PatchModel& model, const Join& join, CoarseGrids* grids)
    : sides_{join.a, join.b} {
  const auto knots = [&](const SideRef& ref, bool coarse) {
    const Direction along = running_direction(ref.side);
    return coarse ? grids->coarse(ref.patch, along) : grids->fine(ref.patch, along);
  };
  std::array<std::vector<Rational>, 2> weights = {weights_along(model, join.a),
                                                  weights_along(model, join.b)};
  // With weights the numerator is a spline on the fine knots only.
  const bool coarse = weights[0].empty() && weights[1].empty();
  const CommonBasis basis = common_basis(model, join, knots(join.a, coarse), knots(join.b, coarse));
  for (size_t s = 0; s < 2; ++s) fill(s, basis.map(static_cast<int>(s)), coarse, weights[s], grids);
}

void CommonRows::fill(size_t s, const ExactMap& map, bool coarse_map,
                      const std::vector<Rational>& weights, CoarseGrids* grids) {
  if (coarse_map) {
    shares_[s] = map;
    return;
  }
  const ExactMap& finer = grids->map(sides_[s].patch, running_direction(sides_[s].side));
  for (const ExactMapRow& row : map) {
    std::map<int, Rational> shares;
    Rational total;
    for (size_t k = 0; k < row.coefficients.size(); ++k) {
      const auto j = static_cast<size_t>(row.first) + k;
      Rational share = row.coefficients[k];
      if (!weights.empty()) share *= weights[j];
      total += share;
      const ExactMapRow& fine = finer[j];
      for (size_t b = 0; b < fine.coefficients.size(); ++b) {
        shares[fine.first + static_cast<int>(b)] += share * fine.coefficients[b];
      }
    }
    const int first = shares.begin()->first;
    ExactMapRow out{first,
                    std::vector<Rational>(static_cast<size_t>(shares.rbegin()->first - first) + 1)};
    for (const auto& [j, share] : shares) {
      out.coefficients[static_cast<size_t>(j - first)] = share / total;
    }
    shares_[s].push_back(std::move(out));
  }
}

std::vector<GridTerm> CommonRows::row(const LineEquation& equation, int c) const {
  std::vector<GridTerm> terms;
  for (const LineTerm& term : equation) {
    const auto s = static_cast<size_t>(term.strip);
    const ExactMapRow& shares = shares_[s][static_cast<size_t>(c)];
    for (size_t k = 0; k < shares.coefficients.size(); ++k) {
      const Rational value = term.value * shares.coefficients[k];
      if (value.is_zero()) continue;
      const int j = shares.first + static_cast<int>(k);
      const bool across_u = is_u_side(sides_[s].side);
      terms.push_back({sides_[s].patch, across_u ? term.row : j, across_u ? j : term.row, value});
    }
  }
  shorten(&terms);
  return terms;
}

}  // namespace isochor::internal
