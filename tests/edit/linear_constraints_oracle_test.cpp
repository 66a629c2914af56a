// ConstraintSystem against dense Eigen factorisations, on random systems with planted dependence.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <optional>

#include "edit/fixtures.h"
#include "isochor/edit/linear_constraints.h"
#include "support/splines.h"

namespace isochor {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::uniform;
using ::testing::UnorderedElementsAre;

// The matrix of all equations in the unknowns of the slots, and their right-hand sides, in the
// order in which ConstraintSystem takes them.
struct Dense {
  Eigen::MatrixXd rows;
  Eigen::VectorXd rhs;
};

Dense dense_of(const DisplacementSpace& space, const Slots& slots,
               const std::vector<LinearConstraint>& constraints) {
  Dense dense{Eigen::MatrixXd::Zero(0, static_cast<long>(slots.size())), Eigen::VectorXd(0)};
  for (const LinearConstraint& constraint : constraints) {
    for (int a = 0; a < 3; ++a) {
      if (!(constraint.axes >> a & 1u)) continue;
      const long at = dense.rows.rows();
      dense.rows.conservativeResize(at + 1, Eigen::NoChange);
      dense.rhs.conservativeResize(at + 1);
      dense.rhs(at) = constraint.value[a];
      for (size_t s = 0; s < slots.size(); ++s) {
        double value = 0.0;
        for (size_t k = 0; k < constraint.row.coefficient.size(); ++k) {
          if (constraint.row.coefficient[k] != slots.coefficient[s]) continue;
          value += constraint.row.value[k][a] * slots.direction[s][a];
        }
        dense.rows(at, static_cast<long>(s)) =
            value / std::sqrt(space.weight(slots.coefficient[s]));
      }
    }
  }
  return dense;
}

Eigen::VectorXd as_eigen(const std::vector<double>& t) {
  return Eigen::Map<const Eigen::VectorXd>(t.data(), static_cast<long>(t.size()));
}

// Random systems on a mirrored cube, so that metric weights of 1 and 2 and locked axes take part.
class LinearConstraintsOracle : public ::testing::Test {
 protected:
  LinearConstraintsOracle()
      : model_(testing::centred_cube(2, 5)), space_(model_, testing::mirrored(0)) {}

  std::vector<char> random_mask(double share) {
    std::vector<char> mask(static_cast<size_t>(space_.size()));
    for (char& flag : mask) flag = uniform(random_, 0.0, 1.0) < share;
    return mask;
  }

  LinearConstraint random_place(const std::string& name) {
    const int patch = std::uniform_int_distribution<int>(0, 5)(random_);
    const Uv uv{uniform(random_, 0.0, 1.0), uniform(random_, 0.0, 1.0)};
    return {name, space_.surface_row(model_, patch, uv),
            testing::random_points(random_, 1).front()};
  }

  // A combination of others; its right-hand side is right, or off by one along x.
  LinearConstraint combination(const std::string& name, const std::vector<LinearConstraint>& others,
                               bool right) {
    LinearConstraint sum{name, {}, Vec3::Zero()};
    for (const LinearConstraint& other : others) {
      // A power of two, so that the rows of the sum depend on the others without rounding.
      const double factor = std::ldexp(1.0, std::uniform_int_distribution<int>(-1, 1)(random_));
      sum.value += factor * other.value;
      for (size_t k = 0; k < other.row.coefficient.size(); ++k) {
        sum.row.coefficient.push_back(other.row.coefficient[k]);
        sum.row.value.push_back(factor * other.row.value[k]);
        sum.row.exact.push_back(other.row.exact[k]);
        for (Rational& value : sum.row.exact.back()) value *= Rational(factor);
      }
    }
    if (!right) sum.value.x() += 1.0;
    return sum;
  }

  ConstraintSystem all(const std::vector<LinearConstraint>& constraints) const {
    const std::vector<char> mask(static_cast<size_t>(space_.size()), 1);
    return ConstraintSystem(space_, axis_slots(space_, mask, 7), constraints, false);
  }

  PatchModel model_;
  DisplacementSpace space_;
  std::mt19937 random_{71};
};

TEST_F(LinearConstraintsOracle, RankShortestSolutionAndProjection) {
  for (int round = 0; round < 12; ++round) {
    std::vector<LinearConstraint> asked;
    for (int k = 0; k < 1 + round % 5; ++k) asked.push_back(random_place("p"));
    if (round % 3 == 1) asked.push_back(combination("sum", asked, true));
    if (round % 4 == 2) asked.insert(asked.begin(), asked.back());
    const Slots slots = axis_slots(space_, random_mask(0.95), round % 2 == 0 ? 7u : 5u);
    if (round % 2 == 1) {
      for (LinearConstraint& constraint : asked) constraint.axes = 5;
    }
    const ConstraintSystem system(space_, slots, asked, false, 1e-13);  // sums of values round
    const Dense dense = dense_of(space_, slots, asked);
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> oracle;
    oracle.setThreshold(1e-10);
    oracle.compute(dense.rows);
    ASSERT_THAT(system.conflicting(), IsEmpty());
    ASSERT_THAT(system.unreachable(), IsEmpty());
    EXPECT_EQ(system.rows(), dense.rows.rows());
    EXPECT_EQ(system.rank(), oracle.rank()) << round;
    const Eigen::VectorXd shortest = oracle.solve(dense.rhs);
    const Eigen::VectorXd got = as_eigen(system.particular());
    EXPECT_LE((got - shortest).norm(), 1e-9 * (1.0 + shortest.norm())) << round;
    EXPECT_LE((dense.rows * got - dense.rhs).norm(), 1e-11 * (1.0 + dense.rhs.norm()));

    std::vector<double> t;
    for (size_t s = 0; s < slots.size(); ++s) t.push_back(uniform(random_, -1.0, 1.0));
    const Eigen::VectorXd before = as_eigen(t);
    const Eigen::VectorXd nearest = before - oracle.solve(dense.rows * before);
    system.project(t);
    EXPECT_LE((as_eigen(t) - nearest).norm(), 1e-9 * before.norm());
    EXPECT_LE((dense.rows * as_eigen(t)).norm(), 1e-12 * before.norm());
    const std::vector<double> once = t;
    system.project(t);
    EXPECT_LE((as_eigen(t) - as_eigen(once)).norm(), 1e-14 * before.norm()) << "idempotent";
  }
}

TEST_F(LinearConstraintsOracle, PlantedContradictionsAreFoundAndExplained) {
  for (int round = 0; round < 10; ++round) {
    std::vector<LinearConstraint> asked;
    for (int k = 0; k < 5; ++k) asked.push_back(random_place("p" + std::to_string(k)));
    const int terms = 1 + round % 3;
    std::vector<LinearConstraint> culprits(asked.begin(), asked.begin() + terms);
    culprits.push_back(combination("sum", culprits, false));
    asked.push_back(culprits.back());
    std::shuffle(asked.begin(), asked.end(), random_);
    const ConstraintSystem system = all(asked);
    std::vector<std::string> expected;
    for (const LinearConstraint& culprit : culprits) expected.push_back(culprit.name);
    EXPECT_THAT(system.conflicting(), ::testing::UnorderedElementsAreArray(expected)) << round;
    EXPECT_THAT(all(culprits).conflicting(), ::testing::UnorderedElementsAreArray(expected));
    for (size_t k = 0; k < culprits.size(); ++k) {  // a minimal set: any one less is consistent
      std::vector<LinearConstraint> fewer = culprits;
      fewer.erase(fewer.begin() + static_cast<long>(k));
      EXPECT_THAT(all(fewer).conflicting(), IsEmpty());
    }
  }
}

TEST_F(LinearConstraintsOracle, DependentRowsOfAnyScaleAreRedundantWhenTheyAgree) {
  for (int exponent : {-30, -10, 0, 20, 40}) {
    const double factor = std::ldexp(1.0, exponent);
    const LinearConstraint a = random_place("a");
    LinearConstraint b = a;
    b.name = "b";
    for (Vec3& value : b.row.value) value *= factor;
    for (auto& entry : b.row.exact) {
      for (Rational& value : entry) value *= Rational(factor);
    }
    b.value *= factor;
    EXPECT_THAT(all({a, b}).redundant(), ElementsAre("b")) << factor;
    EXPECT_THAT(all({b, a}).redundant(), ElementsAre("a")) << factor;
    EXPECT_THAT(all({a, b}).conflicting(), IsEmpty()) << factor;
    b.value *= 1.5;
    EXPECT_THAT(all({a, b}).conflicting(), UnorderedElementsAre("a", "b")) << factor;
  }
}

TEST_F(LinearConstraintsOracle, HomogeneousSystemsNeverConflict) {
  const LinearConstraint a = random_place("a");
  LinearConstraint b = a;
  b.name = "b";
  b.value += Vec3(1, 2, 3);
  const std::vector<char> mask(static_cast<size_t>(space_.size()), 1);
  const ConstraintSystem system(space_, axis_slots(space_, mask, 7), {a, b}, true);
  EXPECT_THAT(system.conflicting(), IsEmpty());
  EXPECT_THAT(system.redundant(), ElementsAre("b"));
  for (double x : system.particular()) EXPECT_EQ(x, 0.0);
}

TEST_F(LinearConstraintsOracle, TheMetricCountsMirroredPairsTwice) {
  // |t|^2 is the metric: sum of weight times squared displacement.
  const std::vector<char> mask(static_cast<size_t>(space_.size()), 1);
  const ConstraintSystem system(space_, axis_slots(space_, mask, 7), {}, false);
  std::vector<double> t;
  for (size_t s = 0; s < system.slots().size(); ++s) t.push_back(uniform(random_, -1.0, 1.0));
  std::vector<Vec3> delta(mask.size(), Vec3::Zero());
  system.add_to(t, 1.0, delta);
  double metric = 0.0;
  for (int c = 0; c < space_.size(); ++c) {
    metric += space_.weight(c) * delta[static_cast<size_t>(c)].squaredNorm();
  }
  EXPECT_NEAR(metric, as_eigen(t).squaredNorm(), 1e-12 * metric);
}

TEST_F(LinearConstraintsOracle, PullBackIsTheTransposeOfAddTo) {
  for (const Vec3& direction : {Vec3(0, 0, 0), Vec3(0, 1, -3)}) {
    const auto mask = random_mask(0.6);
    const bool directed = direction.norm() > 0.0;
    const ConstraintSystem system(
        space_, directed ? direction_slots(space_, mask, direction) : axis_slots(space_, mask, 6),
        {}, true);
    ASSERT_GT(system.slots().size(), 0u);
    std::vector<double> t;
    for (size_t s = 0; s < system.slots().size(); ++s) t.push_back(uniform(random_, -1.0, 1.0));
    std::vector<Vec3> delta(mask.size(), Vec3::Zero());
    system.add_to(t, 2.0, delta);
    const auto gradient = testing::random_points(random_, mask.size());
    EXPECT_NEAR(testing::dot(gradient, delta),
                2.0 * as_eigen(t).dot(as_eigen(system.pull_back(gradient))), 1e-12);
  }
}

TEST_F(LinearConstraintsOracle, SlotsLeaveOutWhatIsLocked) {
  const std::vector<char> mask(static_cast<size_t>(space_.size()), 1);
  const Slots slots = axis_slots(space_, mask, 7);
  size_t expected = 0;
  for (int c = 0; c < space_.size(); ++c) expected += space_.locked_axes(c) == 0 ? 3u : 2u;
  EXPECT_EQ(slots.size(), expected);
  for (size_t s = 0; s < slots.size(); ++s) {
    const unsigned locked = space_.locked_axes(slots.coefficient[s]);
    EXPECT_TRUE(locked == 0 || slots.direction[s].x() == 0.0);
  }
  EXPECT_EQ(axis_slots(space_, mask, 2).size(), static_cast<size_t>(space_.size()));
  // On the plane of symmetry a direction with an x part is impossible, one without is not.
  EXPECT_EQ(direction_slots(space_, mask, Vec3(0, 1, 1)).size(),
            static_cast<size_t>(space_.size()));
  EXPECT_LT(direction_slots(space_, mask, Vec3(1, 1, 0)).size(),
            static_cast<size_t>(space_.size()));
}

TEST_F(LinearConstraintsOracle, OnlyTheAskedAxesAreEquations) {
  LinearConstraint asked = random_place("a");
  asked.axes = 2;
  const ConstraintSystem system = all({asked});
  EXPECT_EQ(system.rows(), 1);
  std::vector<Vec3> delta(static_cast<size_t>(space_.size()), Vec3::Zero());
  system.add_to(system.particular(), 1.0, delta);
  const Vec3 got = testing::value_of(asked.row, delta);
  EXPECT_EQ(got.x(), 0.0);
  EXPECT_NEAR(got.y(), asked.value.y(), 1e-14);
  EXPECT_EQ(got.z(), 0.0);
}

// Displacements far below what is promised are rounding of positions, not wishes.
TEST_F(LinearConstraintsOracle, NegligibleDisagreementIsAgreement) {
  const std::vector<char> mask(static_cast<size_t>(space_.size()), 1);
  const auto system = [&](const std::vector<LinearConstraint>& constraints, double negligible) {
    return ConstraintSystem(space_, axis_slots(space_, mask, 7), constraints, false, negligible);
  };
  LinearConstraint hold = random_place("hold");
  hold.value = Vec3::Zero();
  LinearConstraint stay = hold;
  stay.name = "stay";
  stay.value = Vec3(0, 1e-16, 0);
  EXPECT_THAT(system({hold, stay}, 0.0).conflicting(), UnorderedElementsAre("hold", "stay"));
  EXPECT_THAT(system({hold, stay}, 1e-12).conflicting(), IsEmpty());
  EXPECT_THAT(system({hold, stay}, 1e-12).redundant(), ElementsAre("stay"));
  stay.value.y() = 1e-11;
  EXPECT_THAT(system({hold, stay}, 1e-12).conflicting(), UnorderedElementsAre("hold", "stay"));

  LinearConstraint across{"across", space_.surface_row(model_, 0, {0.5, 0.3}), Vec3(1e-16, 0, 0)};
  EXPECT_THAT(system({across}, 1e-12).unreachable(), IsEmpty());
  across.value.x() = 1e-11;
  EXPECT_THAT(system({across}, 1e-12).unreachable(), ElementsAre("across"));
}

}  // namespace
}  // namespace isochor
