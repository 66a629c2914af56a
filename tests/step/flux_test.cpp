#include "isochor/step/flux.h"

#include <gtest/gtest.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <GProp_GProps.hxx>
#include <Geom2d_Circle.hxx>
#include <Geom2d_Line.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_Plane.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <random>

namespace isochor::internal {
namespace {

constexpr double kPi = 3.14159265358979323846;

TopoDS_Shape box_minus_cylinder() {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(gp_Pnt(-2, -3, -1), 4, 6, 2).Shape();
  const TopoDS_Shape hole =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0.3, 0.4, -5), gp::DZ()), 0.7, 10).Shape();
  return BRepAlgoAPI_Cut(box, hole).Shape();
}

struct Known {
  const char* name;
  TopoDS_Shape shape;
  double volume;
  double area;
};

std::vector<Known> known_shapes() {
  return {
      {"box", BRepPrimAPI_MakeBox(2, 3, 4).Shape(), 24, 52},
      {"cylinder", BRepPrimAPI_MakeCylinder(1.5, 4).Shape(), kPi * 9, kPi * 16.5},
      {"part of a cylinder", BRepPrimAPI_MakeCylinder(1.5, 4, 1.0).Shape(), 4.5, 6 + 12 + 2.25},
      {"cone", BRepPrimAPI_MakeCone(2, 1, 3).Shape(), kPi * 7, kPi * (5 + 3 * std::sqrt(10.0))},
      {"sphere", BRepPrimAPI_MakeSphere(2.0).Shape(), kPi * 32 / 3, kPi * 16},
      {"torus", BRepPrimAPI_MakeTorus(5, 1.5).Shape(), kPi * kPi * 22.5, kPi * kPi * 30},
      {"box minus cylinder", box_minus_cylinder(), 48 - 2 * 0.49 * kPi,
       24 + 24 + 16 + 24 - 2 * kPi * 0.49 + 2 * kPi * 0.7 * 2},
  };
}

std::vector<gp_Trsf> poses() {
  gp_Trsf turned, far;
  turned.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(0.3, -0.5, 0.8)), 1.1);
  far.SetTranslation(gp_Vec(1e4, -2e4, 3e4));
  return {gp_Trsf(), turned, far * turned};
}

TopoDS_Shape moved(const TopoDS_Shape& shape, const gp_Trsf& pose) {
  return BRepBuilderAPI_Transform(shape, pose, Standard_True).Shape();
}

// A closed B-spline solid: a wavy prism whose walls have several spans.
TopoDS_Shape wavy_prism() {
  TColgp_Array1OfPnt through(1, 9);
  for (int k = 1; k <= 9; ++k) {
    const double angle = 2 * kPi * (k - 1) / 8;
    through(k) = gp_Pnt((2 + 0.4 * (k % 2)) * std::cos(angle), 2 * std::sin(angle), 0.1);
  }
  TColStd_Array1OfReal knots(1, 7);
  TColStd_Array1OfInteger multiplicities(1, 7);
  for (int k = 1; k <= 7; ++k) {
    knots(k) = k;
    multiplicities(k) = k == 1 || k == 7 ? 4 : 1;
  }
  const Handle(Geom_BSplineCurve) curve = new Geom_BSplineCurve(through, knots, multiplicities, 3);
  const TopoDS_Wire wire = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(curve));
  const TopoDS_Face base = BRepBuilderAPI_MakeFace(wire, Standard_True);
  return BRepPrimAPI_MakePrism(base, gp_Vec(0.5, 0.3, 3));
}

TEST(Flux, ClosedShapesEncloseTheirKnownVolumeInEveryPose) {
  for (const Known& known : known_shapes()) {
    for (const gp_Trsf& pose : poses()) {
      const double far = pose.TranslationPart().Modulus();
      const ShapeIntegrals got = integrate_shape(moved(known.shape, pose));
      EXPECT_NEAR(got.volume, known.volume, got.bound + 1e-15 * known.volume) << known.name;
      EXPECT_LT(got.bound, 1e-12 * known.volume * (1 + far)) << known.name;
      EXPECT_NEAR(got.area, known.area, 1e-6 * known.area) << known.name;
    }
  }
}

TEST(Flux, SumOverAClosedShapeDoesNotDependOnTheOrigin) {
  for (const Known& known : known_shapes()) {
    for (double z0 : {0.0, 7.0, -100.0}) {
      double volume = 0.0;
      double projected = 0.0;
      double bound = 0.0;
      for (TopExp_Explorer it(known.shape, TopAbs_FACE); it.More(); it.Next()) {
        const FaceIntegrals face = integrate_face(TopoDS::Face(it.Current()), z0, 1e-9);
        volume += face.flux_about_zero(z0);
        projected += face.projected;
        bound += face.bound_about_zero(z0);
      }
      EXPECT_NEAR(volume, known.volume, bound + 1e-14 * known.volume) << known.name << ' ' << z0;
      EXPECT_NEAR(projected, 0.0, 1e-12 * known.area) << known.name;
    }
  }
}

TEST(Flux, ReversedShapeHasTheNegativeVolumeAndTheSameArea) {
  const TopoDS_Shape shape = box_minus_cylinder();
  const ShapeIntegrals forward = integrate_shape(shape);
  const ShapeIntegrals reversed = integrate_shape(shape.Reversed());
  EXPECT_EQ(reversed.volume, -forward.volume);
  EXPECT_EQ(reversed.area, forward.area);
}

// The flux of a field without flux through the planes of missing faces is the whole volume.
TEST(Flux, ShapeWithoutCapsHasTheVolumeByAField) {
  const TopoDS_Shape drum = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(1, 2, 3), gp::DY()), 2.0, 5.0);
  const double volume = 20.0 * M_PI;
  const FluxField field = require_field({parse_closing_plane("y=2"), parse_closing_plane("y=7")});
  double flux = 0.0;
  double bound = 0.0;
  for (TopExp_Explorer it(drum, TopAbs_FACE); it.More(); it.Next()) {
    const TopoDS_Face face = TopoDS::Face(it.Current());
    if (BRepAdaptor_Surface(face).GetType() != GeomAbs_Cylinder) continue;
    const FaceIntegrals wall = integrate_face(face, 0.0, 1e-9, field);
    flux += wall.flux;
    bound += wall.bound;
  }
  EXPECT_NEAR(flux, volume, bound + 1e-13 * volume);
  EXPECT_LT(bound, 1e-11 * volume);
  EXPECT_NEAR(integrate_shape(drum, require_field({parse_closing_plane("1,2,3,4")})).volume, volume,
              1e-12 * volume)
      << "on closed shapes any field will do";
}

// Second method: OpenCASCADE's adaptive integration with a tolerance (never its default).
TEST(Flux, AgreesWithAdaptiveIntegrationOnBSplineSolids) {
  std::vector<TopoDS_Shape> shapes = {wavy_prism(),
                                      BRepBuilderAPI_NurbsConvert(wavy_prism()).Shape()};
  for (const TopoDS_Shape& shape : shapes) {
    GProp_GProps properties;
    const double error = BRepGProp::VolumePropertiesGK(shape, properties, 1e-10);
    const ShapeIntegrals got = integrate_shape(shape);
    EXPECT_GT(error, -1.0);
    EXPECT_NEAR(got.volume, properties.Mass(), 1e-9 * properties.Mass());
    EXPECT_LT(got.bound, 1e-12 * got.volume);
  }
}

// The flux through z = a u v over a disc of radius r about c: a (integral of u v) in closed form.
TEST(Flux, BilinearSurfaceTrimmedByACircleMatchesTheClosedForm) {
  TColgp_Array2OfPnt poles(1, 2, 1, 2);
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) poles(i + 1, j + 1) = gp_Pnt(i, j, 3.0 * i * j + 0.5);
  }
  const Handle(Geom_BezierSurface) surface = new Geom_BezierSurface(poles);
  EdgeUse circle;
  const double r = 0.2;
  circle.curve = new Geom2d_Circle(gp_Ax2d(gp_Pnt2d(0.4, 0.6), gp_Dir2d(1, 0)), r);
  circle.last = 2 * kPi;
  FaceLoop loop;
  loop.uses.push_back(circle);
  const FaceIntegrals disc = integrate_face(surface, {loop}, TrimKind::kTrimmed, false, 0.0);
  const double expected = kPi * r * r * (3.0 * 0.4 * 0.6 + 0.5);
  EXPECT_NEAR(disc.flux, expected, disc.bound + 1e-15);
  EXPECT_LT(disc.bound, 1e-14);
  EXPECT_NEAR(disc.projected, kPi * r * r, 1e-15);

  const FaceIntegrals whole = integrate_face(surface, {}, TrimKind::kNatural, false, 0.0);
  EXPECT_NEAR(whole.flux, 0.75 + 0.5, 1e-15);
  // Midpoint rule with 2000 x 500 points: 2.53764995.
  EXPECT_NEAR(whole.area, 2.53764995, 1e-5);
}

TEST(Flux, HoleAndItsFillingAddUpToTheFaceWithout) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> wave(-0.4, 0.4);
  TColgp_Array2OfPnt poles(1, 8, 1, 7);
  for (int i = 1; i <= 8; ++i) {
    for (int j = 1; j <= 7; ++j)
      poles(i, j) = gp_Pnt(i + wave(random), j + wave(random), wave(random));
  }
  const auto knots = [](int spans) {
    TColStd_Array1OfReal at(1, spans + 1);
    for (int k = 0; k <= spans; ++k) at(k + 1) = k + 0.1 * k * k;
    return at;
  };
  const auto multiplicities = [](int spans) {
    TColStd_Array1OfInteger at(1, spans + 1);
    at.Init(1);
    at(1) = at(spans + 1) = 4;
    return at;
  };
  const Handle(Geom_BSplineSurface) surface = new Geom_BSplineSurface(
      poles, knots(5), knots(4), multiplicities(5), multiplicities(4), 3, 3);
  const auto circle = [](bool reversed) {
    EdgeUse use;
    use.curve = new Geom2d_Circle(gp_Ax2d(gp_Pnt2d(3.1, 2.7), gp_Dir2d(1, 0)), 2.05);
    use.last = 2 * kPi;
    use.reversed = reversed;
    FaceLoop loop;
    loop.uses.push_back(use);
    return loop;
  };
  const auto segment = [](double u0, double v0, double u1, double v1) {
    EdgeUse use;
    const gp_Vec2d along(gp_Pnt2d(u0, v0), gp_Pnt2d(u1, v1));
    use.curve = new Geom2d_Line(gp_Pnt2d(u0, v0), gp_Dir2d(along));
    use.last = along.Magnitude();
    return use;
  };
  FaceLoop outer;
  outer.uses = {segment(0, 0, 7.5, 0), segment(7.5, 0, 7.5, 5.6), segment(7.5, 5.6, 0, 5.6),
                segment(0, 5.6, 0, 0)};
  const FaceIntegrals whole = integrate_face(surface, {}, TrimKind::kNatural, false, 0.2);
  const FaceIntegrals rim =
      integrate_face(surface, {outer, circle(true)}, TrimKind::kTrimmedWithHoles, false, 0.2);
  const FaceIntegrals disc =
      integrate_face(surface, {circle(false)}, TrimKind::kTrimmed, false, 0.2);
  EXPECT_GT(std::abs(disc.flux), 1e-3);
  EXPECT_NEAR(rim.flux + disc.flux, whole.flux, rim.bound + disc.bound + whole.bound + 1e-14);
  EXPECT_LT(rim.bound + disc.bound, 1e-12 * whole.area);
  EXPECT_NEAR(rim.area + disc.area, whole.area, 1e-6 * whole.area);
}

TEST(Flux, OpenLoopHasNoBound) {
  const Handle(Geom_Plane) plane = new Geom_Plane(gp::XOY());
  EdgeUse half;
  half.curve = new Geom2d_Circle(gp_Ax2d(gp_Pnt2d(0, 0), gp_Dir2d(1, 0)), 1.0);
  half.last = kPi;
  FaceLoop loop;
  loop.uses.push_back(half);
  const FaceIntegrals got = integrate_face(plane, {loop}, TrimKind::kTrimmed, false, 0.0);
  EXPECT_TRUE(std::isinf(got.bound));
}

}  // namespace
}  // namespace isochor::internal
