// Cells hold the pieces of faces that they claim to hold.
#include "isochor/step/face_cells.h"

#include <gtest/gtest.h>

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <random>

#include "shapes.h"

namespace isochor::internal {
namespace {

BrepTable table_of(const TopoDS_Shape& shape) {
  const Document document = shapes::document_of(shape);
  return brep_table(document.shape, document.faces);
}

std::vector<TopoDS_Shape> solids() {
  const TopoDS_Shape drilled =
      BRepAlgoAPI_Cut(
          BRepPrimAPI_MakeBox(2, 2, 2).Shape(),
          BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0.9, 1.1, -1), gp::DZ()), 0.6, 4).Shape())
          .Shape();
  return {drilled,
          BRepBuilderAPI_NurbsConvert(drilled, true).Shape(),
          BRepPrimAPI_MakeCone(1, 0.2, 3).Shape(),
          BRepPrimAPI_MakeSphere(1.5).Shape(),
          BRepPrimAPI_MakeTorus(3, 1).Shape(),
          shapes::holed_cube(),
          shapes::dome()};
}

bool in_bounds(const Cell& cell, const Vec3& p) {
  return (cell.low.array() <= p.array()).all() && (p.array() <= cell.high.array()).all();
}

// Laws (1) to (3): points of the face are in the bounds of a cell of every level, never outside.
TEST(FaceCells, HoldThePointsOfTheirFace) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (const TopoDS_Shape& shape : solids()) {
    const BrepTable table = table_of(shape);
    for (const FaceRecord& record : table.faces) {
      FaceCells face(record, table.diagonal);
      ASSERT_TRUE(face.known());
      ASSERT_TRUE(face.proven());
      const UvBox& box = face.bounds();
      int inside = 0;
      for (int k = 0; k < 200; ++k) {
        const double s = unit(random), t = unit(random);
        const Uv at{(1 - s) * box.u_min + s * box.u_max, (1 - t) * box.v_min + t * box.v_max};
        if (face.where(at) != Where::kInside) continue;
        ++inside;
        const gp_Pnt p = face.surface()->Value(at.u, at.v);
        int cell = 0;
        for (int level = 0; level < 8; ++level) {
          ASSERT_FALSE(face.cell(cell).outside);
          ASSERT_TRUE(in_bounds(face.cell(cell), Vec3(p.X(), p.Y(), p.Z()))) << level;
          const int child = face.divide(cell);
          ASSERT_GE(child, 0);
          const UvBox& first = face.cell(child).uv;
          cell = at.u <= first.u_max && at.v <= first.v_max ? child : child + 1;
        }
      }
      EXPECT_GT(inside, 50);
    }
  }
}

TEST(FaceCells, BoundsShrinkWithTheSquareOfTheCell) {
  const BrepTable table = table_of(BRepPrimAPI_MakeSphere(1.5).Shape());
  FaceCells face(table.faces.front(), table.diagonal);
  int cell = 0;
  for (int level = 0; level < 16; ++level) cell = face.divide(cell);
  const double step = face.cell(cell).uv.u_max - face.cell(cell).uv.u_min;
  EXPECT_LT(face.cell(cell).radius, 1.5 * step * step);
  EXPECT_GT(face.bytes(), 0u);
  face.forget();
  EXPECT_EQ(face.bytes(), 0u);
  EXPECT_EQ(face.root().children, -1);
  EXPECT_GE(face.divide(0), 0) << "as at the beginning";
}

TEST(FaceCells, WhereFollowsTheTrims) {
  const BrepTable table = table_of(solids().front());
  int holed = 0;
  for (const FaceRecord& record : table.faces) {
    if (record.loops.size() != 2) continue;
    ++holed;
    FaceCells face(record, table.diagonal);
    int outside = 0;
    for (int i = 1; i < 40; ++i) {
      for (int j = 1; j < 40; ++j) {
        const UvBox& box = face.bounds();
        const Uv at{box.u_min + i / 40.0 * (box.u_max - box.u_min),
                    box.v_min + j / 40.0 * (box.v_max - box.v_min)};
        const gp_Pnt p = face.surface()->Value(at.u, at.v);
        const bool hole = std::hypot(p.X() - 0.9, p.Y() - 1.1) < 0.6;
        EXPECT_EQ(face.where(at), hole ? Where::kOutside : Where::kInside);
        outside += hole ? 1 : 0;
      }
    }
    EXPECT_GT(outside, 300);
    const gp_Pnt2d on = record.loops.back().uses.front().curve->Value(
        record.loops.back().uses.front().first + 0.01);
    EXPECT_EQ(face.where({on.X(), on.Y()}), Where::kOnTrim);
  }
  EXPECT_EQ(holed, 2);
}

}  // namespace
}  // namespace isochor::internal
