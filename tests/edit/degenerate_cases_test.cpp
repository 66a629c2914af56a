// What cannot be done, and why: the degenerate cases of Sauvage et al. 2008, 4.3.2, and others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "edit/fixtures.h"
#include "isochor/base/error.h"
#include "isochor/edit/edit_session.h"
#include "isochor/volume/volume_form.h"
#include "support/messages.h"

namespace isochor {
namespace {

using testing::ball;
using ::testing::Contains;
using testing::edit_of;
using ::testing::ElementsAre;
using testing::figure4;
using ::testing::HasSubstr;
using testing::move_by;
using testing::move_pole_by;
using ::testing::Not;
using testing::paper_cube;
using testing::whole_extent;

// The edit is not done and the session is as if it had never been asked.
Certificate failing(const PatchModel& model, const Edit& edit) {
  EditSession session(model);
  const Certificate no = session.apply(edit);
  EXPECT_NE(no.outcome, Outcome::kDone);
  EXPECT_EQ(session.model().points, model.points);
  EXPECT_FALSE(session.undo());
  EXPECT_FALSE(no.reason.empty());
  EXPECT_EQ(no.volume.after, no.volume.before);
  EXPECT_FALSE(no.volume.kept);
  return no;
}

Edit volume_only(double change, const Extent& extent, Method method) {
  Edit edit;
  edit.volume = {VolumeGoal::Kind::kChange, change};
  edit.extent = extent;
  edit.method = method;
  edit.continuity = Continuity::kC0;
  return edit;
}

class PaperCases : public ::testing::TestWithParam<Method> {};

TEST_P(PaperCases, FirstNothingMovesThePoint) {
  Edit edit = figure4(GetParam());
  edit.extent = testing::faces({"bottom"});
  const Certificate no = failing(paper_cube(), edit);
  EXPECT_EQ(no.outcome, Outcome::kInfeasible);
  EXPECT_THAT(no.conflicting, ElementsAre("move[0]"));
  EXPECT_THAT(no.reason,
              HasSubstr("no free coefficient of the extent moves what move[0] asks for"));
}

TEST_P(PaperCases, SecondNothingChangesTheVolume) {
  // One pole inside the flat top, along x: sliding in its plane.
  const Certificate no = failing(paper_cube(), [&] {
    Edit edit = volume_only(0.01, testing::poles("top", {{6, 6}}), Method::kIsotropic);
    edit.sink.kind = Sink::Kind::kDirection;
    edit.sink.direction = Vec3(1, 0, 0);
    edit.method = GetParam() == Method::kAxis ? Method::kIsotropic : GetParam();
    return edit;
  }());
  EXPECT_NE(no.outcome, Outcome::kConflicting);
  EXPECT_THAT(no.conflicting, ElementsAre("volume"));
  EXPECT_THAT(no.reason, HasSubstr("the gradient vanishes on the extent"));
}

TEST_P(PaperCases, ThirdTheVolumeAndThePointAreOneUnknown) {
  Edit edit = edit_of(move_pole_by("top", 7, 7, Vec3(0, 0, 0.1)), testing::poles("top", {{7, 7}}));
  edit.method = GetParam();
  const Certificate no = failing(paper_cube(), edit);
  EXPECT_EQ(no.outcome, Outcome::kInfeasible);
  EXPECT_THAT(no.conflicting, ElementsAre("move[0]", "volume"));
  EXPECT_THAT(no.reason, HasSubstr("also move a constrained point"));
}

INSTANTIATE_TEST_SUITE_P(Methods, PaperCases,
                         ::testing::Values(Method::kIsotropic, Method::kAxis, Method::kTaylor));

TEST(DegenerateCases, AReasonInTinyUnitsStillHasDigits) {
  PatchModel tiny = testing::make_cube_model(3, 12);
  testing::transform(tiny, 1e-6 * Eigen::Matrix3d::Identity());
  Edit edit = edit_of(move_pole_by("top", 7, 7, Vec3(0, 0, 1e-7)), testing::poles("top", {{7, 7}}));
  const Certificate no = failing(testing::prepared(tiny), edit);
  EXPECT_THAT(no.reason, HasSubstr("the volume is off by -"));
  EXPECT_THAT(no.reason, Not(HasSubstr("0.000000 ")));
}

TEST(DegenerateCases, AVanishingRowWithNothingToCompensateIsFine) {
  // Along x and y the flat top has no gradient, but pulling along z first needs none.
  Edit edit = edit_of(move_by("top", {0.5, 0.5}, Vec3(0.1, 0.0, 0.0)), ball(0.3));
  edit.method = Method::kAxis;
  EditSession session(paper_cube());
  const Certificate done = session.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  EXPECT_TRUE(done.volume.kept);
}

TEST(DegenerateCases, AnEmptyExtentSaysWhatLockedIt) {
  PatchModel model = paper_cube();
  for (int point : model.patches[0].points) model.lock(point, "the lid is welded", false);
  const Certificate no =
      failing(model, edit_of(move_by("top", {0.5, 0.5}, Vec3::UnitZ()), testing::faces({"top"})));
  EXPECT_EQ(no.outcome, Outcome::kInfeasible);
  EXPECT_THAT(no.reason,
              HasSubstr("the extent holds no free coefficient: the lid is welded; enlarge"));
  EXPECT_EQ(no.coefficients, 0);
}

TEST(DegenerateCases, AnEmptySinkIsNamed) {
  Edit edit = edit_of(move_by("top", {0.5, 0.5}, Vec3(0, 0, 0.1)), ball(0.3));
  edit.sink.kind = Sink::Kind::kOtherExtent;
  edit.sink.extent = testing::poles("bottom", {});
  const Certificate no = failing(paper_cube(), edit);
  EXPECT_EQ(no.outcome, Outcome::kInfeasible);
  EXPECT_THAT(no.reason, HasSubstr("choose another sink"));
  EXPECT_THAT(no.conflicting, Contains("volume"));
}

TEST(DegenerateCases, ACorrectionLargerThanTheModelIsNotDone) {
  // Five times the volume out of one pole.
  const Certificate no =
      failing(paper_cube(), volume_only(5.0, testing::poles("top", {{6, 6}}), Method::kIsotropic));
  EXPECT_EQ(no.outcome, Outcome::kUndecided);
  EXPECT_THAT(no.reason, HasSubstr("more than the size of the model"));
}

TEST(DegenerateCases, NearlyDependentMovesAreNotSolvedByBrutality) {
  // Two points a hair apart that should part: possible on paper, absurd on a model.
  Edit edit = edit_of(move_by("top", {0.5, 0.5}, Vec3(0, 0, 0.1)), whole_extent());
  edit.moves.push_back(move_by("top", {0.5 + 1e-7, 0.5}, Vec3(0, 0, -0.1)));
  const Certificate no = failing(paper_cube(), edit);
  EXPECT_EQ(no.outcome, Outcome::kUndecided) << no.reason;
}

TEST(DegenerateCases, ContradictionsWithHolds) {
  Edit edit = edit_of(move_by("top", {0.5, 0.5}, Vec3(0, 0, 0.1)), whole_extent());
  edit.holds = {testing::hold_at("top", {0.2, 0.2}), testing::hold_at("top", {0.5, 0.5})};
  const Certificate no = failing(paper_cube(), edit);
  EXPECT_EQ(no.outcome, Outcome::kConflicting);
  EXPECT_THAT(no.conflicting, ::testing::UnorderedElementsAre("move[0]", "hold[1]"));
}

TEST(DegenerateCases, AMoveOfAHeldEdgeIsInfeasible) {
  Edit edit = edit_of(move_by("top", {0.5, 1.0}, Vec3(0, 0, 0.1)), whole_extent());
  edit.holds = {testing::hold_edge("top", "back")};
  const Certificate no = failing(paper_cube(), edit);
  EXPECT_EQ(no.outcome, Outcome::kInfeasible);
  EXPECT_THAT(no.conflicting, ElementsAre("move[0]", "hold[0].edge"));
}

TEST(DegenerateCases, RefusalsBeforeAnythingIsTried) {
  const auto reason = [](const Edit& edit) {
    const Certificate no = failing(paper_cube(), edit);
    EXPECT_EQ(no.outcome, Outcome::kRefused);
    return no.reason;
  };
  Edit edit = figure4(Method::kAxis);
  edit.sink.kind = Sink::Kind::kDirection;
  edit.sink.direction = Vec3::UnitZ();
  EXPECT_THAT(reason(edit), HasSubstr("a sink along a direction needs the method \"isotropic\""));
  edit = Edit{};
  EXPECT_THAT(reason(edit), HasSubstr("the edit moves nothing and asks for no other volume"));
  edit.volume.kind = VolumeGoal::Kind::kFree;
  EXPECT_THAT(reason(edit), HasSubstr("moves nothing"));
}

TEST(DegenerateCases, ADirectionThatIsNoneIsBadInput) {
  EditSession session(paper_cube());
  Edit edit = figure4();
  edit.sink.kind = Sink::Kind::kDirection;
  EXPECT_THAT(testing::message_of<InputError>([&] { session.apply(edit); }),
              HasSubstr("sink: the direction is zero"));
  EXPECT_EQ(session.apply(figure4()).outcome, Outcome::kDone);
}

// Goals of the volume without any move.
TEST(DegenerateCases, VolumeGoalsAloneAreMet) {
  for (Method method : {Method::kIsotropic, Method::kAxis}) {
    EditSession session(testing::small_cube());
    Edit edit = volume_only(0.1, whole_extent(), method);
    EXPECT_TRUE(session.apply(edit).volume.kept);
    EXPECT_NEAR(session.volume(), 1.1, 1e-14);
    edit.volume = {VolumeGoal::Kind::kFactor, 0.5};
    EXPECT_TRUE(session.apply(edit).volume.kept);
    EXPECT_NEAR(session.volume(), 0.55, 1e-14);
    edit.volume = {VolumeGoal::Kind::kTarget, 2.0};
    EXPECT_TRUE(session.apply(edit).volume.kept);
    const PatchModel& model = session.model();
    EXPECT_NEAR(VolumeForm(model).value(model.points), 2.0, 1e-13);
    EXPECT_NEAR(session.volume(), 2.0, 1e-15);
  }
}

TEST(DegenerateCases, KeepAfterAFreeEditReturnsToTheReference) {
  EditSession session(paper_cube());
  Edit edit = figure4();
  edit.volume.kind = VolumeGoal::Kind::kFree;
  ASSERT_EQ(session.apply(edit).outcome, Outcome::kDone);
  EXPECT_GT(session.volume(), 1.02);
  edit = edit_of(move_by("bottom", {0.5, 0.5}, Vec3(0, 0, 0.01)), testing::faces({"bottom"}));
  const Certificate back = session.apply(edit);
  ASSERT_EQ(back.outcome, Outcome::kDone) << back.reason;
  EXPECT_NEAR(session.volume(), 1.0, 1e-14) << "the volume at the start of the session";
  EXPECT_LT(back.volume.wanted_change, -0.02);
}

}  // namespace
}  // namespace isochor
