#include "isochor/volume/section_cells.h"

#include <algorithm>
#include <cmath>

namespace isochor::internal {
namespace {

using Row = std::array<double, kMaxDegree + 1>;

Row bernstein(int degree, double t) {
  Row row{};
  row[0] = 1.0;
  for (int p = 1; p <= degree; ++p) {
    for (int k = p; k > 0; --k) {
      const auto i = static_cast<size_t>(k);
      row[i] = (1.0 - t) * row[i] + t * row[i - 1];
    }
    row[0] *= 1.0 - t;
  }
  return row;
}

Row bernstein_slopes(int degree, double t) {
  const Row lower = bernstein(degree - 1, t);
  Row row{};
  for (int k = 0; k <= degree; ++k) {
    const auto i = static_cast<size_t>(k);
    row[i] = degree * ((k > 0 ? lower[i - 1] : 0.0) - (k < degree ? lower[i] : 0.0));
  }
  return row;
}

// Row j: Bezier coefficient j of a span, as a combination of the span's spline coefficients (its
// blossom at j times the end and d - j times the begin of the span).
std::vector<Row> extraction(const KnotVector& knots, int span) {
  const int d = knots.degree();
  std::vector<Row> rows(static_cast<size_t>(d) + 1);
  for (int j = 0; j <= d; ++j) {
    std::vector<Row> c(static_cast<size_t>(d) + 1);
    for (size_t i = 0; i < c.size(); ++i) c[i][i] = 1.0;
    for (int r = 1; r <= d; ++r) {
      const double at = r <= j ? knots[span + 1] : knots[span];
      for (int i = d; i >= r; --i) {
        const double left = knots[span - d + i];
        const double share = (at - left) / (knots[span + 1 + i - r] - left);
        Row& to = c[static_cast<size_t>(i)];
        const Row& from = c[static_cast<size_t>(i) - 1];
        for (size_t k = 0; k < c.size(); ++k) to[k] = (1.0 - share) * from[k] + share * to[k];
      }
    }
    rows[static_cast<size_t>(j)] = c.back();
  }
  return rows;
}

double lerp(double a, double b) { return 0.5 * (a + b); }

}  // namespace

Frame plane_frame(const std::vector<Vec3>& points, const Vec3& n, double height) {
  Frame frame;
  const Vec3 a = n.unitOrthogonal();
  frame.axes << a.transpose(), n.cross(a).transpose(), n.transpose();
  Vec3 low = points.front();
  Vec3 high = low;
  for (const Vec3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vec3 middle = 0.5 * low + 0.5 * high;
  frame.origin = middle + (height - n.dot(middle)) * n;
  return frame;
}

double reach_of(const std::vector<Vec3>& points, const Frame& frame) {
  double reach = 0.0;
  for (const Vec3& p : points) reach = std::max(reach, (p - frame.origin).norm());
  return reach;
}

const GaussRule& gauss_rule(int points) {
  static const auto rules = [] {
    std::vector<GaussRule> made(1);
    for (int n = 1; n <= kMaxGaussPoints; ++n) made.push_back(gauss_legendre(n));
    return made;
  }();
  return rules[static_cast<size_t>(points)];
}

bool weights_vary(const BezierCell& cell) {
  if (!cell.rational) return false;
  double low = cell.at.front()[3];
  double high = low;
  for (const auto& pole : cell.at) {
    low = std::min(low, pole[3]);
    high = std::max(high, pole[3]);
  }
  return high > kWeightRatio * low;
}

bool monotonic_in_u(const BezierCell& cell) {
  bool rises = true;
  bool falls = true;
  for (int i = 0; i < cell.u_degree; ++i) {
    for (int j = 0; j <= cell.v_degree; ++j) {
      const double step = cell(i + 1, j)[2] - cell(i, j)[2];
      rises = rises && step > 0.0;
      falls = falls && step < 0.0;
    }
  }
  return rises || falls;
}

void FluxLanes::add(const FluxLanes& other, double factor) {
  for (size_t k = 0; k < 3; ++k) {
    value[k] += factor * other.value[k];
    size[k] += std::abs(factor) * other.size[k];
  }
}

BezierCell BezierCell::transposed() const {
  BezierCell cell{v_degree, u_degree, at, rational};
  for (int i = 0; i <= u_degree; ++i) {
    for (int j = 0; j <= v_degree; ++j) cell(j, i) = (*this)(i, j);
  }
  return cell;
}

std::array<BezierCell, 2> BezierCell::halves_in_u() const {
  std::array<BezierCell, 2> halves = {*this, *this};
  for (int j = 0; j <= v_degree; ++j) {
    // De Casteljau: the left half gets the first, the right half the last of each round.
    for (int r = 1; r <= u_degree; ++r) {
      for (int i = 0; i <= u_degree - r; ++i) {
        halves[1](i, j) = 0.5 * (halves[1](i, j) + halves[1](i + 1, j));
      }
      halves[0](r, j) = halves[1](0, j);
    }
  }
  return halves;
}

std::vector<BezierCell> cells_of(const Patch& patch, const std::vector<Vec3>& points,
                                 const Frame& frame) {
  const auto& w = patch.weights;
  const bool rational = std::any_of(w.begin(), w.end(), [&](double x) { return x != w[0]; });
  const int du = patch.u_knots.degree();
  const int dv = patch.v_knots.degree();
  std::vector<std::vector<Row>> v_maps;
  for (int span : patch.v_knots.spans()) v_maps.push_back(extraction(patch.v_knots, span));
  std::vector<BezierCell> cells;
  for (int su : patch.u_knots.spans()) {
    const std::vector<Row> u_map = extraction(patch.u_knots, su);
    for (size_t s = 0; s < v_maps.size(); ++s) {
      const int sv = patch.v_knots.spans()[s];
      const auto count = static_cast<size_t>((du + 1) * (dv + 1));
      BezierCell cell{du, dv, {count, Vec4::Zero()}, rational};
      for (int k = 0; k <= du; ++k) {
        for (int l = 0; l <= dv; ++l) {
          const int at = (su - du + k) * patch.v_size() + sv - dv + l;
          const auto id = static_cast<size_t>(patch.points[static_cast<size_t>(at)]);
          const double weight = rational ? w[static_cast<size_t>(at)] : 1.0;
          Vec4 pole;
          pole << weight * (frame.axes * (points[id] - frame.origin)), weight;
          for (int i = 0; i <= du; ++i) {
            const double share = u_map[static_cast<size_t>(i)][static_cast<size_t>(k)];
            if (share == 0.0) continue;
            for (int j = 0; j <= dv; ++j) {
              cell(i, j) +=
                  share * v_maps[s][static_cast<size_t>(j)][static_cast<size_t>(l)] * pole;
            }
          }
        }
      }
      cells.push_back(std::move(cell));
    }
  }
  return cells;
}

CellLine::CellLine(const BezierCell& cell, double v)
    : degree_(cell.u_degree),
      value_(static_cast<size_t>(degree_) + 1, Vec4::Zero()),
      slope_(value_) {
  const Row b = bernstein(cell.v_degree, v);
  const Row slopes = bernstein_slopes(cell.v_degree, v);
  for (int i = 0; i <= degree_; ++i) {
    for (int j = 0; j <= cell.v_degree; ++j) {
      value_[static_cast<size_t>(i)] += b[static_cast<size_t>(j)] * cell(i, j);
      slope_[static_cast<size_t>(i)] += slopes[static_cast<size_t>(j)] * cell(i, j);
    }
  }
}

double CellLine::height(double u) const {
  const Row b = bernstein(degree_, u);
  double z = 0.0;
  for (size_t i = 0; i < value_.size(); ++i) z += b[i] * value_[i][2];
  return z;
}

double CellLine::root() const {
  double low = 0.0;
  double high = 1.0;
  const bool rises = value_.front()[2] < 0.0;
  double u = 0.5;
  for (int step = 0; step < 80 && low < u && u < high; ++step) {
    const Row b = bernstein(degree_, u);
    const Row slopes = bernstein_slopes(degree_, u);
    double z = 0.0;
    double slope = 0.0;
    for (size_t i = 0; i < value_.size(); ++i) {
      z += b[i] * value_[i][2];
      slope += slopes[i] * value_[i][2];
    }
    if (z == 0.0) return u;
    ((z < 0.0) == rises ? low : high) = u;
    // Newton's step where it stays inside, else half of what is left.
    const double newton = u - z / slope;
    if (newton == u) return u;
    u = low < newton && newton < high ? newton : lerp(low, high);
  }
  return u;
}

CellPoint CellLine::point(double u) const {
  const Row b = bernstein(degree_, u);
  const Row slopes = bernstein_slopes(degree_, u);
  Vec4 s = Vec4::Zero();
  Vec4 su = Vec4::Zero();
  Vec4 sv = Vec4::Zero();
  for (size_t i = 0; i < value_.size(); ++i) {
    s += b[i] * value_[i];
    su += slopes[i] * value_[i];
    sv += b[i] * slope_[i];
  }
  const Vec3 at = s.head<3>() / s[3];
  return {at, (su.head<3>() - su[3] * at) / s[3], (sv.head<3>() - sv[3] * at) / s[3]};
}

FluxLanes CellLine::integral(double from, double to, const GaussRule& rule) const {
  FluxLanes sum;
  for (size_t g = 0; g < rule.nodes.size(); ++g) {
    const CellPoint p = point(from + (to - from) * rule.nodes[g]);
    const double forward = p.along_u.x() * p.along_v.y();
    const double back = p.along_v.x() * p.along_u.y();
    const double weight = (to - from) * rule.weights[g];
    const double flux = weight * (forward - back);
    const double size = std::abs(weight) * (std::abs(forward) + std::abs(back));
    const std::array<double, 3> f = {1.0, p.at.x(), p.at.y()};
    for (size_t k = 0; k < 3; ++k) {
      sum.value[k] += f[k] * flux;
      sum.size[k] += std::abs(f[k]) * size;
    }
  }
  return sum;
}

namespace {

void add_sign_changes(std::vector<double> c, double from, double to, std::vector<double>& roots) {
  constexpr double kNarrow = 0x1p-50;
  int changes = 0;
  double last = 0.0;
  for (double x : c) {
    if (x == 0.0) continue;
    if (last != 0.0 && (x < 0.0) != (last < 0.0)) ++changes;
    last = x;
  }
  if (changes == 0) return;
  const double middle = lerp(from, to);
  if (to - from < kNarrow) {
    roots.push_back(middle);
    return;
  }
  std::vector<double> left(c.size());
  for (size_t r = 0; r < left.size(); ++r) {
    left[r] = c.front();
    for (size_t i = 0; i + 1 + r < c.size(); ++i) c[i] = lerp(c[i], c[i + 1]);
  }
  // What is left in c is the right half, read from its end.
  add_sign_changes(left, from, middle, roots);
  if (!left.empty() && left.back() == 0.0) roots.push_back(middle);
  add_sign_changes(std::move(c), middle, to, roots);
}

}  // namespace

std::vector<double> sign_changes(const std::vector<double>& coefficients) {
  std::vector<double> roots;
  add_sign_changes(coefficients, 0.0, 1.0, roots);
  std::sort(roots.begin(), roots.end());
  return roots;
}

}  // namespace isochor::internal
