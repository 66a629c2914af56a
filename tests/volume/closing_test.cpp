#include "isochor/volume/closing.h"

#include <gtest/gtest.h>

#include "support/models.h"

namespace isochor {
namespace {

using testing::make_cube_model;

// A cube without some of its faces; "bottom" is 1, "front" 5.
PatchModel open_cube(const std::vector<int>& without) {
  PatchModel model = make_cube_model(3, 2);
  for (auto it = without.rbegin(); it != without.rend(); ++it) {
    model.patches.erase(model.patches.begin() + *it);
  }
  model.joins = find_joins(model);
  return model;
}

std::vector<OpenEdge> edges_of(const PatchModel& model) {
  return open_edges(model, closure(model));
}

TEST(Closing, FoundPlanesCloseTheModel) {
  const PatchModel model = open_cube({1, 5});
  const auto edges = edges_of(model);
  ASSERT_EQ(edges.size(), 6u);
  const OpenPlanes found = planes_of(edges, 1e-9);
  ASSERT_EQ(found.groups.size(), 2u);
  EXPECT_TRUE(found.left_over.empty());
  EXPECT_EQ(found.groups[0].edges + found.groups[1].edges, 6);
  const ClosingCheck check =
      check_closing(edges, {found.groups[0].plane, found.groups[1].plane}, 1e-9);
  EXPECT_TRUE(check.closed) << check.why_open;
  EXPECT_LE(check.farthest, 1e-12);
}

TEST(Closing, EdgesInNoPlaneAreListedWithTheirDistance) {
  PatchModel model = open_cube({1});
  const auto flat = edges_of(model);
  EXPECT_FALSE(check_closing(flat, {}, 1e-9).closed);
  const ClosingCheck check = check_closing(flat, {parse_closing_plane("z=0.25")}, 1e-9);
  EXPECT_FALSE(check.closed);
  EXPECT_NE(check.why_open.find("leaves the plane z = 0.25 by 0.25"), std::string::npos)
      << check.why_open;
  // A corner is lifted: two edges no longer lie in the plane.
  for (Vec3& p : model.points) {
    if (p == Vec3::Zero()) p.z() = -0.125;
  }
  const ClosingCheck lifted = check_closing(edges_of(model), {parse_closing_plane("z=0")}, 1e-9);
  EXPECT_NE(lifted.why_open.find("by 0.125"), std::string::npos) << lifted.why_open;
}

TEST(Closing, OpeningIsSaidInWords) {
  EXPECT_EQ(opening_text({}, 1e-9), "");
  EXPECT_EQ(opening_text(edges_of(open_cube({1})), 1e-9),
            "open along 4 edges, all in the plane z = 0: --close z=0 closes it");
  const std::string two = opening_text(edges_of(open_cube({1, 5})), 1e-9);
  EXPECT_NE(two.find("close it"), std::string::npos) << two;
  EXPECT_NE(two.find("--close z=0"), std::string::npos) << two;
  EXPECT_NE(two.find("--close y=0"), std::string::npos) << two;
  PatchModel bent = open_cube({1});
  for (Vec3& p : bent.points) {
    if (p.z() == 0.0 && p.x() > 0.3 && p.x() < 0.7) p.z() = p.y() < 0.5 ? 0.2 : -0.3;
  }
  const std::string text = opening_text(edges_of(bent), 1e-9);
  EXPECT_EQ(text.find("--close z=0 closes it"), std::string::npos) << text;
}

TEST(Closing, ObliquePlanesAreFoundToo) {
  PatchModel model = open_cube({1});
  Eigen::Matrix3d turn;
  turn << 0.8, 0.0, -0.6, 0.0, 1.0, 0.0, 0.6, 0.0, 0.8;
  // Straight edges fix no plane of their own: bend them within the plane first.
  for (Vec3& p : model.points) {
    if (p.z() == 0.0 && p.y() == 0.0 && p.x() > 0.2 && p.x() < 0.8) p.y() = -0.1;
    if (p.z() == 0.0 && p.x() == 0.0 && p.y() > 0.2 && p.y() < 0.8) p.x() = -0.1;
    if (p.z() == 0.0 && p.y() == 1.0 && p.x() > 0.2 && p.x() < 0.8) p.y() = 1.1;
  }
  testing::transform(model, turn);
  const OpenPlanes found = planes_of(edges_of(model), 1e-9);
  EXPECT_TRUE(found.left_over.empty());
  ASSERT_FALSE(found.groups.empty());
  std::vector<ClosingPlane> planes;
  for (const auto& group : found.groups) planes.push_back(group.plane);
  EXPECT_TRUE(check_closing(edges_of(model), planes, 1e-9).closed);
}

}  // namespace
}  // namespace isochor
