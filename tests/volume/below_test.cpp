// Volumes below a plane that are known, and the laws of below.h.
#include "isochor/volume/below.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "isochor/base/error.h"
#include "isochor/bspline/model_refinement.h"
#include "isochor/volume/below_cells.h"
#include "isochor/volume/moments.h"
#include "isochor/volume/section.h"
#include "isochor/volume/volume_form.h"
#include "support/messages.h"
#include "support/models.h"
#include "support/revolved.h"

namespace isochor {
namespace {

const double kPi = std::acos(-1.0);

Eigen::Matrix3d turned() {
  return Eigen::AngleAxisd(0.9, Vec3(2, -1, 0.4).normalized()).toRotationMatrix();
}

ClosingPlane plane(const Vec3& n, double h) { return {n.normalized(), h / n.norm(), false}; }

void expect_part(const PartBelow& got, double volume, const Vec3& centroid, double share = 1e-12) {
  EXPECT_EQ(got.side, PlaneSide::kCut);
  EXPECT_NEAR(got.volume, volume, got.bound + 1e-15 * std::abs(volume));
  EXPECT_NEAR(got.volume, volume, share * std::abs(volume));
  EXPECT_LT(got.bound, 100 * share * std::abs(volume));
  EXPECT_LE((got.centroid - centroid).norm(), got.centroid_bound + 1e-15);
  EXPECT_LT(got.centroid_bound, 1000 * share);
}

TEST(Below, OfTheUnitCube) {
  for (const auto& [degree, spans] : {std::pair{1, 1}, std::pair{2, 3}, std::pair{3, 6}}) {
    const PatchModel cube = testing::make_cube_model(degree, spans);
    expect_part(part_below(cube, plane(Vec3(0, 0, 1), 0.3)), 0.3, Vec3(0.5, 0.5, 0.15));
    expect_part(part_below(cube, plane(Vec3(0, 0, -1), -0.3)), 0.7, Vec3(0.5, 0.5, 0.65));
    expect_part(part_below(cube, plane(Vec3(0, 2, 0), 0.5)), 0.25, Vec3(0.5, 0.125, 0.5));
    // A corner, and half of it all.
    expect_part(part_below(cube, plane(Vec3(1, 1, 1), 0.5)), 0.125 / 6, Vec3::Constant(0.125));
    const PartBelow half = part_below(cube, plane(Vec3(1, 1, 1), 1.5));
    EXPECT_NEAR(half.volume, 0.5, half.bound);
    EXPECT_TRUE(half.proven);
    EXPECT_LT(half.bound, 1e-11);
  }
}

TEST(Below, OfRoundBodies) {
  PatchModel ball = testing::make_sphere(2.0);
  for (const Vec3& n : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(1, 2, -0.5)}) {
    for (double h : {-1.5, 0.0, 0.4, 1.9}) {
      const double depth = 2.0 + h;
      const double volume = kPi * depth * depth * (6.0 - depth) / 3.0;
      const double low = -0.75 * (4.0 - depth) * (4.0 - depth) / (6.0 - depth);
      const PartBelow part = part_below(ball, plane(n.normalized(), h));
      expect_part(part, volume, low * n.normalized());
      EXPECT_FALSE(part.proven);
    }
  }
  testing::translate(ball, Vec3(0, 100, 0));
  expect_part(part_below(ball, plane(Vec3(0, 1, 0), 100.0)), kPi * 16 / 3, Vec3(0, 99.25, 0),
              1e-11);
  // A cylinder cut aslant through its axis' middle, and along.
  const PatchModel cylinder = testing::make_cylinder(1.0, 6.0);
  const PartBelow slanted = part_below(cylinder, plane(Vec3(0.6, 0, 0.8), 2.4));
  expect_part(slanted, 3 * kPi, Vec3(-0.75 / 12, 0, 1.5 + 0.5625 / 24));
  expect_part(part_below(cylinder, plane(Vec3(1, 0, 0), 0.0)), 3 * kPi,
              Vec3(-4 / (3 * kPi), 0, 3.0));
}

// A torus that the plane touches from inside along a circle, and at a point: nothing to divide by.
TEST(Below, WhereThePlaneTouches) {
  const PatchModel torus = testing::make_rational_torus(3.0, 1.0);
  const PartBelow all = part_below(torus, plane(Vec3(0, 0, 1), 1.0));
  EXPECT_NEAR(all.volume, 6 * kPi * kPi, all.bound + 1e-12);
  EXPECT_LT(all.bound, 1e-7);
  const PartBelow half = part_below(torus, plane(Vec3(1, 0, std::sqrt(8.0)), 0.0));
  EXPECT_NEAR(half.volume, 3 * kPi * kPi, half.bound);
  EXPECT_LT(half.bound, 1e-7);
}

// Law (2), on bodies without closed forms, and that everything turns along.
TEST(Below, HalvesAreTheWholeInEveryPose) {
  testing::RandomModelOptions options;
  for (const double ratio : {1.0, 3.0}) {
    options.weight_ratio = ratio;
    PatchModel model = testing::random_closed_model(521, options);
    const double whole = VolumeForm(model).value(model.points);
    const Vec3 g = MomentForm(model).moments(model.points).centroid;
    const Vec3 n = Vec3(0.3, 1, -0.4).normalized();
    const PartBelow below = part_below(model, plane(n, 0.25));
    const PartBelow above = part_below(model, plane(-n, -0.25));
    EXPECT_EQ(below.proven, ratio == 1.0);
    EXPECT_GT(below.volume, 0.1);
    EXPECT_LT(below.bound, 1e-10);
    EXPECT_NEAR(below.volume + above.volume, whole, below.bound + above.bound);
    const Vec3 both = (below.volume * below.centroid + above.volume * above.centroid) / whole;
    EXPECT_LT((both - g).norm(), 1e-11);
    testing::transform(model, turned());
    testing::translate(model, Vec3(3, 4, 5));
    const Vec3 to = turned() * n;
    const PartBelow after = part_below(model, plane(to, 0.25 + to.dot(Vec3(3, 4, 5))));
    EXPECT_NEAR(after.volume, below.volume, below.bound + after.bound + 1e-14);
    EXPECT_LT((after.centroid - turned() * below.centroid - Vec3(3, 4, 5)).norm(),
              after.centroid_bound + below.centroid_bound);
    for (Patch& patch : model.patches) patch.reversed = !patch.reversed;
    const PartBelow inside_out = part_below(model, plane(to, 0.25 + to.dot(Vec3(3, 4, 5))));
    EXPECT_EQ(inside_out.volume, -after.volume);
    EXPECT_LT((inside_out.centroid - after.centroid).norm(), 1e-14);
  }
}

// The derivative of the volume by the height is the area of the section: a second method.
TEST(Below, GrowsByTheSection) {
  testing::RandomModelOptions options;
  options.degrees[1] = 2;
  const PatchModel model = testing::random_closed_model(525, options);
  const double step = 1e-3;
  for (double h : {0.3, 0.5, 0.7}) {
    const double up = part_below(model, plane(Vec3::UnitX(), h + step)).volume;
    const double down = part_below(model, plane(Vec3::UnitX(), h - step)).volume;
    const double simpson =
        (section(model, Vec3::UnitX(), h - step).area + 4 * section(model, Vec3::UnitX(), h).area +
         section(model, Vec3::UnitX(), h + step).area) /
        6;
    EXPECT_NEAR((up - down) / (2 * step), simpson, 1e-9);
  }
}

KnotVector with_knot(const KnotVector& knots, double at) {
  std::vector<double> all = knots.knots();
  all.insert(std::upper_bound(all.begin(), all.end(), at), at);
  return KnotVector(knots.degree(), all);
}

TEST(Below, RefinementChangesNothing) {
  testing::RandomModelOptions options;
  options.spans = 2;
  const PatchModel model = testing::random_closed_model(523, options);
  PatchModel finer = model;
  for (int q = 0; q < 6; ++q) {
    const Patch& patch = finer.patches[static_cast<size_t>(q)];
    finer = refine(finer, q, with_knot(patch.u_knots, 0.37), with_knot(patch.v_knots, 0.61));
  }
  for (double h : {0.2, 0.5, 0.9}) {
    const PartBelow a = part_below(model, plane(Vec3(1, 0.2, 0.1), h));
    const PartBelow b = part_below(finer, plane(Vec3(1, 0.2, 0.1), h));
    EXPECT_NEAR(a.volume, b.volume, a.bound + b.bound);
    EXPECT_LT((a.centroid - b.centroid).norm(), a.centroid_bound + b.centroid_bound);
  }
}

// High degrees, for which no rule is exact up to a cubic, or at all.
TEST(Below, HighDegrees) {
  for (const int degree : {11, 17}) {
    testing::RandomModelOptions options;
    options.degrees[0] = degree;
    options.degrees[1] = degree < 17 ? 2 : 16;
    options.degrees[2] = 2;
    options.spans = 1;
    options.bend = 0.004;
    const PatchModel model = testing::random_closed_model(524, options);
    const double whole = VolumeForm(model).value(model.points);
    const PartBelow below = part_below(model, plane(Vec3(1, 0.3, 0.1), 0.6));
    const PartBelow above = part_below(model, plane(Vec3(-1, -0.3, -0.1), -0.6));
    EXPECT_NEAR(below.volume + above.volume, whole, below.bound + above.bound);
    EXPECT_LT(below.bound, 1e-10) << degree;
    EXPECT_EQ(below.proven, degree < 17) << degree;
  }
}

// The starboard half of a Wigley hull, y = (1 - 4 x^2 / L^2)(1 - z^2 / T^2) B / 2, -T <= z <= 0:
// open along the centre plane and the deck z = 0.
PatchModel wigley(double length, double beam, double draught) {
  const KnotVector knots = KnotVector(2, {0, 0, 0, 1, 1, 1});
  PatchModel model;
  // Bernstein coefficients of x and y over u, of z and 1 - z^2 / T^2 over v.
  const double x[] = {-length / 2, 0, length / 2}, along[] = {0, 2, 0};
  const double z[] = {-draught, -draught / 2, 0}, down[] = {0, 1, 1};
  Patch patch{"side", "face:1", knots, knots, {}, {}, false, {}, {}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      patch.points.push_back(static_cast<int>(model.points.size()));
      model.points.emplace_back(x[i], beam / 2 * along[i] * down[j], z[j]);
    }
  }
  patch.reversed = true;  // x cross z is -y
  model.patches.push_back(patch);
  return model;
}

TEST(Below, WigleyHullByItsClosedForm) {
  const double length = 10, beam = 1, draught = 0.625;
  const PatchModel hull = wigley(length, beam, draught);
  const std::vector<ClosingPlane> close = {plane(Vec3::UnitY(), 0), plane(Vec3::UnitZ(), 0)};
  const auto integral = [&](double z) { return z - z * z * z / (3 * draught * draught); };
  const auto moment = [&](double z) { return z * z / 2 - z * z * z * z / (4 * draught * draught); };
  for (double h : {-0.6, -0.3125, -0.01}) {
    const double shape = integral(h) - integral(-draught);
    const double volume = beam / 2 * (2 * length / 3) * shape;
    const double low = (moment(h) - moment(-draught)) / shape;
    // y: half the mean of y^2 over that of y.
    const auto square = [&](double z) {
      const double t = z / draught;
      return draught * (t - 2 * t * t * t / 3 + t * t * t * t * t / 5);
    };
    const double out = beam / 4 * (8.0 / 15) / (2.0 / 3) * (square(h) - square(-draught)) / shape;
    const PartBelow part = part_below(hull, plane(Vec3::UnitZ(), h), close);
    expect_part(part, volume, Vec3(0, out, low), 1e-11);
    EXPECT_TRUE(part.proven);
    // Heeled about the x axis, in the frame of the water.
    PatchModel turned_hull = hull;
    testing::transform(turned_hull, turned());
    const PartBelow other =
        part_below(turned_hull, plane(turned() * Vec3::UnitZ(), h),
                   {plane(turned() * Vec3::UnitY(), 0), plane(turned() * Vec3::UnitZ(), 0)});
    EXPECT_NEAR(other.volume, volume, other.bound + 1e-15);
  }
  // Over the deck: everything, as the volume of the closed hull has it.
  const PartBelow all = part_below(hull, plane(Vec3::UnitZ(), 0.2), close);
  EXPECT_EQ(all.side, PlaneSide::kEverything);
  EXPECT_NEAR(all.volume, beam / 2 * (2 * length / 3) * (2 * draught / 3), all.bound + 1e-14);
  EXPECT_EQ(part_below(hull, plane(Vec3::UnitZ(), -0.7), close).side, PlaneSide::kNothing);
}

// A trimmed, listing waterline: symmetric halves cut by planes that lean fore and aft.
TEST(Below, LeaningPlanesAndClosedHalves) {
  const PatchModel hull = wigley(10, 1, 0.625);
  const std::vector<ClosingPlane> close = {plane(Vec3::UnitY(), 0), plane(Vec3::UnitZ(), 0)};
  // The centre plane holds the direction of the field; the deck does not, but lies above.
  const ClosingPlane leaning = plane(Vec3(0.05, 0, 1), -0.3);
  const PartBelow part = part_below(hull, leaning, {close[0]});
  EXPECT_EQ(part.side, PlaneSide::kCut);
  // Strips across the hull, where the waterline is z = -0.3 - 0.05 x: exact for polynomials.
  double sum = 0.0;
  const GaussRule rule = gauss_legendre(8);
  for (size_t g = 0; g < rule.nodes.size(); ++g) {
    const double x = -5 + 10 * rule.nodes[g];
    const double h = (leaning.offset - leaning.normal.x() * x) / leaning.normal.z();
    const auto area = [&](double z) { return z - z * z * z / (3 * 0.625 * 0.625); };
    sum += 10 * rule.weights[g] * 0.5 * (1 - 4 * x * x / 100) * (area(h) - area(-0.625));
  }
  EXPECT_NEAR(part.volume, sum, part.bound + 1e-14);
  EXPECT_LT(part.bound, 1e-11);
  // With the deck named as well no direction crosses the water, but one lies in all planes.
  const PartBelow along =
      part_below(hull, plane(Vec3(0, 0, 1), -0.3), {close[0], plane(Vec3::UnitZ(), -0.7)});
  EXPECT_NEAR(along.volume, part_below(hull, plane(Vec3(0, 0, 1), -0.3), close).volume,
              along.bound + 1e-13);
  EXPECT_LT(along.bound, 1e-9);
}

// A deck that slopes, over a stern plane and the centre plane: no direction lies in all of them,
// and none needs to where the deck is above the water.
TEST(Below, CapsAboveTheWaterDoNotMatter) {
  const PatchModel cube = testing::make_cube_model(1, 1);
  const ClosingPlane sheer = plane(Vec3(-0.1, 0, 1), 0.9);
  const std::vector<ClosingPlane> close = {plane(Vec3::UnitY(), 0), plane(Vec3::UnitX(), 0), sheer};
  const Vec3 low = Vec3::Zero(), high = Vec3::Ones();
  EXPECT_EQ(internal::caps_below(plane(Vec3::UnitZ(), 0.5), close, low, high).size(), 2U);
  EXPECT_EQ(internal::caps_below(plane(Vec3::UnitZ(), 0.95), close, low, high).size(), 3U);
  EXPECT_EQ(internal::caps_below(plane(-Vec3::UnitZ(), -0.95), close, low, high).size(), 3U);
  // As if the sheer closed it; below 0.5 the cube has everything but walls that are planes.
  const PartBelow part = part_below(cube, plane(Vec3::UnitZ(), 0.5), close);
  EXPECT_NEAR(part.volume, 0.5, part.bound);
  // Below the sheer's end a field along y is left, which is zero on the centre plane.
  const std::optional<FluxField> field = field_below(plane(Vec3::UnitZ(), 0.95), close);
  ASSERT_TRUE(field.has_value());
  EXPECT_EQ(field->direction, Vec3::UnitY());
}

TEST(Below, PlanesThatMissTheBody) {
  const PatchModel cube = testing::make_cube_model(2, 2);
  const PartBelow nothing = part_below(cube, plane(Vec3::UnitZ(), -0.5));
  EXPECT_EQ(nothing.side, PlaneSide::kNothing);
  EXPECT_EQ(nothing.volume, 0.0);
  EXPECT_EQ(nothing.bound, 0.0);
  EXPECT_TRUE(std::isinf(nothing.centroid_bound));
  const PartBelow all = part_below(cube, plane(Vec3::UnitZ(), 1.5));
  EXPECT_EQ(all.side, PlaneSide::kEverything);
  EXPECT_NEAR(all.volume, 1.0, all.bound);
  // In the plane of a face.
  EXPECT_EQ(part_below(cube, plane(Vec3::UnitZ(), 1.0)).side, PlaneSide::kEverything);
  EXPECT_EQ(part_below(cube, plane(Vec3::UnitZ(), 0.0)).side, PlaneSide::kNothing);
}

TEST(Below, WaterlinesKeepTheirSide) {
  EXPECT_EQ(parse_waterline("z=0.4").normal, Vec3::UnitZ());
  const ClosingPlane turned_over = parse_waterline("0,0,-2,-0.8");
  EXPECT_EQ(turned_over.normal, Vec3(-Vec3::UnitZ()));
  EXPECT_EQ(turned_over.offset, -0.4);
  EXPECT_EQ(parse_waterline("0.6,0,-0.8,1").normal, Vec3(0.6, 0, -0.8));
  EXPECT_NE(testing::message_of<InputError>([] { (void)parse_waterline("z<4"); }).find("z<4"),
            std::string::npos);
}

TEST(Below, PlanesWithoutAFieldAreRefused) {
  const PatchModel cube = testing::make_cube_model(1, 1);
  const std::vector<ClosingPlane> four = {plane(Vec3(1, 0, 0), 0), plane(Vec3(0, 1, 0), 0),
                                          plane(Vec3(1, 1, 1), 0), plane(Vec3(1, -1, 2), 3)};
  EXPECT_FALSE(field_below(plane(Vec3::UnitZ(), 0.5), four));
  const std::string message = testing::message_of<InputError>(
      [&] { (void)part_below(cube, plane(Vec3::UnitZ(), 0.5), four); });
  for (const char* part : {"the plane z = 0.5", "cannot be measured", "cap the model"}) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

TEST(Below, FieldsVanishOnTheWaterlineWhereTheyCan) {
  const ClosingPlane water = plane(Vec3::UnitZ(), 0.5);
  for (const auto& closing :
       {std::vector<ClosingPlane>{},
        {plane(Vec3::UnitY(), 0)},
        {plane(Vec3::UnitY(), 0), plane(Vec3(1, 0, -0.4), 2)},
        {plane(Vec3::UnitY(), 0), plane(Vec3::UnitZ(), 0.5), plane(Vec3::UnitX(), 1)}}) {
    const FluxField field = require_field_below(water, closing);
    EXPECT_NEAR(field.slope.dot(field.direction), 1.0, 1e-15);
    EXPECT_EQ(field.at(Vec3(3, 4, 0.5)), Vec3::Zero());
  }
}

// The residual on a curve, in two ways.
TEST(Below, HeightsAlongACurve) {
  internal::BezierCell cell{3, 2, {}, false};
  for (int k = 0; k < 12; ++k) cell.at.emplace_back(0, 0, std::cos(3.0 * k), 1);
  const std::vector<double> r = {0.2, 0.5, 0.1, 0.8};
  const std::vector<double> z = internal::heights_along(cell, r);
  ASSERT_EQ(z.size(), 12U);
  const auto value = [](std::vector<double> c, double t) {
    for (size_t round = 1; round < c.size(); ++round) {
      for (size_t i = 0; i + round < c.size(); ++i) c[i] += t * (c[i + 1] - c[i]);
    }
    return c[0];
  };
  for (double v : {0.0, 0.3, 0.77, 1.0}) {
    EXPECT_NEAR(value(z, v), internal::CellLine(cell, v).height(value(r, v)), 1e-14);
  }
  const internal::BezierCell part = internal::part_of_cell(cell, -0.25, 0.5, 0.25, 1.5);
  for (double s : {0.0, 0.4, 1.0}) {
    EXPECT_NEAR(internal::CellLine(part, s).height(s),
                internal::CellLine(cell, 0.25 + 1.25 * s).height(-0.25 + 0.75 * s), 1e-13);
  }
}

}  // namespace
}  // namespace isochor
