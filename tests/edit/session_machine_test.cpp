// EditSession as a state machine: random calls beside a list of snapshots, compared bit by bit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "edit/fixtures.h"
#include "isochor/base/error.h"
#include "isochor/edit/edit_session.h"
#include "isochor/volume/volume_form.h"
#include "support/messages.h"
#include "support/splines.h"

namespace isochor {
namespace {

using testing::ball;
using testing::edit_of;
using testing::figure4;
using ::testing::HasSubstr;
using testing::message_of;
using testing::move_by;
using testing::paper_cube;
using testing::small_cube;

// What an undo must bring back.
struct Snapshot {
  std::vector<Vec3> points;
  std::vector<bool> moved;
  double volume = 0.0;
  friend bool operator==(const Snapshot& a, const Snapshot& b) {
    return a.points == b.points && a.moved == b.moved && a.volume == b.volume;
  }
};

Snapshot snapshot_of(const EditSession& session) {
  return {session.model().points, session.moved_patches(), session.volume()};
}

// The specification: commits in a list, and how many of them are in force.
class Machine {
 public:
  Machine(PatchModel model, std::uint32_t seed) : session_(std::move(model)), random_(seed) {
    history_.push_back(snapshot_of(session_));
  }

  void step() {
    switch (std::uniform_int_distribution<int>(0, 6)(random_)) {
      case 0:
      case 1:
        begin();
        break;
      case 2:
        drag();
        break;
      case 3:
        commit();
        break;
      case 4:
        session_.cancel();
        active_.reset();
        break;
      case 5:
        undo_or_redo(true);
        break;
      case 6:
        undo_or_redo(false);
        break;
    }
    check();
  }

  int commits() const { return commits_; }
  int failures() const { return failures_; }

 private:
  Vec3 random_vector() { return 0.1 * testing::random_points(random_, 1).front(); }

  Edit random_edit() {
    const char* const names[] = {"top", "bottom", "right", "left", "back", "front"};
    const int patch = std::uniform_int_distribution<int>(0, 5)(random_);
    Edit edit = edit_of(
        move_by(names[patch],
                {testing::uniform(random_, 0.1, 0.9), testing::uniform(random_, 0.1, 0.9)},
                random_vector()),
        ball(testing::uniform(random_, -0.3, 1.0)));  // a small ball holds nothing: infeasible
    edit.method = Method(std::uniform_int_distribution<int>(0, 2)(random_));
    if (testing::uniform(random_, 0.0, 1.0) < 0.2) edit.volume.kind = VolumeGoal::Kind::kFree;
    return edit;
  }

  void begin() {
    const Edit edit = random_edit();
    if (active_) {
      EXPECT_THROW(session_.begin(edit), PreconditionError);
      return;
    }
    active_ = session_.begin(edit).outcome;
    failures_ += active_ != Outcome::kDone;
  }

  void drag() {
    if (!active_) {
      EXPECT_THROW(session_.drag({random_vector()}), PreconditionError);
      return;
    }
    active_ = session_.drag({random_vector()}).outcome;
  }

  void commit() {
    if (active_ != Outcome::kDone) {
      EXPECT_THROW(session_.commit(), PreconditionError);
      return;
    }
    const std::vector<Vec3> promised = session_.candidate().points;
    EXPECT_EQ(session_.commit().outcome, Outcome::kDone);
    EXPECT_EQ(session_.model().points, promised);
    active_.reset();
    history_.resize(now_ + 1);
    history_.push_back(snapshot_of(session_));
    ++now_;
    ++commits_;
  }

  void undo_or_redo(bool undo) {
    const auto call = [&] { return undo ? session_.undo() : session_.redo(); };
    if (active_) {
      EXPECT_THROW(call(), PreconditionError);
      return;
    }
    const bool possible = undo ? now_ > 0 : now_ + 1 < history_.size();
    EXPECT_EQ(call(), possible);
    if (possible) now_ += undo ? -1 : 1;
  }

  void check() {
    EXPECT_TRUE(snapshot_of(session_) == history_[now_]);
    // Without a result the candidate is the last commit.
    if (active_ != Outcome::kDone) {
      EXPECT_EQ(session_.candidate().points, history_[now_].points);
    }
  }

  EditSession session_;
  std::mt19937 random_;
  std::vector<Snapshot> history_;
  size_t now_ = 0;
  std::optional<Outcome> active_;
  int commits_ = 0;
  int failures_ = 0;
};

TEST(SessionMachine, RandomCallsFollowTheListOfSnapshots) {
  for (std::uint32_t seed : {1u, 2u, 3u}) {
    Machine machine(small_cube(2, 4), seed);
    for (int k = 0; k < 150 && !::testing::Test::HasFailure(); ++k) machine.step();
    EXPECT_GT(machine.commits(), 5) << "seed " << seed;
    EXPECT_GT(machine.failures(), 0) << "seed " << seed;
  }
}

TEST(SessionMachine, ACandidateIsAlwaysAWholeModel) {
  EditSession session(paper_cube());
  Edit edit = figure4();
  edit.extent = testing::faces({"bottom"});  // cannot move the point of the top
  ASSERT_EQ(session.begin(edit).outcome, Outcome::kInfeasible);
  EXPECT_EQ(session.candidate().points, session.model().points);
  EXPECT_EQ(session.candidate().patches.size(), 6u);
}

TEST(SessionMachine, AFailedDragForgetsTheOneBefore) {
  EditSession session(paper_cube());
  Edit edit = figure4();
  edit.moves.push_back(move_by("top", {0.7, 0.8}, Vec3(0.2, 0.2, 0.9)));
  ASSERT_EQ(session.begin(edit).outcome, Outcome::kDone);
  ASSERT_EQ(session.drag({Vec3(0, 0, 0.1), Vec3(0, 0, 0.2)}).outcome, Outcome::kConflicting);
  EXPECT_EQ(session.candidate().points, session.model().points);
  EXPECT_THROW(session.commit(), PreconditionError);
  ASSERT_EQ(session.drag({Vec3(0, 0, 0.1), Vec3(0, 0, 0.1)}).outcome, Outcome::kDone);
  EXPECT_NE(session.candidate().points, session.model().points);
}

TEST(SessionMachine, DraggingBackToZeroRestoresEveryBit) {
  for (Method method : {Method::kIsotropic, Method::kAxis, Method::kTaylor}) {
    EditSession session(paper_cube());
    const std::vector<Vec3> before = session.model().points;
    ASSERT_EQ(session.begin(figure4(method)).outcome, Outcome::kDone);
    ASSERT_NE(session.candidate().points, before);
    const Certificate back = session.drag({Vec3::Zero()});
    ASSERT_EQ(back.outcome, Outcome::kDone) << back.reason;
    EXPECT_EQ(session.candidate().points, before);
    EXPECT_EQ(back.poles_moved, 0);
    EXPECT_EQ(back.patches_moved, 0);
    EXPECT_EQ(back.max_distance, 0.0);
    EXPECT_EQ(back.volume.relative_change, 0.0);
  }
}

TEST(SessionMachine, TheWrongNumberOfValuesChangesNothing) {
  EditSession session(paper_cube());
  ASSERT_EQ(session.begin(figure4()).outcome, Outcome::kDone);
  const std::vector<Vec3> candidate = session.candidate().points;
  EXPECT_THROW(session.drag({}), PreconditionError);
  EXPECT_THROW(session.drag({Vec3::Zero(), Vec3::Zero()}), PreconditionError);
  EXPECT_EQ(session.candidate().points, candidate);
  EXPECT_EQ(session.commit().moves.size(), 1u) << "the last good drag is still the one";
}

TEST(SessionMachine, NumbersThatAreNoNumbersAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EditSession session(paper_cube());
  for (double bad : {nan, infinity}) {
    for (VolumeGoal::Kind goal : {VolumeGoal::Kind::kKeep, VolumeGoal::Kind::kFree}) {
      Edit edit = figure4();
      edit.volume.kind = goal;
      edit.moves[0].vector.y() = bad;
      EXPECT_THAT(message_of<InputError>([&] { session.apply(edit); }),
                  HasSubstr("move[0]: the vector"));
      edit = figure4();
      edit.moves[0].drag = {Vec3(0, 0, 0.1), Vec3(bad, 0, 0)};
      EXPECT_THAT(message_of<InputError>([&] { session.apply(edit); }), HasSubstr("is not finite"));
    }
    Edit edit = figure4();
    edit.volume = {VolumeGoal::Kind::kTarget, bad};
    EXPECT_THAT(message_of<InputError>([&] { session.apply(edit); }), HasSubstr("volume: "));
    ASSERT_EQ(session.begin(figure4()).outcome, Outcome::kDone) << "nothing is under way";
    EXPECT_THROW(session.drag({Vec3(0, bad, 0)}), InputError);
    EXPECT_EQ(session.drag({Vec3(0, 0, 0.1)}).outcome, Outcome::kDone);
    session.cancel();
  }
  EXPECT_EQ(session.model().points, paper_cube().points);
}

TEST(SessionMachine, CancellingWithoutAnEditIsAllowed) {
  EditSession session(paper_cube());
  session.cancel();
  EXPECT_FALSE(session.undo());
  EXPECT_FALSE(session.redo());
  EXPECT_EQ(&session.candidate(), &session.model());
}

TEST(SessionMachine, ANewCommitDropsWhatWasUndone) {
  EditSession session(small_cube());
  const Edit up = edit_of(move_by("top", {0.5, 0.5}, Vec3(0, 0, 0.1)), ball(0.6));
  Edit down = up;
  down.moves[0].vector *= -1.0;
  ASSERT_EQ(session.apply(up).outcome, Outcome::kDone);
  ASSERT_TRUE(session.undo());
  ASSERT_EQ(session.apply(down).outcome, Outcome::kDone);
  EXPECT_FALSE(session.redo());
  ASSERT_TRUE(session.undo());
  EXPECT_EQ(session.model().points, small_cube().points);
}

TEST(SessionMachine, UndoTakesBackRefinementAndMovedPatches) {
  EditSession session(small_cube());
  Edit edit = edit_of(move_by("top", {0.5, 0.5}, Vec3(0, 0, 0.1)), ball(0.3));
  edit.refine.kind = Refine::Kind::kSpans;
  edit.refine.spans = {8, 8};
  ASSERT_EQ(session.apply(edit).outcome, Outcome::kDone);
  EXPECT_EQ(session.model().patches[0].u_knots.spans().size(), 8u);
  EXPECT_TRUE(session.moved_patches()[0]);
  ASSERT_TRUE(session.undo());
  EXPECT_EQ(session.model().patches[0].u_knots, small_cube().patches[0].u_knots);
  EXPECT_EQ(session.moved_patches(), std::vector<bool>(6, false));
  ASSERT_TRUE(session.redo());
  EXPECT_EQ(session.model().patches[0].u_knots.spans().size(), 8u);
}

TEST(SessionMachine, MovingTakesTheWholeStateAlong) {
  EditSession first(small_cube());
  const Edit up = edit_of(move_by("top", {0.5, 0.5}, Vec3(0, 0, 0.1)), ball(0.6));
  ASSERT_EQ(first.apply(up).outcome, Outcome::kDone);
  const std::vector<Vec3> points = first.model().points;
  EditSession second(std::move(first));
  EXPECT_EQ(second.model().points, points);
  EXPECT_TRUE(second.undo());
  EditSession third(small_cube(3, 3));
  third = std::move(second);
  EXPECT_EQ(third.model().points, small_cube().points);
  EXPECT_TRUE(third.redo());
}

// A token may be raised between two drag steps; what was committed before stays.
TEST(SessionMachine, ACancelledEditKeepsTheHistory) {
  EditSession session(small_cube());
  const Edit up = edit_of(move_by("top", {0.5, 0.5}, Vec3(0, 0, 0.1)), ball(0.6));
  ASSERT_EQ(session.apply(up).outcome, Outcome::kDone);
  const std::vector<Vec3> points = session.model().points;
  const CancelToken token;
  token.cancel();
  Edit path = up;
  path.moves[0].drag = {Vec3(0, 0, 0.1), Vec3(0, 0, 0.2)};
  const Certificate no = session.apply(path, token);
  EXPECT_EQ(no.outcome, Outcome::kCancelled);
  EXPECT_THAT(no.reason, HasSubstr("cancelled"));
  EXPECT_EQ(session.model().points, points);
  EXPECT_EQ(session.apply(path).outcome, Outcome::kDone);
  EXPECT_TRUE(session.undo());
  EXPECT_EQ(session.model().points, points);
}

TEST(SessionMachine, TwoHundredEditsHoldTheVolume) {
  std::mt19937 random(61);
  EditSession session(small_cube(2, 3));
  int done = 0;
  for (int k = 0; k < 200; ++k) {
    const char* const patch = k % 2 == 0 ? "top" : "right";
    const Vec3 by = 0.03 * testing::random_points(random, 1).front();
    const Edit edit = edit_of(
        move_by(patch, {testing::uniform(random, 0.2, 0.8), testing::uniform(random, 0.2, 0.8)},
                by),
        ball(0.5));
    const Certificate certificate = session.apply(edit);
    done += certificate.outcome == Outcome::kDone;
    EXPECT_TRUE(certificate.outcome != Outcome::kDone || certificate.volume.kept) << k;
  }
  EXPECT_GT(done, 190);
  const PatchModel& model = session.model();
  EXPECT_NEAR(VolumeForm(model).value(model.points), 1.0, 4e-15);
  EXPECT_NEAR(session.volume(), 1.0, 4e-15);
}

}  // namespace
}  // namespace isochor
