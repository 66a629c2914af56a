#include "isochor/edit/edit_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "edit/fixtures.h"
#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/volume/exact_volume.h"
#include "isochor/volume/volume_form.h"

namespace isochor {
namespace {

using ::testing::HasSubstr;

using testing::figure4;
using testing::paper_cube;
using testing::prepared;

double volume_of(const PatchModel& model) { return VolumeForm(model).value(model.points); }

class FigureFour : public ::testing::TestWithParam<Method> {};

TEST_P(FigureFour, KeepsTheVolumeAndReachesThePoint) {
  EditSession session(paper_cube());
  const Certificate done = session.apply(figure4(GetParam()));
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  EXPECT_TRUE(done.volume.kept);
  EXPECT_NEAR(volume_of(session.model()), 1.0, 1e-14);
  EXPECT_LE(std::abs(done.volume.relative_change), 1e-14);
  const Vec3 reached = session.model().surface(0).point(0.7, 0.8);
  EXPECT_LE((reached - Vec3(0.9, 1.0, 1.9)).norm(), 4e-15);
}

TEST_P(FigureFour, KeepsTheExactRationalVolume) {
  EditSession session(paper_cube());
  ASSERT_EQ(session.apply(figure4(GetParam())).outcome, Outcome::kDone);
  const Rational volume = ExactVolume(session.model()).value(session.model().points);
  EXPECT_LE(std::abs((volume - Rational(1)).to_double()), 1e-14);
}

TEST_P(FigureFour, WorksAtACoarseScale) {
  EditSession session(paper_cube());
  Edit edit = figure4(GetParam());
  edit.scale.kind = Scale::Kind::kEvery;
  edit.scale.every = 3;
  const Certificate done = session.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  EXPECT_NEAR(volume_of(session.model()), 1.0, 1e-14);
  EXPECT_LE((session.model().surface(0).point(0.7, 0.8) - Vec3(0.9, 1.0, 1.9)).norm(), 4e-15);
  EXPECT_LE(closure(session.model()).vector_area, 1e-15);
}

INSTANTIATE_TEST_SUITE_P(Methods, FigureFour, ::testing::Values(Method::kAxis, Method::kIsotropic));

TEST(EditSession, IsotropicIsEquivariantUnderRotation) {
  const Eigen::Matrix3d rotation =
      (Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()) * Eigen::AngleAxisd(-1.1, Vec3::UnitY()))
          .toRotationMatrix();
  EditSession straight(paper_cube());
  ASSERT_EQ(straight.apply(figure4(Method::kIsotropic)).outcome, Outcome::kDone);

  PatchModel turned = paper_cube();
  testing::transform(turned, rotation);
  EditSession session(turned);
  Edit edit = figure4(Method::kIsotropic);
  edit.moves[0].vector = rotation * edit.moves[0].vector;
  ASSERT_EQ(session.apply(edit).outcome, Outcome::kDone);
  double worst = 0.0;
  for (size_t i = 0; i < turned.points.size(); ++i) {
    const Vec3 expected = rotation * straight.model().points[i];
    worst = std::max(worst, (session.model().points[i] - expected).norm());
  }
  EXPECT_LE(worst, 1e-12);
}

TEST(EditSession, AxisDependsOnTheFrameButIsotropicIsSmaller) {
  EditSession axis(paper_cube());
  EditSession isotropic(paper_cube());
  const Certificate a = axis.apply(figure4(Method::kAxis));
  const Certificate b = isotropic.apply(figure4(Method::kIsotropic));
  EXPECT_LT(b.energy_after, a.energy_after);
  EXPECT_GT(b.energy_after, b.energy_before);  // keeping the volume costs something
}

TEST(EditSession, TaylorIsOnlyFirstOrderAndNeverSaysKept) {
  EditSession session(paper_cube());
  Edit edit = figure4(Method::kTaylor);
  edit.moves[0].vector *= 0.01;
  const Certificate small = session.apply(edit);
  ASSERT_EQ(small.outcome, Outcome::kDone);
  EXPECT_FALSE(small.volume.kept);
  EXPECT_LT(std::abs(small.volume.relative_change), 1e-4);
  EXPECT_GT(std::abs(small.volume.relative_change), 1e-9);
}

TEST(EditSession, VolumeTargets) {
  EditSession session(paper_cube());
  Edit edit = figure4(Method::kIsotropic);
  edit.moves[0].vector = Vec3(0, 0, 0.1);
  edit.volume = {VolumeGoal::Kind::kFactor, 1.01};
  ASSERT_EQ(session.apply(edit).outcome, Outcome::kDone);
  EXPECT_NEAR(volume_of(session.model()), 1.01, 1e-14);
  edit.volume = {VolumeGoal::Kind::kChange, -0.02};
  ASSERT_EQ(session.apply(edit).outcome, Outcome::kDone);
  EXPECT_NEAR(volume_of(session.model()), 0.99, 1e-14);
  edit.volume = {VolumeGoal::Kind::kKeep, 0.0};  // now means the last target
  edit.moves[0].vector = Vec3(0, 0, -0.1);
  ASSERT_EQ(session.apply(edit).outcome, Outcome::kDone);
  EXPECT_NEAR(volume_of(session.model()), 0.99, 1e-14);
  edit.volume = {VolumeGoal::Kind::kTarget, 1.0};
  ASSERT_EQ(session.apply(edit).outcome, Outcome::kDone);
  EXPECT_NEAR(session.volume(), 1.0, 1e-14);
}

TEST(EditSession, KeepDoesNotDriftOverManyEdits) {
  EditSession session(paper_cube());
  Edit edit = figure4(Method::kIsotropic);
  for (int k = 0; k < 12; ++k) {
    edit.moves[0].place.uv = {0.3 + 0.03 * k, 0.6 - 0.02 * k};
    edit.moves[0].vector = Vec3(0.02, -0.01, k % 2 == 0 ? 0.05 : -0.04);
    ASSERT_EQ(session.apply(edit).outcome, Outcome::kDone);
  }
  EXPECT_NEAR(volume_of(session.model()), 1.0, 2e-14);
}

TEST(EditSession, SeveralMovesAndHoldsTogether) {
  EditSession session(paper_cube());
  Edit edit = figure4(Method::kIsotropic);
  edit.extent.kind = Extent::Kind::kAll;
  edit.moves.push_back(edit.moves[0]);
  edit.moves[1].place.patch = "right";
  edit.moves[1].place.uv = {0.5, 0.5};
  edit.moves[1].relative = false;
  edit.moves[1].vector = Vec3(1.1, 0.5, 0.5);
  Hold hold;
  hold.place.patch = "top";
  hold.place.uv = {0.2, 0.2};
  edit.holds = {hold};
  const Certificate done = session.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  const PatchModel& model = session.model();
  EXPECT_LE((model.surface(0).point(0.2, 0.2) - Vec3(0.2, 0.2, 1.0)).norm(), 4e-15);
  EXPECT_LE((model.surface(0).point(0.7, 0.8) - Vec3(0.9, 1.0, 1.9)).norm(), 4e-15);
  EXPECT_LE(done.moves[1].error, 4e-15);
  EXPECT_NEAR(volume_of(model), 1.0, 2e-14);
}

TEST(EditSession, NearTakesTheClosestPointOfTheSurface) {
  EditSession session(paper_cube());
  Edit edit = figure4(Method::kIsotropic);
  edit.moves[0].place.kind = Place::Kind::kNear;
  edit.moves[0].place.near = Vec3(0.7, 0.8, 1.2);
  const Certificate done = session.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  EXPECT_LE((done.moves[0].from - Vec3(0.7, 0.8, 1.0)).norm(), 1e-12);
}

TEST(EditSession, SymmetryHoldKeepsTheMirrorImage) {
  PatchModel model = testing::make_cube_model(3, 8);
  testing::translate(model, Vec3(0.0, -0.5, 0.0));
  EditSession session(prepared(model));
  Edit edit = figure4(Method::kIsotropic);
  Hold hold;
  hold.kind = Hold::Kind::kSymmetry;
  hold.axis = 1;
  edit.holds = {hold};
  const Certificate done = session.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  const Surface top = session.model().surface(0);
  for (double u : {0.1, 0.5, 0.7}) {
    for (double v : {0.2, 0.33, 0.5}) {
      const Vec3 a = top.point(u, v);
      const Vec3 b = top.point(u, 1.0 - v);
      EXPECT_LE((a - Vec3(b.x(), -b.y(), b.z())).norm(), 1e-14);
    }
  }
  EXPECT_NEAR(volume_of(session.model()), 1.0, 1e-14);
}

TEST(EditSession, EdgeHoldKeepsTheEdge) {
  EditSession session(paper_cube());
  Edit edit = figure4(Method::kIsotropic);
  Hold hold;
  hold.kind = Hold::Kind::kEdge;
  hold.edge = {"top", "back"};
  edit.holds = {hold};
  ASSERT_EQ(session.apply(edit).outcome, Outcome::kDone);
  const PatchModel before = paper_cube();
  const PatchModel& after = session.model();
  for (int i = 0; i < before.patches[0].u_size(); ++i) {
    const int id = before.patches[0].point(i, before.patches[0].v_size() - 1);
    EXPECT_EQ(before.points[static_cast<size_t>(id)], after.points[static_cast<size_t>(id)]);
  }
}

TEST(EditSession, SinkInAnotherPlace) {
  EditSession session(paper_cube());
  Edit edit = figure4(Method::kIsotropic);
  edit.moves[0].vector = Vec3(0, 0, 0.2);
  edit.moves[0].place.uv = {0.5, 0.5};
  edit.extent.radius = 0.3;
  edit.sink.kind = Sink::Kind::kOtherExtent;
  edit.sink.extent.kind = Extent::Kind::kFaces;
  edit.sink.extent.faces = {"bottom"};
  ASSERT_EQ(session.apply(edit).outcome, Outcome::kDone);
  EXPECT_NEAR(volume_of(session.model()), 1.0, 1e-14);
  EXPECT_GT(session.model().surface(1).point(0.5, 0.5).z(), 1e-3);  // the bottom went up
}

TEST(EditSession, SinkAlongADirection) {
  EditSession session(paper_cube());
  Edit edit = figure4(Method::kIsotropic);
  edit.moves[0].vector = Vec3(0, 0, 0.2);
  edit.sink.kind = Sink::Kind::kDirection;
  edit.sink.direction = Vec3(0, 0, 2);
  ASSERT_EQ(session.apply(edit).outcome, Outcome::kDone);
  EXPECT_NEAR(volume_of(session.model()), 1.0, 1e-14);
  const PatchModel before = paper_cube();
  for (size_t i = 0; i < before.points.size(); ++i) {
    EXPECT_EQ(before.points[i].x(), session.model().points[i].x());
  }
}

TEST(EditSession, RefineAddsFreedomWithoutChangingTheShape) {
  EditSession session(prepared(testing::make_cube_model(3, 2)));
  Edit edit = figure4(Method::kIsotropic);
  edit.moves[0].vector = Vec3(0, 0, 0.1);
  edit.refine.kind = Refine::Kind::kSpans;
  edit.refine.spans = {10, 10};
  edit.extent.radius = 0.3;
  const Certificate done = session.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  EXPECT_NEAR(volume_of(session.model()), 1.0, 1e-14);
  EXPECT_EQ(session.model().patches[0].u_size(), 13);
  EXPECT_LE((session.model().surface(0).point(0.1, 0.1) - Vec3(0.1, 0.1, 1.0)).norm(), 1e-15);
  EXPECT_TRUE(session.moved_patches()[0]);
  EXPECT_FALSE(session.moved_patches()[1]);
}

TEST(EditSession, UndoRedoAndCancelRestoreEveryBit) {
  EditSession session(paper_cube());
  const std::vector<Vec3> first = session.model().points;
  ASSERT_EQ(session.apply(figure4(Method::kIsotropic)).outcome, Outcome::kDone);
  const std::vector<Vec3> second = session.model().points;
  EXPECT_NE(first, second);
  EXPECT_TRUE(session.undo());
  EXPECT_EQ(session.model().points, first);
  EXPECT_FALSE(session.undo());
  EXPECT_TRUE(session.redo());
  EXPECT_EQ(session.model().points, second);
  EXPECT_FALSE(session.redo());
  session.begin(figure4(Method::kAxis));
  EXPECT_NE(session.candidate().points, second);
  session.cancel();
  EXPECT_EQ(session.model().points, second);
}

TEST(EditSession, ADragDependsOnlyOnItsLastValue) {
  EditSession wandering(paper_cube());
  Edit edit = figure4(Method::kIsotropic);
  edit.moves[0].drag = {Vec3(0.1, 0, 0.3), Vec3(-0.5, 0.2, 0.1), Vec3(0.2, 0.2, 0.9)};
  ASSERT_EQ(wandering.apply(edit).outcome, Outcome::kDone);
  EditSession direct(paper_cube());
  ASSERT_EQ(direct.apply(figure4(Method::kIsotropic)).outcome, Outcome::kDone);
  EXPECT_EQ(wandering.model().points, direct.model().points);
}

TEST(EditSession, CancelledEditLeavesTheModel) {
  EditSession session(paper_cube());
  const std::vector<Vec3> before = session.model().points;
  CancelToken token;
  token.cancel();
  Edit edit = figure4(Method::kIsotropic);
  EXPECT_EQ(session.apply(edit, token).outcome, Outcome::kCancelled);
  EXPECT_EQ(session.model().points, before);
}

TEST(EditSession, ConvertedSurfacesStaySmoothUnlessC0IsAsked) {
  // A sphere is smooth across its seam and its knot lines only by the accident of its poles.
  Edit edit = figure4(Method::kIsotropic);
  edit.moves[0].place.patch = "face:1";
  edit.moves[0].place.normalised = true;
  edit.moves[0].place.uv = {0.25, 0.5};
  edit.moves[0].vector = Vec3(0.0, 0.05, 0.0);
  edit.extent.kind = Extent::Kind::kAll;
  edit.continuity = Continuity::kMeasured;
  EditSession session(prepared(testing::make_sphere(1.0)));
  const Certificate smooth = session.apply(edit);
  ASSERT_EQ(smooth.outcome, Outcome::kDone) << smooth.reason;
  EXPECT_LE(std::abs(smooth.volume.relative_change), 1e-13);
  EXPECT_GE(smooth.skin.change.knot_lines, 3);
  EXPECT_EQ(smooth.skin.change.poles, 2);
  EXPECT_LE(smooth.skin.change.angle_rad, 1e-12);
  EXPECT_TRUE(session.undo());
  edit.continuity = Continuity::kC0;
  const Certificate creased = session.apply(edit);
  EXPECT_EQ(creased.outcome, Outcome::kDone) << creased.reason;
  EXPECT_GE(creased.skin.change.angle_rad, 1e-3);
  EXPECT_LE(std::abs(creased.volume.relative_change), 1e-13);
}

// Errors and honest refusals.

TEST(EditSession, EmptyExtentIsInfeasible) {
  EditSession session(paper_cube());
  Edit edit = figure4(Method::kIsotropic);
  edit.extent.radius = 1e-6;
  const Certificate no = session.apply(edit);
  EXPECT_EQ(no.outcome, Outcome::kInfeasible);
  EXPECT_THAT(no.reason, HasSubstr("no free coefficient"));
  EXPECT_EQ(session.model().points, paper_cube().points);
}

TEST(EditSession, ExtentThatDoesNotMoveThePointIsInfeasible) {  // [S 4.3.2] case 1
  EditSession session(paper_cube());
  Edit edit = figure4(Method::kAxis);
  edit.extent.kind = Extent::Kind::kFaces;
  edit.extent.faces = {"bottom"};
  const Certificate no = session.apply(edit);
  EXPECT_EQ(no.outcome, Outcome::kInfeasible);
  EXPECT_THAT(no.conflicting, ::testing::ElementsAre("move[0]"));
}

TEST(EditSession, GradientThatVanishesIsNamed) {  // [S 4.3.2] case 2
  // Inside the flat top the volume does not depend on x, so the x-axis cannot compensate z.
  EditSession session(paper_cube());
  Edit edit = figure4(Method::kAxis);
  edit.moves[0].place.uv = {0.5, 0.5};
  edit.moves[0].vector = Vec3(0, 0, 0.2);
  edit.extent.radius = 0.25;
  edit.axis_order = {2, 1, 0};
  edit.volume = {VolumeGoal::Kind::kChange, 0.01};
  ASSERT_EQ(session.begin(edit).outcome, Outcome::kDone);  // z bulges, then x can act
  session.cancel();
  edit.moves.clear();
  edit.extent.kind = Extent::Kind::kBox;
  edit.extent.patch = "top";
  edit.extent.u = edit.extent.v = {0.3, 0.7};
  const Certificate no = session.apply(edit);
  EXPECT_EQ(no.outcome, Outcome::kInfeasible);
  EXPECT_THAT(no.reason, HasSubstr("no free coefficient changes it along x"));
}

TEST(EditSession, GradientDependentOnTheMoveIsNamed) {  // [S 4.3.2] case 3
  EditSession session(paper_cube());
  Edit edit = figure4(Method::kIsotropic);
  edit.moves[0].place = {};
  edit.moves[0].place.kind = Place::Kind::kCoefficient;
  edit.moves[0].place.patch = "top";
  edit.moves[0].place.i = 7;
  edit.moves[0].place.j = 7;
  edit.moves[0].vector = Vec3(0, 0, 0.1);
  edit.extent.kind = Extent::Kind::kPoles;
  edit.extent.poles["top"] = {{7, 7}};
  const Certificate no = session.apply(edit);
  EXPECT_EQ(no.outcome, Outcome::kInfeasible);
  EXPECT_THAT(no.conflicting, ::testing::Contains("volume"));
  EXPECT_THAT(no.reason, HasSubstr("constrained point"));
}

TEST(EditSession, ContradictingMovesAreNamed) {
  EditSession session(paper_cube());
  Edit edit = figure4(Method::kIsotropic);
  edit.moves.push_back(edit.moves[0]);
  edit.moves[1].vector = Vec3(0, 0, 0.5);
  const Certificate no = session.apply(edit);
  EXPECT_EQ(no.outcome, Outcome::kConflicting);
  EXPECT_THAT(no.conflicting, ::testing::UnorderedElementsAre("move[0]", "move[1]"));
}

TEST(EditSession, ARepeatedHoldIsRedundantAndHarmless) {
  EditSession session(paper_cube());
  Edit edit = figure4(Method::kIsotropic);
  Hold hold;
  hold.place.patch = "top";
  hold.place.uv = {0.5, 0.6};
  edit.holds = {hold, hold};
  const Certificate done = session.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  EXPECT_THAT(done.redundant, ::testing::ElementsAre("hold[1]"));
}

TEST(EditSession, OpenModelsAreRefusedUnlessOpenIsSaid) {
  PatchModel open = testing::make_cube_model(3, 12);
  open.patches.pop_back();
  open = prepared(open);
  EditSession session(open, {false, "side v0 of the rim", 0.0, 0.0});
  Edit edit = figure4(Method::kIsotropic);
  edit.moves[0].place.uv = {0.5, 0.5};
  edit.extent.radius = 0.3;
  const Certificate no = session.apply(edit);
  EXPECT_EQ(no.outcome, Outcome::kRefused);
  EXPECT_THAT(no.reason, HasSubstr("side v0 of the rim"));
  edit.open = true;
  EXPECT_EQ(session.apply(edit).outcome, Outcome::kDone);
}

TEST(EditSession, NamesAndParametersThatDoNotExist) {
  EditSession session(paper_cube());
  Edit edit = figure4(Method::kIsotropic);
  edit.moves[0].place.patch = "tpo";
  try {
    session.begin(edit);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("\"tpo\": no such patch; there are: face:1"));
  }
  edit = figure4(Method::kIsotropic);
  edit.moves[0].place.uv = {0.7, 1.8};
  try {
    session.begin(edit);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("move[0]: uv (0.7, 1.8) is outside the domain"));
  }
  EXPECT_EQ(session.model().points, paper_cube().points);
  EXPECT_EQ(session.apply(figure4(Method::kIsotropic)).outcome, Outcome::kDone);  // still usable
}

}  // namespace
}  // namespace isochor
