#include "make_data/spline_tools.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "isochor/base/error.h"

namespace make_data {

using isochor::BasisValues;
using isochor::Side;

namespace {

// A polynomial in Bernstein form over [0, 1].
using Bernstein = std::vector<double>;

double binomial(int n, int k) {
  double value = 1.0;
  for (int i = 1; i <= k; ++i) value = value * (n - k + i) / i;
  return value;
}

Bernstein product(const Bernstein& a, const Bernstein& b) {
  const int m = static_cast<int>(a.size()) - 1, n = static_cast<int>(b.size()) - 1;
  Bernstein c(a.size() + b.size() - 1, 0.0);
  for (int i = 0; i <= m; ++i) {
    for (int j = 0; j <= n; ++j) {
      c[i + j] += a[i] * b[j] * binomial(m, i) * binomial(n, j) / binomial(m + n, i + j);
    }
  }
  return c;
}

// The four cubic Bernstein polynomials of the function x(t).
std::array<Bernstein, 4> cubic_basis_of(const Bernstein& x) {
  Bernstein rest = x;
  for (double& value : rest) value = 1.0 - value;
  std::array<Bernstein, 4> basis;
  for (int i = 0; i < 4; ++i) {
    Bernstein term{binomial(3, i)};
    for (int k = 0; k < 3; ++k) term = product(term, k < i ? x : rest);
    basis[i] = term;
  }
  return basis;
}

// The polar form of the polynomial piece on a span, at as many arguments as the degree.
Vec3 polar_form(const KnotVector& knots, const std::vector<Vec3>& poles, int span,
                const std::vector<double>& arguments) {
  const int d = knots.degree();
  std::vector<Vec3> work(poles.begin() + (span - d), poles.begin() + (span + 1));
  for (int r = 1; r <= d; ++r) {
    for (int j = d; j >= r; --j) {
      const double left = knots[span - d + j], right = knots[span + 1 + j - r];
      const double a = (arguments[r - 1] - left) / (right - left);
      work[j] = (1.0 - a) * work[j - 1] + a * work[j];
    }
  }
  return work[d];
}

// The part of a curve between t0 < t1, with the same parameter.
Curve segment(const Curve& curve, double t0, double t1) {
  const int d = curve.knots.degree();
  std::vector<double> breaks{t0};
  for (double knot : curve.knots.breaks()) {
    if (knot > t0 && knot < t1) breaks.push_back(knot);
  }
  breaks.push_back(t1);
  const KnotVector knots = KnotVector::clamped(d, breaks);
  std::vector<Vec3> poles;
  for (int i = 0; i < knots.size(); ++i) {
    std::vector<double> arguments(knots.knots().begin() + i + 1, knots.knots().begin() + i + 1 + d);
    // Any piece under the coefficient's support will do; take the first non-empty one.
    int k = i;
    while (knots[k] == knots[k + 1]) ++k;
    const int span = curve.knots.span_of(0.5 * (knots[k] + knots[k + 1]));
    poles.push_back(polar_form(curve.knots, curve.poles, span, arguments));
  }
  return {knots, poles};
}

Curve whole_iso_u(const Surface& surface, double u) {
  const BasisValues basis = evaluate_basis(surface.u_knots(), u);
  std::vector<Vec3> poles(surface.v_size(), Vec3::Zero());
  for (int j = 0; j < surface.v_size(); ++j) {
    for (int i = 0; i <= basis.degree; ++i) {
      poles[j] += basis.value(0, i) * surface.pole(basis.first + i, j);
    }
  }
  return {surface.v_knots(), poles};
}

Curve whole_iso_v(const Surface& surface, double v) {
  const BasisValues basis = evaluate_basis(surface.v_knots(), v);
  std::vector<Vec3> poles(surface.u_size(), Vec3::Zero());
  for (int i = 0; i < surface.u_size(); ++i) {
    for (int j = 0; j <= basis.degree; ++j) {
      poles[i] += basis.value(0, j) * surface.pole(i, basis.first + j);
    }
  }
  return {surface.u_knots(), poles};
}

// The Bezier points (4 x 4, u-major) of a bicubic surface over a box inside one knot cell; the box
// may run backwards in either direction.
std::array<std::array<Vec3, 4>, 4> bezier_box(const Surface& s, Uv from, Uv to) {
  const int u_span = s.u_knots().span_of(0.5 * (from.u + to.u));
  const int v_span = s.v_knots().span_of(0.5 * (from.v + to.v));
  std::array<std::array<Vec3, 4>, 4> points;
  for (int a = 0; a < 4; ++a) {
    std::vector<double> u_arguments, v_arguments;
    for (int k = 0; k < 3; ++k) u_arguments.push_back(k < a ? to.u : from.u);
    std::vector<Vec3> row(s.v_size(), Vec3::Zero());
    for (int j = v_span - 3; j <= v_span; ++j) {
      std::vector<Vec3> column(s.u_size());
      for (int i = u_span - 3; i <= u_span; ++i) column[i] = s.pole(i, j);
      row[j] = polar_form(s.u_knots(), column, u_span, u_arguments);
    }
    for (int b = 0; b < 4; ++b) {
      v_arguments.clear();
      for (int k = 0; k < 3; ++k) v_arguments.push_back(k < b ? to.v : from.v);
      points[a][b] = polar_form(s.v_knots(), row, v_span, v_arguments);
    }
  }
  return points;
}

}  // namespace

std::vector<double> complete_spline(const KnotVector& knots, const Profile& profile) {
  const int n = knots.size();
  const std::vector<double> breaks = knots.breaks();
  ISOCHOR_REQUIRE(knots.degree() == 3 && static_cast<int>(breaks.size()) + 2 == n, n);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right(n);
  const auto add_row = [&](int row, double at, int order, double value) {
    const BasisValues basis = evaluate_basis(knots, at, 1);
    for (int j = 0; j <= 3; ++j) matrix(row, basis.first + j) = basis.value(order, j);
    right(row) = value;
  };
  for (int i = 0; i < n - 2; ++i) add_row(i, breaks[i], 0, profile.value(breaks[i]));
  add_row(n - 2, breaks.front(), 1, profile.begin_slope);
  add_row(n - 1, breaks.back(), 1, profile.end_slope);
  const Eigen::VectorXd solution = matrix.partialPivLu().solve(right);
  return {solution.begin(), solution.end()};
}

double round_to_step(double value, double step) { return std::round(value / step) * step + 0.0; }

double round_to_reciprocal(double value, double reciprocal) {
  return std::round(value * reciprocal) / reciprocal + 0.0;
}

Curve side_curve(const Surface& s, Side side) {
  const bool along_v = is_u_side(side);
  std::vector<Vec3> poles;
  for (int k = 0; k < (along_v ? s.v_size() : s.u_size()); ++k) {
    const int last = (along_v ? s.u_size() : s.v_size()) - 1;
    const int row = is_begin_side(side) ? 0 : last;
    poles.push_back(along_v ? s.pole(row, k) : s.pole(k, row));
  }
  return {along_v ? s.v_knots() : s.u_knots(), poles};
}

Curve iso_u_curve(const Surface& surface, double u, double v0, double v1) {
  return segment(whole_iso_u(surface, u), v0, v1);
}

Curve iso_v_curve(const Surface& surface, double v, double u0, double u1) {
  return segment(whole_iso_v(surface, v), u0, u1);
}

Curve corner_curve(const Surface& surface, Uv p0, Uv p1, Uv p2) {
  ISOCHOR_REQUIRE((p1.u == p0.u && p1.v == p2.v) || (p1.u == p2.u && p1.v == p0.v), p1.u, p1.v);
  const auto points = bezier_box(surface, p0, p2);
  const auto u_basis = cubic_basis_of({0.0, p1.u == p0.u ? 0.0 : 1.0, 1.0});
  const auto v_basis = cubic_basis_of({0.0, p1.v == p0.v ? 0.0 : 1.0, 1.0});
  std::vector<Vec3> poles(13, Vec3::Zero());
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < 4; ++b) {
      const Bernstein weight = product(u_basis[a], v_basis[b]);
      for (size_t k = 0; k < poles.size(); ++k) poles[k] += weight[k] * points[a][b];
    }
  }
  return {KnotVector::clamped(12, {0.0, 1.0}), poles};
}

}  // namespace make_data
