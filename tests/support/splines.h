// Random knot vectors and surfaces for tests; every generator takes its own seeded engine.
#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "isochor/bspline/surface.h"

namespace isochor::testing {

inline double uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

// Interior knots with gaps in [0.1, 1] and multiplicities in [1, max_multiplicity].
inline std::vector<double> random_interior(std::mt19937& random, int breaks, int max_multiplicity,
                                           double* end) {
  std::uniform_int_distribution<int> repeat(1, max_multiplicity);
  std::vector<double> interior;
  double at = 0.0;
  for (int i = 0; i < breaks; ++i) {
    at += uniform(random, 0.1, 1.0);
    interior.insert(interior.end(), static_cast<size_t>(repeat(random)), at);
  }
  *end = at + uniform(random, 0.1, 1.0);
  return interior;
}

inline KnotVector random_clamped(std::mt19937& random, int degree, int breaks = 4,
                                 int max_multiplicity = 0) {
  double end = 0.0;
  const auto interior =
      random_interior(random, breaks, max_multiplicity > 0 ? max_multiplicity : degree, &end);
  std::vector<double> knots(static_cast<size_t>(degree) + 1, 0.0);
  knots.insert(knots.end(), interior.begin(), interior.end());
  knots.insert(knots.end(), static_cast<size_t>(degree) + 1, end);
  return KnotVector(degree, knots);
}

// All knots simple, also beyond the domain.
inline KnotVector random_unclamped(std::mt19937& random, int degree, int spans = 5) {
  std::vector<double> knots;
  double at = -3.0;
  for (int i = 0; i < 2 * degree + spans + 1; ++i) {
    knots.push_back(at);
    at += uniform(random, 0.1, 1.0);
  }
  return KnotVector(degree, knots);
}

// A periodic vector with N simple knots a period and all d poles wrapped.
inline KnotVector random_wrapped(std::mt19937& random, int degree, int period_knots) {
  std::vector<double> period = {0.0};
  for (int i = 1; i < period_knots; ++i) period.push_back(period.back() + uniform(random, 0.1, 1));
  const double length = period.back() + uniform(random, 0.1, 1.0);
  std::vector<double> knots;
  for (int i = -degree; i <= period_knots + degree; ++i) {
    int rest = i % period_knots;
    int turn = i / period_knots;
    if (rest < 0) rest += period_knots, --turn;
    knots.push_back(period[static_cast<size_t>(rest)] + turn * length);
  }
  return KnotVector(degree, knots);
}

inline std::vector<Vec3> random_points(std::mt19937& random, size_t count) {
  std::vector<Vec3> points;
  for (size_t i = 0; i < count; ++i) {
    points.emplace_back(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
  }
  return points;
}

inline std::vector<double> random_weights(std::mt19937& random, size_t count) {
  std::vector<double> weights;
  for (size_t i = 0; i < count; ++i) weights.push_back(uniform(random, 0.3, 3.0));
  return weights;
}

inline Surface random_surface(std::mt19937& random, const KnotVector& u, const KnotVector& v,
                              bool rational) {
  const auto count = static_cast<size_t>(u.size()) * static_cast<size_t>(v.size());
  std::vector<Vec3> poles = random_points(random, count);
  return Surface(u, v, poles, rational ? random_weights(random, count) : std::vector<double>{});
}

// Interior values to insert: some old breaks again where the multiplicity allows, some new ones.
inline std::vector<double> random_insertions(std::mt19937& random, const KnotVector& knots,
                                             int count) {
  std::vector<double> values;
  for (double old : knots.breaks()) {
    if (old > knots.begin() && old < knots.end() && knots.multiplicity(old) < knots.degree() &&
        uniform(random, 0, 1) < 0.4) {
      values.push_back(old);
    }
  }
  for (int i = 0; i < count; ++i) {
    const double share = uniform(random, 0.01, 0.99);
    values.push_back(knots.begin() + share * (knots.end() - knots.begin()));
  }
  return values;
}

// Parameters inside every span and at every break.
inline std::vector<double> sample_parameters(const KnotVector& knots, int per_span = 3) {
  std::vector<double> values = knots.breaks();
  for (int k : knots.spans()) {
    for (int i = 0; i < per_span; ++i) {
      values.push_back(knots[k] + (knots[k + 1] - knots[k]) * (i + 0.37) / per_span);
    }
  }
  return values;
}

// Every knot vector of this degree with `count` knots that are whole numbers from 0 to `top`: all
// multiplicities, clamped and unclamped, also with functions that vanish on the whole domain.
inline std::vector<KnotVector> all_small_knots(int degree, int count, int top = 3) {
  std::vector<KnotVector> all;
  std::vector<double> knots(static_cast<size_t>(count), 0.0);
  for (;;) {
    if (KnotVector::defect(degree, knots).empty()) all.emplace_back(degree, knots);
    // The next ascending sequence: raise the last knot that can be raised, level those after it.
    size_t i = knots.size();
    while (i > 0 && knots[i - 1] == top) --i;
    if (i == 0) return all;
    std::fill(knots.begin() + static_cast<long>(i) - 1, knots.end(), knots[i - 1] + 1.0);
  }
}

}  // namespace isochor::testing
