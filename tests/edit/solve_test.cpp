#include "isochor/edit/solve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "isochor/bspline/joins.h"
#include "isochor/edit/nearest_root.h"
#include "support/models.h"

namespace isochor {
namespace {

TEST(NearestRoot, SolvesRandomCubics) {
  std::mt19937 random(11);
  std::normal_distribution<double> value;
  std::uniform_real_distribution<double> exponent(-12.0, 3.0);
  for (int k = 0; k < 5000; ++k) {
    const LineCubic c{value(random), value(random) * std::pow(10.0, exponent(random)),
                      value(random) * std::pow(10.0, exponent(random))};
    const double target = value(random) * std::pow(10.0, exponent(random));
    const double s = nearest_root(c, target);
    ASSERT_TRUE(std::isfinite(s)) << k;
    const double size = std::abs(target) + std::abs(c.linear * s) + std::abs(c.quadratic * s * s) +
                        std::abs(c.cubic * s * s * s);
    EXPECT_LE(std::abs(c.change(s) - target), 1e-13 * size) << k;
  }
}

TEST(NearestRoot, TakesTheNearest) {
  // (s - 1)(s + 2)(s - 5) = s^3 - 4 s^2 - 7 s + 10
  EXPECT_NEAR(nearest_root({-7.0, -4.0, 1.0}, -10.0), 1.0, 1e-14);
  EXPECT_NEAR(nearest_root({2.0, 0.0, 0.0}, 3.0), 1.5, 1e-15);
  EXPECT_EQ(nearest_root({2.0, 5.0, 1.0}, 0.0), 0.0);
}

TEST(NearestRoot, SaysWhenThereIsNone) {
  EXPECT_TRUE(std::isnan(nearest_root({0.0, 1.0, 0.0}, -1.0)));
  EXPECT_TRUE(std::isnan(nearest_root({0.0, 0.0, 0.0}, 1.0)));
}

// The problem of figure 4 on a bent model, for properties of the solution itself.
class Solve : public ::testing::Test {
 protected:
  Solve() : model_(make_model()), volume_(model_), space_(model_, {}) {
    problem_.space = &space_;
    problem_.volume = &volume_;
    problem_.points = &model_.points;
    problem_.extent.assign(static_cast<size_t>(space_.size()), 1);
    problem_.sink = problem_.extent;
    problem_.constraints = {
        {"move[0]", space_.surface_row(model_, 0, {0.4, 0.6}), Vec3(0.1, 0.05, 0.2)}};
    problem_.size = 2.0;
  }
  static PatchModel make_model() {
    testing::RandomModelOptions options;
    options.bend = 0.05;
    PatchModel model = testing::random_closed_model(5, options);
    model.joins = find_joins(model);
    return model;
  }
  PatchModel model_;
  VolumeForm volume_;
  DisplacementSpace space_;
  SolveProblem problem_;
};

TEST_F(Solve, IsotropicMeetsTheFirstOrderConditions) {
  const SolveResult result = solve(problem_);
  ASSERT_EQ(result.outcome, Outcome::kDone) << result.reason;
  EXPECT_LE(std::abs(result.achieved_change), 1e-14);
  // delta = A' mu + lambda g(p + delta): remove the row part, the rest is parallel to the gradient.
  std::vector<Vec3> points = space_.expand(result.delta);
  for (size_t i = 0; i < points.size(); ++i) points[i] += model_.points[i];
  const ConstraintSystem rows(space_, axis_slots(space_, problem_.extent, 7), problem_.constraints,
                              true);
  std::vector<double> g = rows.pull_back(space_.gather(volume_.gradient(points)));
  std::vector<double> d = rows.pull_back(result.delta);
  rows.project(g);
  rows.project(d);
  double gg = 0.0, gd = 0.0, dd = 0.0;
  for (size_t s = 0; s < g.size(); ++s) {
    gg += g[s] * g[s];
    gd += g[s] * d[s];
    dd += d[s] * d[s];
  }
  EXPECT_GT(dd, 0.0);
  EXPECT_NEAR(gd * gd / (gg * dd), 1.0, 1e-12);
}

TEST_F(Solve, IsotropicIsNoLongerThanAxisInAnyOrder) {
  const double isotropic = solve(problem_).energy;
  problem_.method = Method::kAxis;
  for (const std::array<int, 3>& order :
       {std::array<int, 3>{0, 1, 2}, {2, 1, 0}, {1, 0, 2}, {2, 0, 1}}) {
    problem_.axis_order = order;
    const SolveResult axis = solve(problem_);
    ASSERT_EQ(axis.outcome, Outcome::kDone) << axis.reason;
    EXPECT_LE(std::abs(axis.achieved_change), 1e-14);
    EXPECT_LE(isotropic, axis.energy * (1.0 + 1e-12));
  }
}

TEST_F(Solve, AxisStepIsThePublishedClosedForm) {  // [S] (16) for the x axis alone
  problem_.method = Method::kAxis;
  problem_.constraints[0].value = Vec3(0.1, 0.0, 0.0);
  const SolveResult result = solve(problem_);
  ASSERT_EQ(result.outcome, Outcome::kDone);
  const std::vector<Vec3> theta = space_.gather(volume_.gradient(model_.points));
  std::vector<double> phi(theta.size(), 0.0);
  const CoefficientRow& row = problem_.constraints[0].row;
  for (size_t k = 0; k < row.coefficient.size(); ++k) {
    phi[static_cast<size_t>(row.coefficient[k])] = row.value[k].x();
  }
  double pp = 0.0, tt = 0.0, pt = 0.0;
  for (size_t i = 0; i < phi.size(); ++i) {
    pp += phi[i] * phi[i];
    tt += theta[i].x() * theta[i].x();
    pt += phi[i] * theta[i].x();
  }
  const double alpha = pp * tt - pt * pt;
  for (size_t i = 0; i < phi.size(); ++i) {
    const double published = 0.1 / alpha * (tt * phi[i] - pt * theta[i].x());
    EXPECT_NEAR(result.delta[i].x(), published, 1e-12);
  }
}

TEST_F(Solve, TaylorMissesBySecondOrder) {
  problem_.method = Method::kTaylor;
  const double large = std::abs(solve(problem_).achieved_change);
  problem_.constraints[0].value *= 0.1;
  const double small = std::abs(solve(problem_).achieved_change);
  EXPECT_GT(large, 1e-6);
  EXPECT_NEAR(std::log10(large / small), 2.0, 0.6);
}

TEST_F(Solve, InputsAreNotChanged) {
  const std::vector<Vec3> before = model_.points;
  solve(problem_);
  EXPECT_EQ(model_.points, before);
}

}  // namespace
}  // namespace isochor
