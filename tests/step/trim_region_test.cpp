#include "isochor/step/trim_region.h"

#include <gtest/gtest.h>

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Circle.hxx>
#include <Geom2d_Line.hxx>
#include <Geom_Plane.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <cmath>

#include "isochor/step/occt_surface.h"
#include "step/shapes.h"

namespace isochor::internal {
namespace {

constexpr double kPi = 3.14159265358979323846;

FaceTrim trim_of(const TopoDS_Face& face) {
  return classify_trim(BRep_Tool::Surface(face), face_loops(face), 1e-9);
}

TopoDS_Face first_face(const TopoDS_Shape& shape) {
  return TopoDS::Face(TopExp_Explorer(shape, TopAbs_FACE).Current());
}

bool inside(const TrimRegion& region, double u, double v) {
  bool odd = false;
  for (const auto& loop : region.loops) {
    for (size_t k = 0; k < loop.size(); ++k) {
      const Uv& a = loop[k];
      const Uv& b = loop[(k + 1) % loop.size()];
      if ((a.v > v) != (b.v > v) && u < a.u + (b.u - a.u) * (v - a.v) / (b.v - a.v)) odd = !odd;
    }
  }
  return odd;
}

EdgeUse segment(double u0, double v0, double u1, double v1) {
  EdgeUse use;
  const gp_Vec2d along(gp_Pnt2d(u0, v0), gp_Pnt2d(u1, v1));
  use.curve = new Geom2d_Line(gp_Pnt2d(u0, v0), gp_Dir2d(along));
  use.last = along.Magnitude();
  return use;
}

FaceLoop polygon(const std::vector<gp_Pnt2d>& corners) {
  FaceLoop loop;
  for (size_t k = 0; k < corners.size(); ++k) {
    const gp_Pnt2d& a = corners[k];
    const gp_Pnt2d& b = corners[(k + 1) % corners.size()];
    loop.uses.push_back(segment(a.X(), a.Y(), b.X(), b.Y()));
  }
  return loop;
}

// The surface of one bicubic face of the cube, over [0,1] x [0,1].
Handle(Geom_Surface) square() { return plain_bspline(first_face(shapes::bicubic_cube())); }

TEST(TrimRegion, FaceOverItsWholeSurfaceIsNaturalWithAnEmptyRegion) {
  const FaceTrim trim = trim_of(first_face(shapes::bicubic_cube()));
  EXPECT_EQ(trim.kind, TrimKind::kNatural);
  EXPECT_TRUE(trim.region.empty());
  for (const SideCover& side : trim.sides) {
    EXPECT_TRUE(side.whole());
    EXPECT_FALSE(side.collapsed);
  }
}

TEST(TrimRegion, PoleSideIsCollapsedAndCovered) {
  const FaceTrim sphere = trim_of(first_face(BRepPrimAPI_MakeSphere(2.0).Shape()));
  EXPECT_EQ(sphere.kind, TrimKind::kNatural);
  EXPECT_TRUE(sphere.sides[2].collapsed);
  EXPECT_TRUE(sphere.sides[3].collapsed);
  EXPECT_FALSE(sphere.sides[0].collapsed);
}

TEST(TrimRegion, PeriodicFaceHasBothSeamSides) {
  const FaceTrim trim = trim_of(first_face(shapes::barrel(true)));
  EXPECT_EQ(trim.kind, TrimKind::kNatural);
  EXPECT_TRUE(trim.sides[0].whole());
  EXPECT_TRUE(trim.sides[1].whole());
}

TEST(TrimRegion, RectangleInsideTheDomainIsAnIsoBox) {
  const FaceTrim trim =
      classify_trim(square(), {polygon({{0.2, 0.3}, {0.7, 0.3}, {0.7, 0.9}, {0.2, 0.9}})}, 1e-9);
  EXPECT_EQ(trim.kind, TrimKind::kIsoBox);
  EXPECT_TRUE(inside(trim.region, 0.5, 0.5));
  EXPECT_FALSE(inside(trim.region, 0.1, 0.5));
}

TEST(TrimRegion, IsoLinesRoundACornerAreNoBox) {
  const FaceTrim trim = classify_trim(
      square(), {polygon({{0.2, 0.2}, {0.8, 0.2}, {0.8, 0.5}, {0.5, 0.5}, {0.5, 0.8}, {0.2, 0.8}})},
      1e-9);
  EXPECT_EQ(trim.kind, TrimKind::kTrimmed);
}

TEST(TrimRegion, SideCutIntoSeveralEdgesIsCoveredButNotWhole) {
  const FaceTrim trim =
      classify_trim(square(), {polygon({{0, 0}, {0.4, 0}, {1, 0}, {1, 1}, {0, 1}})}, 1e-9);
  EXPECT_EQ(trim.kind, TrimKind::kNatural);
  EXPECT_TRUE(trim.sides[2].covered);
  EXPECT_FALSE(trim.sides[2].whole());
  EXPECT_TRUE(trim.sides[3].whole());
}

TEST(TrimRegion, SideThatIsUsedInPartOnlyIsNotCovered) {
  const FaceTrim trim =
      classify_trim(square(), {polygon({{0, 0}, {0.6, 0}, {0.6, 1}, {0, 1}})}, 1e-9);
  EXPECT_EQ(trim.kind, TrimKind::kIsoBox);
  EXPECT_TRUE(trim.sides[0].whole());
  EXPECT_FALSE(trim.sides[1].covered);
  EXPECT_FALSE(trim.sides[2].covered);
}

// A curve within the tolerance of its edge counts as the side, one outside of it does not.
TEST(TrimRegion, ToleranceOfTheEdgeDecidesWhatRunsAlongASide) {
  for (double tolerance : {1e-3, 1e-6}) {
    FaceLoop loop = polygon({{0, 1e-4}, {1, 1e-4}, {1, 1}, {0, 1}});
    for (EdgeUse& use : loop.uses) use.tolerance = tolerance;
    const FaceTrim trim = classify_trim(square(), {loop}, 1e-9);
    EXPECT_EQ(trim.kind, tolerance > 1e-4 ? TrimKind::kNatural : TrimKind::kIsoBox) << tolerance;
  }
}

TEST(TrimRegion, BoxesCoverEveryTrimmingCurveAndStaySmall) {
  FaceLoop hole;
  EdgeUse circle;
  circle.curve = new Geom2d_Circle(gp_Ax2d(gp_Pnt2d(0.5, 0.4), gp_Dir2d(1, 0)), 0.21);
  circle.last = 2 * kPi;
  circle.reversed = true;
  hole.uses.push_back(circle);
  const FaceTrim trim =
      classify_trim(square(), {polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), hole}, 1e-9);
  EXPECT_EQ(trim.kind, TrimKind::kTrimmedWithHoles);
  for (int k = 0; k < 5000; ++k) {
    const gp_Pnt2d p = circle.curve->Value(2 * kPi * k / 5000);
    bool covered = false;
    for (const UvBox& box : trim.region.boundary) {
      covered = covered || (box.u_min <= p.X() && p.X() <= box.u_max && box.v_min <= p.Y() &&
                            p.Y() <= box.v_max);
    }
    ASSERT_TRUE(covered) << k;
  }
  for (const UvBox& box : trim.region.boundary) {
    EXPECT_LT(std::max(box.u_max - box.u_min, box.v_max - box.v_min), 0.1);
  }
  EXPECT_TRUE(inside(trim.region, 0.5, 0.8));
  EXPECT_FALSE(inside(trim.region, 0.5, 0.4));
  EXPECT_FALSE(inside(trim.region, 1.5, 0.4));
}

}  // namespace
}  // namespace isochor::internal
