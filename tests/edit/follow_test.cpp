#include "isochor/edit/follow.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "edit/fixtures.h"
#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/edit/edit_session.h"
#include "isochor/volume/volume_form.h"
#include "support/messages.h"

namespace isochor {
namespace {

using testing::ball;
using testing::edit_of;
using ::testing::HasSubstr;
using testing::make_separate_model;
using testing::message_of;
using testing::move_by;

// The parabola that both patches of the model are trimmed along, in both parameter planes.
Uv on_curve(double t) { return {t, 0.5 + 0.5 * (t - 0.5) * (t - 0.5)}; }

// A plane patch over the unit square with smooth bumps.
Surface sheet(const KnotVector& u, const KnotVector& v, double height) {
  std::vector<Vec3> poles;
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      poles.emplace_back(u.greville(i), v.greville(j), height + 0.01 * std::sin(3.0 * i + j));
    }
  }
  return {u, v, poles};
}

// What lies below the curve, and its boxes; the rest of the boundary runs along the sides.
TrimRegion trimmed_along_curve() {
  constexpr int kPieces = 200;
  TrimRegion trim;
  std::vector<Uv> loop = {{0.0, 0.0}, {1.0, 0.0}};
  for (int k = kPieces; k >= 0; --k) loop.push_back(on_curve(static_cast<double>(k) / kPieces));
  for (int k = 0; k < kPieces; ++k) {
    const Uv a = on_curve(static_cast<double>(k) / kPieces);
    const Uv b = on_curve(static_cast<double>(k + 1) / kPieces);
    trim.boundary.push_back({a.u, b.u, std::min(a.v, b.v), std::max(a.v, b.v)});
  }
  trim.loops.push_back(loop);
  return trim;
}

// Two patches that share the curve, in bases that have no inner knot in common; their sides are
// locked. (They need not meet in space: only displacements are compared.)
PatchModel two_sheets() {
  PatchModel model =
      make_separate_model({sheet(KnotVector::uniform(3, 12), KnotVector::uniform(3, 12), 0.0),
                           sheet(KnotVector::uniform(3, 7), KnotVector::uniform(2, 7), 0.0)});
  for (int q = 0; q < 2; ++q) {
    model.patches[static_cast<size_t>(q)].trim = trimmed_along_curve();
    for (Side side : kSides) {
      model.locked_sides.push_back({{q, side}, "is held", Smoothness::kSharp, {}});
    }
  }
  SharedTrim trim;
  trim.patches = {0, 1};
  for (int k = 0; k <= 400; ++k) {
    for (auto& along : trim.along) along.push_back(on_curve(k / 400.0));
  }
  trim.boxes = {{{0, 200}, {0, 200}}};
  model.shared_trims.push_back(trim);
  derive_locks(model);
  return model;
}

Follow second_follows(double tolerance) { return {{"face:2"}, tolerance}; }

// A bump of the first sheet around the middle of the curve.
std::vector<Vec3> bumped(const PatchModel& model, double height) {
  std::vector<Vec3> points = model.points;
  for (int id : model.patches[0].points) {
    Vec3& p = points[static_cast<size_t>(id)];
    const double square = std::pow(p.x() - 0.5, 2) + std::pow(p.y() - 0.5, 2);
    if (square < 0.09) p += Vec3(0.2, -0.1, 1.0) * height * std::pow(1.0 - square / 0.09, 3);
  }
  return points;
}

TEST(Follow, ReleasedTrimsFreeThePolesAlongThem) {
  const PatchModel model = two_sheets();
  const PatchModel released = with_released_trims(model, second_follows(1e-4));
  EXPECT_LT(released.locks.size(), model.locks.size());
  const PatchModel again = with_locked_trims(released);
  EXPECT_EQ(again.locks.size(), model.locks.size());
}

TEST(Follow, TheDisplacementsAgreeAlongTheCurveAndBetweenThePlaces) {
  const PatchModel model = with_released_trims(two_sheets(), second_follows(1e-5));
  const auto points = bumped(model, 0.05);
  const Followed followed = make_follow(model, points, second_follows(1e-5), Continuity::kMeasured);
  ASSERT_EQ(followed.refusal, "");
  ASSERT_EQ(followed.records.size(), 1u);
  EXPECT_LE(followed.records[0].deviation, 1e-5);
  EXPECT_GT(followed.records[0].poles_after, followed.records[0].poles_before);
  const auto displacement = [&](int q, const Uv& uv) {
    return Vec3(followed.rest.surface(q, followed.points).point(uv.u, uv.v) -
                followed.rest.surface(q).point(uv.u, uv.v));
  };
  double largest = 0.0;
  for (int k = 0; k <= 1000; ++k) {
    const Uv uv = on_curve(k / 1000.0);
    const Vec3 leader = displacement(0, uv);
    largest = std::max(largest, leader.norm());
    EXPECT_LE((displacement(1, uv) - leader).norm(), 1e-5) << k;
  }
  EXPECT_GT(largest, 0.02) << "the curve has moved";
  for (int q = 0; q < 2; ++q) {
    for (double t : {0.0, 0.3, 0.6, 1.0}) {
      for (const Uv& uv : {Uv{t, 0.0}, {t, 1.0}, {0.0, t}, {1.0, t}}) {
        EXPECT_EQ(displacement(q, uv), Vec3::Zero()) << "sides stay";
      }
    }
  }
  // The rest shape is the old one in another basis.
  for (double t = 0.05; t < 1.0; t += 0.1) {
    const Vec3 moved = followed.rest.surface(1).point(t, 1.0 - t);
    EXPECT_LE((moved - model.surface(1).point(t, 1.0 - t)).norm(), 1e-14);
  }
}

TEST(Follow, DetailsOfTheFollowerSurvive) {
  const PatchModel model = with_released_trims(two_sheets(), second_follows(1e-4));
  const Followed followed =
      make_follow(model, bumped(model, 0.05), second_follows(1e-4), Continuity::kMeasured);
  ASSERT_EQ(followed.refusal, "");
  // A displacement without waves of its own: it is never larger than what it follows by far.
  EXPECT_LE(followed.records[0].max_distance, 0.1);
}

TEST(Follow, WhatCannotFollowIsRefusedWithTheDeviation) {
  PatchModel model = with_released_trims(two_sheets(), second_follows(1e-5));
  std::vector<Vec3> points = bumped(model, 0.05);
  // A move of the curve's end, where the sides of the follower are locked.
  for (int id : model.patches[0].points) points[static_cast<size_t>(id)] += Vec3(0.0, 0.0, 0.1);
  const Followed followed = make_follow(model, points, second_follows(1e-5), Continuity::kMeasured);
  EXPECT_THAT(followed.refusal, HasSubstr("face:2 cannot follow within 1e-05"));
  EXPECT_THAT(followed.refusal, HasSubstr("misses the moved trimming curve by 0.1"));
}

TEST(Follow, FacesThatShareNoCurveOrMeetSmoothlyAreErrors) {
  PatchModel model = two_sheets();
  const Follow unknown{{"face:9"}, 1e-5};
  EXPECT_THAT(message_of<InputError>([&] { with_released_trims(model, unknown); }),
              HasSubstr("face:9"));
  const Follow both{{"face:1", "face:2"}, 1e-5};
  EXPECT_THAT(message_of<InputError>([&] { with_released_trims(model, both); }),
              HasSubstr("face:1 shares no trimming curve with another editable face"));
  model.shared_trims[0].smoothness = Smoothness::kTangent;
  EXPECT_THAT(message_of<InputError>([&] { with_released_trims(model, second_follows(1e-5)); }),
              HasSubstr("face:2 meets face:1 smoothly (G1)"));
}

// A session on the two sheets with a volume that is measured, not integrated: here the whole of
// both patches plus what a trimmed solid would add as they move.
struct Measured {
  int calls = 0;
  double slip = 0.0;
  double tolerance = 0.0;  // of the last call
};
Surroundings around(Measured* measured) {
  Surroundings surroundings;
  surroundings.outside_volume = 5.0;
  surroundings.measure = [measured](const PatchModel& model, const std::vector<bool>& moved,
                                    double tolerance) {
    ++measured->calls;
    EXPECT_EQ(moved, (std::vector<bool>{true, true}));
    measured->tolerance = tolerance;
    const double volume = 5.0 + VolumeForm(model).value(model.points) + measured->slip;
    return MeasuredVolume{{volume, 1e-15}, ""};
  };
  return surroundings;
}

Edit pull_across() {
  Edit edit = edit_of(move_by("face:1", {0.5, 0.45}, Vec3(0.0, 0.0, 0.04)), ball(0.45));
  edit.follow = second_follows(1e-5);
  return edit;
}

TEST(Follow, TheSessionMakesUpForTheMeasuredVolume) {
  Measured measured;
  measured.slip = 0.003;  // what the trimmed parts bring
  EditSession session(two_sheets(), around(&measured));
  const double before = session.volume();
  const Certificate certificate = session.apply(pull_across());
  ASSERT_EQ(certificate.outcome, Outcome::kDone) << certificate.reason;
  EXPECT_EQ(measured.calls, 1);
  EXPECT_EQ(measured.tolerance, 1e-5);
  EXPECT_GT(std::abs(certificate.volume_of_followers), 1e-4);
  EXPECT_TRUE(certificate.volume.kept);
  EXPECT_LE(certificate.moves[0].error, 1e-13) << "the point stays where it was asked to be";
  EXPECT_EQ(session.moved_patches(), (std::vector<bool>{true, true}));
  const PatchModel& model = session.model();
  EXPECT_NEAR(5.0 + VolumeForm(model).value(model.points) + measured.slip, before, 1e-13);
  for (const SharedTrim& trim : model.shared_trims) {
    EXPECT_EQ(trim.released, (std::array<bool, 2>{false, false}));
  }
}

TEST(Follow, TrimsOfEarlierEditsMayStayAsFarApartAsThoseAllowed) {
  Measured measured;
  EditSession session(two_sheets(), around(&measured));
  Edit loose = pull_across();
  loose.follow.tolerance = 1e-3;
  ASSERT_EQ(session.apply(loose).outcome, Outcome::kDone);
  EXPECT_EQ(measured.tolerance, 1e-3);
  Certificate tight = session.apply(pull_across());
  ASSERT_EQ(tight.outcome, Outcome::kDone) << tight.reason;
  EXPECT_EQ(measured.tolerance, 1e-3);
  ASSERT_TRUE(session.undo());
  ASSERT_TRUE(session.undo());
  ASSERT_EQ(session.apply(pull_across()).outcome, Outcome::kDone);
  EXPECT_EQ(measured.tolerance, 1e-5);
}

TEST(Follow, AnUndoneSessionIsAsBefore) {
  Measured measured;
  EditSession session(two_sheets(), around(&measured));
  const std::vector<Vec3> before = session.model().points;
  ASSERT_EQ(session.apply(pull_across()).outcome, Outcome::kDone);
  ASSERT_TRUE(session.undo());
  EXPECT_EQ(session.model().points, before);
}

TEST(Follow, FailuresLeaveTheModelAsItWas) {
  Measured measured;
  EditSession session(two_sheets(), around(&measured));
  const std::vector<Vec3> before = session.model().points;
  Edit edit = pull_across();
  edit.moves[0].place.uv = {0.03, 0.6};  // by the end of the curve, which is locked
  edit.moves[0].vector = Vec3(0.0, 0.0, 0.3);
  edit.extent = ball(0.3);
  const Certificate certificate = session.apply(edit);
  EXPECT_NE(certificate.outcome, Outcome::kDone);
  EXPECT_FALSE(certificate.reason.empty());
  EXPECT_EQ(session.model().points, before);
  EXPECT_EQ(session.moved_patches(), (std::vector<bool>{false, false}));
}

TEST(Follow, NeedsASolidThatCanBeMeasured) {
  EditSession session(two_sheets());
  const Certificate certificate = session.apply(pull_across());
  EXPECT_EQ(certificate.outcome, Outcome::kRefused);
  EXPECT_THAT(certificate.reason, HasSubstr("\"follow\" needs a solid from a STEP"));
}

}  // namespace
}  // namespace isochor
