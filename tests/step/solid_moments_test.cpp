// Moments of solids with analytic and trimmed faces: closed forms, motions, patch models.
#include "isochor/step/solid_moments.h"

#include <gtest/gtest.h>

#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <cmath>

#include "isochor/bspline/patch_model.h"
#include "isochor/step/bridge.h"
#include "isochor/step/document.h"
#include "isochor/step/document_model.h"
#include "isochor/step/model_bytes.h"
#include "shapes.h"

namespace isochor::internal {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Body {
  const char* name;
  TopoDS_Shape shape;
  double volume;
  Vec3 centroid;
  Matrix3 second;  // about the centroid
};

Matrix3 diagonal_of(double x, double y, double z) { return Vec3(x, y, z).asDiagonal(); }

// Second moments of a mass at `at`, seen from `from`.
Matrix3 shifted(double mass, const Vec3& at, const Vec3& from) {
  return mass * (at - from) * (at - from).transpose();
}

// A plate 4 x 6 x 2 about the origin with a round hole at (0.3, 0.4).
Body holed_plate() {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(gp_Pnt(-2, -3, -1), 4, 6, 2).Shape();
  const TopoDS_Shape hole =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0.3, 0.4, -5), gp::DZ()), 0.7, 10).Shape();
  const double cut = kPi * 0.49 * 2;
  const Vec3 at(0.3, 0.4, 0);
  const double volume = 48 - cut;
  const Vec3 centroid = -cut / volume * at;
  const Matrix3 of_plate = 48.0 / 12 * diagonal_of(16, 36, 4) + shifted(48, Vec3::Zero(), centroid);
  const Matrix3 of_hole =
      cut * diagonal_of(0.49 / 4, 0.49 / 4, 4.0 / 12) + shifted(cut, at, centroid);
  return {"holed plate", BRepAlgoAPI_Cut(box, hole).Shape(), volume, centroid, of_plate - of_hole};
}

std::vector<Body> bodies() {
  const double cylinder = kPi * 9;
  const double cone = kPi * 4;
  const double sphere = kPi * 32 / 3;
  const double torus = kPi * kPi * 22.5;
  const double across = 25.0 / 2 + 3 * 2.25 / 8;
  return {
      {"box", BRepPrimAPI_MakeBox(2, 3, 4).Shape(), 24, Vec3(1, 1.5, 2), 2 * diagonal_of(4, 9, 16)},
      {"cylinder", BRepPrimAPI_MakeCylinder(1.5, 4).Shape(), cylinder, Vec3(0, 0, 2),
       cylinder * diagonal_of(2.25 / 4, 2.25 / 4, 16.0 / 12)},
      {"cone", BRepPrimAPI_MakeCone(2, 0, 3).Shape(), cone, Vec3(0, 0, 0.75),
       cone * diagonal_of(0.15 * 4, 0.15 * 4, 27.0 / 80)},
      {"sphere", BRepPrimAPI_MakeSphere(2.0).Shape(), sphere, Vec3::Zero(),
       sphere / 5 * diagonal_of(4, 4, 4)},
      {"torus", BRepPrimAPI_MakeTorus(5, 1.5).Shape(), torus, Vec3::Zero(),
       torus * diagonal_of(across, across, 2.25 / 4)},
      holed_plate(),
  };
}

// Within the bounds, which are small, of what geometry says.
void expect_body(const Moments& m, const Body& body, const gp_Trsf& pose, double far) {
  const gp_Mat rows = pose.VectorialPart();
  Matrix3 turn;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) turn(i, j) = rows(i + 1, j + 1);
  }
  const gp_Pnt moved =
      gp_Pnt(body.centroid.x(), body.centroid.y(), body.centroid.z()).Transformed(pose);
  const Vec3 centroid(moved.X(), moved.Y(), moved.Z());
  const Matrix3 second = turn * body.second * turn.transpose();
  const double scale = body.second.norm();
  EXPECT_NEAR(m.volume.value, body.volume, m.volume.bound + 4e-15 * body.volume) << body.name;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(m.centroid[i], centroid[i], m.centroid_bound[i] + 4e-15) << body.name;
    EXPECT_LT(m.centroid_bound[i], 1e-11 * (1 + far)) << body.name;
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(m.second(i, j), second(i, j), m.second_bound(i, j) + 4e-15 * scale) << body.name;
      EXPECT_LT(m.second_bound(i, j), 1e-11 * (1 + far) * scale) << body.name;
    }
  }
  EXPECT_LT((m.second - second).norm(), 1e-13 * (1 + far) * scale) << body.name;
}

TEST(SolidMoments, ClosedFormsInEveryPose) {
  gp_Trsf turned, far;
  turned.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(0.3, -0.5, 0.8)), 1.1);
  far.SetTranslation(gp_Vec(1e4, -2e4, 3e4));
  for (const Body& body : bodies()) {
    for (const gp_Trsf& pose : {gp_Trsf(), turned, gp_Trsf(far * turned)}) {
      const TopoDS_Shape shape = BRepBuilderAPI_Transform(body.shape, pose, Standard_True).Shape();
      expect_body(moments_from(shape_moments(shape)), body, pose, pose.TranslationPart().Modulus());
    }
    // The same bodies as rational B-splines.
    const TopoDS_Shape splines = BRepBuilderAPI_NurbsConvert(body.shape).Shape();
    expect_body(moments_from(shape_moments(splines)), body, gp_Trsf(), 0.0);
  }
}

TEST(SolidMoments, ReversedShapeHasNegativeMoments) {
  const TopoDS_Shape shape = holed_plate().shape;
  const MomentIntegrals forward = shape_moments(shape);
  const MomentIntegrals reversed = shape_moments(shape.Reversed());
  for (size_t k = 0; k < kMomentCount; ++k) EXPECT_EQ(reversed.value[k], -forward.value[k]);
}

// All faces are whole B-spline patches here, so that two programs measure the same body.
void expect_like_patches(const SolidModel& solid) {
  for (const FaceFacts& face : solid.faces) ASSERT_EQ(face.trim, TrimKind::kNatural);
  ASSERT_TRUE(solid.moments.has_value());
  const Moments got = moments_from(*solid.moments);
  const Moments patches = MomentForm(solid.patches).moments(solid.patches.points);
  // Faces of a file meet within its precision only: what is left depends on the origin a little.
  const double gap = solid.facts.max_edge_gap * solid.facts.area;
  const double size = solid.facts.diagonal;
  EXPECT_NEAR(got.volume.value, patches.volume.value, 1e-13 * got.volume.value + gap);
  EXPECT_LT((got.centroid - patches.centroid).norm(), 1e-13 * size + gap * size / got.volume.value);
  EXPECT_LT((got.second - patches.second).norm(), 1e-13 * got.second.norm() + gap * size * size);
}

TEST(SolidMoments, SolidsOfWholePatchesAgreeWithTheirPatchModel) {
  ReadOptions options;
  options.moments = true;
  expect_like_patches(document_model(shapes::document_of(shapes::bicubic_cube(2.0)), options));
}

TEST(SolidMoments, BundledFuselageOfTwelvePatches) {
  const std::string file = std::string(ISOCHOR_SOURCE_DIR) + "/data/step/fuselage12.step";
  ReadOptions options;
  options.moments = true;
  const SolidModel solid = read_solid(file, options);
  ASSERT_TRUE(solid.moments.has_value());
  const Moments m = moments_from(*solid.moments);
  EXPECT_NEAR(m.volume.value, solid.facts.volume, m.volume.bound + solid.facts.volume_bound);
  // It is symmetric in y, and slender along x.
  EXPECT_LT(std::abs(m.centroid.y()), 1e-9);
  EXPECT_LT(std::abs(m.second(0, 1)) + std::abs(m.second(1, 2)), 1e-9 * m.second.norm());
  EXPECT_GT(std::abs(m.axes(0, 0)), 0.99);
  EXPECT_LT(m.axis_bound[0], 1e-6);
  EXPECT_FALSE(read_solid(file).moments.has_value()) << "only when asked for";
}

// Second moments about the origin add up where bodies do.
Matrix3 about_zero(const Moments& m) {
  return m.second + shifted(m.volume.value, m.centroid, Vec3::Zero());
}

TEST(SolidMoments, ABodyCutInTwoAddsUp) {
  const TopoDS_Shape cube = shapes::bicubic_cube(1.0, 12);
  const TopoDS_Shape rod =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0.5, 0.4, -1), gp::DZ()), 0.11, 3).Shape();
  const Moments whole = moments_from(shape_moments(cube));
  const Moments outside = moments_from(shape_moments(BRepAlgoAPI_Cut(cube, rod).Shape()));
  const Moments inside = moments_from(shape_moments(BRepAlgoAPI_Common(cube, rod).Shape()));
  EXPECT_GT(inside.volume.value, 0.01 * whole.volume.value);
  // The cut runs along curves that the boolean operation approximates to about 1e-7.
  const double fit = 1e-7;
  EXPECT_NEAR(outside.volume.value + inside.volume.value, whole.volume.value, fit);
  const Vec3 first =
      outside.volume.value * outside.centroid + inside.volume.value * inside.centroid;
  EXPECT_LT((first - whole.volume.value * whole.centroid).norm(), fit);
  EXPECT_LT((about_zero(outside) + about_zero(inside) - about_zero(whole)).norm(), fit);
  EXPECT_LT(outside.second_bound.maxCoeff(), 1e-10);
}

TEST(SolidMoments, CrossTheBridgeBitForBit) {
  SolidModel model;
  model.moments = MomentIntegrals{Vec3(1, 2, 3), {1, 0.1, 0.2}, {1e-9}};
  const auto back = from_bytes<SolidModel>(to_bytes(model));
  ASSERT_TRUE(back.moments.has_value());
  EXPECT_EQ(back.moments->origin, model.moments->origin);
  EXPECT_EQ(back.moments->value, model.moments->value);
  EXPECT_EQ(back.moments->bound, model.moments->bound);
}

}  // namespace
}  // namespace isochor::internal
