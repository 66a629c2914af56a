#include "isochor/bspline/pole_rows.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "isochor/base/tolerance.h"
#include "isochor/bspline/joins.h"
#include "isochor/exact/simplest_rational.h"

namespace isochor::internal {
namespace {

const Patch& patch_of(const PatchModel& model, const SideRef& ref) {
  return model.patches[static_cast<size_t>(ref.patch)];
}

// p_1j - P0 for one collapsed side.
std::vector<Vec3> second_row(const PatchModel& model, const SideRef& ref) {
  const Patch& patch = patch_of(model, ref);
  std::vector<Vec3> row;
  const auto pole = side_indices(patch, ref.side, 0);
  const auto next = side_indices(patch, ref.side, 1);
  for (size_t j = 0; j < next.size(); ++j) {
    const auto point = [&](const std::pair<int, int>& at) -> const Vec3& {
      return model.points[static_cast<size_t>(patch.point(at.first, at.second))];
    };
    row.push_back(point(next[j]) - point(pole[j]));
  }
  return row;
}

// Coordinates of vectors in a plane spanned by two of them.
struct PlaneCoordinates {
  size_t a = 0, b = 0;  // the two
  std::vector<double> alpha, beta;
  double residual = 0.0;  // largest distance from the plane, as a part of the longest vector
};

// The longest vector, and the one farthest from its line; empty when all lie on one line.
std::optional<PlaneCoordinates> plane_coordinates(const std::vector<Vec3>& vectors) {
  PlaneCoordinates plane;
  for (size_t k = 0; k < vectors.size(); ++k) {
    if (vectors[k].norm() > vectors[plane.a].norm()) plane.a = k;
  }
  const Vec3& a = vectors[plane.a];
  for (size_t k = 0; k < vectors.size(); ++k) {
    if (a.cross(vectors[k]).norm() > a.cross(vectors[plane.b]).norm()) plane.b = k;
  }
  const Vec3& b = vectors[plane.b];
  const Vec3 normal = a.cross(b);
  const double length = a.norm();
  if (!(normal.norm() > kSingular * length * length)) return std::nullopt;
  const double area2 = normal.squaredNorm();
  for (const Vec3& v : vectors) {
    plane.alpha.push_back(v.cross(b).dot(normal) / area2);
    plane.beta.push_back(a.cross(v).dot(normal) / area2);
    const Vec3 rest = v - plane.alpha.back() * a - plane.beta.back() * b;
    plane.residual = std::max(plane.residual, rest.norm() / length);
  }
  return plane;
}

// Second-row coefficients around a pole: which are one and the same, and where they lie.
class SecondRow {
 public:
  SecondRow(const PatchModel& model, const std::vector<SideRef>& sides, CoarseGrids* grids)
      : model_(model), sides_(sides), grids_(grids) {
    for (const SideRef& ref : sides) {
      offsets_.push_back(static_cast<int>(parent_.size()));
      const int count = along_knots(ref).size();
      for (int b = 0; b < count; ++b) parent_.push_back(static_cast<int>(parent_.size()));
      for (int b = 0; b < count; ++b) {
        const int image = grids_->wrapped(ref.patch, running_direction(ref.side), b);
        merge(offsets_.back() + b, offsets_.back() + image);
      }
    }
    for (const Join& join : model.joins) tie_meridian(join);
    number_classes();
  }

  int count() const { return static_cast<int>(representative_.size()); }

  // The class of grid entry (i, j) of a patch: kPole for the pole itself, kElsewhere outside.
  static constexpr int kPole = -1;
  static constexpr int kElsewhere = -2;
  int class_at(int patch, int i, int j) const {
    int found = kElsewhere;
    for (size_t m = 0; m < sides_.size(); ++m) {
      const SideRef& ref = sides_[m];
      if (ref.patch != patch) continue;
      const auto [depth, b] = depth_and_along(ref, i, j);
      if (depth == 0) found = kPole;
      if (depth == 1) return class_of_[static_cast<size_t>(offsets_[m] + b)];
    }
    return found;
  }

  // The grid entry of a class, and of the pole in the same patch.
  GridTerm entry(int c, int depth, const Rational& value) const {
    const auto [m, b] = representative_[static_cast<size_t>(c)];
    const SideRef& ref = sides_[m];
    const int rows = across_knots(ref).size();
    const int row = is_begin_side(ref.side) ? depth : rows - 1 - depth;
    return is_u_side(ref.side) ? GridTerm{ref.patch, row, b, value}
                               : GridTerm{ref.patch, b, row, value};
  }

  // d for the identity map, by class: X / s where p_1 - P0 = V X; empty when there is no such X.
  std::vector<Vec3> own_coefficients() const {
    std::vector<Vec3> result(representative_.size(), Vec3::Zero());
    for (size_t m = 0; m < sides_.size(); ++m) {
      const SideRef& ref = sides_[m];
      const std::vector<Vec3> row = second_row(model_, ref);
      const auto x =
          along_knots(ref) == knots_of(patch_of(model_, ref), running_direction(ref.side))
              ? row
              : solved(ref, row);
      if (x.empty()) return {};
      const double share = across_share(ref);
      for (size_t b = 0; b < x.size(); ++b) {
        const int c = class_of_[static_cast<size_t>(offsets_[m]) + b];
        if (representative_[static_cast<size_t>(c)] == std::make_pair(m, static_cast<int>(b))) {
          result[static_cast<size_t>(c)] = x[b] / share;
        }
      }
    }
    return result;
  }

 private:
  const KnotVector& along_knots(const SideRef& ref) const {
    return grids_->coarse(ref.patch, running_direction(ref.side));
  }
  const KnotVector& across_knots(const SideRef& ref) const {
    return grids_->coarse(ref.patch, across_direction(ref.side));
  }

  std::pair<int, int> depth_and_along(const SideRef& ref, int i, int j) const {
    const int row = is_u_side(ref.side) ? i : j;
    const int rows = across_knots(ref).size();
    return {is_begin_side(ref.side) ? row : rows - 1 - row, is_u_side(ref.side) ? j : i};
  }

  // s: the share of the second coarse row in the second fine row; the rest is the pole's.
  double across_share(const SideRef& ref) const {
    const ExactMap& map = grids_->map(ref.patch, across_direction(ref.side));
    const bool begin = is_begin_side(ref.side);
    const ExactMapRow& row = begin ? map[1] : map[map.size() - 2];
    const int column = begin ? 1 : across_knots(ref).size() - 2;
    return row.coefficients[static_cast<size_t>(column - row.first)].to_double();
  }

  // X with V X = row, or nothing.
  std::vector<Vec3> solved(const SideRef& ref, const std::vector<Vec3>& row) const {
    const Direction along = running_direction(ref.side);
    const int period = grids_->period(ref.patch, along);
    const int columns = along_knots(ref).size();
    const auto rows = static_cast<Eigen::Index>(row.size());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(rows, period > 0 ? period : columns);
    Eigen::MatrixXd right(rows, 3);
    double size = 0.0;
    for (Eigen::Index k = 0; k < rows; ++k) {
      const auto at = static_cast<size_t>(k);
      const ExactMapRow& shares = grids_->map(ref.patch, along)[at];
      for (size_t c = 0; c < shares.coefficients.size(); ++c) {
        matrix(k, grids_->wrapped(ref.patch, along, shares.first + static_cast<int>(c))) +=
            shares.coefficients[c].to_double();
      }
      right.row(k) = row[at].transpose();
      size = std::max(size, row[at].norm());
    }
    const Eigen::MatrixXd x = matrix.colPivHouseholderQr().solve(right);
    if (!((matrix * x - right).rowwise().norm().maxCoeff() <= kSmoothResidual * size)) return {};
    std::vector<Vec3> result;
    for (int b = 0; b < columns; ++b) {
      result.emplace_back(x.row(grids_->wrapped(ref.patch, along, b)).transpose());
    }
    return result;
  }

  // Two patches, or two ends of one, share a meridian that ends in the pole.
  void tie_meridian(const Join& join) {
    if (!join.matching) return;
    for (size_t a = 0; a < sides_.size(); ++a) {
      for (size_t b = 0; b < sides_.size(); ++b) {
        const SideRef& first = sides_[a];
        const SideRef& second = sides_[b];
        if (first.patch != join.a.patch || second.patch != join.b.patch ||
            is_u_side(first.side) == is_u_side(join.a.side) ||
            is_u_side(second.side) == is_u_side(join.b.side)) {
          continue;
        }
        const bool same_end = is_begin_side(first.side) == is_begin_side(second.side);
        if (same_end == join.opposed) continue;
        if (grids_->period(first.patch, across_direction(join.a.side)) > 0) continue;  // a wrap
        merge(offsets_[a] + end_of(first, join.a), offsets_[b] + end_of(second, join.b));
      }
    }
  }

  int end_of(const SideRef& pole, const SideRef& meridian) const {
    return is_begin_side(meridian.side) ? 0 : along_knots(pole).size() - 1;
  }

  int root(int k) const {
    while (parent_[static_cast<size_t>(k)] != k) k = parent_[static_cast<size_t>(k)];
    return k;
  }
  void merge(int a, int b) {
    a = root(a);
    b = root(b);
    parent_[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
  }

  void number_classes() {
    class_of_.assign(parent_.size(), -1);
    for (size_t m = 0; m < sides_.size(); ++m) {
      const int count = along_knots(sides_[m]).size();
      for (int b = 0; b < count; ++b) {
        const auto at = static_cast<size_t>(offsets_[m] + b);
        const auto first = static_cast<size_t>(root(static_cast<int>(at)));
        if (first == at) {
          class_of_[at] = static_cast<int>(representative_.size());
          representative_.emplace_back(m, b);
        } else {
          class_of_[at] = class_of_[first];
        }
      }
    }
  }

  const PatchModel& model_;
  const std::vector<SideRef>& sides_;
  CoarseGrids* grids_;
  std::vector<int> offsets_;  // of the entries of each side
  std::vector<int> parent_;
  std::vector<int> class_of_;                           // by entry
  std::vector<std::pair<size_t, int>> representative_;  // by class: side and index along
};

// Equations between second-row classes alone (the pole drops out of sums that are zero).
using ClassEquation = std::map<int, Rational>;

std::vector<ClassEquation> equations_between(const SecondRow& row,
                                             const std::vector<ContinuityRow>& rows) {
  std::vector<ClassEquation> equations;
  for (const ContinuityRow& line : rows) {
    ClassEquation equation;
    bool inside = true;
    for (const GridTerm& term : line.terms) {
      const int c = row.class_at(term.patch, term.i, term.j);
      inside = inside && c != SecondRow::kElsewhere;
      if (!inside) break;
      if (c >= 0) equation[c] += term.value;
    }
    if (inside && !equation.empty()) equations.push_back(std::move(equation));
  }
  return equations;
}

// Reduced so that each equation has a class of its own, its pivot with value 1, that no other
// equation has; a and b are never pivots. False when an equation is left with a and b only.
bool reduce(std::vector<ClassEquation>* equations, int a, int b,
            std::vector<std::pair<int, ClassEquation>>* reduced) {
  std::vector<ClassEquation> left = std::move(*equations);
  while (!left.empty()) {
    // The equation whose pivot is largest in comparison with its other terms is next.
    size_t best = left.size();
    int pivot = -1;
    double best_share = 0.0;
    for (size_t k = 0; k < left.size(); ++k) {
      double size = 0.0;
      for (const auto& [c, value] : left[k]) size = std::max(size, std::abs(value.to_double()));
      for (const auto& [c, value] : left[k]) {
        const double share = std::abs(value.to_double()) / size;
        if (c == a || c == b || value.is_zero() || share <= best_share) continue;
        best = k;
        pivot = c;
        best_share = share;
      }
    }
    if (best == left.size()) break;
    ClassEquation chosen = std::move(left[best]);
    left.erase(left.begin() + static_cast<long>(best));
    const Rational scale = chosen[pivot];
    for (auto& [c, value] : chosen) value /= scale;
    const auto eliminate = [&](ClassEquation& from) {
      const auto found = from.find(pivot);
      if (found == from.end()) return;
      const Rational factor = found->second;
      for (const auto& [c, value] : chosen) from[c] -= factor * value;
      from.erase(pivot);
    };
    for (ClassEquation& equation : left) eliminate(equation);
    for (auto& known : *reduced) eliminate(known.second);
    reduced->emplace_back(pivot, std::move(chosen));
  }
  for (const ClassEquation& equation : left) {
    for (const auto& [c, value] : equation) {
      if (!value.is_zero()) return false;
    }
  }
  return true;
}

// Rationals within the noise of the measured values that fulfil the reduced equations exactly.
// Empty when a pivot lands outside of it.
std::vector<Rational> settled(const std::vector<double>& measured, double noise,
                              const std::vector<std::pair<int, ClassEquation>>& reduced) {
  double size = 1.0;
  std::vector<Rational> values;
  for (double value : measured) {
    size = std::max(size, std::abs(value));
    values.push_back(
        simplest_between(Rational(value) - Rational(noise), Rational(value) + Rational(noise)));
  }
  for (const auto& [pivot, equation] : reduced) {
    Rational sum;
    for (const auto& [c, value] : equation) {
      if (c != pivot) sum += value * values[static_cast<size_t>(c)];
    }
    const auto at = static_cast<size_t>(pivot);
    values[at] = -sum;
    if (!(std::abs(values[at].to_double() - measured[at]) <= kSmoothResidual * size)) return {};
  }
  return values;
}

// The row of class c: d_c = alpha d_a + beta d_b, in displacements.
ContinuityRow affine_row(const SecondRow& row, int number, int c, const Rational& alpha, int a,
                         const Rational& beta, int b) {
  ContinuityRow result;
  result.relation = number;
  result.terms.push_back(row.entry(c, 1, Rational(1)));
  if (!alpha.is_zero()) result.terms.push_back(row.entry(a, 1, -alpha));
  if (!beta.is_zero()) result.terms.push_back(row.entry(b, 1, -beta));
  const Rational own = alpha + beta - Rational(1);
  if (!own.is_zero()) result.terms.push_back(row.entry(c, 0, own));
  return result;
}

}  // namespace

std::vector<SmoothRelation> pole_relations(const PatchModel& model) {
  const double size = diagonal(model);
  const PointClasses classes = point_classes(model);
  std::map<int, std::vector<SideRef>> poles;  // by the class of the point
  std::map<int, bool> smooth;
  for (int q = 0; q < static_cast<int>(model.patches.size()); ++q) {
    const Patch& patch = model.patches[static_cast<size_t>(q)];
    const Surface surface = model.surface(q);
    for (Side side : kSides) {
      if (!is_collapsed(patch, side, classes)) continue;
      const PoleSide pole = pole_side(surface, side, size);
      const auto [i, j] = side_indices(patch, side).front();
      const int c = classes.class_of[static_cast<size_t>(patch.point(i, j))];
      poles[c].push_back({q, side});
      smooth.emplace(c, true);
      smooth[c] = smooth[c] && pole.collapsed && pole.smoothness == Smoothness::kTangent;
    }
  }
  std::vector<SmoothRelation> relations;
  for (const auto& [c, sides] : poles) {
    if (!smooth[c]) continue;
    std::vector<Vec3> vectors;
    for (const SideRef& ref : sides) {
      const std::vector<Vec3> row = second_row(model, ref);
      vectors.insert(vectors.end(), row.begin(), row.end());
    }
    const auto plane = plane_coordinates(vectors);
    if (!plane || !(plane->residual <= kSmoothResidual)) continue;
    SmoothRelation relation;
    relation.kind = SmoothRelation::Kind::kPole;
    relation.sides = sides;
    relation.residual = plane->residual;
    relation.text =
        "the point where " + label_of(model, sides.front()) + " collapses has a tangent plane";
    relations.push_back(std::move(relation));
  }
  return relations;
}

bool add_pole_rows(const PatchModel& model, const SmoothRelation& relation, int number,
                   CoarseGrids* grids, std::vector<ContinuityRow>* rows) {
  const SecondRow second(model, relation.sides, grids);
  const std::vector<Vec3> own = second.own_coefficients();
  const auto plane = own.empty() ? std::nullopt : plane_coordinates(own);
  if (!plane || !(plane->residual <= kSmoothResidual)) {
    // This scale has no copy of the pole's surroundings: they move as one.
    for (int c = 0; c < second.count(); ++c) {
      rows->push_back(affine_row(second, number, c, {}, 0, {}, 0));
    }
    return true;
  }
  const int a = static_cast<int>(plane->a);
  const int b = static_cast<int>(plane->b);
  std::vector<ClassEquation> equations = equations_between(second, *rows);
  std::vector<std::pair<int, ClassEquation>> reduced;
  if (!reduce(&equations, a, b, &reduced)) return false;
  const double noise = std::max(kFactorNoise, 0.25 * plane->residual);
  const std::vector<Rational> alpha = settled(plane->alpha, noise, reduced);
  const std::vector<Rational> beta = settled(plane->beta, noise, reduced);
  if (alpha.empty() || beta.empty()) return false;
  for (int c = 0; c < second.count(); ++c) {
    if (c == a || c == b) continue;
    rows->push_back(affine_row(second, number, c, alpha[static_cast<size_t>(c)], a,
                               beta[static_cast<size_t>(c)], b));
  }
  return true;
}

}  // namespace isochor::internal
