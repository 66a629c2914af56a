// The smooth pieces of a line v = const on a surface, for the integrands along it.
//
// Internal to the step layer.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace isochor::internal {

// Breaks of a periodic direction, repeated, because pcurves may run past the period.
inline void repeat_breaks(std::vector<double>& breaks, double period) {
  std::vector<double> all;
  for (int turn = -1; turn <= 1; ++turn) {
    for (size_t k = 0; k + 1 < breaks.size(); ++k) all.push_back(breaks[k] + turn * period);
  }
  all.push_back(breaks.back() + period);
  breaks = std::move(all);
}

// Visits (from, to) for the pieces of [low, high] between the breaks; where the parameter is an
// angle, no piece is wider than a rule of 16 points resolves to rounding.
template <typename Visit>
void for_each_smooth_piece(const std::vector<double>& breaks, double low, double high, bool angular,
                           const Visit& visit) {
  constexpr double kWidestTurn = 1.1;  // radians
  double from = low;
  const auto piece = [&](double to) {
    const int parts =
        angular ? std::max(1, static_cast<int>(std::ceil((to - from) / kWidestTurn))) : 1;
    const double step = (to - from) / parts;
    for (int k = 0; k < parts; ++k) {
      visit(from + k * step, k + 1 == parts ? to : from + (k + 1) * step);
    }
    from = to;
  };
  for (double at : breaks) {
    if (at > from && at < high) piece(at);
  }
  if (high > from) piece(high);
}

}  // namespace isochor::internal
