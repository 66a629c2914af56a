// Cross sections of solids with analytic and trimmed faces.
#include "isochor/step/solid_section.h"

#include <gtest/gtest.h>

#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <cmath>

#include "isochor/base/error.h"
#include "isochor/step/document.h"
#include "isochor/step/document_model.h"
#include "isochor/step/model_bytes.h"
#include "shapes.h"

namespace isochor::internal {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Cut {
  const char* name;
  TopoDS_Shape shape;
  Vec3 normal;
  double height;
  double area;
  Vec3 centroid;
};

std::vector<Cut> cuts() {
  const double hole = kPi * 0.49;
  const double tilt = std::sqrt(0.5);
  return {
      {"box across", BRepPrimAPI_MakeBox(2, 3, 4).Shape(), Vec3(0, 0, 2), 3.0, 6,
       Vec3(1, 1.5, 1.5)},
      {"box, a rectangle aslant", BRepPrimAPI_MakeBox(2, 2, 4).Shape(), Vec3(1, 1, 0), 2.0,
       8 * std::sqrt(2.0), Vec3(1, 1, 2)},
      {"cylinder across", BRepPrimAPI_MakeCylinder(1.5, 4).Shape(), Vec3(0, 0, 1), 1.3, kPi * 2.25,
       Vec3(0, 0, 1.3)},
      {"cylinder along", BRepPrimAPI_MakeCylinder(1.5, 4).Shape(), Vec3(1, 0, 0), 0.9,
       4 * 2 * std::sqrt(2.25 - 0.81), Vec3(0.9, 0, 2)},
      {"cylinder aslant", BRepPrimAPI_MakeCylinder(1.5, 8).Shape(), Vec3(tilt, 0, tilt), 4 * tilt,
       kPi * 2.25 / tilt, Vec3(0, 0, 4)},
      {"cone", BRepPrimAPI_MakeCone(2, 0, 3).Shape(), Vec3(0, 0, -1), -1.2, kPi * 1.44,
       Vec3(0, 0, 1.2)},
      {"sphere", BRepPrimAPI_MakeSphere(2.0).Shape(), Vec3(1, 2, 2), 3.0, kPi * 3,
       Vec3(1, 2, 2) / 3},
      {"torus across", BRepPrimAPI_MakeTorus(5, 1.5).Shape(), Vec3(0, 0, 1), 0.4,
       4 * kPi * 5 * std::sqrt(2.25 - 0.16), Vec3(0, 0, 0.4)},
      {"torus, two disks", BRepPrimAPI_MakeTorus(5, 1.5).Shape(), Vec3(0, 1, 0), 0.0,
       2 * kPi * 2.25, Vec3::Zero()},
      {"holed plate across", shapes::holed_plate(), Vec3(0, 0, 1), 0.25, 24 - hole,
       Vec3(-0.3, -0.4, 0) * hole / (24 - hole) + Vec3(0, 0, 0.25)},
      {"holed plate through the hole", shapes::holed_plate(), Vec3(1, 0, 0), 0.3, 12 - 2 * 1.4,
       Vec3(0.3, -0.4 * 2.8 / 9.2, 0)},
  };
}

void expect_cut(const Section& section, const Cut& cut, double area, const Vec3& centroid) {
  EXPECT_LE(std::abs(section.area - area), section.bound) << cut.name;
  EXPECT_LT(section.bound, 1e-9 * area) << cut.name;
  EXPECT_LE((section.centroid - centroid).norm(), section.centroid_bound) << cut.name;
  EXPECT_LT(section.centroid_bound, 1e-8) << cut.name;
  EXPECT_FALSE(section.coplanar) << cut.name;
}

TEST(SolidSection, ClosedForms) {
  for (const Cut& cut : cuts()) {
    expect_cut(shape_section(cut.shape, cut.normal, cut.height), cut, cut.area, cut.centroid);
    expect_cut(shape_section(cut.shape, -cut.normal, -cut.height), cut, cut.area, cut.centroid);
  }
}

TEST(SolidSection, PosesMoveTheSectionAlong) {
  const gp_Trsf pose = shapes::some_pose();
  const auto moved = [&](const Vec3& p, bool vector) { return shapes::posed(pose, p, vector); };
  for (const Cut& cut : cuts()) {
    const TopoDS_Shape shape = BRepBuilderAPI_Transform(cut.shape, pose, true).Shape();
    const Vec3 normal = moved(cut.normal, true);
    const Vec3 on_plane = moved(cut.normal * (cut.height / cut.normal.squaredNorm()), false);
    expect_cut(shape_section(shape, normal, normal.dot(on_plane)), cut, cut.area,
               moved(cut.centroid, false));
  }
}

TEST(SolidSection, RationalPatchesInsteadOfAnalyticFaces) {
  for (const Cut& cut : cuts()) {
    const TopoDS_Shape shape = BRepBuilderAPI_NurbsConvert(cut.shape, true).Shape();
    expect_cut(shape_section(shape, cut.normal, cut.height), cut, cut.area, cut.centroid);
  }
}

// Law (2): the other way to sections, which integrates Bezier cells and knows no loops.
TEST(SolidSection, PatchModelsHaveTheSame) {
  const Document document = shapes::document_of(shapes::bicubic_cube(2.0, 7));
  const SolidModel model = document_model(document);
  for (const auto& [normal, height] :
       {std::pair(Vec3(0, 0, 1), 0.7), std::pair(Vec3(1, 2, -1), 1.1),
        std::pair(Vec3(1, 1, 1), 2.9)}) {
    const Section cells = section(model.patches, normal, height);
    const Section loops = shape_section(document.shape, normal, height);
    EXPECT_NEAR(loops.area, cells.area, loops.bound + cells.bound);
    EXPECT_LE((loops.centroid - cells.centroid).norm(),
              loops.centroid_bound + cells.centroid_bound);
    EXPECT_LT(loops.bound, 1e-9);
    EXPECT_GT(loops.area, 1.0);
  }
}

TEST(SolidSection, GoesThroughTheBridge) {
  Section before = shape_section(BRepPrimAPI_MakeSphere(2.0).Shape(), Vec3(0, 0, 1), 0.5);
  SolidModel model;
  model.section = before;
  const SolidModel after = from_bytes<SolidModel>(to_bytes(model));
  ASSERT_TRUE(after.section.has_value());
  EXPECT_EQ(after.section->area, before.area);
  EXPECT_EQ(after.section->centroid, before.centroid);
  EXPECT_EQ(after.section->coplanar, before.coplanar);
}

TEST(SolidSection, BesideTheSolidThereIsNothing) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(2, 3, 4).Shape();
  for (double height : {-1.0, 5.0}) {
    const Section section = shape_section(box, Vec3::UnitZ(), height);
    EXPECT_LE(std::abs(section.area), section.bound);
    EXPECT_TRUE(std::isinf(section.centroid_bound));
  }
}

TEST(SolidSection, FacesInThePlaneCountAsAbove) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(2, 3, 4).Shape();
  const Section bottom = shape_section(box, Vec3::UnitZ(), 0.0);
  EXPECT_TRUE(bottom.coplanar);
  EXPECT_LE(std::abs(bottom.area), bottom.bound);
  const Section top = shape_section(box, Vec3::UnitZ(), 4.0);
  EXPECT_TRUE(top.coplanar);
  EXPECT_LE(std::abs(top.area - 6.0), top.bound);
}

TEST(SolidSection, PlanesThatAreNone) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1, 1, 1).Shape();
  EXPECT_THROW((void)shape_section(box, Vec3::Zero(), 1.0), PreconditionError);
  EXPECT_THROW((void)shape_section(box, Vec3::UnitX(), NAN), PreconditionError);
}

}  // namespace
}  // namespace isochor::internal
