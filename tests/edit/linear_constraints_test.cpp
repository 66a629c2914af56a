#include "isochor/edit/linear_constraints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>

#include "edit/fixtures.h"

namespace isochor {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;
using testing::value_of;

class LinearConstraints : public ::testing::Test {
 protected:
  LinearConstraints() : model_(testing::small_cube()) {
    space_.emplace(model_, DisplacementSpace::Options{});
    all_.assign(static_cast<size_t>(space_->size()), 1);
  }
  ConstraintSystem system(const std::vector<LinearConstraint>& constraints) const {
    return ConstraintSystem(*space_, axis_slots(*space_, all_, 7), constraints, false);
  }
  LinearConstraint at(const std::string& name, int q, double u, double v, const Vec3& value) const {
    return {name, space_->surface_row(model_, q, {u, v}), value};
  }

  PatchModel model_;
  std::optional<DisplacementSpace> space_;
  std::vector<char> all_;
};

TEST_F(LinearConstraints, ParticularSolvesAndIsShortest) {
  const std::vector<LinearConstraint> asked = {at("a", 0, 0.3, 0.4, Vec3(1, 2, 3)),
                                               at("b", 0, 0.35, 0.4, Vec3(-1, 0, 3)),
                                               at("c", 3, 0.5, 0.5, Vec3(0, 0, 1))};
  const ConstraintSystem equations = system(asked);
  EXPECT_EQ(equations.rows(), 9);
  EXPECT_EQ(equations.rank(), 9);
  const std::vector<double> t = equations.particular();
  std::vector<Vec3> delta(all_.size(), Vec3::Zero());
  equations.add_to(t, 1.0, delta);
  for (const LinearConstraint& constraint : asked) {
    EXPECT_LE((value_of(constraint.row, delta) - constraint.value).norm(), 1e-13);
  }
  std::vector<double> in_null_space = t;  // the shortest solution has no part that changes nothing
  equations.project(in_null_space);
  for (double x : in_null_space) EXPECT_NEAR(x, 0.0, 1e-13);
}

TEST_F(LinearConstraints, ProjectionChangesNoConstraint) {
  const std::vector<LinearConstraint> asked = {at("a", 0, 0.3, 0.4, Vec3::Zero()),
                                               at("b", 1, 0.3, 0.4, Vec3::Zero())};
  const ConstraintSystem equations = system(asked);
  std::mt19937 random(3);
  std::normal_distribution<double> value;
  std::vector<double> t(equations.slots().size());
  for (double& x : t) x = value(random);
  equations.project(t);
  std::vector<Vec3> delta(all_.size(), Vec3::Zero());
  equations.add_to(t, 1.0, delta);
  for (const LinearConstraint& constraint : asked) {
    EXPECT_LE(value_of(constraint.row, delta).norm(), 1e-13);
  }
}

TEST_F(LinearConstraints, VerdictsDoNotDependOnTheOrderOfDisjointInput) {
  const LinearConstraint a = at("a", 0, 0.3, 0.4, Vec3(1, 0, 0));
  const LinearConstraint b = at("b", 0, 0.7, 0.6, Vec3(0, 1, 0));
  LinearConstraint again = a;
  again.name = "again";
  EXPECT_THAT(system({a, b, again}).redundant(), ElementsAre("again"));
  EXPECT_THAT(system({again, b, a}).redundant(), ElementsAre("a"));
  again.value = Vec3(1.001, 0, 0);
  EXPECT_THAT(system({a, b, again}).conflicting(), UnorderedElementsAre("a", "again"));
  EXPECT_THAT(system({again, a, b}).conflicting(), UnorderedElementsAre("a", "again"));
}

// Five places of a bilinear face have four degrees of freedom: who is to blame must not depend on
// who came first.
TEST_F(LinearConstraints, ConflictsAreTheSameInEveryOrder) {
  const PatchModel flat = testing::prepared(testing::make_cube_model(1, 1));
  const DisplacementSpace space(flat, {});
  std::vector<LinearConstraint> asked;
  const std::vector<Uv> places = {
      {0.25, 0.25}, {0.75, 0.25}, {0.25, 0.75}, {0.5, 0.5}, {0.5, 0.25}};
  for (size_t k = 0; k < places.size(); ++k) {
    const std::string name(1, static_cast<char>('a' + k));
    asked.push_back({name, space.surface_row(flat, 0, places[k]), Vec3(0, 0, k == 4 ? 1 : 0)});
  }
  std::vector<int> order = {0, 1, 2, 3, 4};
  const std::vector<char> all(static_cast<size_t>(space.size()), 1);
  do {
    std::vector<LinearConstraint> shuffled;
    for (int k : order) shuffled.push_back(asked[static_cast<size_t>(k)]);
    const ConstraintSystem system(space, axis_slots(space, all, 7), shuffled, false);
    EXPECT_EQ(system.rank(), 12);
    // (0.5, 0.25) lies between a and b.
    EXPECT_THAT(system.conflicting(), UnorderedElementsAre("a", "b", "e"));
    ASSERT_EQ(system.conflicts().size(), 1u);
    EXPECT_EQ(system.conflicts()[0].constraints.size(), 3u);
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST_F(LinearConstraints, ASumOfThreeConflictsNamesAllThree) {
  const LinearConstraint a = at("a", 0, 0.3, 0.4, Vec3(1, 0, 0));
  const LinearConstraint b = at("b", 0, 0.7, 0.6, Vec3(0, 1, 0));
  LinearConstraint c{"c", a.row, Vec3(0.25, 0.5, 0.1)};
  for (size_t k = 0; k < b.row.coefficient.size(); ++k) {
    c.row.coefficient.push_back(b.row.coefficient[k]);
    c.row.value.push_back(b.row.value[k]);
    c.row.exact.push_back(b.row.exact[k]);
  }
  for (Vec3& value : c.row.value) value *= 0.5;
  for (auto& entry : c.row.exact) {
    for (Rational& value : entry) value /= Rational(2);
  }
  EXPECT_THAT(system({a, b, c}).conflicting(), UnorderedElementsAre("a", "b", "c"));
}

TEST_F(LinearConstraints, WhatNoSlotCanDoIsUnreachable) {
  std::vector<char> none(all_.size(), 0);
  none[static_cast<size_t>(space_->coefficient(1, 2, 2))] = 1;
  const ConstraintSystem equations(
      *space_, axis_slots(*space_, none, 7),
      {at("far", 0, 0.5, 0.5, Vec3(0, 0, 1)), at("still", 0, 0.5, 0.5, Vec3::Zero())}, false);
  EXPECT_THAT(equations.unreachable(), ElementsAre("far"));
  EXPECT_THAT(equations.conflicting(), IsEmpty());
}

TEST_F(LinearConstraints, DirectionSlotsMoveAlongTheDirectionOnly) {
  const Vec3 direction(1, 2, 2);
  const ConstraintSystem equations(*space_, direction_slots(*space_, all_, direction), {}, true);
  std::vector<double> t(equations.slots().size(), 3.0);
  std::vector<Vec3> delta(all_.size(), Vec3::Zero());
  equations.add_to(t, 1.0, delta);
  EXPECT_LE((delta[0] - Vec3(1, 2, 2)).norm(), 1e-15);
}

TEST_F(LinearConstraints, NoConstraintsAndNoSlots) {
  const ConstraintSystem nothing(*space_, axis_slots(*space_, std::vector<char>(all_.size(), 0), 7),
                                 {}, false);
  EXPECT_EQ(nothing.rank(), 0);
  EXPECT_TRUE(nothing.particular().empty());
}

}  // namespace
}  // namespace isochor
