// Every number of a certificate, computed again from the models before and after.
#include "isochor/edit/certificate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "edit/fixtures.h"
#include "isochor/base/tolerance.h"
#include "isochor/edit/edit_session.h"
#include "isochor/volume/exact_volume.h"
#include "isochor/volume/volume_form.h"

namespace isochor {
namespace {

using testing::edit_of;
using testing::figure4;
using ::testing::HasSubstr;
using testing::move_by;
using testing::paper_cube;
using testing::whole_extent;

struct EditRun {
  PatchModel before, after;
  Certificate certificate;
};

EditRun apply_to(const PatchModel& model, const Edit& edit) {
  EditSession session(model);
  EditRun result{model, {}, session.apply(edit)};
  result.after = session.model();
  return result;
}

TEST(Certificate, VolumeAgainstTheExactRational) {
  for (Method method : {Method::kIsotropic, Method::kAxis, Method::kTaylor}) {
    for (double change : {0.0, 0.05}) {
      Edit edit = edit_of(move_by("top", {0.4, 0.6}, Vec3(0.1, 0.0, 0.2)), whole_extent());
      edit.method = method;
      if (change != 0.0) edit.volume = {VolumeGoal::Kind::kChange, change};
      const EditRun r = apply_to(testing::bent_cube(61), edit);
      ASSERT_EQ(r.certificate.outcome, Outcome::kDone) << r.certificate.reason;
      const VolumeRecord& volume = r.certificate.volume;
      const ExactVolume exact(r.before);
      const Rational before = exact.value(r.before.points);
      const Rational after = exact.value(r.after.points);
      EXPECT_LE((Rational(volume.before) - before).abs(), Rational(volume.total_bound));
      EXPECT_NEAR(volume.after, after.to_double(), 1e-14);
      const Rational relative = (after - before) / before.abs();
      EXPECT_LE((Rational(volume.relative_change) - relative).abs(), Rational(volume.bound))
          << "the bound is a bound";
      EXPECT_LT(volume.bound, 1e-12) << "and a sharp one";
      EXPECT_EQ(volume.wanted_change, change);
      EXPECT_EQ(volume.kept, method != Method::kTaylor);
    }
  }
}

TEST(Certificate, CountsAndDistances) {
  Edit edit = figure4();
  const EditRun r = apply_to(paper_cube(), edit);
  ASSERT_EQ(r.certificate.outcome, Outcome::kDone);
  int moved = 0;
  double farthest = 0.0;
  std::set<size_t> patches;
  for (size_t i = 0; i < r.before.points.size(); ++i) {
    const double distance = (r.after.points[i] - r.before.points[i]).norm();
    moved += distance > 0.0;
    farthest = std::max(farthest, distance);
    for (size_t q = 0; q < 6; ++q) {
      const auto& points = r.before.patches[q].points;
      if (distance > 0.0 &&
          std::find(points.begin(), points.end(), static_cast<int>(i)) != points.end()) {
        patches.insert(q);
      }
    }
  }
  EXPECT_EQ(r.certificate.poles_moved, moved);
  EXPECT_EQ(r.certificate.coefficients, moved) << "on a cube all free ones take part";
  EXPECT_EQ(r.certificate.patches_moved, static_cast<int>(patches.size()));
  EXPECT_EQ(r.certificate.max_distance, farthest);
  EXPECT_EQ(r.certificate.rows, 3);
  EXPECT_EQ(r.certificate.rank, 3);
  EXPECT_EQ(r.certificate.freedom_left, 3 * moved - 3 - 1) << "three rows and the volume";
  edit.volume.kind = VolumeGoal::Kind::kFree;
  EXPECT_EQ(apply_to(paper_cube(), edit).certificate.freedom_left, 3 * moved - 3);
}

TEST(Certificate, EnergiesAreThoseOfTheDisplacement) {
  // On the finest scale of a model with shared points each point is one coefficient.
  const auto half_square = [](const EditRun& r) {
    double sum = 0.0;
    for (size_t i = 0; i < r.before.points.size(); ++i) {
      sum += 0.5 * (r.after.points[i] - r.before.points[i]).squaredNorm();
    }
    return sum;
  };
  for (Method method : {Method::kIsotropic, Method::kAxis}) {
    Edit edit = figure4(method);
    const EditRun kept = apply_to(paper_cube(), edit);
    edit.volume.kind = VolumeGoal::Kind::kFree;
    const EditRun free = apply_to(paper_cube(), edit);
    EXPECT_NEAR(kept.certificate.energy_after, half_square(kept), 1e-13);
    EXPECT_NEAR(free.certificate.energy_after, half_square(free), 1e-13);
    EXPECT_NEAR(kept.certificate.energy_before, half_square(free), 1e-13) << "the moves alone";
  }
}

TEST(Certificate, MovesAndHoldsAreMeasuredOnTheResult) {
  Edit edit = edit_of(move_by("top", {0.4, 0.6}, Vec3(0.1, 0.0, 0.2)), whole_extent());
  edit.moves.push_back(testing::move_pole_by("right", 2, 3, Vec3(0.05, 0.0, 0.0)));
  edit.holds = {testing::hold_at("top", {0.9, 0.2})};
  const EditRun r = apply_to(testing::bent_cube(62, 2.0), edit);
  ASSERT_EQ(r.certificate.outcome, Outcome::kDone) << r.certificate.reason;
  ASSERT_EQ(r.certificate.moves.size(), 2u);
  ASSERT_EQ(r.certificate.holds.size(), 1u);
  const MoveRecord& first = r.certificate.moves[0];
  const Vec3 from = r.before.surface(0).point(0.4, 0.6);
  const Vec3 got = r.after.surface(0).point(0.4, 0.6) - from;
  EXPECT_EQ(first.from, from);
  EXPECT_EQ(first.got, got);
  EXPECT_EQ(first.asked, Vec3(0.1, 0.0, 0.2));
  EXPECT_EQ(first.error, (got - first.asked).norm());
  EXPECT_LE(first.error, kReached * diagonal(r.before));
  const int pole = r.before.patches[2].point(2, 3);
  const Vec3 moved =
      r.after.points[static_cast<size_t>(pole)] - r.before.points[static_cast<size_t>(pole)];
  EXPECT_LE((r.certificate.moves[1].got - moved).norm(), 1e-16);
  EXPECT_EQ(r.certificate.holds[0].asked, Vec3::Zero());
  EXPECT_LE((r.after.surface(0).point(0.9, 0.2) - r.certificate.holds[0].from).norm(), 1e-15);
}

TEST(Certificate, JoinsAreMeasuredOnTheResult) {
  const EditRun r = apply_to(testing::bent_cube(63),
                             edit_of(move_by("top", {0.5, 1.0}, Vec3(0, 0, 0.2)), whole_extent()));
  ASSERT_EQ(r.certificate.outcome, Outcome::kDone);
  EXPECT_EQ(r.certificate.joins.count, 12) << "the edges of a cube";
  EXPECT_LE(r.certificate.joins.max_gap, 1e-15);
  double angle = 0.0;
  for (const Join& join : r.before.joins) {
    angle = std::max(angle, measure_join(r.after, join.a, join.b, join.opposed).max_angle_rad);
  }
  EXPECT_EQ(r.certificate.joins.max_angle_rad, angle);
  EXPECT_EQ(r.certificate.joins.angle_change_rad, 0.0) << "no join of a cube is protected";
}

TEST(Certificate, LocksAreListedByPatchAndReason) {
  PatchModel model = paper_cube();
  model.lock(model.patches[0].point(7, 7), "a window is here", false);
  model.lock(model.patches[0].point(7, 8), "a window is here", false);
  model.lock(model.patches[0].point(10, 10), "another reason", false);
  const EditRun r = apply_to(model, figure4());
  ASSERT_EQ(r.certificate.outcome, Outcome::kDone) << r.certificate.reason;
  ASSERT_EQ(r.certificate.locked.size(), 2u);
  EXPECT_EQ(r.certificate.locked[0].patch, "face:1 (\"top\")");
  EXPECT_EQ(r.certificate.locked[0].reason, "a window is here");
  EXPECT_EQ(r.certificate.locked[0].coefficients, 2);
  EXPECT_EQ(r.certificate.locked[1].coefficients, 1);
}

TEST(Certificate, OutsideVolumeCountsInTheTotal) {
  // The patches are one cube; the rest of the solid adds ten with an error of its own.
  EditSession session(testing::small_cube(), {true, "", 10.0, 1e-3});
  EXPECT_NEAR(session.volume(), 11.0, 1e-13);
  Edit edit = figure4();
  edit.volume = {VolumeGoal::Kind::kFactor, 1.1};
  edit.extent = whole_extent();
  const Certificate done = session.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  EXPECT_NEAR(done.volume.wanted_change, 1.1, 1e-13);
  EXPECT_NEAR(done.volume.relative_change, 0.1, 1e-13);
  EXPECT_GE(done.volume.total_bound, 1e-3);
  EXPECT_LT(done.volume.bound, 1e-12) << "of the change: the rest cancels";
  const PatchModel& model = session.model();
  EXPECT_NEAR(VolumeForm(model).value(model.points), 2.1, 1e-13);
}

TEST(Certificate, AModelWithoutVolumeStillHasFiniteNumbers) {
  // A flat sheet in the plane z = 0: its integral of z dx dy is zero.
  PatchModel sheet = testing::make_cube_model(2, 5);
  sheet.patches.erase(sheet.patches.begin() + 1, sheet.patches.end());
  testing::translate(sheet, Vec3(0, 0, -1));
  EditSession session(testing::prepared(sheet), {false, "four free edges", 0.0, 0.0});
  Edit edit = edit_of(move_by("top", {0.5, 0.5}, Vec3(0, 0, 0.1)), testing::ball(0.4));
  edit.open = true;
  const Certificate done = session.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  EXPECT_EQ(done.volume.before, 0.0);
  EXPECT_LE(std::abs(done.volume.after), 1e-16);
  EXPECT_LE(std::abs(done.volume.relative_change), 1e-16);
  EXPECT_LE(done.volume.bound, 1e-13);
  EXPECT_TRUE(done.volume.kept);
}

TEST(Certificate, ResolvedRepeatsTheEditAndTimingsAreThere) {
  Edit edit = figure4(Method::kAxis);
  edit.axis_order = {2, 0, 1};
  const EditRun r = apply_to(paper_cube(), edit);
  EXPECT_EQ(r.certificate.name, "figure 4");
  EXPECT_EQ(r.certificate.resolved.method, Method::kAxis);
  EXPECT_EQ(r.certificate.resolved.axis_order, edit.axis_order);
  EXPECT_EQ(r.certificate.resolved.extent.radius, 0.5);
  for (const char* step : {"prepare", "solve"}) {
    ASSERT_EQ(r.certificate.timings_ms.count(step), 1u) << step;
    EXPECT_GE(r.certificate.timings_ms.at(step), 0.0);
  }
}

TEST(Certificate, ARefusalSaysWhatItRefused) {
  EditSession open(paper_cube(), {false, "side u0 of face:1", 0.0, 0.0});
  const Certificate no = open.begin(figure4());
  EXPECT_EQ(no.outcome, Outcome::kRefused);
  EXPECT_EQ(no.name, "figure 4");
  EXPECT_EQ(no.resolved.moves.size(), 1u);
  EXPECT_EQ(no.volume.before, no.volume.after);
  EXPECT_THAT(no.reason, HasSubstr("the model is open (side u0 of face:1)"));
  Edit free = figure4();
  free.volume.kind = VolumeGoal::Kind::kFree;
  EXPECT_EQ(open.apply(free).outcome, Outcome::kDone) << "a free volume needs no closed model";
}

}  // namespace
}  // namespace isochor
