// The volume under a patch with weights to many digits: an oracle that shares no code with the
// library. Any floating-point type with the usual operators and functions will do.
//
// Every span is cut at multiples of 1/8 and, towards both of its ends, further at powers of 1/2,
// and each piece gets the same Gauss rule. Whoever uses it should ask for two different counts of
// points and see them agree.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "isochor/bspline/surface.h"

namespace isochor::testing {

// Nodes in [0, 1] and weights, by Newton's method on the three-term recursion.
template <typename Real>
std::vector<std::pair<Real, Real>> fine_gauss(int count) {
  using std::abs;
  using std::acos;
  using std::cos;
  const Real pi = acos(Real(-1));
  std::vector<std::pair<Real, Real>> rule;
  for (int i = 0; i < count; ++i) {
    Real x = cos(pi * (Real(i) + Real(3) / 4) / (Real(count) + Real(1) / 2));
    Real slope = 0;
    for (int step = 0; step < 12; ++step) {
      Real p = 1;
      Real before = 0;
      for (int k = 1; k <= count; ++k) {
        const Real next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p;
        p = next;
      }
      slope = count * (x * p - before) / (x * x - 1);
      x -= p / slope;
    }
    rule.emplace_back((1 + x) / 2, 1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

// The functions of one direction at all nodes: per node its weight, the first function, d + 1
// values and d + 1 slopes.
template <typename Real>
struct FineNode {
  Real weight;
  size_t first;
  std::vector<Real> values, slopes;
};

template <typename Real>
std::vector<FineNode<Real>> fine_nodes(const KnotVector& knots, int count, int halvings) {
  std::vector<double> breaks = {0.0};
  for (int k = 3 + halvings; k > 3; --k) breaks.push_back(std::ldexp(1.0, -k));
  for (int k = 1; k < 8; ++k) breaks.push_back(k / 8.0);
  for (int k = 4; k <= 3 + halvings; ++k) breaks.push_back(1.0 - std::ldexp(1.0, -k));
  breaks.push_back(1.0);
  const auto rule = fine_gauss<Real>(count);
  const int d = knots.degree();
  std::vector<FineNode<Real>> nodes;
  for (int span : knots.spans()) {
    const Real width = Real(knots[span + 1]) - Real(knots[span]);
    for (size_t b = 0; b + 1 < breaks.size(); ++b) {
      for (const auto& [at, weight] : rule) {
        const Real share = Real(breaks[b + 1]) - Real(breaks[b]);
        const Real u = Real(knots[span]) + width * (Real(breaks[b]) + share * at);
        FineNode<Real> node;
        node.weight = weight * share * width;
        node.first = static_cast<size_t>(span - d);
        // Divided by the textbook: N_{i,p} from N_{i,p-1} and N_{i+1,p-1}.
        std::vector<Real> n(static_cast<size_t>(d) + 2, Real(0));  // n[j]: function span - p + j
        n[0] = 1;
        for (int p = 1; p <= d; ++p) {
          std::vector<Real> next(n.size(), Real(0));
          std::vector<Real> slope(n.size(), Real(0));
          for (int j = 0; j <= p; ++j) {
            const int i = span - p + j;
            const auto ji = static_cast<size_t>(j);
            if (j > 0) {
              const Real part = n[ji - 1] / (Real(knots[i + p]) - Real(knots[i]));
              next[ji] += (u - Real(knots[i])) * part;
              slope[ji] += p * part;
            }
            if (j < p) {
              const Real part = n[ji] / (Real(knots[i + p + 1]) - Real(knots[i + 1]));
              next[ji] += (Real(knots[i + p + 1]) - u) * part;
              slope[ji] -= p * part;
            }
          }
          n = next;
          if (p == d) node.slopes = slope;
        }
        node.values = n;
        nodes.push_back(std::move(node));
      }
    }
  }
  return nodes;
}

// The integral of z (x_u y_v - x_v y_u) over the surface.
template <typename Real>
Real fine_volume(const Surface& surface, int count, int halvings) {
  const auto us = fine_nodes<Real>(surface.u_knots(), count, halvings);
  const auto vs = fine_nodes<Real>(surface.v_knots(), count, halvings);
  const auto columns = static_cast<size_t>(surface.u_size());
  const auto e = static_cast<size_t>(surface.v_knots().degree());
  const auto d = static_cast<size_t>(surface.u_knots().degree());
  Real sum = 0;
  for (const FineNode<Real>& v : vs) {
    // w x, w y, w z, w along this line, and their derivatives by v.
    std::vector<Real> line[8];
    for (auto& each : line) each.assign(columns, Real(0));
    for (size_t i = 0; i < columns; ++i) {
      for (size_t j = 0; j <= e; ++j) {
        const size_t at = surface.index(static_cast<int>(i), static_cast<int>(v.first + j));
        const Real w = surface.rational() ? Real(surface.weights()[at]) : Real(1);
        for (int axis = 0; axis < 4; ++axis) {
          const Real c = axis < 3 ? Real(w * Real(surface.poles()[at][axis % 3])) : w;
          line[axis][i] += v.values[j] * c;
          line[axis + 4][i] += v.slopes[j] * c;
        }
      }
    }
    Real row = 0;
    for (const FineNode<Real>& u : us) {
      Real f[4], fu[4], fv[4];
      for (int axis = 0; axis < 4; ++axis) {
        f[axis] = fu[axis] = fv[axis] = 0;
        for (size_t i = 0; i <= d; ++i) {
          f[axis] += u.values[i] * line[axis][u.first + i];
          fu[axis] += u.slopes[i] * line[axis][u.first + i];
          fv[axis] += u.values[i] * line[axis + 4][u.first + i];
        }
      }
      const Real det = f[0] * (fu[1] * fv[3] - fv[1] * fu[3]) -
                       f[1] * (fu[0] * fv[3] - fv[0] * fu[3]) +
                       f[3] * (fu[0] * fv[1] - fv[0] * fu[1]);
      const Real square = f[3] * f[3];
      row += u.weight * f[2] * det / (square * square);
    }
    sum += v.weight * row;
  }
  return sum;
}

}  // namespace isochor::testing
