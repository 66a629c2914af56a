#include "isochor/volume/flux_field.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <random>

#include "isochor/base/error.h"
#include "isochor/bspline/joins.h"
#include "isochor/volume/exact_volume.h"
#include "isochor/volume/volume_form.h"
#include "support/messages.h"
#include "support/models.h"

namespace isochor {
namespace {

using testing::random_closed_model;

ClosingPlane plane(double x, double y, double z, double h) {
  return closing_plane(Vec3(x, y, z), h, "");
}

// Sets of planes that a body may be closed by.
std::vector<std::vector<ClosingPlane>> plane_sets() {
  return {{plane(0, 1, 0, 0)},
          {plane(0, 0, 1, 12.5)},
          {plane(1, 2, 3, 4)},
          {plane(0, 1, 0, 0), plane(0, 0, 1, 12.5)},
          {plane(0, 1, 0, 0), plane(0, 0, 1, 12.5), plane(1, 0, 0, -3), plane(1, 0, 0, 90)},
          {plane(0, 1, 0, 0), plane(0.1, 0, 1, 12.5), plane(1, 0, 0.2, -3)},
          {plane(1, 0, 0, 0), plane(1, 0, 0, 10)},
          {plane(1, 2, 3, 4), plane(1, 2, 3, 9)},
          {plane(1, 2, 3, 4), plane(3, -1, 0.5, 1), plane(0.2, 0.3, -1, 2)}};
}

TEST(FluxField, UnitDivergenceNoFluxAndFrame) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-20.0, 20.0);
  for (const auto& planes : plane_sets()) {
    SCOPED_TRACE(text_of(planes));
    const auto field = field_without_flux(planes);
    ASSERT_TRUE(field.has_value());
    EXPECT_NEAR(field->slope.dot(field->direction), 1.0, 1e-14);
    for (const ClosingPlane& each : planes) {
      for (int k = 0; k < 20; ++k) {
        Vec3 x(coordinate(random), coordinate(random), coordinate(random));
        x -= (each.normal.dot(x) - each.offset) * each.normal;
        EXPECT_NEAR(field->at(x).dot(each.normal), 0.0, 1e-12);
      }
    }
    const FluxFrame frame(*field);
    EXPECT_NEAR(frame.matrix().determinant(), 1.0, 1e-14);
    EXPECT_LT((frame.matrix() * field->direction - Vec3::UnitZ()).norm(), 1e-14);
    const Vec3 x(1.5, -2.0, 3.25);
    EXPECT_NEAR(frame.point(x).z(), field->slope.dot(x) - field->level, 1e-14);
  }
}

TEST(FluxField, CoordinatePlanesThroughTheOriginKeepTheBits) {
  EXPECT_TRUE(FluxFrame(*field_without_flux({plane(0, 0, 1, 0)})).plain());
  EXPECT_TRUE(FluxFrame(*field_without_flux({})).plain());
  const FluxFrame turned(*field_without_flux({plane(0, 1, 0, 0), plane(0, 0, 1, 12.5)}));
  EXPECT_TRUE(turned.exact());
  EXPECT_FALSE(turned.plain());
  EXPECT_EQ(turned.point(Vec3(0.1, 0.2, 0.3)), Vec3(0.3, 0.1, 0.2));
  EXPECT_EQ(turned.slip(Vec3(0.1, 0.2, 0.3)), 0.0);
  EXPECT_FALSE(FluxFrame(*field_without_flux({plane(0, 0, 1, 12.5)})).exact());
}

TEST(FluxField, RefusedPlanesAreNotRefusedForTheirOrder) {
  std::vector<ClosingPlane> planes = {plane(1, 0, 0, 0), plane(0, 1, 0, 0), plane(0, 0, 1, 0),
                                      plane(1, 1, 1, 5)};
  for (int turn = 0; turn < 4; ++turn) {
    EXPECT_FALSE(field_without_flux(planes).has_value());
    std::rotate(planes.begin(), planes.begin() + 1, planes.end());
  }
  const std::string text = testing::message_of<InputError>([&] { require_field(planes); });
  EXPECT_NE(text.find("4 planes"), std::string::npos) << text;
  EXPECT_NE(text.find("no direction lies in all of them but one"), std::string::npos) << text;
}

TEST(FluxField, NormalsOfLengthOneKeepTheirDigits) {
  for (const Vec3& normal :
       {Vec3(-0.03125, 0, 1), Vec3(1, 2, 3), Vec3(0.3, -7, 11), Vec3(1e-9, 1, 5)}) {
    const ClosingPlane once = closing_plane(normal, 4.5, "");
    const ClosingPlane twice = closing_plane(once.normal, once.offset, "");
    EXPECT_EQ(twice.normal, once.normal);
    EXPECT_EQ(twice.offset, once.offset);
  }
}

TEST(FluxField, PlanesAreReadAndPrinted) {
  EXPECT_EQ(text_of(parse_closing_plane("y=0")), "y = 0");
  EXPECT_EQ(text_of(parse_closing_plane("z=12.5")), "z = 12.5");
  EXPECT_EQ(text_of(parse_closing_plane("0,-2,0,3")), "y = -1.5");
  EXPECT_EQ(text_of(parse_closing_plane("3,0,-4,10")), "0.6 x - 0.8 z = 2");
  for (const char* bad :
       {"", "y", "y=", "y=a", "w=3", "1,2,3", "1,2,3,4,5", "0,0,0,1", "1,0,0,nan"}) {
    EXPECT_THROW(parse_closing_plane(bad), InputError) << bad;
  }
}

TEST(FluxField, CommonPointLiesOnAllPlanes) {
  const std::vector<ClosingPlane> planes = {plane(1, 2, 3, 4), plane(3, -1, 0.5, 1)};
  const auto point = common_point(planes);
  ASSERT_TRUE(point.has_value());
  for (const auto& each : planes) EXPECT_NEAR(each.normal.dot(*point), each.offset, 1e-14);
  EXPECT_FALSE(common_point({plane(1, 0, 0, 0), plane(1, 0, 0, 10)}).has_value());
}

// A body whose faces in `flat` are flat, in the unit cube's planes z = 0 and y = 0; then `turned`.
PatchModel flat_body(std::uint32_t seed, const std::vector<std::pair<size_t, int>>& flat) {
  PatchModel model = random_closed_model(seed);
  for (const auto& [patch, axis] : flat) {
    for (int id : model.patches[patch].points) model.points[static_cast<size_t>(id)][axis] = 0.0;
  }
  return model;
}

PatchModel without(const PatchModel& model, const std::vector<size_t>& patches) {
  PatchModel open = model;
  for (auto it = patches.rbegin(); it != patches.rend(); ++it) {
    open.patches.erase(open.patches.begin() + static_cast<std::ptrdiff_t>(*it));
  }
  open.joins = find_joins(open);
  return open;
}

TEST(FluxField, SkinAloneHasTheVolumeOfTheClosedBody) {
  // Patch 1 is "bottom" (z = 0), patch 5 "front" (y = 0).
  const PatchModel body = flat_body(11, {{1, 2}, {5, 1}});
  Eigen::Matrix3d skew;
  skew << 1.2, 0.3, -0.1, 0.2, 0.9, 0.4, -0.3, 0.1, 1.1;
  const Vec3 shift(3.0, -2.0, 5.0);
  for (bool oblique : {false, true}) {
    PatchModel closed = body;
    std::vector<ClosingPlane> planes = {plane(0, 0, 1, 0), plane(0, 1, 0, 0)};
    if (oblique) {
      testing::transform(closed, skew);
      testing::translate(closed, shift);
      for (ClosingPlane& each : planes) {
        const Vec3 normal = skew.inverse().transpose() * each.normal;
        each = closing_plane(normal, normal.dot(shift), "");
      }
    }
    const double volume = ExactVolume(closed).value(closed.points).to_double();
    const PatchModel open = without(closed, {1, 5});
    const VolumeForm form(open, 1, require_field(planes));
    const Bounded skin = form.bounded_value(open.points);
    EXPECT_NEAR(skin.value, volume, 1e-14 * std::abs(volume) + skin.bound);
    EXPECT_NEAR(form.value(open.points), volume, 1e-14);
    EXPECT_NEAR(form.quadrature_value(open.points).value, volume, 1e-14);
    EXPECT_LT(skin.bound, 1e-13);
    EXPECT_GT(std::abs(VolumeForm(open, 1, require_field({plane(0, 0, 1, 7)})).value(open.points) -
                       volume),
              1e-3)
        << "a field that flows through the caps must not do";
  }
}

// Derivatives and changes are those of the closed body while the rim stays in its planes.
TEST(FluxField, GradientAndChangesAreThoseOfTheBody) {
  const PatchModel closed = flat_body(12, {{1, 2}});
  const PatchModel open = without(closed, {1});
  const VolumeForm body(closed);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> step(-0.05, 0.05);
  std::vector<Vec3> after = closed.points;
  for (Vec3& p : after) {
    p += Vec3(step(random), step(random), p.z() == 0.0 ? 0.0 : step(random));
  }
  for (const double offset : {0.0, 4.0}) {
    PatchModel moved = open;
    testing::translate(moved, Vec3(0, 0, offset));
    std::vector<Vec3> moved_after = after;
    for (Vec3& p : moved_after) p.z() += offset;
    const VolumeForm skin(moved, 1, require_field({plane(0, 0, 1, offset)}));
    const Support whole = skin.whole();
    const double expected = body.change(closed.points, after, body.whole());
    const Bounded change = skin.bounded_change(moved.points, moved_after, whole);
    EXPECT_NEAR(change.value, expected, 1e-14 + change.bound);
    EXPECT_NEAR(skin.change(moved.points, moved_after, whole), expected, 1e-14);
    // Along displacements that keep the rim in the plane.
    double slope = 0.0;
    double body_slope = 0.0;
    const auto rows = skin.gradient(moved.points);
    const auto body_rows = body.gradient(closed.points);
    for (size_t i = 0; i < rows.size(); ++i) {
      slope += rows[i].dot(after[i] - closed.points[i]);
      body_slope += body_rows[i].dot(after[i] - closed.points[i]);
    }
    EXPECT_NEAR(slope, body_slope, 1e-13);
    EXPECT_EQ(skin.gradient(moved.points, whole).size(), rows.size());
  }
}

}  // namespace
}  // namespace isochor
