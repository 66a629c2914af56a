#include "reference.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "isochor/base/error.h"

namespace isochor::bench {
namespace {

using Real = long double;
using Numbers = std::vector<Real>;

struct Rule {
  Numbers nodes, weights;  // on [-1, 1]
};

Rule rule_of(int count) {
  Rule rule;
  for (int i = 0; i < count; ++i) {
    Real x = std::cos(std::acos(-1.0L) * (i + 0.75L) / (count + 0.5L));
    Real slope = 1.0L;
    for (int step = 0; step < 10; ++step) {
      Real last = 1.0L, now = x;
      for (int k = 2; k <= count; ++k) {
        const Real next = ((2 * k - 1) * x * now - (k - 1) * last) / k;
        last = now;
        now = next;
      }
      slope = count * (x * now - last) / (x * x - 1.0L);
      x -= now / slope;
    }
    rule.nodes.push_back(x);
    rule.weights.push_back(2.0L / ((1.0L - x * x) * slope * slope));
  }
  return rule;
}

// Values of the degree + 1 functions of a span at t, by the Cox-de Boor recursion.
Numbers basis_values(const KnotVector& knots, int degree, int span, Real t) {
  Numbers values(1, 1.0L);
  for (int d = 1; d <= degree; ++d) {
    Real saved = 0.0L;
    for (int r = 0; r < d; ++r) {
      const Real right = static_cast<Real>(knots[span + r + 1]) - t;
      const Real left = t - static_cast<Real>(knots[span + 1 - d + r]);
      const Real part = values[static_cast<size_t>(r)] / (right + left);
      values[static_cast<size_t>(r)] = saved + right * part;
      saved = left * part;
    }
    values.push_back(saved);
  }
  return values;
}

Numbers basis_slopes(const KnotVector& knots, int span, Real t) {
  const int d = knots.degree();
  const Numbers lower = basis_values(knots, d - 1, span, t);
  Numbers slopes(static_cast<size_t>(d) + 1, 0.0L);
  for (int c = 0; c < d; ++c) {
    const int k = span - d + c;
    const Real step = static_cast<Real>(knots[k + d + 1]) - static_cast<Real>(knots[k + 1]);
    const Real b = d * lower[static_cast<size_t>(c)] / step;
    slopes[static_cast<size_t>(c)] -= b;
    slopes[static_cast<size_t>(c) + 1] += b;
  }
  return slopes;
}

// A Gauss point of one direction.
struct Node {
  int first;
  Real weight;
  Numbers values, slopes;
};

std::vector<Node> nodes_of(const KnotVector& knots) {
  const int d = knots.degree();
  const Rule rule = rule_of((3 * d + 1) / 2);
  std::vector<Node> nodes;
  for (int span : knots.spans()) {
    const Real begin = knots[span], end = knots[span + 1];
    for (size_t g = 0; g < rule.nodes.size(); ++g) {
      const Real t = 0.5L * ((begin + end) + (end - begin) * rule.nodes[g]);
      nodes.push_back({span - d, 0.5L * (end - begin) * rule.weights[g],
                       basis_values(knots, d, span, t), basis_slopes(knots, span, t)});
    }
  }
  return nodes;
}

using Row = std::array<Real, 3>;

// Adds the areas of one patch to the rows of its points.
void add_patch(const Patch& patch, const std::vector<Vec3>& points, std::vector<Row>& rows) {
  const std::vector<Node> along_v = nodes_of(patch.v_knots);
  const auto m = static_cast<size_t>(patch.v_size());
  std::vector<Row> value(m), slope(m), area(m);
  for (const Node& u : nodes_of(patch.u_knots)) {
    for (size_t j = 0; j < m; ++j) {
      value[j] = slope[j] = area[j] = Row{};
      for (size_t a = 0; a < u.values.size(); ++a) {
        const Vec3& p = points[static_cast<size_t>(
            patch.point(u.first + static_cast<int>(a), static_cast<int>(j)))];
        for (size_t axis = 0; axis < 3; ++axis) {
          value[j][axis] += u.values[a] * static_cast<Real>(p[static_cast<int>(axis)]);
          slope[j][axis] += u.slopes[a] * static_cast<Real>(p[static_cast<int>(axis)]);
        }
      }
    }
    for (const Node& v : along_v) {
      Row su{}, sv{};
      for (size_t b = 0; b < v.values.size(); ++b) {
        const size_t j = static_cast<size_t>(v.first) + b;
        for (size_t axis = 0; axis < 3; ++axis) {
          su[axis] += v.values[b] * slope[j][axis];
          sv[axis] += v.slopes[b] * value[j][axis];
        }
      }
      const Real w = u.weight * v.weight * static_cast<Real>(patch.sign());
      const Row normal = {w * (su[1] * sv[2] - su[2] * sv[1]), w * (su[2] * sv[0] - su[0] * sv[2]),
                          w * (su[0] * sv[1] - su[1] * sv[0])};
      for (size_t b = 0; b < v.values.size(); ++b) {
        for (size_t axis = 0; axis < 3; ++axis) {
          area[static_cast<size_t>(v.first) + b][axis] += v.values[b] * normal[axis];
        }
      }
    }
    for (size_t a = 0; a < u.values.size(); ++a) {
      for (size_t j = 0; j < m; ++j) {
        Row& row = rows[static_cast<size_t>(
            patch.point(u.first + static_cast<int>(a), static_cast<int>(j)))];
        for (size_t axis = 0; axis < 3; ++axis) row[axis] += u.values[a] * area[j][axis];
      }
    }
  }
}

}  // namespace

Reference reference(const PatchModel& model) {
  Reference result;
  result.gradient.assign(model.points.size(), Row{});
  for (const Patch& patch : model.patches) {
    ISOCHOR_REQUIRE(patch.weights.empty(), patch.handle);
    add_patch(patch, model.points, result.gradient);
  }
  for (size_t i = 0; i < model.points.size(); ++i) {
    result.volume += static_cast<Real>(model.points[i].z()) * result.gradient[i][2];
  }
  return result;
}

double relative_error(const Reference& reference, const std::vector<Vec3>& gradient) {
  ISOCHOR_REQUIRE(gradient.size() == reference.gradient.size(), gradient.size());
  Real largest = 0.0L, error = 0.0L;
  for (size_t i = 0; i < gradient.size(); ++i) {
    for (size_t axis = 0; axis < 3; ++axis) {
      const Real exact = reference.gradient[i][axis];
      const Real off = std::fabs(static_cast<Real>(gradient[i][static_cast<int>(axis)]) - exact);
      largest = std::max(largest, std::fabs(exact));
      if (std::isnan(off)) return std::numeric_limits<double>::quiet_NaN();
      error = std::max(error, off);
    }
  }
  return static_cast<double>(error / largest);
}

}  // namespace isochor::bench
