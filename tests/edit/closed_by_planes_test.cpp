// Models closed by planes in an edit session.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "isochor/base/error.h"
#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"
#include "isochor/edit/edit_session.h"
#include "isochor/edit/mirrored_model.h"
#include "support/messages.h"
#include "support/models.h"

namespace isochor {
namespace {

using testing::make_cube_model;

// A cube without these faces: "bottom" (z = 0) is 1, "front" (y = 0) 5.
PatchModel open_cube(const std::vector<int>& without) {
  PatchModel model = make_cube_model(3, 3);
  for (auto it = without.rbegin(); it != without.rend(); ++it) {
    model.patches.erase(model.patches.begin() + *it);
  }
  model.joins = find_joins(model);
  derive_locks(model);
  return model;
}

ClosingPlane plane(const std::string& text) { return parse_closing_plane(text); }
ClosingPlane mirror(int axis) { return {Vec3::Unit(axis), 0.0, true}; }

Surroundings closed_by(std::vector<ClosingPlane> planes) {
  Surroundings around;
  around.closing = std::move(planes);
  return around;
}

Edit pull(const Vec3& at, const Vec3& by) {
  Edit edit;
  edit.name = "pull";
  edit.extent.kind = Extent::Kind::kAll;
  Move move;
  move.place.kind = Place::Kind::kNear;
  move.place.near = at;
  move.vector = by;
  edit.moves.push_back(move);
  return edit;
}

TEST(ClosedByPlanes, VolumeIsTheClosedOneAndIsKept) {
  const PatchModel model = open_cube({1, 5});
  for (Method method : {Method::kIsotropic, Method::kAxis}) {
    EditSession session(model, closed_by({plane("z=0"), plane("y=0")}));
    EXPECT_NEAR(session.volume(), 1.0, 1e-15);
    Edit edit = pull(Vec3(0.5, 0.5, 1.0), Vec3(0.0, 0.0, 0.2));
    edit.method = method;
    const Certificate certificate = session.apply(edit);
    ASSERT_EQ(certificate.outcome, Outcome::kDone) << certificate.reason;
    EXPECT_TRUE(certificate.volume.kept);
    EXPECT_LE(std::abs(certificate.volume.relative_change), 1e-13);
  }
}

// The rim glides in its planes; a side in both planes glides along their line.
TEST(ClosedByPlanes, RimStaysInItsPlanes) {
  for (const std::string& first : {std::string("z=0"), std::string("0,0.6,0.8,0")}) {
    PatchModel model = open_cube({1, 5});
    const bool oblique = first != "z=0";
    if (oblique) {  // z' = z - 0.75 y: the bottom's rim lies in the second plane
      for (Vec3& p : model.points) p.z() -= 0.75 * p.y();
      derive_locks(model);
    }
    EditSession session(model, closed_by({plane(first), plane("y=0")}));
    EXPECT_NEAR(session.volume(), 1.0, 1e-14);
    // A point of the rim, pulled along its plane.
    const Certificate certificate = session.apply(pull(Vec3(1.0, 0.0, 0.5), Vec3(0.1, 0.0, 0.0)));
    ASSERT_EQ(certificate.outcome, Outcome::kDone) << certificate.reason;
    EXPECT_TRUE(certificate.volume.kept);
    double off = 0.0;
    double along = 0.0;
    for (size_t i = 0; i < model.points.size(); ++i) {
      const Vec3 moved = session.model().points[i] - model.points[i];
      const bool front = model.points[i].y() == 0.0;
      const ClosingPlane bottom = plane(first);
      const bool low = std::abs(bottom.normal.dot(model.points[i]) - bottom.offset) < 1e-12;
      // The faces "top" and "left" only touch the planes in their rims.
      if (front) off = std::max(off, std::abs(moved.y()));
      if (low) off = std::max(off, std::abs(bottom.normal.dot(moved)));
      if (front) along = std::max(along, std::abs(moved.x()));
    }
    EXPECT_LE(off, oblique ? 1e-15 : 0.0);
    EXPECT_GT(along, 0.05);
  }
}

TEST(ClosedByPlanes, LeavingThePlaneContradictsIt) {
  EditSession session(open_cube({1}), closed_by({plane("z=0")}));
  const Certificate certificate = session.apply(pull(Vec3(0.5, 0.0, 0.0), Vec3(0.0, 0.0, 0.1)));
  EXPECT_NE(certificate.outcome, Outcome::kDone);
}

TEST(ClosedByPlanes, HalfAgreesWithTheWholeHeldSymmetric) {
  const PatchModel half = open_cube({5});
  const PatchModel whole = mirrored_model(half, 1);
  EXPECT_TRUE(closure(whole).closed);
  const Edit edit = pull(Vec3(0.4, 0.3, 1.0), Vec3(0.05, 0.0, 0.2));
  Edit symmetric = edit;
  Hold hold;
  hold.kind = Hold::Kind::kSymmetry;
  hold.axis = 1;
  symmetric.holds.push_back(hold);
  EditSession of_half(half, closed_by({mirror(1)}));
  EditSession of_whole(whole);
  EXPECT_NEAR(2.0 * of_half.volume(), of_whole.volume(), 1e-14);
  const Certificate first = of_half.apply(edit);
  const Certificate second = of_whole.apply(symmetric);
  ASSERT_EQ(first.outcome, Outcome::kDone) << first.reason;
  ASSERT_EQ(second.outcome, Outcome::kDone) << second.reason;
  double worst = 0.0;
  double farthest = 0.0;
  for (size_t i = 0; i < half.points.size(); ++i) {
    worst = std::max(
        worst, (of_half.model().points[i] - of_whole.model().points[i]).cwiseAbs().maxCoeff());
    farthest = std::max(farthest, (of_half.model().points[i] - half.points[i]).norm());
    if (half.points[i].y() == 0.0) {
      EXPECT_EQ(of_half.model().points[i].y(), 0.0);
    }
  }
  EXPECT_LE(worst, 1e-12);
  EXPECT_GT(farthest, 0.1);
  EXPECT_EQ(of_half.model().points.size(), half.points.size());
}

// The skin meets its mirror image smoothly: a plane would let it crease there, a mirror does not.
TEST(ClosedByPlanes, MirrorPlaneKeepsTheSkinSmoothAcross) {
  const PatchModel half = open_cube({5});
  const Edit edit = pull(Vec3(0.4, 0.0, 1.0), Vec3(0.0, 0.0, 0.2));
  EditSession mirrored(half, closed_by({mirror(1)}));
  ASSERT_EQ(mirrored.apply(edit).outcome, Outcome::kDone);
  EditSession cut(half, closed_by({plane("y=0")}));
  ASSERT_EQ(cut.apply(edit).outcome, Outcome::kDone);
  const auto slope = [](const PatchModel& model) {
    return std::abs(model.surface(0).normal(0.4, 0.0).y());  // "top", (u, v) = (x, y)
  };
  EXPECT_LE(slope(mirrored.model()), 1e-14);
  EXPECT_GT(slope(cut.model()), 1e-3);
}

TEST(ClosedByPlanes, BadMirrorsAreRefusedByName) {
  const PatchModel half = open_cube({5});
  const Edit edit = pull(Vec3(0.4, 0.3, 1.0), Vec3(0.0, 0.0, 0.2));
  EditSession two(half, closed_by({mirror(1), mirror(2)}));
  EXPECT_NE(testing::message_of<InputError>([&] { two.begin(edit); }).find("one mirror plane"),
            std::string::npos);
  ClosingPlane shifted = mirror(1);
  shifted.offset = 1.0;
  EditSession off(half, closed_by({shifted}));
  EXPECT_NE(testing::message_of<InputError>([&] { off.begin(edit); }).find("must be x = 0"),
            std::string::npos);
}

TEST(ClosedByPlanes, EditsOfAFileShareTheirPlanes) {
  EditScript script;
  script.edits.resize(2);
  EXPECT_TRUE(closing_planes(script).empty());
  script.edits[0].close = {plane("y=0")};
  EXPECT_EQ(closing_planes(script).size(), 1u);
  script.edits[1].close = {plane("0,-3,0,0")};
  EXPECT_EQ(closing_planes(script).size(), 1u) << "the same plane, written otherwise";
  script.edits[1].close = {mirror(1)};
  EXPECT_NE(testing::message_of<InputError>([&] { closing_planes(script); }).find("edits[1].close"),
            std::string::npos);
}

}  // namespace
}  // namespace isochor
