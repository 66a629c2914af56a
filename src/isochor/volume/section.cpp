#include "isochor/volume/section.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/volume/compensated_sum.h"
#include "isochor/volume/element_fields.h"
#include "isochor/volume/section_cells.h"

namespace isochor {
namespace {

using internal::BezierCell;
using internal::CellLine;
using internal::CompensatedSum;
using internal::FluxLanes;
using internal::Frame;
using internal::gauss_rule;
using internal::monotonic_in_u;
using internal::weights_vary;

constexpr int kMaxDivisions = 24;    // of a cell, in all; then it is undecided
constexpr int kMaxHalvings = 24;     // of an interval of lines
constexpr int kLinePoints = 10;      // lines per interval
constexpr int kRationalPoints = 16;  // resolve a quotient whose weights are within a factor of two
constexpr int kBudget = 100000;      // of divisions and halvings in all: seconds, not minutes
constexpr double kNoise = 64 * kUnitRoundoff;  // of the sum of a rule, relative to its terms

// Roundings of a coordinate from pole to Gauss point, for the degrees in use.
constexpr double kCoordinateNoise = 128 * kUnitRoundoff;

enum class Place { kAbove, kBelow, kCrossed };

// The integrals over {Z < 0} of all cells of a patch, and their errors.
class Below {
 public:
  Below(double noise, double negligible) : noise_(noise), negligible_(negligible) {}

  void add(const BezierCell& cell, double sign) { add(cell, sign, 0); }
  double value(size_t k) const { return sums_[k].total(); }
  double error(size_t k) const { return errors_[k] + kNoise * sizes_[k]; }
  bool coplanar() const { return coplanar_; }

 private:
  void add(const BezierCell& cell, double sign, int divisions);
  void divide(const BezierCell& cell, double sign, int divisions);
  void add_whole(const BezierCell& cell, double sign);
  void add_undecided(const BezierCell& cell, double sign);
  void add_by_lines(const BezierCell& cell, double sign);
  void halve(const BezierCell& cell, double from, double to, const FluxLanes& coarse,
             double negligible, double sign, int halvings);
  FluxLanes lines(const BezierCell& cell, double from, double to) const;
  Place place_of(const BezierCell& cell);
  void keep(const FluxLanes& sum, double sign) {
    for (size_t k = 0; k < 3; ++k) {
      sums_[k].add(sign * sum.value[k]);
      sizes_[k] += sum.size[k];
    }
  }

  double noise_;       // of a height; nearer to the plane than this is in it
  double negligible_;  // an area
  int budget_ = kBudget;
  std::array<CompensatedSum, 3> sums_;
  std::array<double, 3> errors_{}, sizes_{};
  bool coplanar_ = false;
};

// Enough points for X J of this degree; more where there are weights.
const GaussRule& rule_for(int degree, bool rational) {
  const int exact = (3 * degree + 1) / 2;
  return gauss_rule(rational ? std::max(exact, kRationalPoints) : exact);
}

Place Below::place_of(const BezierCell& cell) {
  bool above = true;
  bool below = true;
  for (const auto& pole : cell.at) {
    above = above && pole[2] >= -noise_ * pole[3];
    below = below && pole[2] <= noise_ * pole[3];
  }
  coplanar_ = coplanar_ || (above && below);
  return above ? Place::kAbove : below ? Place::kBelow : Place::kCrossed;
}

void Below::add(const BezierCell& cell, double sign, int divisions) {
  const Place place = place_of(cell);
  if (place == Place::kAbove) return;
  const bool divisible = divisions < kMaxDivisions && budget_ > 0;
  if (weights_vary(cell) && divisible) return divide(cell, sign, divisions);
  if (place == Place::kBelow) return add_whole(cell, sign);
  if (monotonic_in_u(cell)) return add_by_lines(cell, sign);
  const BezierCell turned = cell.transposed();
  if (monotonic_in_u(turned)) return add_by_lines(turned, -sign);
  if (divisible) return divide(cell, sign, divisions);
  add_undecided(cell, sign);
}

// Into halves, along the direction that has not had its turn.
void Below::divide(const BezierCell& cell, double sign, int divisions) {
  --budget_;
  for (const BezierCell& half : cell.halves_in_u()) add(half.transposed(), -sign, divisions + 1);
}

void Below::add_whole(const BezierCell& cell, double sign) {
  const GaussRule& u_rule = rule_for(cell.u_degree, cell.rational);
  const GaussRule& v_rule = rule_for(cell.v_degree, cell.rational);
  FluxLanes sum;
  for (size_t g = 0; g < v_rule.nodes.size(); ++g) {
    sum.add(CellLine(cell, v_rule.nodes[g]).integral(0.0, 1.0, u_rule), v_rule.weights[g]);
  }
  keep(sum, sign);
}

// As if it lay where its middle lies; all of it is error.
void Below::add_undecided(const BezierCell& cell, double sign) {
  const FluxLanes sum =
      CellLine(cell, 0.5).integral(0.0, 1.0, rule_for(cell.u_degree, cell.rational));
  for (size_t k = 0; k < 3; ++k) errors_[k] += sum.size[k];
  if (CellLine(cell, 0.5).height(0.5) < 0.0) keep(sum, sign);
}

// Of the lines v = const between these two, the parts below.
FluxLanes Below::lines(const BezierCell& cell, double from, double to) const {
  const GaussRule& rule = rule_for(cell.u_degree, cell.rational);
  const GaussRule& across = gauss_rule(kLinePoints);
  FluxLanes sum;
  for (size_t g = 0; g < across.nodes.size(); ++g) {
    const CellLine line(cell, from + (to - from) * across.nodes[g]);
    const bool begins = line.height(0.0) < 0.0;
    const bool ends = line.height(1.0) < 0.0;
    if (!begins && !ends) continue;
    const double root = begins == ends ? 0.0 : line.root();
    sum.add(line.integral(begins ? 0.0 : root, ends ? 1.0 : root, rule),
            (to - from) * across.weights[g]);
  }
  return sum;
}

void Below::halve(const BezierCell& cell, double from, double to, const FluxLanes& coarse,
                  double negligible, double sign, int halvings) {
  const double middle = 0.5 * (from + to);
  const FluxLanes left = lines(cell, from, middle);
  const FluxLanes right = lines(cell, middle, to);
  FluxLanes both = left;
  both.add(right, 1.0);
  const double change = std::abs(both.value[0] - coarse.value[0]);
  if (change <= negligible || halvings == kMaxHalvings || --budget_ < 0) {
    keep(both, sign);
    for (size_t k = 0; k < 3; ++k) errors_[k] += std::abs(both.value[k] - coarse.value[k]);
    return;
  }
  halve(cell, from, middle, left, negligible, sign, halvings + 1);
  halve(cell, middle, to, right, negligible, sign, halvings + 1);
}

// Z is monotonic along u: one root a line, smooth in v between the places where it leaves the cell.
void Below::add_by_lines(const BezierCell& cell, double sign) {
  std::vector<double> cuts = {0.0, 1.0};
  for (int i : {0, cell.u_degree}) {
    std::vector<double> side;
    for (int j = 0; j <= cell.v_degree; ++j) side.push_back(cell(i, j)[2]);
    for (double v : internal::sign_changes(side)) cuts.push_back(v);
  }
  std::sort(cuts.begin(), cuts.end());
  std::vector<FluxLanes> coarse;
  double size = 0.0;
  for (size_t k = 0; k + 1 < cuts.size(); ++k) {
    coarse.push_back(lines(cell, cuts[k], cuts[k + 1]));
    size += coarse.back().size[0];
  }
  for (size_t k = 0; k + 1 < cuts.size(); ++k) {
    if (!(cuts[k] < cuts[k + 1])) continue;
    halve(cell, cuts[k], cuts[k + 1], coarse[k], negligible_ + kNoise * size, sign, 0);
  }
}

}  // namespace

Section section(const PatchModel& model, const Vec3& normal, double height) {
  const double length = normal.norm();
  ISOCHOR_REQUIRE(length > 0.0 && std::isfinite(length) && std::isfinite(height), length, height);
  Section result;
  result.normal = normal / length;
  result.height = height / length;
  if (model.points.empty()) return result;
  const Frame frame = internal::plane_frame(model.points, result.normal, result.height);
  const double reach = internal::reach_of(model.points, frame);
  // A coordinate is rounded relative to the distance from the plane's origin, and to where that is.
  const double noise = kCoordinateNoise * reach + 4 * kUnitRoundoff * frame.origin.norm();
  Below below(noise, kUnitRoundoff * reach * reach);
  for (const Patch& patch : model.patches) {
    internal::require_poles(patch, model.points.size());
    for (const BezierCell& cell : internal::cells_of(patch, model.points, frame)) {
      below.add(cell, patch.sign());
    }
  }
  result.coplanar = below.coplanar();
  result.area = -below.value(0) + 0.0;
  result.bound = below.error(0);
  result.centroid = frame.origin;
  result.centroid_bound = std::numeric_limits<double>::infinity();
  const double least = std::abs(result.area) - result.bound;
  if (least > 0.0) {
    const double x = -below.value(1) / result.area;
    const double y = -below.value(2) / result.area;
    result.centroid += frame.axes.transpose() * Vec3(x, y, 0.0);
    const double away = std::hypot(x, y);
    result.centroid_bound = (below.error(1) + below.error(2) + away * result.bound) / least +
                            8 * kUnitRoundoff * result.centroid.norm();
  }
  return result;
}

}  // namespace isochor
