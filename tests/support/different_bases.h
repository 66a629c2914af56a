// Sheets of one smooth surface that meet along a side in different bases; open models.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "isochor/bspline/exact_basis.h"
#include "isochor/bspline/joins.h"
#include "support/models.h"

namespace isochor::testing {

// Poles that put the surface point (x(u), y, bump(x, y)) where the bump is of low degree in y, so
// that sides along y can have any knots: interpolated at the Greville points.
inline Surface sheet(const KnotVector& u, const KnotVector& v, double x0, double x1, double y0,
                     double y1, bool backwards = false) {
  const auto bump = [](double x, double y) { return 0.2 * x * y + 0.1 * x * x * y * (1.5 - y); };
  const int nu = u.size();
  const int nv = v.size();
  const auto collocation = [](const KnotVector& knots) {
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(knots.size(), knots.size());
    for (int i = 0; i < knots.size(); ++i) {
      const ExactBasisValues basis = evaluate_exact_basis(knots, knots.greville(i));
      for (size_t k = 0; k < basis.values.size(); ++k) {
        matrix(i, basis.first + static_cast<int>(k)) = basis.values[k].to_double();
      }
    }
    return Eigen::MatrixXd(matrix.inverse());
  };
  const Eigen::MatrixXd in_u = collocation(u);
  const Eigen::MatrixXd in_v = collocation(v);
  std::vector<Vec3> poles(static_cast<size_t>(nu * nv));
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::MatrixXd values(nu, nv);
    for (int i = 0; i < nu; ++i) {
      for (int j = 0; j < nv; ++j) {
        const double s = (u.greville(i) - u.begin()) / (u.end() - u.begin());
        const double share = (v.greville(j) - v.begin()) / (v.end() - v.begin());
        const double x = x0 + s * (x1 - x0);
        const double y = y0 + (backwards ? 1.0 - share : share) * (y1 - y0);
        values(i, j) = axis == 0 ? x : axis == 1 ? y : bump(x, y);
      }
    }
    const Eigen::MatrixXd net = in_u * values * in_v.transpose();
    for (int i = 0; i < nu; ++i) {
      for (int j = 0; j < nv; ++j) poles[static_cast<size_t>(i * nv + j)][axis] = net(i, j);
    }
  }
  return Surface(u, v, poles);
}

// The side u1 of patch 0 against the side u0 of another one.
inline Join joined(const PatchModel& model, const SidePart& part_a, int b, bool opposed) {
  return measure_common_join(model, model.points, {0, Side::kUEnd}, part_a, {b, Side::kUBegin}, {},
                             opposed);
}

inline PatchModel pair_of(const KnotVector& v_a, const KnotVector& v_b, bool opposed) {
  const KnotVector u = KnotVector::uniform(3, 2);
  PatchModel model =
      make_separate_model({sheet(u, v_a, 0, 1, 0, 1), sheet(u, v_b, 1, 2, 0, 1, opposed)});
  if (opposed) model.patches[1].reversed = true;
  model.joins = {joined(model, {}, 1, opposed)};
  return model;
}

// One long side against two short ones.
inline PatchModel junction(double at) {
  const KnotVector u = KnotVector::uniform(3, 2);
  const KnotVector v = KnotVector::uniform(3, 3);
  PatchModel model = make_separate_model({sheet(u, v, 0, 1, 0, 1),
                                          sheet(u, KnotVector::uniform(3, 2), 1, 2, 0, at),
                                          sheet(u, KnotVector::uniform(2, 3, 5, 8), 1, 2, at, 1)});
  model.joins = {joined(model, {0.0, at}, 1, false), joined(model, {at, 1.0}, 2, false)};
  return model;
}

}  // namespace isochor::testing
