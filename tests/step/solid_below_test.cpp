// What solids with analytic and trimmed faces have below a plane.
#include "isochor/step/solid_below.h"

#include <gtest/gtest.h>

#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <cmath>

#include "isochor/step/document.h"
#include "isochor/step/document_model.h"
#include "isochor/step/model_bytes.h"
#include "shapes.h"

namespace isochor::internal {
namespace {

constexpr double kPi = 3.14159265358979323846;

ClosingPlane plane(const Vec3& n, double h) { return {n.normalized(), h / n.norm(), false}; }

struct Part {
  const char* name;
  TopoDS_Shape shape;
  Vec3 normal;
  double height;
  double volume;
  Vec3 centroid;
};

std::vector<Part> parts() {
  const double hole = kPi * 0.49;
  return {
      {"box", BRepPrimAPI_MakeBox(2, 3, 4).Shape(), Vec3(0, 0, 2), 3.0, 9, Vec3(1, 1.5, 0.75)},
      {"a corner of a box", BRepPrimAPI_MakeBox(2, 3, 4).Shape(), Vec3(1, 1, 1), 1.0, 1.0 / 6,
       Vec3(0.25, 0.25, 0.25)},
      {"cylinder across", BRepPrimAPI_MakeCylinder(1.5, 4).Shape(), Vec3(0, 0, 1), 1.3,
       1.3 * kPi * 2.25, Vec3(0, 0, 0.65)},
      {"half a cylinder", BRepPrimAPI_MakeCylinder(1.5, 4).Shape(), Vec3(1, 0, 0), 0.0, 4.5 * kPi,
       Vec3(-2 / kPi, 0, 2)},
      {"cylinder aslant", BRepPrimAPI_MakeCylinder(1.0, 6).Shape(), Vec3(0.6, 0, 0.8), 2.4, 3 * kPi,
       Vec3(-0.75 / 12, 0, 1.5 + 0.5625 / 24)},
      {"tip of a cone", BRepPrimAPI_MakeCone(2, 0, 3).Shape(), Vec3(0, 0, -1), -1.5, kPi * 0.5,
       Vec3(0, 0, 1.875)},
      {"cap of a ball", BRepPrimAPI_MakeSphere(2.0).Shape(), Vec3(0, 1, 0), -1.0, kPi * 5 / 3,
       Vec3(0, -0.75 * 9 / 5, 0)},
      {"half a torus", BRepPrimAPI_MakeTorus(5, 1.5).Shape(), Vec3(0, 0, 1), 0.0,
       kPi * kPi * 5 * 2.25, Vec3(0, 0, -4 * 1.5 / (3 * kPi))},
      {"holed plate", shapes::holed_plate(), Vec3(0, 0, 1), 0.25, 1.25 * (24 - hole),
       Vec3(-0.3, -0.4, 0) * hole / (24 - hole) + Vec3(0, 0, -0.375)},
      {"holed plate, through the hole", shapes::holed_plate(), Vec3(1, 0, 0), 0.3, 2.3 * 12 - hole,
       Vec3((2.3 * 12 * -0.85 - hole * (0.3 - 4 * 0.7 / (3 * kPi))) / (27.6 - hole),
            -0.4 * hole / (27.6 - hole), 0)},
  };
}

void expect_part(const PartBelow& got, const Part& part, const Vec3& centroid) {
  EXPECT_EQ(got.side, PlaneSide::kCut) << part.name;
  EXPECT_LE(std::abs(got.volume - part.volume), got.bound) << part.name;
  EXPECT_LT(got.bound, 1e-9 * part.volume) << part.name;
  EXPECT_LE((got.centroid - centroid).norm(), got.centroid_bound) << part.name;
  EXPECT_LT(got.centroid_bound, 1e-8) << part.name;
}

TEST(SolidBelow, ClosedForms) {
  for (const Part& part : parts()) {
    expect_part(shape_below(part.shape, plane(part.normal, part.height)), part, part.centroid);
  }
}

TEST(SolidBelow, RationalPatchesInsteadOfAnalyticFaces) {
  for (const Part& part : parts()) {
    const TopoDS_Shape shape = BRepBuilderAPI_NurbsConvert(part.shape, true).Shape();
    expect_part(shape_below(shape, plane(part.normal, part.height)), part, part.centroid);
  }
}

TEST(SolidBelow, PosesMoveItAlong) {
  const gp_Trsf pose = shapes::some_pose();
  const auto moved = [&](const Vec3& p, bool vector) { return shapes::posed(pose, p, vector); };
  for (const Part& part : parts()) {
    const TopoDS_Shape shape = BRepBuilderAPI_Transform(part.shape, pose, true).Shape();
    const Vec3 normal = moved(part.normal, true);
    const Vec3 on_plane = moved(part.normal * (part.height / part.normal.squaredNorm()), false);
    expect_part(shape_below(shape, plane(normal, normal.dot(on_plane))), part,
                moved(part.centroid, false));
  }
}

// Law (2): cells with proven bounds against loops.
TEST(SolidBelow, PatchModelsHaveTheSame) {
  const Document document = shapes::document_of(shapes::bicubic_cube(2.0, 7));
  const SolidModel model = document_model(document);
  for (const auto& [normal, height] :
       {std::pair(Vec3(0, 0, 1), 0.7), std::pair(Vec3(1, 2, -1), 1.1)}) {
    const PartBelow cells = part_below(model.patches, plane(normal, height));
    const PartBelow loops = shape_below(document.shape, plane(normal, height));
    EXPECT_NEAR(loops.volume, cells.volume, loops.bound + cells.bound);
    EXPECT_LE((loops.centroid - cells.centroid).norm(),
              loops.centroid_bound + cells.centroid_bound);
    EXPECT_LT(loops.bound, 1e-9);
    EXPECT_TRUE(cells.proven);
    EXPECT_FALSE(loops.proven);
  }
}

// A box without its lid and its wall y = 0, closed by their planes.
TEST(SolidBelow, OpenShapesClosedByPlanes) {
  TopoDS_Compound open;
  BRep_Builder builder;
  builder.MakeCompound(open);
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(2, 3, 4).Shape();
  int face = 0;
  for (TopExp_Explorer it(box, TopAbs_FACE); it.More(); it.Next(), ++face) {
    if (face != 2 && face != 5) builder.Add(open, it.Current());  // y = 0, z = 4
  }
  const std::vector<ClosingPlane> close = {plane(Vec3::UnitY(), 0), plane(Vec3::UnitZ(), 4)};
  const PartBelow part = shape_below(open, plane(Vec3::UnitZ(), 1.5), close);
  EXPECT_NEAR(part.volume, 9.0, part.bound);
  EXPECT_LT(part.bound, 1e-11);
  EXPECT_LE((part.centroid - Vec3(1, 1.5, 0.75)).norm(), part.centroid_bound);
  const PartBelow all = shape_below(open, plane(Vec3::UnitZ(), 6), close);
  EXPECT_EQ(all.side, PlaneSide::kEverything);
  EXPECT_NEAR(all.volume, 24.0, all.bound);
}

TEST(SolidBelow, PlanesThatMissTheSolid) {
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(2.0).Shape();
  for (double height : {-3.0, -2.0}) {
    const PartBelow nothing = shape_below(ball, plane(Vec3::UnitX(), height));
    EXPECT_EQ(nothing.side, PlaneSide::kNothing);
    EXPECT_LE(std::abs(nothing.volume), nothing.bound);
    EXPECT_TRUE(std::isinf(nothing.centroid_bound));
  }
  for (double height : {2.0, 2.01, 7.0}) {
    const PartBelow all = shape_below(ball, plane(Vec3::UnitX(), height));
    EXPECT_EQ(all.side, PlaneSide::kEverything) << height;
    EXPECT_NEAR(all.volume, kPi * 32 / 3, all.bound);
  }
}

TEST(SolidBelow, GoesThroughTheBridge) {
  SolidModel model;
  model.below = shape_below(BRepPrimAPI_MakeSphere(2.0).Shape(), plane(Vec3::UnitZ(), 0.5));
  const SolidModel after = from_bytes<SolidModel>(to_bytes(model));
  ASSERT_TRUE(after.below.has_value());
  EXPECT_EQ(after.below->volume, model.below->volume);
  EXPECT_EQ(after.below->centroid, model.below->centroid);
  EXPECT_EQ(after.below->side, PlaneSide::kCut);
  EXPECT_EQ(after.below->bound, model.below->bound);
}

}  // namespace
}  // namespace isochor::internal
