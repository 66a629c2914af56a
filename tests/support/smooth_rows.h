// Displacements that fulfil continuity rows, the freedom they leave, and what they do to a model.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "isochor/bspline/continuity.h"
#include "isochor/bspline/exact_refinement.h"
#include "isochor/bspline/joins.h"
#include "isochor/bspline/refinement.h"
#include "isochor/bspline/smooth_relations.h"
#include "support/splines.h"

namespace isochor::testing {

// The model's own knots: nothing coarser.
inline std::vector<CoarseKnots> finest_knots(const PatchModel& model) {
  std::vector<CoarseKnots> knots;
  for (const Patch& patch : model.patches) knots.push_back({patch.u_knots, patch.v_knots});
  return knots;
}

// The coarse coefficients of all patches as one list of unknowns, and the equations on them: the
// continuity rows, and the ties of fine points.
class CoarseSpace {
 public:
  using SparseRow = std::map<int, Rational>;

  CoarseSpace(const PatchModel& model, const std::vector<CoarseKnots>& coarse)
      : model_(model), coarse_(coarse), classes_(point_classes(model)) {
    for (size_t q = 0; q < model.patches.size(); ++q) {
      const Patch& patch = model.patches[q];
      offsets_.push_back(size_);
      size_ += coarse[q].u.size() * coarse[q].v.size();
      const auto map = [&](Direction direction, const KnotVector& few, const KnotVector& many) {
        return wrapped_rows(patch, direction, classes_) > 0 ? exact_wrapped_insertion_map(few, many)
                                                            : exact_insertion_map(few, many);
      };
      maps_.push_back({map(Direction::kU, coarse[q].u, patch.u_knots),
                       map(Direction::kV, coarse[q].v, patch.v_knots)});
    }
  }

  int size() const { return size_; }
  int unknown(int q, int i, int j) const {
    return offsets_[static_cast<size_t>(q)] + i * coarse_[static_cast<size_t>(q)].v.size() + j;
  }

  SparseRow row_of(const ContinuityRow& row) const {
    SparseRow sparse;
    for (const GridTerm& term : row.terms)
      sparse[unknown(term.patch, term.i, term.j)] += term.value;
    return sparse;
  }
  std::vector<SparseRow> rows_of(const std::vector<ContinuityRow>& rows) const {
    std::vector<SparseRow> sparse;
    for (const ContinuityRow& row : rows) sparse.push_back(row_of(row));
    return sparse;
  }

  // Fine pole (i, j) of patch q in terms of the unknowns.
  SparseRow fine_row(int q, int i, int j) const {
    SparseRow row;
    const ExactMapRow& u = maps_[static_cast<size_t>(q)].first[static_cast<size_t>(i)];
    const ExactMapRow& v = maps_[static_cast<size_t>(q)].second[static_cast<size_t>(j)];
    for (size_t a = 0; a < u.coefficients.size(); ++a) {
      for (size_t b = 0; b < v.coefficients.size(); ++b) {
        row[unknown(q, u.first + static_cast<int>(a), v.first + static_cast<int>(b))] +=
            u.coefficients[a] * v.coefficients[b];
      }
    }
    return row;
  }

  // Fine poles that are one point move together, and coarse rows that wrap.
  std::vector<SparseRow> ties() const {
    std::vector<SparseRow> rows = wrap_ties();
    std::map<int, SparseRow> first_of;
    each_pole([&](int q, int i, int j, int c) {
      SparseRow row = fine_row(q, i, j);
      const auto [known, fresh] = first_of.emplace(c, row);
      if (fresh) return;
      for (const auto& [k, value] : known->second) row[k] -= value;
      rows.push_back(std::move(row));
    });
    return rows;
  }

  // Points of the model after moving it by the coefficients.
  std::vector<Vec3> moved(const Eigen::MatrixXd& coefficients) const {
    std::vector<Vec3> at = model_.points;
    std::set<int> done;
    std::vector<Vec3> by(classes_.representative.size(), Vec3::Zero());
    each_pole([&](int q, int i, int j, int c) {
      if (!done.insert(c).second) return;
      for (const auto& [k, value] : fine_row(q, i, j)) {
        by[static_cast<size_t>(c)] += value.to_double() * coefficients.row(k).transpose();
      }
    });
    for (size_t p = 0; p < at.size(); ++p) at[p] += by[static_cast<size_t>(classes_.class_of[p])];
    return at;
  }

  // Random coefficients (#unknowns x 3), as near as possible, that fulfil the equations.
  Eigen::MatrixXd random_solution(const std::vector<SparseRow>& equations, double amount,
                                  unsigned seed = 5) const {
    std::mt19937 random(seed);
    Eigen::MatrixXd x(size_, 3);
    for (int k = 0; k < size_; ++k) {
      for (int a = 0; a < 3; ++a) x(k, a) = uniform(random, -amount, amount);
    }
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(static_cast<long>(equations.size()), size_);
    for (size_t r = 0; r < equations.size(); ++r) {
      for (const auto& [k, value] : equations[r]) {
        matrix(static_cast<long>(r), k) = value.to_double();
      }
      const double length = matrix.row(static_cast<long>(r)).norm();
      if (length > 0.0) matrix.row(static_cast<long>(r)) /= length;
    }
    const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver(matrix);
    for (int round = 0; round < 2; ++round) x -= solver.solve(matrix * x);
    return x;
  }

 private:
  std::vector<SparseRow> wrap_ties() const {
    std::vector<SparseRow> rows;
    for (int q = 0; q < static_cast<int>(model_.patches.size()); ++q) {
      const CoarseKnots& knots = coarse_[static_cast<size_t>(q)];
      const Patch& patch = model_.patches[static_cast<size_t>(q)];
      const int u = wrapped_rows(patch, Direction::kU, classes_);
      const int v = wrapped_rows(patch, Direction::kV, classes_);
      for (int i = 0; i < knots.u.size(); ++i) {
        for (int j = 0; j < knots.v.size(); ++j) {
          const int from_i = i < u ? knots.u.size() - u + i : i;
          const int from_j = j < v ? knots.v.size() - v + j : j;
          if (from_i == i && from_j == j) continue;
          rows.push_back(
              {{unknown(q, i, j), Rational(1)}, {unknown(q, from_i, from_j), Rational(-1)}});
        }
      }
    }
    return rows;
  }

  template <typename Visit>
  void each_pole(Visit visit) const {
    for (int q = 0; q < static_cast<int>(model_.patches.size()); ++q) {
      const Patch& patch = model_.patches[static_cast<size_t>(q)];
      for (int i = 0; i < patch.u_size(); ++i) {
        for (int j = 0; j < patch.v_size(); ++j) {
          visit(q, i, j, classes_.class_of[static_cast<size_t>(patch.point(i, j))]);
        }
      }
    }
  }

  const PatchModel& model_;
  std::vector<CoarseKnots> coarse_;
  PointClasses classes_;
  std::vector<int> offsets_;
  std::vector<std::pair<ExactMap, ExactMap>> maps_;
  int size_ = 0;
};

// The rank over the rationals, by elimination.
inline int exact_rank(const std::vector<CoarseSpace::SparseRow>& rows) {
  std::map<int, CoarseSpace::SparseRow> pivots;  // by leading column, leading value 1
  for (CoarseSpace::SparseRow row : rows) {
    for (;;) {
      while (!row.empty() && row.begin()->second.is_zero()) row.erase(row.begin());
      if (row.empty()) break;
      const int lead = row.begin()->first;
      const Rational factor = row.begin()->second;
      const auto pivot = pivots.find(lead);
      if (pivot == pivots.end()) {
        for (auto& [k, value] : row) value /= factor;
        pivots.emplace(lead, std::move(row));
        break;
      }
      for (const auto& [k, value] : pivot->second) row[k] -= factor * value;
    }
  }
  return static_cast<int>(pivots.size());
}

inline std::vector<CoarseSpace::SparseRow> joined(std::vector<CoarseSpace::SparseRow> a,
                                                  const std::vector<CoarseSpace::SparseRow>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// How many coefficients (3-vectors) ties and rows leave free.
inline int freedom(const CoarseSpace& space, const std::vector<ContinuityRow>& rows) {
  return space.size() - exact_rank(joined(space.ties(), space.rows_of(rows)));
}

// The worst angle and curvature jump over all joins, knot lines and poles with a tangent plane.
struct Seams {
  double angle = 0.0;      // radians; joins and lines that are smooth in `model`
  double curvature = 0.0;  // jump times diagonal; those of curvature continuity
  double pole = 0.0;       // radians
};

// `at`: positions of the points. Which seams count is decided on the model as it was.
inline Seams seams_of(const PatchModel& model, const std::vector<Vec3>& at) {
  Seams seams;
  const double size = diagonal(model);
  const auto take = [&](Smoothness smoothness, int order, double angle, double jump) {
    if (smoothness >= Smoothness::kTangent) seams.angle = std::max(seams.angle, angle);
    if (order >= 2) seams.curvature = std::max(seams.curvature, jump * size);
  };
  for (const SmoothRelation& relation : smooth_relations(model)) {
    if (relation.join < 0) continue;
    const Join& join = model.joins[static_cast<size_t>(relation.join)];
    const Join after = measure_join(model, at, join.a, join.b, join.opposed);
    take(Smoothness::kTangent, relation.order, after.max_angle_rad, after.max_curvature_jump);
  }
  for (int q = 0; q < static_cast<int>(model.patches.size()); ++q) {
    const Surface before = model.surface(q);
    const Surface after = model.surface(q, at);
    for (Direction direction : {Direction::kU, Direction::kV}) {
      const auto old_lines = interior_smoothness(before, direction, size);
      const auto lines = interior_smoothness(after, direction, size);
      const int degree = knots_of(before, direction).degree();
      for (size_t k = 0; k < lines.size(); ++k) {
        take(old_lines[k].measured, std::min(order_of(old_lines[k].measured), degree - 1),
             lines[k].max_angle_rad, lines[k].max_curvature_jump);
      }
    }
    for (Side side : kSides) {
      if (pole_side(before, side, size).smoothness != Smoothness::kTangent) continue;
      const PoleSide pole = pole_side(after, side, size);
      if (pole.collapsed) seams.pole = std::max(seams.pole, pole.max_angle_rad);
    }
  }
  return seams;
}

// Laws (1) and (2) on one model at one scale; returns the freedom.
// `inexpressible`: how many relations the scale cannot state; they are locked instead.
inline int expect_rows_keep_the_skin(const PatchModel& model,
                                     const std::vector<CoarseKnots>& coarse, double amount,
                                     size_t inexpressible = 0) {
  const auto relations = smooth_relations(model);
  EXPECT_FALSE(relations.empty());
  const ContinuityRows rows = continuity_rows(model, relations, coarse);
  EXPECT_EQ(rows.inexpressible.size(), inexpressible);
  for (const ContinuityRow& row : rows.rows) {
    const SmoothRelation& relation = relations[static_cast<size_t>(row.relation)];
    Rational sum;
    Integer common(1);
    for (const GridTerm& term : row.terms) {
      sum += term.value;
      common = lcm(common, term.value.denominator());
    }
    if (relation.kind != SmoothRelation::Kind::kPole) {
      EXPECT_LE(common.bits(), 65u) << "short";
    }
    EXPECT_EQ(sum, Rational(0)) << relation.text;
  }
  const CoarseSpace space(model, coarse);
  const Seams before = seams_of(model, model.points);
  const auto ties = space.ties();
  const auto solution = space.random_solution(joined(ties, space.rows_of(rows.rows)), amount);
  EXPECT_GT(solution.norm(), 0.1 * amount);
  const Seams after = seams_of(model, space.moved(solution));
  EXPECT_NEAR(after.angle, before.angle, 1e-12);
  EXPECT_NEAR(after.curvature, before.curvature, 1e-9);
  EXPECT_NEAR(after.pole, before.pole, 1e-12);
  if (!rows.rows.empty()) {
    const Seams creased = seams_of(model, space.moved(space.random_solution(ties, amount)));
    EXPECT_GT(creased.angle + creased.curvature + creased.pole, 1e-3);
  }
  return freedom(space, rows.rows);
}

}  // namespace isochor::testing
