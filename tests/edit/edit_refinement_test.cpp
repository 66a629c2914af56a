#include "isochor/edit/edit_refinement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "edit/fixtures.h"
#include "isochor/base/error.h"
#include "isochor/bspline/continuity.h"
#include "isochor/edit/edit_session.h"
#include "support/messages.h"

namespace isochor {
namespace {

using testing::ball;
using testing::edit_of;
using ::testing::HasSubstr;
using testing::message_of;
using testing::move_by;
using testing::move_pole_by;
using testing::small_cube;
using testing::whole_extent;

TEST(EditRefinement, ReachesEveryPatchTheEditNames) {
  const PatchModel model = small_cube();
  const auto spans = [&](const Edit& edit, size_t q) {
    const PatchModel refined = refined_for(model, edit);
    return std::make_pair(refined.patches[q].u_knots.spans().size(),
                          refined.patches[q].v_knots.spans().size());
  };
  const auto fine = std::make_pair<size_t, size_t>(8, 8);
  const auto coarse = std::make_pair<size_t, size_t>(4, 4);
  Edit edit;
  edit.refine.kind = Refine::Kind::kSpans;
  edit.refine.spans = {8, 8};
  EXPECT_EQ(spans(edit, 0), coarse) << "nothing is named";
  edit.moves = {move_by("top", {0.5, 0.5}, Vec3::UnitZ())};
  EXPECT_EQ(spans(edit, 0), fine);
  EXPECT_EQ(spans(edit, 1), fine) << "the chain of joins reaches the bottom";
  edit.moves.clear();
  edit.extent = testing::poles("right", {{1, 1}});
  EXPECT_EQ(spans(edit, 2), fine);
  edit.extent = testing::faces({"right"});
  EXPECT_EQ(spans(edit, 2), fine);
  edit.extent = whole_extent();
  EXPECT_EQ(spans(edit, 5), fine);
  edit.extent = Extent{};
  edit.sink.kind = Sink::Kind::kOtherExtent;
  edit.sink.extent = testing::faces({"left"});
  EXPECT_EQ(spans(edit, 3), fine);
  edit.refine.kind = Refine::Kind::kNone;
  EXPECT_EQ(spans(edit, 3), coarse);
}

TEST(EditRefinement, ByLengthBoundsTheSpans) {
  const PatchModel model = testing::bent_cube(52);
  Edit edit = edit_of(move_by("top", {0.5, 0.5}, Vec3::UnitZ()), ball(0.3));
  edit.refine.kind = Refine::Kind::kLength;
  edit.refine.length = 0.08;
  const PatchModel refined = refined_for(model, edit);
  const Surface top = refined.surface(0);
  const auto& breaks = refined.patches[0].u_knots.breaks();
  for (size_t k = 0; k + 1 < breaks.size(); ++k) {
    for (double v : {0.0, 0.3, 0.8, 1.0}) {
      double length = 0.0;  // of the iso curve over one span
      Vec3 last = top.point(breaks[k], v);
      for (int s = 1; s <= 16; ++s) {
        const Vec3 next = top.point(breaks[k] + (breaks[k + 1] - breaks[k]) * s / 16.0, v);
        length += (next - last).norm();
        last = next;
      }
      EXPECT_LE(length, 0.08 * 1.05);
    }
  }
  for (double u : {0.1, 0.5, 0.93}) {
    EXPECT_LE((top.point(u, 0.4) - model.surface(0).point(u, 0.4)).norm(), 1e-14);
  }
  edit.refine.length = 1e-12;
  EXPECT_THROW(refined_for(model, edit), InputError);
}

// A window in the middle of the lid.
constexpr double kWindow[2] = {0.4, 0.6};

PatchModel cube_with_a_window() {
  PatchModel model = small_cube();
  const double low = kWindow[0], high = kWindow[1];
  TrimRegion& trim = model.patches[0].trim;
  trim.loops = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}},
                {{low, low}, {low, high}, {high, high}, {high, low}, {low, low}}};
  trim.boundary = {{low, high, low, low},
                   {low, high, high, high},
                   {low, low, low, high},
                   {high, high, low, high}};
  derive_locks(model);
  return model;
}

Edit pull_close_to_the_window(double distance) {
  Edit edit =
      edit_of(move_by("top", {0.5, kWindow[1] + distance}, {0.0, 0.0, 0.1 * distance}), ball(0.3));
  edit.open = true;  // the window is a hole
  return edit;
}

TEST(EditRefinement, AutoFreesThePointAndLeavesTheWindowAlone) {
  const PatchModel model = cube_with_a_window();
  for (double distance : {0.2, 0.1, 0.03, 0.004}) {
    SCOPED_TRACE(distance);
    Edit edit = pull_close_to_the_window(distance);
    EditSession stuck(model, {});
    const Certificate before = stuck.apply(edit);
    if (distance < 0.1) {
      EXPECT_NE(before.outcome, Outcome::kDone);
    }
    edit.refine.kind = Refine::Kind::kAuto;
    EditSession session(model, {});
    const Certificate certificate = session.apply(edit);
    ASSERT_EQ(certificate.outcome, Outcome::kDone) << certificate.reason;
    EXPECT_LE(certificate.moves[0].error, 1e-15);
    EXPECT_LE(std::abs(certificate.volume.relative_change), 1e-14);
    const Surface was = model.surface(0), is = session.model().surface(0);
    for (double along = kWindow[0]; along <= kWindow[1]; along += 0.01) {
      for (const Uv& uv : {Uv{along, kWindow[0]}, Uv{along, kWindow[1]}, Uv{kWindow[0], along},
                           Uv{kWindow[1], along}}) {
        EXPECT_LE((is.point(uv.u, uv.v) - was.point(uv.u, uv.v)).norm(), 1e-15);
      }
    }
  }
}

TEST(EditRefinement, AutoInsertsKnotsNearThePointOnly) {
  const PatchModel model = cube_with_a_window();
  Edit edit = pull_close_to_the_window(0.03);
  edit.refine.kind = Refine::Kind::kAuto;
  const PatchModel refined = refined_for(model, edit);
  const std::vector<double> old = model.patches[0].v_knots.breaks();
  for (const auto& [knots, middle] : {std::make_pair(refined.patches[0].u_knots, 0.5),
                                      std::make_pair(refined.patches[0].v_knots, 0.63)}) {
    int near = 0;
    for (double knot : knots.breaks()) {
      const bool close = std::abs(knot - middle) <= 0.03 * 1.2;
      near += close;
      EXPECT_TRUE(close || std::find(old.begin(), old.end(), knot) != old.end()) << knot;
    }
    EXPECT_GT(near, knots.degree() + 4);
  }
}

TEST(EditRefinement, AutoChangesNothingWhereThePointIsFreeAlready) {
  Edit edit = edit_of(move_by("top", {0.5, 0.5}, Vec3::UnitZ()), Extent{});
  edit.refine.kind = Refine::Kind::kAuto;
  const PatchModel model = small_cube();
  EXPECT_EQ(refined_for(model, edit).points.size(), model.points.size());
}

TEST(EditRefinement, AutoNeedsAPointOfASurface) {
  Edit edit;
  edit.refine.kind = Refine::Kind::kAuto;
  const auto message = [&] {
    return message_of<InputError>([&] { (void)refined_for(small_cube(), edit); });
  };
  EXPECT_THAT(message(), HasSubstr("refine: \"auto\" refines around moved points"));
  edit.moves = {move_pole_by("top", 1, 1, Vec3::UnitZ())};
  EXPECT_THAT(message(), HasSubstr("move[0]: names a pole by its indices"));
}

}  // namespace
}  // namespace isochor
