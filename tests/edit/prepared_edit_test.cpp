// Places, holds, refinement and sinks: what an edit means on a model, and what it says when it
// means nothing.
#include "isochor/edit/prepared_edit.h"
#include "isochor/edit/edit_refinement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "edit/fixtures.h"
#include "isochor/base/error.h"
#include "isochor/edit/edit_session.h"
#include "isochor/edit/extent_selection.h"
#include "support/messages.h"

namespace isochor {
namespace {

using ::testing::AllOf;
using testing::ball;
using testing::edit_of;
using testing::figure4;
using ::testing::HasSubstr;
using testing::message_of;
using testing::move_by;
using testing::move_pole_by;
using testing::paper_cube;
using testing::prepared;
using testing::small_cube;
using testing::whole_extent;

std::string refusal_of(const PatchModel& model, const Edit& edit) {
  return message_of<InputError>([&] { PreparedEdit refused(refined_for(model, edit), edit); });
}

// A cube over [0, 2] x [0, 1] x [0, 1] in parameters and space, off the unit domain.
PatchModel long_box() {
  return prepared(testing::make_box_model(KnotVector::uniform(3, 4, 0.0, 2.0),
                                          KnotVector::uniform(3, 4), KnotVector::uniform(3, 4)));
}

TEST(PreparedEdit, OnePlaceInFourNotations) {
  const PatchModel model = long_box();
  Edit edit = edit_of(move_by("top", {0.5, 0.25}, Vec3::UnitZ()), ball(0.4));
  const PreparedEdit by_uv(model, edit);
  const ResolvedPlace& place = by_uv.moves()[0];
  EXPECT_EQ(place.text, "face:1 (\"top\") at uv (0.5, 0.25)");
  EXPECT_EQ(place.patch, 0);
  EXPECT_LE((place.position - Vec3(0.5, 0.25, 1.0)).norm(), 1e-15);

  edit.moves[0].place.normalised = true;
  edit.moves[0].place.uv = {0.25, 0.25};
  EXPECT_EQ(PreparedEdit(model, edit).moves()[0].text, place.text);

  edit.moves[0].place.kind = Place::Kind::kNear;
  edit.moves[0].place.near = Vec3(0.5, 0.25, 1.3);
  const PreparedEdit near(model, edit);
  EXPECT_LE((near.moves()[0].position - place.position).norm(), 1e-12);
  EXPECT_EQ(near.moves()[0].patch, 0);

  edit.moves[0] = move_pole_by("face:1", 2, 1, Vec3::UnitZ());
  const PreparedEdit pole(model, edit);
  EXPECT_EQ(pole.moves()[0].text, "face:1 (\"top\") pole [2, 1]");
  EXPECT_EQ(pole.moves()[0].position,
            model.points[static_cast<size_t>(model.patches[0].point(2, 1))]);
}

TEST(PreparedEdit, ByAndToMeanTheSameMove) {
  const PatchModel model = long_box();
  Edit edit = edit_of(move_by("top", {0.5, 0.25}, Vec3(0.1, 0.2, 0.3)), ball(0.4));
  const PreparedEdit by(model, edit);
  edit.moves[0].relative = false;
  edit.moves[0].vector = Vec3(0.6, 0.45, 1.3);
  const PreparedEdit to(model, edit);
  EXPECT_EQ(by.displacement(0, Vec3(1, 2, 3)), Vec3(1, 2, 3));
  EXPECT_LE((to.displacement(0, edit.moves[0].vector) - Vec3(0.1, 0.2, 0.3)).norm(), 1e-15);
}

TEST(PreparedEdit, PlacesThatDoNotExistAreNamed) {
  const PatchModel model = long_box();
  const auto message = [&](const Move& move) {
    return refusal_of(model, edit_of(move, whole_extent()));
  };
  EXPECT_THAT(message(move_by("tpo", {0, 0}, Vec3::UnitZ())),
              HasSubstr("patch \"tpo\": no such patch; there are: face:1 (\"top\")"));
  EXPECT_THAT(message(move_by("top", {2.5, 0.5}, Vec3::UnitZ())),
              HasSubstr("move[0]: uv (2.5, 0.5) is outside the domain [0, 2] x [0, 1] of face:1"));
  EXPECT_THAT(message(move_by("top", {std::nan(""), 0.5}, Vec3::UnitZ())),
              HasSubstr("is outside the domain"));
  Move move = move_by("top", {1.5, 0.5}, Vec3::UnitZ());
  move.place.normalised = true;
  EXPECT_THAT(message(move), HasSubstr("uv01 (1.5, 0.5) is outside [0, 1] x [0, 1]"));
  for (const auto& [i, j] : {std::pair<int, int>{7, 0}, {0, 7}, {-1, 0}, {0, -1}}) {
    EXPECT_THAT(message(move_pole_by("top", i, j, Vec3::UnitZ())),
                HasSubstr("pole [" + std::to_string(i) + ", " + std::to_string(j) +
                          "] is outside the grid of 7 x 7 coefficients of the chosen scale"));
  }
}

TEST(PreparedEdit, PlacesThatAreTrimmedAwayAreNamed) {
  PatchModel model = long_box();
  TrimRegion& trim = model.patches[0].trim;
  trim.loops = {{{0.2, 0.2}, {1.8, 0.2}, {1.8, 0.8}, {0.2, 0.8}, {0.2, 0.2}}};
  trim.boundary = {{0.2, 1.8, 0.2, 0.2}};
  const Edit outside = edit_of(move_by("top", {0.1, 0.1}, Vec3::UnitZ()), whole_extent());
  EXPECT_THAT(
      refusal_of(model, outside),
      HasSubstr("move[0]: uv (0.1, 0.1) lies in a part of face:1 (\"top\") that is trimmed"));
  EXPECT_EQ(refusal_of(model, edit_of(move_by("top", {0.5, 0.5}, Vec3::UnitZ()), whole_extent())),
            "no error");
}

TEST(PreparedEdit, CoarseCoefficientsMoveByButNotTo) {
  const PatchModel model = paper_cube();
  Edit edit = edit_of(move_pole_by("top", 2, 3, Vec3(0, 0, 0.1)), whole_extent());
  edit.scale = testing::every(3);
  EditSession session(model);
  const Certificate done = session.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  EXPECT_LE(done.moves[0].error, 1e-15);
  edit.moves[0].relative = false;
  EXPECT_THAT(refusal_of(model, edit), HasSubstr("move[0]: a coefficient of a coarser scale"));
  edit.moves[0].place.i = 7;  // the coarse grid has 3 + 4 functions
  edit.moves[0].relative = true;
  EXPECT_THAT(refusal_of(model, edit), HasSubstr("grid of 7 x 7"));
}

TEST(PreparedEdit, AMoveOfAJoinMovesBothSides) {
  EditSession session(paper_cube());
  const Vec3 by(0.05, 0.1, 0.15);
  const Certificate done = session.apply(edit_of(move_by("top", {0.4, 1.0}, by), ball(0.4)));
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  // "back" carries (z, x): the same point of the edge.
  const Vec3 there = session.model().surface(4).point(1.0, 0.4);
  EXPECT_LE((there - (Vec3(0.4, 1.0, 1.0) + by)).norm(), 4e-15);
  EXPECT_LE(done.joins.max_gap, 1e-15);
}

TEST(PreparedEdit, MovesOfOnePointByItsTwoFacesAgreeOrConflict) {
  EditSession session(paper_cube());
  Edit edit = edit_of(move_by("top", {0.4, 1.0}, Vec3(0.05, 0.1, 0.15)), ball(0.4));
  edit.moves.push_back(move_by("back", {1.0, 0.4}, Vec3(0.05, 0.1, 0.15)));
  const Certificate same = session.apply(edit);
  ASSERT_EQ(same.outcome, Outcome::kDone) << same.reason;
  EXPECT_THAT(same.redundant, ::testing::ElementsAre("move[1]"));
  session.undo();
  edit.moves[1].vector.x() += 1e-6;
  const Certificate torn = session.apply(edit);
  EXPECT_EQ(torn.outcome, Outcome::kConflicting);
  EXPECT_THAT(torn.reason, HasSubstr("move[0], move[1]"));
}

// "to" the place where a point is already, in other digits: rounding is no contradiction.
TEST(PreparedEdit, RoundingOfAPositionIsNoWish) {
  const PatchModel model = testing::bent_cube(51);
  const Surface top = model.surface(0);
  const Uv uv{0.37, 0.61};
  Edit edit = edit_of(move_by("top", uv, top.point(uv.u, uv.v)), whole_extent());
  edit.moves[0].relative = false;
  edit.moves[0].vector.y() = std::nextafter(edit.moves[0].vector.y(), 10.0);
  edit.holds = {testing::hold_at("top", uv)};
  edit.volume = {VolumeGoal::Kind::kChange, 0.01};
  EditSession session(model);
  const Certificate done = session.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  EXPECT_LE(done.moves[0].error, 1e-15);
}

TEST(PreparedEdit, EdgeHoldsKeepTheWholeCurve) {
  EditSession session(prepared(testing::make_periodic_torus(3, 3, 9, 9)));
  const Surface before = session.model().surface(0);
  Edit edit = edit_of(move_by("torus", {4.5, 4.5}, Vec3(0.1, 0.0, 0.2)), whole_extent());
  edit.holds = {testing::hold_edge("torus", "torus")};  // the two seams
  const Certificate done = session.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  const Surface after = session.model().surface(0);
  for (double t = 0.0; t <= 9.0; t += 0.375) {
    EXPECT_EQ(after.point(0.0, t), before.point(0.0, t)) << t;
    EXPECT_EQ(after.point(t, 0.0), before.point(t, 0.0)) << t;
  }
  EXPECT_TRUE(std::any_of(done.locked.begin(), done.locked.end(), [](const LockRecord& lock) {
    return lock.reason == "hold[0].edge keeps the edge";
  }));
}

TEST(PreparedEdit, HoldsThatMeanNothingAreNamed) {
  const PatchModel model = small_cube();
  Edit edit = edit_of(move_by("top", {0.5, 0.5}, Vec3::UnitZ()), whole_extent());
  edit.holds = {testing::hold_edge("top", "bottom")};
  EXPECT_THAT(refusal_of(model, edit),
              HasSubstr("hold[0].edge: \"top\" and \"bottom\" share no edge"));
  edit.holds = {testing::hold_at("top", {0.1, 0.1}), testing::hold_edge("top", "lid")};
  EXPECT_THAT(refusal_of(model, edit), HasSubstr("\"lid\": no such patch"));
  edit.holds = {testing::hold_at("top", {0.1, 0.1}), testing::hold_at("top", {0.1, 1.1})};
  EXPECT_THAT(refusal_of(model, edit), HasSubstr("hold[1]: uv (0.1, 1.1) is outside"));
  edit.holds = {testing::hold_symmetry(0), testing::hold_symmetry(1)};
  EXPECT_THAT(refusal_of(model, edit),
              HasSubstr("hold: one plane of symmetry per edit is supported, 2 were given"));
  edit.holds = {testing::hold_symmetry(0)};
  EXPECT_THAT(refusal_of(model, edit), HasSubstr("hold symmetry \"x\""));
}

TEST(PreparedEdit, ASinkThatIsTheExtentIsTheDefault) {
  EditSession usual(paper_cube());
  EditSession named(paper_cube());
  Edit edit = figure4();
  ASSERT_EQ(usual.apply(edit).outcome, Outcome::kDone);
  edit.sink.kind = Sink::Kind::kOtherExtent;
  edit.sink.extent = edit.extent;
  ASSERT_EQ(named.apply(edit).outcome, Outcome::kDone);
  EXPECT_EQ(usual.model().points, named.model().points);
}

TEST(PreparedEdit, ASinkElsewhereLeavesTheMoveToItsExtent) {
  const PatchModel cube = paper_cube();
  for (Method method : {Method::kIsotropic, Method::kAxis}) {
    Edit edit = edit_of(move_by("top", {0.5, 0.5}, Vec3(0, 0, 0.1)), ball(0.3));
    edit.method = method;
    edit.volume.kind = VolumeGoal::Kind::kFree;
    EditSession free(cube);
    ASSERT_EQ(free.apply(edit).outcome, Outcome::kDone);
    edit.volume.kind = VolumeGoal::Kind::kKeep;
    edit.sink.kind = Sink::Kind::kOtherExtent;
    edit.sink.extent = testing::faces({"bottom"});
    EditSession kept(cube);
    const Certificate done = kept.apply(edit);
    ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
    EXPECT_TRUE(done.volume.kept);
    std::set<int> bottom(cube.patches[1].points.begin(), cube.patches[1].points.end());
    for (int i = 0; i < static_cast<int>(cube.points.size()); ++i) {
      const auto at = static_cast<size_t>(i);
      if (bottom.count(i) == 0) {
        EXPECT_LE((free.model().points[at] - kept.model().points[at]).norm(), 1e-15);
      }
    }
  }
}

}  // namespace
}  // namespace isochor
