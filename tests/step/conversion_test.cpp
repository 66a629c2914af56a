#include "isochor/step/conversion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <Geom_BezierCurve.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TopExp.hxx>
#include <cmath>
#include <gp_Ax2.hxx>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/step/flux.h"
#include "isochor/step/occt_surface.h"

namespace isochor::internal {
namespace {

BrepTable table_of(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  return brep_table(shape, faces);
}

TopoDS_Shape drilled_box() {
  const gp_Ax2 axis(gp_Pnt(1, 1.5, -1), gp_Dir(0, 0, 1));
  return BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(2, 3, 1).Shape(),
                         BRepPrimAPI_MakeCylinder(axis, 0.5, 4).Shape())
      .Shape();
}

double volume_of(const BrepTable& table) {
  double volume = 0.0;
  for (const FaceRecord& face : table.faces) {
    volume +=
        integrate_face(face.surface.geometry, face.loops, face.trim.kind, face.reversed(), table.z0)
            .flux;
  }
  return volume;
}

TEST(Conversion, PlanesBecomeBicubicAndKeepTheVolume) {
  BrepTable table = table_of(drilled_box());
  const double before = volume_of(table);
  std::vector<int> planes;
  for (size_t f = 0; f < table.faces.size(); ++f) {
    if (table.faces[f].surface.kind == "plane") planes.push_back(static_cast<int>(f));
  }
  ASSERT_EQ(planes.size(), 6u);
  EXPECT_EQ(convert_faces(table, planes), "");
  int natural = 0;
  for (int f : planes) {
    const FaceRecord& face = table.faces[static_cast<size_t>(f)];
    ASSERT_TRUE(face.surface.surface.has_value());
    EXPECT_EQ(face.surface.surface->u_knots().degree(), 3);
    EXPECT_EQ(face.surface.kind, "B-spline 3x3 (was plane)");
    natural += face.trim.kind == TrimKind::kNatural ? 1 : 0;
  }
  EXPECT_EQ(natural, 4);  // the two with a hole stay trimmed
  EXPECT_NEAR(volume_of(table), before, 1e-14 * before);
}

TEST(Conversion, ExtrudedCurveKeepsItsParameters) {
  TColgp_Array1OfPnt poles(1, 3);
  poles(1) = gp_Pnt(0, 0, 0);
  poles(2) = gp_Pnt(1, 2, 0);
  poles(3) = gp_Pnt(3, 0, 0.5);
  const Handle(Geom_BezierCurve) curve = new Geom_BezierCurve(poles);
  const BrepTable table =
      table_of(BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeEdge(curve), gp_Vec(0, 0.3, 2)).Shape());
  ASSERT_EQ(table.faces[0].surface.kind, "extruded surface");
  const Conversion conversion = convert_face(table.faces[0], table.diagonal);
  ASSERT_FALSE(conversion.surface.IsNull()) << conversion.refusal;
  EXPECT_EQ(conversion.surface->UDegree(), 3);
  for (double u : {0.0, 0.3, 1.0}) {
    for (double v : {0.1, 1.9}) {
      EXPECT_LT(
          conversion.surface->Value(u, v).Distance(table.faces[0].surface.geometry->Value(u, v)),
          kSameSurface * table.diagonal);
    }
  }
}

// A wavy surface over [0, 6] x [0, 4] in the plane, its parameters.
Handle(Geom_BSplineSurface) wavy() {
  const KnotVector u = KnotVector::uniform(3, 6, 0.0, 6.0), v = KnotVector::uniform(3, 4, 0.0, 4.0);
  std::vector<Vec3> poles;
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      poles.emplace_back(u.greville(i), v.greville(j), 0.2 * std::sin(2.0 * i + j));
    }
  }
  return to_occt(Surface(u, v, poles));
}

TEST(Conversion, BoxesOfParametersAreCutOut) {
  const Handle(Geom_BSplineSurface) surface = wavy();
  BrepTable table = table_of(BRepBuilderAPI_MakeFace(surface, 0.7, 4.0, 1.1, 3.3, 1e-9).Shape());
  ASSERT_EQ(table.faces[0].trim.kind, TrimKind::kIsoBox);
  const double before = volume_of(table);
  cut_iso_boxes(table);
  const FaceRecord& face = table.faces[0];
  EXPECT_EQ(face.trim.kind, TrimKind::kNatural);
  EXPECT_TRUE(face.trim.region.empty());
  const Surface& part = *face.surface.surface;
  EXPECT_EQ(part.u_knots().breaks(), (std::vector<double>{0.7, 1, 2, 3, 4}));
  EXPECT_EQ(part.v_knots().breaks(), (std::vector<double>{1.1, 2, 3, 3.3}));
  for (double u : {0.7, 1.9, 4.0}) {
    for (double v : {1.1, 2.0, 3.3}) {
      const gp_Pnt p = surface->Value(u, v);
      EXPECT_LT((part.point(u, v) - Vec3(p.X(), p.Y(), p.Z())).norm(), 1e-14);
    }
  }
  EXPECT_NEAR(volume_of(table), before, 1e-13);
  // What an edit sends back is recognised by its domain.
  const Surface whole = from_occt(*surface);
  const auto again = cut_like(whole, part);
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(again->poles(), part.poles());
  EXPECT_FALSE(cut_like(whole, whole).has_value());
  EXPECT_FALSE(cut_like(part, whole).has_value());
}

TEST(Conversion, OtherTrimsStay) {
  const Handle(Geom_BSplineSurface) surface = wavy();
  BrepTable table = table_of(BRepBuilderAPI_MakeFace(surface, 1e-9).Shape());
  cut_iso_boxes(table);
  EXPECT_EQ(table.faces[0].surface.surface->poles(), from_occt(*surface).poles());
}

TEST(Conversion, DiscBoundedByOneCircleIsCoveredWhole) {
  BrepTable table = table_of(BRepPrimAPI_MakeCylinder(2.0, 3.0).Shape());
  const double before = volume_of(table);
  for (int f = 0; f < 3; ++f) {
    const FaceRecord& face = table.faces[static_cast<size_t>(f)];
    if (face.surface.kind != "plane") continue;
    ASSERT_EQ(convert_faces(table, {f}), "");
    EXPECT_EQ(face.trim.kind, TrimKind::kTrimmed);
    const UvBox& domain = face.trim.domain;
    for (const UvBox& box : face.trim.region.boundary) {
      EXPECT_LT(domain.u_min, box.u_min);
      EXPECT_LT(box.v_max, domain.v_max);
    }
  }
  EXPECT_NEAR(volume_of(table), before, 1e-14 * before);
}

TEST(Conversion, CirclesAreRefusedWithTheReason) {
  BrepTable table = table_of(BRepPrimAPI_MakeCylinder(1.0, 2.0).Shape());
  for (size_t f = 0; f < table.faces.size(); ++f) {
    if (table.faces[f].surface.kind != "cylinder") continue;
    EXPECT_EQ(convert_face(table.faces[f], table.diagonal).refusal,
              "no B-spline runs along its circles with the same parameters");
    EXPECT_THAT(convert_faces(table, {static_cast<int>(f)}),
                ::testing::HasSubstr("(cylinder) cannot be turned into a B-spline face"));
  }
  EXPECT_THROW(static_cast<void>(convert_faces(table, {3})), PreconditionError);
}

}  // namespace
}  // namespace isochor::internal
