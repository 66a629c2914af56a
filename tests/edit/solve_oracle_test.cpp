// The solve against independent oracles: Newton's method on the optimality conditions, stacked
// dense systems, closed forms; and its invariances.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "edit/fixtures.h"
#include "isochor/base/error.h"
#include "isochor/edit/extent_selection.h"
#include "isochor/edit/solve.h"
#include "isochor/volume/exact_volume.h"
#include "support/splines.h"

namespace isochor {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

// A model, its space and a problem on it that owns everything.
struct Job {
  PatchModel model;
  DisplacementSpace space;
  VolumeForm volume;
  SolveProblem problem;

  Job(PatchModel m, const DisplacementSpace::Options& options)
      : model(std::move(m)), space(model, options), volume(model) {
    problem.space = &space;
    problem.volume = &volume;
    problem.points = &model.points;
    problem.extent.assign(static_cast<size_t>(space.size()), 1);
    problem.sink = problem.extent;
    problem.volume_scale = std::abs(volume.value(model.points));
    problem.size = diagonal(model);
  }
  Job(const Job&) = delete;

  void ask(const std::string& name, int patch, Uv uv, const Vec3& value) {
    problem.constraints.push_back({name, space.surface_row(model, patch, uv), value});
  }

  void limit_to_ball(const Vec3& centre, double radius) {
    for (int c = 0; c < space.size(); ++c) {
      problem.extent[static_cast<size_t>(c)] = (space.place(c) - centre).norm() <= radius;
    }
    problem.sink = problem.extent;
  }

  std::vector<Vec3> points_at(const std::vector<Vec3>& delta) const {
    std::vector<Vec3> points = space.expand(delta);
    for (size_t i = 0; i < points.size(); ++i) points[i] += model.points[i];
    return points;
  }
};

// The problem in plain unknowns x, one per free axis of every coefficient of the extent, scaled so
// that the metric is |x|^2: columns of the coefficients they move, rows A x = b.
class PlainProblem {
 public:
  explicit PlainProblem(const Job& job, unsigned axes = 7) : job_(job) {
    for (int c = 0; c < job.space.size(); ++c) {
      if (!job.problem.extent[static_cast<size_t>(c)]) continue;
      for (int a = 0; a < 3; ++a) {
        if ((axes >> a & 1u) && !(job.space.locked_axes(c) >> a & 1u)) unknowns_.emplace_back(c, a);
      }
    }
    const auto n = static_cast<long>(unknowns_.size());
    rows = Matrix::Zero(0, n);
    rhs = Vector(0);
    for (const LinearConstraint& constraint : job.problem.constraints) {
      for (int a = 0; a < 3; ++a) {
        if (!(axes >> a & 1u)) continue;
        rows.conservativeResize(rows.rows() + 1, Eigen::NoChange);
        rows.row(rows.rows() - 1).setZero();
        rhs.conservativeResize(rows.rows());
        rhs(rows.rows() - 1) = constraint.value[a];
        for (long s = 0; s < n; ++s) {
          const auto [c, axis] = unknowns_[static_cast<size_t>(s)];
          for (size_t k = 0; k < constraint.row.coefficient.size(); ++k) {
            if (constraint.row.coefficient[k] == c && axis == a) {
              rows(rows.rows() - 1, s) += constraint.row.value[k][a] * factor(c);
            }
          }
        }
      }
    }
  }

  long size() const { return static_cast<long>(unknowns_.size()); }

  std::vector<Vec3> delta_of(const Vector& x) const {
    std::vector<Vec3> delta(static_cast<size_t>(job_.space.size()), Vec3::Zero());
    for (long s = 0; s < size(); ++s) {
      const auto [c, a] = unknowns_[static_cast<size_t>(s)];
      delta[static_cast<size_t>(c)][a] += x(s) * factor(c);
    }
    return delta;
  }

  Vector gradient(const std::vector<Vec3>& delta) const {
    const auto full = job_.space.gather(job_.volume.gradient(job_.points_at(delta)));
    Vector g(size());
    for (long s = 0; s < size(); ++s) {
      const auto [c, a] = unknowns_[static_cast<size_t>(s)];
      g(s) = full[static_cast<size_t>(c)][a] * factor(c);
    }
    return g;
  }
  Vector gradient(const Vector& x) const { return gradient(delta_of(x)); }

  double change(const Vector& x) const {
    return job_.volume.value(job_.points_at(delta_of(x))) - job_.volume.value(job_.model.points);
  }

  // The gradient is quadratic, so this central difference is the Hessian exactly.
  Matrix hessian(const Vector& x) const {
    Matrix h(size(), size());
    for (long s = 0; s < size(); ++s) {
      const Vector e = Vector::Unit(size(), s);
      h.col(s) = (gradient(Vector(x + e)) - gradient(Vector(x - e))) / 2.0;
    }
    return h;
  }

  Matrix rows;
  Vector rhs;

 private:
  double factor(int c) const { return 1.0 / std::sqrt(job_.space.weight(c)); }

  const Job& job_;
  std::vector<std::pair<int, int>> unknowns_;
};

Vector shortest(const Matrix& rows, const Vector& rhs) {
  return rows.completeOrthogonalDecomposition().solve(rhs);
}

// A stationary point of 1/2 |x|^2 subject to A x = b and V(x) - V(0) = change, by Newton's method.
Vector newton(const PlainProblem& plain, double change) {
  const long n = plain.size();
  const long m = plain.rows.rows();
  Vector x = shortest(plain.rows, plain.rhs);
  Vector multipliers = Vector::Zero(m + 1);
  for (int iteration = 0; iteration < 12; ++iteration) {
    const Vector g = plain.gradient(x);
    Matrix jacobian(m + 1, n);
    jacobian << plain.rows, g.transpose();
    if (iteration == 0) multipliers = shortest(jacobian.transpose(), x);
    Matrix kkt = Matrix::Zero(n + m + 1, n + m + 1);
    kkt.topLeftCorner(n, n) = Matrix::Identity(n, n) - multipliers(m) * plain.hessian(x);
    kkt.topRightCorner(n, m + 1) = -jacobian.transpose();
    kkt.bottomLeftCorner(m + 1, n) = jacobian;
    Vector residual(n + m + 1);
    residual << x - jacobian.transpose() * multipliers, plain.rows * x - plain.rhs,
        plain.change(x) - change;
    const Vector step = kkt.partialPivLu().solve(residual);
    x -= step.head(n);
    multipliers -= step.tail(m + 1);
    if (step.norm() <= 1e-6) break;  // convergence is quadratic: the next step is nothing
  }
  return x;
}

TEST(SolveOracle, IsotropicFindsWhatNewtonFinds) {
  testing::RandomModelOptions options;
  options.degrees[0] = options.degrees[1] = options.degrees[2] = 2;
  options.bend = 0.05;
  for (int round = 0; round < 3; ++round) {
    options.weight_ratio = round == 1 ? 2.0 : 1.0;
    const auto seed = static_cast<std::uint32_t>(20 + round);
    Job job(testing::prepared(testing::random_closed_model(seed, options)), testing::at_scale(1));
    job.limit_to_ball(Vec3(0.5, 0.5, 1.0), round == 1 ? 0.35 : 0.45);
    job.ask("move[0]", 0, {0.45, 0.55}, Vec3(0.05, -0.02, 0.1));
    if (round == 2) job.ask("hold[0]", 0, {0.6, 0.4}, Vec3::Zero());
    job.problem.change = 0.002 * round;
    const SolveResult result = solve(job.problem);
    ASSERT_EQ(result.outcome, Outcome::kDone) << result.reason;
    const PlainProblem plain(job);
    const Vector x = newton(plain, job.problem.change);
    EXPECT_LE(testing::distance(result.delta, plain.delta_of(x)), 1e-9) << round;
    EXPECT_NEAR(result.energy, 0.5 * x.squaredNorm(), 1e-9);
    EXPECT_NEAR(result.positional_energy, 0.5 * shortest(plain.rows, plain.rhs).squaredNorm(),
                1e-12);
    EXPECT_NEAR(result.achieved_change, job.problem.change, 1e-15);
  }
}

TEST(SolveOracle, IsotropicUnderMirrorSymmetryFindsWhatNewtonFinds) {
  Job job(testing::centred_cube(2, 4), testing::mirrored(1));
  job.limit_to_ball(Vec3(0.0, 0.0, 0.5), 0.5);
  job.ask("move[0]", 0, {0.45, 0.7}, Vec3(0.05, -0.02, 0.1));
  const SolveResult result = solve(job.problem);
  ASSERT_EQ(result.outcome, Outcome::kDone) << result.reason;
  const PlainProblem plain(job);
  EXPECT_LE(testing::distance(result.delta, plain.delta_of(newton(plain, 0.0))), 1e-9);
}

TEST(SolveOracle, EachAxisIsTheShortestOfItsStackedSystem) {
  for (const std::array<int, 3>& order : {std::array<int, 3>{0, 1, 2}, {2, 0, 1}}) {
    Job job(testing::bent_cube(24), testing::at_scale(1));
    job.problem.method = Method::kAxis;
    job.problem.axis_order = order;
    job.problem.change = 0.01;
    job.ask("move[0]", 0, {0.3, 0.6}, Vec3(0.05, -0.02, 0.1));
    job.ask("move[1]", 3, {0.5, 0.5}, Vec3(0.0, 0.03, 0.02));
    const SolveResult result = solve(job.problem);
    ASSERT_EQ(result.outcome, Outcome::kDone) << result.reason;
    std::vector<Vec3> delta(result.delta.size(), Vec3::Zero());
    for (size_t turn = 0; turn < 3; ++turn) {
      const PlainProblem plain(job, 1u << order[turn]);
      const double before = job.volume.value(job.points_at(delta));
      const double wanted =
          job.volume.value(job.model.points) + (turn == 2 ? job.problem.change : 0.0) - before;
      Matrix stacked(plain.rows.rows() + 1, plain.size());
      stacked << plain.rows, plain.gradient(delta).transpose();
      Vector rhs(plain.rhs.size() + 1);
      rhs << plain.rhs, wanted;
      const auto step = plain.delta_of(shortest(stacked, rhs));
      for (size_t c = 0; c < delta.size(); ++c) delta[c] += step[c];
    }
    EXPECT_LE(testing::distance(result.delta, delta), 1e-11);
  }
}

TEST(SolveOracle, TaylorIsTheShortestOfItsStackedSystem) {
  Job job(testing::bent_cube(25, 2.0), testing::at_scale(1));
  job.problem.method = Method::kTaylor;
  job.problem.change = -0.005;
  job.ask("move[0]", 2, {0.3, 0.6}, Vec3(0.05, -0.02, 0.1));
  const SolveResult result = solve(job.problem);
  ASSERT_EQ(result.outcome, Outcome::kDone) << result.reason;
  const PlainProblem plain(job);
  Matrix stacked(plain.rows.rows() + 1, plain.size());
  stacked << plain.rows, plain.gradient(Vector(Vector::Zero(plain.size()))).transpose();
  Vector rhs(plain.rhs.size() + 1);
  rhs << plain.rhs, job.problem.change;
  EXPECT_LE(testing::distance(result.delta, plain.delta_of(shortest(stacked, rhs))), 1e-12);
}

// One coefficient free along one axis: the volume is affine in it, the answer a quotient.
TEST(SolveOracle, OneUnknownIsOneDivision) {
  for (Method method : {Method::kIsotropic, Method::kAxis, Method::kTaylor}) {
    Job job(testing::bent_cube(26), testing::at_scale(1));
    const auto c = static_cast<size_t>(job.space.coefficient(0, 2, 2));
    job.problem.method = method;
    job.problem.axis_order = {0, 1, 2};
    job.problem.change = 1e-4;
    job.problem.extent.assign(job.problem.extent.size(), 0);
    job.problem.sink = job.problem.extent;
    job.problem.sink[c] = 1;
    const Vec3 g = job.space.gather(job.volume.gradient(job.model.points))[c];
    if (method != Method::kAxis) job.problem.sink_direction = Vec3(0, 0, -2);
    const SolveResult result = solve(job.problem);
    ASSERT_EQ(result.outcome, Outcome::kDone) << result.reason;
    EXPECT_NEAR(result.delta[c].z(), 1e-4 / g.z(), 1e-16 / std::abs(g.z()));
    EXPECT_EQ(result.delta[c].head<2>(), Eigen::Vector2d::Zero());
  }
}

TEST(SolveOracle, TheExactRationalChangeIsWhatWasAsked) {
  for (Method method : {Method::kIsotropic, Method::kAxis}) {
    for (double change : {0.0, 0.013, -0.2}) {
      Job job(testing::bent_cube(27), testing::at_scale(1));
      job.problem.method = method;
      job.problem.change = change;
      job.ask("move[0]", 1, {0.3, 0.6}, Vec3(0.05, -0.02, 0.1));
      const SolveResult result = solve(job.problem);
      ASSERT_EQ(result.outcome, Outcome::kDone) << result.reason;
      const Rational exact =
          ExactVolume(job.model).change(job.model.points, job.points_at(result.delta));
      EXPECT_LE((exact - Rational(change)).abs(), Rational(4e-16)) << change;
      EXPECT_NEAR(result.achieved_change, exact.to_double(), 4e-16);
    }
  }
}

// Isotropic: turning, moving and sizing the model turns, leaves and sizes the displacement.
TEST(SolveOracle, IsotropicFollowsSimilarities) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Vec3(0.2, -1.0, 0.7).normalized()).toRotationMatrix();
  const PatchModel model = testing::bent_cube(28, 2.0);
  const Vec3 by(0.1, -0.05, 0.2);
  Job plain(model, testing::at_scale(1));
  plain.ask("move[0]", 0, {0.4, 0.6}, by);
  const SolveResult reference = solve(plain.problem);
  ASSERT_EQ(reference.outcome, Outcome::kDone);
  for (double size : {1.0, 1e-6, 1e6}) {
    for (const Vec3& shift : {Vec3(0, 0, 0), Vec3(3, -7, 5)}) {
      PatchModel other = model;
      testing::transform(other, size * turn);
      testing::translate(other, size * shift);
      Job job(other, testing::at_scale(1));
      job.ask("move[0]", 0, {0.4, 0.6}, size * (turn * by));
      const SolveResult result = solve(job.problem);
      ASSERT_EQ(result.outcome, Outcome::kDone) << size << ": " << result.reason;
      double worst = 0.0;
      for (size_t c = 0; c < result.delta.size(); ++c) {
        worst = std::max(worst, (result.delta[c] / size - turn * reference.delta[c]).norm());
      }
      EXPECT_LE(worst, 1e-12) << size;
      EXPECT_LE(std::abs(result.achieved_change), 1e-13 * job.problem.volume_scale);
    }
  }
}

TEST(SolveOracle, AxisFollowsShiftsAndSizes) {
  const PatchModel model = testing::bent_cube(29);
  Job plain(model, testing::at_scale(1));
  plain.problem.method = Method::kAxis;
  plain.ask("move[0]", 0, {0.4, 0.6}, Vec3(0.1, -0.05, 0.2));
  const SolveResult reference = solve(plain.problem);
  for (double size : {1e-6, 1e6}) {
    PatchModel other = model;
    testing::transform(other, size * Eigen::Matrix3d::Identity());
    testing::translate(other, size * Vec3(1, 2, 3));
    Job job(other, testing::at_scale(1));
    job.problem.method = Method::kAxis;
    job.ask("move[0]", 0, {0.4, 0.6}, size * Vec3(0.1, -0.05, 0.2));
    const SolveResult result = solve(job.problem);
    ASSERT_EQ(result.outcome, Outcome::kDone) << result.reason;
    for (size_t c = 0; c < result.delta.size(); ++c) {
      EXPECT_LE((result.delta[c] / size - reference.delta[c]).norm(), 1e-12);
    }
  }
}

TEST(SolveOracle, OrientationDoesNotMatter) {
  const PatchModel model = testing::bent_cube(30);
  PatchModel inside_out = model;
  for (Patch& patch : inside_out.patches) patch.reversed = !patch.reversed;
  std::vector<std::vector<Vec3>> deltas;
  for (const PatchModel& one : {model, inside_out}) {
    Job job(one, testing::at_scale(1));
    job.ask("move[0]", 0, {0.4, 0.6}, Vec3(0.1, -0.05, 0.2));
    const SolveResult result = solve(job.problem);
    ASSERT_EQ(result.outcome, Outcome::kDone) << result.reason;
    deltas.push_back(result.delta);
  }
  EXPECT_LE(testing::distance(deltas[0], deltas[1]), 1e-14);
}

TEST(SolveOracle, OppositeMovesOfAFlatFaceAreOpposite) {
  // The cube is symmetric to z -> 1 - z: pulling the bottom mirrors pulling the top.
  std::vector<SolveResult> results;
  for (double sign : {1.0, -1.0}) {
    Job job(testing::centred_cube(2, 4), testing::at_scale(1));
    const int patch = sign > 0.0 ? 0 : 1;
    job.limit_to_ball(Vec3(0, 0, 0.5 * sign), 0.5);
    job.ask("move[0]", patch, {0.5, 0.5}, Vec3(0, 0, 0.2 * sign));
    results.push_back(solve(job.problem));
    ASSERT_EQ(results.back().outcome, Outcome::kDone);
  }
  EXPECT_NEAR(results[0].energy, results[1].energy, 1e-13);
  EXPECT_NEAR(results[0].positional_energy, results[1].positional_energy, 1e-14);
}

TEST(SolveOracle, NothingAskedIsNothingDone) {
  for (Method method : {Method::kIsotropic, Method::kAxis, Method::kTaylor}) {
    Job job(testing::bent_cube(31), testing::at_scale(1));
    job.problem.method = method;
    job.ask("move[0]", 0, {0.4, 0.6}, Vec3::Zero());
    const SolveResult result = solve(job.problem);
    ASSERT_EQ(result.outcome, Outcome::kDone);
    for (const Vec3& d : result.delta) EXPECT_EQ(d, Vec3::Zero());
    EXPECT_EQ(result.achieved_change, 0.0);
    EXPECT_EQ(result.energy, 0.0);
  }
}

TEST(SolveOracle, FreeVolumeIsThePositionalSolutionAlone) {
  Job job(testing::bent_cube(32), testing::at_scale(1));
  job.ask("move[0]", 0, {0.4, 0.6}, Vec3(0.1, -0.05, 0.2));
  job.problem.volume_free = true;
  const PlainProblem plain(job);
  const auto expected = plain.delta_of(shortest(plain.rows, plain.rhs));
  for (Method method : {Method::kIsotropic, Method::kAxis, Method::kTaylor}) {
    job.problem.method = method;
    const SolveResult result = solve(job.problem);
    ASSERT_EQ(result.outcome, Outcome::kDone);
    EXPECT_LE(testing::distance(result.delta, expected), 1e-14);
    EXPECT_NEAR(result.energy, result.positional_energy, 1e-15);
  }
}

TEST(SolveOracle, CountsOfRowsRankAndFreedom) {
  Job job(testing::bent_cube(33), testing::at_scale(1));
  job.ask("move[0]", 0, {0.4, 0.6}, Vec3(0.1, -0.05, 0.2));
  job.ask("again", 0, {0.4, 0.6}, Vec3(0.1, -0.05, 0.2));
  for (Method method : {Method::kIsotropic, Method::kAxis}) {
    job.problem.method = method;
    const SolveResult result = solve(job.problem);
    EXPECT_EQ(result.rows, 6);
    EXPECT_EQ(result.rank, 3);
    EXPECT_EQ(result.freedom_left, 3 * job.space.size() - 3);
    EXPECT_EQ(result.redundant, std::vector<std::string>{"again"});
  }
}

TEST(SolveOracle, InputThatDoesNotFitIsTheCallersBug) {
  Job job(testing::bent_cube(34), testing::at_scale(1));
  EXPECT_THROW(solve(SolveProblem{}), PreconditionError);
  SolveProblem problem = job.problem;
  problem.extent.pop_back();
  EXPECT_THROW(solve(problem), PreconditionError);
  problem = job.problem;
  problem.sink.push_back(1);
  EXPECT_THROW(solve(problem), PreconditionError);
  problem = job.problem;
  problem.axis_order = {0, 0, 2};
  EXPECT_THROW(solve(problem), PreconditionError);
}

}  // namespace
}  // namespace isochor
