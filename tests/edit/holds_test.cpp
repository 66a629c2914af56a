// Holds of normals, planes and symmetry, continuity edge by edge, and what names them in verdicts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "edit/fixtures.h"
#include "isochor/base/error.h"
#include "isochor/bspline/smoothness.h"
#include "isochor/edit/edit_session.h"
#include "support/revolved.h"

namespace isochor {
namespace {

using testing::edit_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

Edit pull_top(const Vec3& vector) {
  return edit_of(testing::move_by("top", {0.4, 0.6}, vector), testing::ball(0.5));
}

Hold hold_normal(const std::string& patch, Uv uv) {
  Hold hold = testing::hold_at(patch, uv);
  hold.kind = Hold::Kind::kNormal;
  return hold;
}

Hold hold_plane(const Vec3& point, const Vec3& normal) {
  Hold hold;
  hold.kind = Hold::Kind::kPlane;
  hold.plane_point = point;
  hold.plane_normal = normal;
  return hold;
}

double turn_of_top(const EditSession& session, const PatchModel& before, Uv uv) {
  return angle_between(before.surface(0).normal(uv.u, uv.v),
                       session.model().surface(0).normal(uv.u, uv.v));
}

TEST(Holds, ANormalStaysWhileThePointMoves) {
  const PatchModel cube = testing::paper_cube();
  ASSERT_EQ(cube.patches[0].name, "top");
  const Uv beside{0.5, 0.5};
  for (bool held : {false, true}) {
    Edit edit = pull_top(Vec3(0.05, 0.0, 0.2));
    if (held) edit.holds = {hold_normal("top", beside)};
    EditSession session(cube);
    const Certificate done = session.apply(edit);
    ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
    EXPECT_LE(std::abs(done.volume.relative_change), 1e-14);
    if (held) {
      EXPECT_LE(turn_of_top(session, cube, beside), 1e-13);
    } else {
      EXPECT_GE(turn_of_top(session, cube, beside), 1e-2) << "the test can fail";
    }
  }
}

TEST(Holds, APlaneKeepsWhatLiesInIt) {
  const PatchModel cube = testing::paper_cube();
  Edit edit = pull_top(Vec3(0.1, 0.0, 0.0));
  edit.extent = testing::whole_extent();
  edit.holds = {hold_plane(Vec3(7, 7, 1), Vec3(0, 0, 3))};
  EditSession session(cube);
  const Certificate done = session.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  double moved = 0.0;
  for (size_t i = 0; i < cube.points.size(); ++i) {
    if (cube.points[i].z() != 1.0) continue;
    EXPECT_NEAR(session.model().points[i].z(), 1.0, 1e-15);
    moved = std::max(moved, (session.model().points[i] - cube.points[i]).norm());
  }
  EXPECT_GE(moved, 0.1);

  edit.moves[0].vector = Vec3(0, 0, 0.1);
  const Certificate no = EditSession(cube).apply(edit);
  EXPECT_EQ(no.outcome, Outcome::kConflicting);
  EXPECT_THAT(no.conflicting, UnorderedElementsAre("move[0]", "hold[0].plane"));
  ASSERT_EQ(no.conflicts.size(), 1u);
  EXPECT_EQ(no.conflicts[0].multipliers[0], Rational(1));
  EXPECT_NEAR(no.conflicts[0].residual, 0.1, 1e-15);
}

TEST(Holds, ASlantedPlaneCouplesTheAxes) {
  // The diagonal plane x = z holds points of the sides; they slide in it.
  const PatchModel cube = testing::paper_cube();
  Edit edit =
      edit_of(testing::move_by("front", {0.3, 0.3}, Vec3(0.1, 0.05, 0.1)), testing::whole_extent());
  edit.holds = {hold_plane(Vec3::Zero(), Vec3(1, 0, -1))};
  EditSession session(cube);
  const Certificate done = session.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  int held = 0;
  for (size_t i = 0; i < cube.points.size(); ++i) {
    if (std::abs(cube.points[i].x() - cube.points[i].z()) > 1e-12) continue;
    ++held;
    EXPECT_NEAR(session.model().points[i].x(), session.model().points[i].z(), 1e-14);
  }
  EXPECT_GE(held, 15);
  edit.method = Method::kAxis;
  const Certificate no = EditSession(cube).apply(edit);
  EXPECT_EQ(no.outcome, Outcome::kRefused);
  EXPECT_THAT(no.reason, HasSubstr("hold[0].plane couples the axes"));
}

TEST(Holds, APlaneWithoutPointsIsAMistake) {
  Edit edit = pull_top(Vec3(0, 0, 0.1));
  edit.holds = {hold_plane(Vec3(0, 0, 5), Vec3(0, 0, 1))};
  EditSession session(testing::paper_cube());
  EXPECT_THROW(session.apply(edit), InputError);
}

TEST(Holds, OneHoldTwiceIsRedundantAndHarmless) {
  const PatchModel cube = testing::paper_cube();
  Edit edit = pull_top(Vec3(0, 0, 0.2));
  edit.holds = {testing::hold_at("top", {0.6, 0.5})};
  EditSession once(cube);
  ASSERT_EQ(once.apply(edit).outcome, Outcome::kDone);
  edit.holds.push_back(edit.holds[0]);
  EditSession twice(cube);
  const Certificate done = twice.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  EXPECT_THAT(done.redundant, ElementsAre("hold[1]"));
  EXPECT_LE(testing::distance(once.model().points, twice.model().points), 1e-14);
}

// Three places on a straight line of a bilinear patch: the middle one follows from the others,
// though no two rows are alike. Rounding cannot see that exactly, fractions can.
TEST(Holds, DependenceThroughTheBasisIsExact) {
  const PatchModel cube = testing::prepared(testing::make_cube_model(1, 1));
  Edit edit =
      edit_of(testing::move_by("top", {0.25, 0.5}, Vec3(0, 0, 0.1)), testing::whole_extent());
  edit.moves.push_back(testing::move_by("top", {0.75, 0.5}, Vec3(0, 0, 0.3)));
  edit.moves.push_back(testing::move_by("top", {0.5, 0.5}, Vec3(0, 0, 0.2)));
  edit.volume.kind = VolumeGoal::Kind::kFree;
  const Certificate done = EditSession(cube).apply(edit);
  EXPECT_EQ(done.outcome, Outcome::kDone) << done.reason;
  EXPECT_EQ(done.redundant.size(), 1u);
  edit.moves[2].vector.z() = 0.21;
  const Certificate no = EditSession(cube).apply(edit);
  EXPECT_EQ(no.outcome, Outcome::kConflicting);
  EXPECT_THAT(no.conflicting, UnorderedElementsAre("move[0]", "move[1]", "move[2]"));
}

TEST(Holds, MirrorImagesOfConvertedBodiesStaySmooth) {
  for (int axis : {0, 1, 2}) {
    const PatchModel torus = testing::prepared(testing::make_rational_torus(3.0, 1.0));
    Edit edit = edit_of(testing::move_by("face:1", {0.6, 0.6}, Vec3(0.05, 0.1, 0.07)),
                        testing::whole_extent());
    edit.continuity = Continuity::kMeasured;
    edit.holds = {testing::hold_symmetry(axis)};
    EditSession session(torus);
    const Certificate done = session.apply(edit);
    ASSERT_EQ(done.outcome, Outcome::kDone) << axis << ": " << done.reason;
    EXPECT_LE(done.skin.change.angle_rad, 1e-12) << axis;
    EXPECT_GT(done.freedom_left, 5) << axis;
  }
}

TEST(Holds, SymmetryIsNamedWhenItIsInTheWay) {
  PatchModel cube = testing::make_cube_model(3, 7);
  testing::translate(cube, Vec3(-0.1, -0.5, -0.3));
  Edit edit =
      edit_of(testing::move_by("top", {0.3, 0.5}, Vec3(0, 0.1, 0)), testing::whole_extent());
  edit.holds = {testing::hold_symmetry(1)};
  const Certificate no = EditSession(testing::prepared(cube)).apply(edit);
  EXPECT_EQ(no.outcome, Outcome::kInfeasible);
  EXPECT_THAT(no.conflicting, ElementsAre("move[0]", "hold[0].symmetry"));
}

TEST(Holds, ContinuityEdgeByEdge) {
  const PatchModel torus = testing::prepared(testing::make_rational_torus(3.0, 1.0));
  ASSERT_EQ(torus.relations.size(), 8u);
  Edit edit =
      edit_of(testing::move_by("face:1", {4.0, 0.5}, Vec3(0.0, 0.1, 0.1)), testing::whole_extent());
  edit.continuity = Continuity::kMeasured;
  EditSession smooth(torus);
  const Certificate kept = smooth.apply(edit);
  ASSERT_EQ(kept.outcome, Outcome::kDone) << kept.reason;
  EXPECT_EQ(kept.skin.relations, 8);
  EXPECT_LE(kept.skin.change.angle_rad, 1e-12);
  edit.edge_continuity = {{{"face:1", "face:1"}, Continuity::kC0}};
  EditSession creased(torus);
  const Certificate done = creased.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  EXPECT_EQ(done.skin.relations, 6) << "both seams are let go, the knot lines are not";
  EXPECT_GE(done.joins.angle_change_rad, 1e-3);
  edit.edge_continuity = {{{"face:1", "face:2"}, Continuity::kC0}};
  EXPECT_THROW(EditSession(torus).apply(edit), InputError);
}

}  // namespace
}  // namespace isochor
