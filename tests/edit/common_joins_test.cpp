// Edits across edges whose faces have different bases.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "edit/fixtures.h"
#include "isochor/base/tolerance.h"
#include "isochor/edit/edit_session.h"
#include "support/different_bases.h"

namespace isochor {
namespace {

using testing::joined;
using testing::junction;
using testing::move_by;
using testing::pair_of;
using testing::sheet;

PatchModel locked(PatchModel model) {
  derive_locks(model);
  return model;
}

Edit pull(const std::string& patch, Uv uv, const Vec3& by) {
  Edit edit;
  edit.open = true;
  edit.volume.kind = VolumeGoal::Kind::kFree;
  edit.moves = {move_by(patch, uv, by)};
  return edit;
}

// The edge stays where both faces say it is, and as smooth.
void expect_kept(const PatchModel& before, const Edit& edit) {
  EditSession session(before);
  const Certificate done = session.apply(edit);
  ASSERT_EQ(done.outcome, Outcome::kDone) << done.reason;
  EXPECT_GT(done.max_distance, 0.005);
  for (const Join& join : before.joins) {
    const Join now = measure_join(session.model(), session.model().points, join);
    EXPECT_LT(now.max_gap, join.max_gap + 1e-15);
    if (edit.continuity != Continuity::kC0 && join.smoothness >= Smoothness::kTangent) {
      EXPECT_LT(now.max_angle_rad, join.max_angle_rad + 1e-11);
    }
  }
}

TEST(CommonJoinEdits, MoveTheEdgeFromEitherSide) {
  const PatchModel model =
      locked(pair_of(KnotVector::uniform(3, 6), KnotVector::uniform(3, 9, 0.0, 2.0), false));
  for (const char* continuity : {"C0", "measured"}) {
    Edit edit = pull("face:1", {1.0, 0.4}, {0.01, 0.0, 0.02});
    edit.continuity = std::string(continuity) == "C0" ? Continuity::kC0 : Continuity::kMeasured;
    expect_kept(model, edit);
    edit.moves = {move_by("face:2", {0.0, 1.2}, {0.0, 0.01, 0.02})};
    expect_kept(model, edit);
    edit.moves = {move_by("face:2", {0.1, 1.2}, {0.0, 0.01, 0.02})};
    expect_kept(model, edit);
  }
}

TEST(CommonJoinEdits, MoveTheMiddleOfASideThatTwoFacesMeet) {
  for (double at : {0.5, 0.3141592653589793}) {
    const PatchModel model = locked(junction(at));
    expect_kept(model, pull("face:1", {1.0, at}, {0.0, 0.0, 0.02}));
    expect_kept(model, pull("face:3", {0.0, 6.5}, {0.0, 0.0, 0.02}));
  }
}

TEST(CommonJoinEdits, ScalesMayDiffer) {
  const PatchModel model =
      locked(pair_of(KnotVector::uniform(3, 6), KnotVector::uniform(3, 12), true));
  Edit edit = pull("face:1", {1.0, 0.4}, {0.01, 0.0, 0.02});
  edit.scale = testing::every(2);
  expect_kept(model, edit);
}

TEST(CommonJoinEdits, ExtentsGrowAcrossTheEdge) {
  const PatchModel model =
      locked(pair_of(KnotVector::uniform(3, 8), KnotVector::uniform(3, 16), false));
  const DisplacementSpace space(model, testing::at_scale(1));
  const int on_edge = space.coefficient(0, space.u_knots(0).size() - 1, 4);
  const std::vector<int>& next = space.neighbours(on_edge);
  EXPECT_TRUE(std::is_sorted(next.begin(), next.end()));
  EXPECT_TRUE(std::any_of(next.begin(), next.end(), [&](int c) { return space.patch_of(c) == 1; }));
}

// Smooth lines that end on the edge from both sides: their equations there follow from those of the
// edge, but only up to the noise of factors measured for knots that are not round.
PatchModel crossing(double at) {
  const KnotVector u = KnotVector::uniform(3, 3);
  PatchModel model =
      testing::make_separate_model({sheet(u, KnotVector::uniform(3, 4), 0, 1, 0, at),
                                    sheet(u, KnotVector::uniform(3, 4), 0, 1, at, 1),
                                    sheet(u, KnotVector::uniform(3, 6, 0.0, 7.0), 1, 2, 0, at),
                                    sheet(u, KnotVector::uniform(3, 6), 1, 2, at, 1)});
  for (int q : {0, 2}) {
    const auto a = side_indices(model.patches[static_cast<size_t>(q)], Side::kVEnd);
    const auto b = side_indices(model.patches[static_cast<size_t>(q) + 1], Side::kVBegin);
    for (size_t k = 0; k < a.size(); ++k) {
      model.ties.emplace_back(
          model.patches[static_cast<size_t>(q)].point(a[k].first, a[k].second),
          model.patches[static_cast<size_t>(q) + 1].point(b[k].first, b[k].second));
    }
    model.joins.push_back(measure_join(model, {q, Side::kVEnd}, {q + 1, Side::kVBegin}, false));
  }
  for (int q : {0, 1}) {
    model.joins.push_back(measure_common_join(model, model.points, {q, Side::kUEnd}, {},
                                              {q + 2, Side::kUBegin}, {}, false));
  }
  return locked(model);
}

TEST(CommonJoinEdits, SmoothLinesMayEndOnTheEdge) {
  for (double at : {0.5, 0.3141592653589793}) {
    const PatchModel model = crossing(at);
    ASSERT_EQ(model.joins.size(), 4u);
    EXPECT_TRUE(model.locks.empty());
    int common = 0;
    for (const Join& join : model.joins) common += join.common ? 1 : 0;
    EXPECT_EQ(common, 2);
    expect_kept(model, pull("face:1", {1.0, 1.0}, {0.0, 0.0, 0.02}));
    Edit sharp = pull("face:3", {0.0, 7.0}, {0.01, 0.0, 0.02});
    sharp.continuity = Continuity::kTangent;
    expect_kept(model, sharp);
  }
}

}  // namespace
}  // namespace isochor
