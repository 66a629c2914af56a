#include "isochor/volume/below_cells.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "isochor/base/tolerance.h"

namespace isochor::internal {
namespace {

constexpr int kMaxDivisions = 24;    // of a cell, in all; then it is undecided
constexpr int kMaxFit = 3;           // degree of the curve along the waterline
constexpr double kMargin = 0x1p-4;   // around it, in parameters of the cell
constexpr int kRationalPoints = 16;  // resolve a quotient whose weights are within kWeightRatio
constexpr int kFewerPoints = 4;      // by this much is the rule coarser that judges another
constexpr double kTermNoise = 32 * kUnitRoundoff;  // of a lane, relative to its factors
constexpr double kRimSlack = 1e-4;  // of the diagonal: how far outside its box a cap may be
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double binomial(int n, int k) {
  double value = 1.0;
  for (int i = 0; i < k; ++i) value = value * (n - i) / (i + 1);
  return value;
}

double polynomial(const std::vector<double>& coefficients, double t) {
  std::vector<double> c = coefficients;
  for (size_t r = 1; r < c.size(); ++r) {
    for (size_t i = 0; i + r < c.size(); ++i) c[i] += t * (c[i + 1] - c[i]);
  }
  return c.front();
}

// What bounds integrals over a cell in [0, 1]^2: its box of derivatives, positions and weights.
struct CellBox {
  double along_u = 0.0, along_v = 0.0;  // speeds, at most
  double reach = 0.0;                   // distance from the origin, at most
  double field = 0.0;                   // |T|, at most
  double least_weight = kInfinity, most_weight = 0.0;
};

CellBox box_of(const BezierCell& cell, const FrameField& field) {
  CellBox box;
  const auto at = [&](int i, int j) { return Vec3(cell(i, j).head<3>() / cell(i, j)[3]); };
  for (int i = 0; i <= cell.u_degree; ++i) {
    for (int j = 0; j <= cell.v_degree; ++j) {
      const Vec3 p = at(i, j);
      if (i > 0) box.along_u = std::max(box.along_u, (p - at(i - 1, j)).norm());
      if (j > 0) box.along_v = std::max(box.along_v, (p - at(i, j - 1)).norm());
      box.reach = std::max(box.reach, p.norm());
      box.field = std::max(box.field, std::abs(field.at(p)));
      box.least_weight = std::min(box.least_weight, cell(i, j)[3]);
      box.most_weight = std::max(box.most_weight, cell(i, j)[3]);
    }
  }
  // The derivative of a quotient: Floater's bound.
  const double ratio = box.most_weight / box.least_weight;
  box.along_u *= cell.u_degree * ratio * ratio;
  box.along_v *= cell.v_degree * ratio * ratio;
  return box;
}

// The least |dZ/du| of the numerators, from their coefficients; 0 when the sign is not known.
double steepness(const BezierCell& cell) {
  double least = kInfinity;
  const bool rises = cell(cell.u_degree, 0)[2] > cell(0, 0)[2];
  for (int i = 0; i < cell.u_degree; ++i) {
    for (int j = 0; j <= cell.v_degree; ++j) {
      const double step = cell(i + 1, j)[2] - cell(i, j)[2];
      least = std::min(least, rises ? step : -step);
    }
  }
  return cell.u_degree * std::max(least, 0.0);
}

// The polynomial of this degree through roots of Z between two lines, as Bernstein coefficients.
std::vector<double> fit(const BezierCell& cell, double from, double to, int degree) {
  const int count = degree + 1;
  Eigen::MatrixXd rows(count, count);
  Eigen::VectorXd roots(count);
  for (int k = 0; k < count; ++k) {
    const double s = 0.5 - 0.5 * std::cos(M_PI * (2 * k + 1) / (2.0 * count));
    const CellLine line(cell, from + (to - from) * s);
    const double first = line.height(0.0);
    const double last = line.height(1.0);
    const bool crosses = (first < 0.0) != (last < 0.0);
    // It left the cell just before, within rounding.
    roots[k] = crosses ? line.root() : std::abs(first) < std::abs(last) ? 0.0 : 1.0;
    for (int j = 0; j < count; ++j) {
      rows(k, j) = binomial(degree, j) * std::pow(s, j) * std::pow(1.0 - s, degree - j);
    }
  }
  const Eigen::VectorXd c = rows.partialPivLu().solve(roots);
  return {c.data(), c.data() + count};
}

// The highest degree of a fit up to which a Gauss rule is exact; where there is none, the best fit.
int fit_degree(const BezierCell& cell) {
  for (int degree = kMaxFit; degree > 0; --degree) {
    if (2 * (cell.u_degree * degree + cell.v_degree) <= kMaxGaussPoints) return degree;
  }
  return kMaxFit;
}

// One direction of a cell, [a, b] of [0, 1]: by de Casteljau, first up to b, then from a on.
void restrict_u(BezierCell& cell, double a, double b) {
  for (int j = 0; j <= cell.v_degree; ++j) {
    const int d = cell.u_degree;
    for (int r = 1; r <= d; ++r) {
      for (int i = d; i >= r; --i) cell(i, j) = (1.0 - b) * cell(i - 1, j) + b * cell(i, j);
    }
    const double t = a / b;
    for (int r = 1; r <= d; ++r) {
      for (int i = 0; i <= d - r; ++i) cell(i, j) = (1.0 - t) * cell(i, j) + t * cell(i + 1, j);
    }
  }
}

}  // namespace

std::vector<ClosingPlane> caps_below(const ClosingPlane& plane,
                                     const std::vector<ClosingPlane>& closing, const Vec3& low,
                                     const Vec3& high) {
  // Rims miss their planes by the tolerance that check_closing allows, or a file's own.
  const double slack = kRimSlack * (high - low).norm();
  const auto corner = [&](int k) {
    Vec3 c;
    for (int a = 0; a < 3; ++a) c[a] = (k >> a & 1) != 0 ? high[a] + slack : low[a] - slack;
    return c;
  };
  std::vector<ClosingPlane> result;
  for (const ClosingPlane& other : closing) {
    // The lowest point of the plane in the box lies on one of the box's edges.
    double lowest = kInfinity;
    for (int k = 0; k < 8; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        if ((k >> axis & 1) != 0) continue;
        const Vec3 a = corner(k);
        const Vec3 b = corner(k | 1 << axis);
        const double at_a = other.normal.dot(a) - other.offset;
        const double at_b = other.normal.dot(b) - other.offset;
        if ((at_a < 0.0) == (at_b < 0.0) && at_a != 0.0 && at_b != 0.0) continue;
        const double share = at_a == at_b ? 0.0 : at_a / (at_a - at_b);
        const Vec3 crossing = a + share * (b - a);
        lowest = std::min(lowest, plane.normal.dot(crossing));
        if (at_a == at_b) lowest = std::min(lowest, plane.normal.dot(b));
      }
    }
    // A plane beside the box closes nothing: it is judged as before.
    if (std::isinf(lowest) || lowest < plane.offset) result.push_back(other);
  }
  return result;
}

FrameField in_frame(const FluxField& field, const Frame& frame) {
  FrameField result;
  result.slope = frame.axes * field.slope;
  result.direction = frame.axes * field.direction;
  result.level = field.level - field.slope.dot(frame.origin);
  const Vec3 n = frame.axes.row(2);
  result.on_waterline = field.slope.cross(n).norm() <= kSameDirection * field.slope.norm() &&
                        std::abs(result.direction.z()) > 0.0;
  if (result.on_waterline) {  // as by construction of field_below, without its roundings
    result.slope = Vec3(0.0, 0.0, 1.0 / result.direction.z());
    result.level = 0.0;
  }
  return result;
}

BelowLanes lanes_at(const FrameField& field, const Vec3& at, const Vec3& normal) {
  const double t = field.at(at);
  const double flux = t * field.direction.dot(normal);
  const Vec3 moments = (at - 0.5 * t * field.direction) * flux;
  return {flux, moments.x(), moments.y(), moments.z()};
}

BezierCell part_of_cell(const BezierCell& cell, double a, double b, double c, double d) {
  BezierCell part = cell;
  restrict_u(part, a, b);
  part = part.transposed();
  restrict_u(part, c, d);
  return part.transposed();
}

std::vector<double> heights_along(const BezierCell& cell, const std::vector<double>& r) {
  const int m = static_cast<int>(r.size()) - 1;
  std::vector<std::vector<double>> z(static_cast<size_t>(cell.u_degree) + 1);
  for (int i = 0; i <= cell.u_degree; ++i) {
    for (int j = 0; j <= cell.v_degree; ++j) z[static_cast<size_t>(i)].push_back(cell(i, j)[2]);
  }
  // De Casteljau with a polynomial for the parameter: products in Bernstein form.
  const auto width = static_cast<size_t>(m) + 1;
  for (int round = 0; round < cell.u_degree; ++round) {
    const int p = cell.v_degree + round * m;
    std::vector<double> share;
    for (int k = 0; k <= p; ++k) {
      for (int l = 0; l <= m; ++l) {
        share.push_back(binomial(p, k) * binomial(m, l) / binomial(p + m, k + l));
      }
    }
    for (size_t i = 0; i + 1 < z.size() - static_cast<size_t>(round); ++i) {
      std::vector<double> next(static_cast<size_t>(p) + width, 0.0);
      for (size_t k = 0; k <= static_cast<size_t>(p); ++k) {
        for (size_t l = 0; l < width; ++l) {
          next[k + l] += share[k * width + l] * ((1.0 - r[l]) * z[i][k] + r[l] * z[i + 1][k]);
        }
      }
      z[i] = std::move(next);
    }
  }
  return z.front();
}

// Between two lines v = const: all of it, nothing of it, or up to a curve.
struct BelowSums::Strip {
  double from = 0.0, to = 1.0;
  std::vector<double> begin, end;  // in u; empty: nothing
  double missed = 0.0;             // of the volume; infinite when it is not known
  double least = 0.0;              // of that, what no division mends
  double lever = 0.0;
};

BelowSums::Strip BelowSums::cut(const BezierCell& cell, double from, double to) const {
  Strip strip;
  strip.from = from;
  strip.to = to;
  const CellLine middle(cell, 0.5 * from + 0.5 * to);
  const bool begins = middle.height(0.0) < 0.0;
  const bool ends = middle.height(1.0) < 0.0;
  if (!begins && !ends) return strip;
  strip.begin = {0.0};
  strip.end = {1.0};
  if (begins && ends) return strip;
  const std::vector<double> r = fit(cell, from, to, fit_degree(cell));
  (begins ? strip.end : strip.begin) = r;
  const double a = *std::min_element(r.begin(), r.end()) - kMargin;
  const double b = *std::max_element(r.begin(), r.end()) + kMargin;
  strip.missed = kInfinity;
  if (!(b > 0.0) || b - a > 2.0) return strip;
  const BezierCell around = part_of_cell(cell, a, b, from, to);
  const CellBox box = box_of(around, field_);
  if (!(box.least_weight > 0.0)) return strip;
  const double steep = steepness(around) / (b - a);
  if (!(steep > 0.0)) return strip;
  double residual = 0.0;
  for (double z : heights_along(part_of_cell(cell, 0.0, 1.0, from, to), r)) {
    residual = std::max(residual, std::abs(z));
  }
  const double noise = noise_ * box.most_weight;
  // Beyond the margin nothing is known about the slope.
  if ((residual + noise) / steep > kMargin) return strip;
  const auto missed = [&](double height) {
    const double field =
        field_.on_waterline ? std::abs(field_.slope.z()) * height / box.least_weight : box.field;
    return height / steep * field * field_.direction.norm() * (box.along_u / (b - a)) * box.along_v;
  };
  strip.missed = missed(residual + noise);
  strip.least = missed(noise);
  strip.lever = box.reach + 0.5 * field_.direction.norm() * box.field;
  return strip;
}

void BelowSums::add_error(double volume, double lever) {
  errors_[0] += volume;
  for (size_t k = 1; k < 4; ++k) errors_[k] += volume * lever;
}

void BelowSums::add_region(const BezierCell& cell, double from, double to,
                           const std::vector<double>& begin, const std::vector<double>& end,
                           double sign) {
  const int fit = static_cast<int>(std::max(begin.size(), end.size())) - 1;
  const int least = cell.rational ? kRationalPoints : 1;
  const int exact = 2 * (cell.u_degree * fit + cell.v_degree);
  const int across = std::min(std::max(exact, least), kMaxGaussPoints);
  const int along = std::max(2 * cell.u_degree, least);
  const bool judged = cell.rational || exact > kMaxGaussPoints;
  proven_ = proven_ && !judged;
  const double slip_u = 2 * cell.u_degree * noise_;
  const double slip_v = 2 * cell.v_degree * noise_;
  BelowLanes fine{}, coarse{};
  for (int fewer : {0, judged ? kFewerPoints : -1}) {
    if (fewer < 0) continue;
    BelowLanes& sum = fewer == 0 ? fine : coarse;
    const GaussRule& v_rule = gauss_rule(std::max(across - fewer, 1));
    const GaussRule& u_rule = gauss_rule(std::max(along - fewer, 1));
    for (size_t g = 0; g < v_rule.nodes.size(); ++g) {
      const double low = polynomial(begin, v_rule.nodes[g]);
      const double high = polynomial(end, v_rule.nodes[g]);
      const CellLine line(cell, from + (to - from) * v_rule.nodes[g]);
      for (size_t h = 0; h < u_rule.nodes.size(); ++h) {
        const CellPoint p = line.point(low + (high - low) * u_rule.nodes[h]);
        const double weight = (to - from) * v_rule.weights[g] * (high - low) * u_rule.weights[h];
        const BelowLanes lanes = lanes_at(field_, p.at, p.along_u.cross(p.along_v));
        for (size_t k = 0; k < 4; ++k) sum[k] += weight * lanes[k];
        if (fewer > 0) continue;
        // What rounding of coordinates and derivatives may do to the lanes.
        const double t = std::abs(field_.at(p.at));
        const double u = p.along_u.norm(), v = p.along_v.norm();
        const double b = field_.direction.norm();
        const double lever = p.at.norm() + 0.5 * b * t;
        const double slip = std::abs(weight) * b *
                            (t * (slip_u * v + u * slip_v + kTermNoise * u * v) +
                             field_.slope.norm() * noise_ * u * v);
        rounding_[0] += slip;
        const double shift = (1.0 + b * field_.slope.norm()) * noise_;
        for (size_t k = 1; k < 4; ++k) {
          rounding_[k] += slip * lever + std::abs(weight) * b * t * u * v * shift;
        }
      }
    }
  }
  for (size_t k = 0; k < 4; ++k) {
    sums_[k].add(sign * fine[k]);
    if (judged) errors_[k] += std::abs(fine[k] - coarse[k]);
  }
}

// As if all of it were above; all that it can have below is error.
void BelowSums::add_undecided(const BezierCell& cell) {
  any_above_ = any_below_ = true;
  double deepest = 0.0;
  for (const auto& pole : cell.at) deepest = std::min(deepest, pole[2] / pole[3]);
  const CellBox box = box_of(cell, field_);
  const double field = field_.on_waterline ? std::abs(field_.slope.z() * deepest) : box.field;
  const double b = field_.direction.norm();
  add_error(field * b * box.along_u * box.along_v, box.reach + 0.5 * b * box.field);
}

bool BelowSums::add_cut(const BezierCell& cell, double sign, bool divisible) {
  std::vector<double> cuts = {0.0, 1.0};
  for (int i : {0, cell.u_degree}) {
    std::vector<double> side;
    for (int j = 0; j <= cell.v_degree; ++j) side.push_back(cell(i, j)[2]);
    for (double v : sign_changes(side)) cuts.push_back(v);
  }
  std::sort(cuts.begin(), cuts.end());
  std::vector<Strip> strips;
  double missed = 0.0, least = 0.0;
  for (size_t k = 0; k + 1 < cuts.size(); ++k) {
    if (!(cuts[k] < cuts[k + 1])) continue;
    strips.push_back(cut(cell, cuts[k], cuts[k + 1]));
    missed += strips.back().missed;
    least += strips.back().least;
  }
  if (!std::isfinite(missed)) return false;
  if (divisible && missed > negligible_ + 2.0 * least) return false;
  for (const Strip& strip : strips) {
    if (strip.begin.empty()) continue;
    add_region(cell, strip.from, strip.to, strip.begin, strip.end, sign);
    add_error(strip.missed, strip.lever);
  }
  any_above_ = any_below_ = true;
  return true;
}

void BelowSums::add(const BezierCell& cell, double sign, int divisions) {
  bool above = true, below = true;
  for (const auto& pole : cell.at) {
    above = above && pole[2] >= -noise_ * pole[3];
    below = below && pole[2] <= noise_ * pole[3];
  }
  if (above) {
    any_above_ = any_above_ || !below;
    return;
  }
  const bool divisible = divisions < kMaxDivisions && budget_ > 0;
  const bool varies = weights_vary(cell);
  if (below && (!varies || !divisible)) {
    any_below_ = true;
    return add_region(cell, 0.0, 1.0, {0.0}, {1.0}, sign);
  }
  if (!varies || !divisible) {
    if (monotonic_in_u(cell) && add_cut(cell, sign, divisible)) return;
    const BezierCell turned = cell.transposed();
    if (monotonic_in_u(turned) && add_cut(turned, -sign, divisible)) return;
  }
  if (!divisible) return add_undecided(cell);
  // Into halves, along the direction that has not had its turn.
  --budget_;
  for (const BezierCell& half : cell.halves_in_u()) add(half.transposed(), -sign, divisions + 1);
}

}  // namespace isochor::internal
