#include "isochor/step/document_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepTools.hxx>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "isochor/base/error.h"
#include "isochor/step/flux.h"
#include "step/shapes.h"

namespace isochor::internal {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

class SolidFile : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ =
        std::filesystem::temp_directory_path() / ("isochor_" + std::string(test->name()) + ".brep");
  }
  void TearDown() override { std::filesystem::remove(path_); }
  std::filesystem::path path_;
};

TEST(DocumentModel, CubeHasSixEditableFacesAndItsVolume) {
  const auto solid = shapes::bicubic_cube(2.0, 7);
  const SolidModel model = document_model(shapes::document_of(solid, "inch"));
  EXPECT_EQ(model.unit, "inch");
  EXPECT_EQ(model.patches.unit, "inch");
  EXPECT_EQ(model.faces.size(), 6u);
  EXPECT_EQ(model.patches.patches.size(), 6u);
  EXPECT_EQ(model.edges.size(), 12u);
  EXPECT_TRUE(model.facts.closed);
  EXPECT_NEAR(model.facts.volume, integrate_shape(solid).volume, 1e-13);
  EXPECT_LT(model.facts.volume_bound, 1e-12);
  double fluxes = 0.0;
  for (const FaceFacts& face : model.faces) {
    EXPECT_EQ(face.trim, TrimKind::kNatural);
    EXPECT_EQ(face.surface, "B-spline 3x3");
    EXPECT_EQ(face.not_editable, "");
    EXPECT_EQ(model.patches.patches[static_cast<size_t>(face.patch)].handle, face.handle);
    fluxes += face.flux;
  }
  EXPECT_NEAR(fluxes, model.facts.volume, 1e-13);
}

TEST(DocumentModel, AssemblyNamesPartsByPathAndEditsOnlyPartsUsedOnce) {
  const SolidModel model = document_model(shapes::assembly());
  ASSERT_EQ(model.faces.size(), 12u);
  EXPECT_EQ(model.faces[0].name, "lid");
  EXPECT_THAT(model.faces[0].aliases, Contains("pair/box/face:1"));
  EXPECT_EQ(model.patches.patches.size(), 6u);
  EXPECT_EQ(model.patches.patches[0].name, "lid");
  EXPECT_THAT(model.faces[6].not_editable, HasSubstr("cylinder"));
}

TEST(DocumentModel, FacesOfPartsUsedSeveralTimesNameThePart) {
  const SolidModel model = document_model(shapes::assembly());
  int planes = 0;
  for (size_t f = 0; f < model.faces.size(); ++f) {
    const FaceFacts& face = model.faces[f];
    const bool pin = f >= 6;
    const std::string reason = "it belongs to the part 'pin', which is used 2 times";
    EXPECT_EQ(face.not_editable.find(reason) != std::string::npos, pin) << face.handle;
    if (face.surface != "plane") continue;
    ++planes;
    EXPECT_FALSE(face.convertible);
    EXPECT_THAT(face.not_editable, HasSubstr("it is a plane, not a B-spline surface; it belongs"));
  }
  EXPECT_EQ(planes, 4);  // two caps, twice
}

TEST(DocumentModel, ConvertingAFaceOfAPartUsedTwiceIsRefusedWithItsName) {
  gp_Trsf shift;
  shift.SetTranslation(gp_Vec(5, 0, 0));
  const Document document =
      shapes::placed(BRepPrimAPI_MakeBox(1, 2, 3).Solid(), {gp_Trsf(), shift});
  ReadOptions options;
  options.convert = {4};
  try {
    document_model(document, options);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.reason(),
              "face:5 (plane) cannot be turned into a B-spline face: it belongs to the part 'bar', "
              "which is used 2 times; an edit would change all of them");
  }
}

TEST(DocumentModel, PlacedPartIsEditedInTheFrameOfTheAssembly) {
  gp_Trsf move;
  move.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 2, 3)), 0.7);
  move.SetTranslationPart(gp_Vec(5, 0, 0));
  const TopoDS_Shape cube = shapes::bicubic_cube();
  const SolidModel here = document_model(shapes::document_of(cube));
  const SolidModel there = document_model(shapes::document_of(cube.Located(TopLoc_Location(move))));
  ASSERT_EQ(there.patches.patches.size(), 6u);
  EXPECT_EQ(there.patches.joins.size(), 12u);
  for (size_t k = 0; k < here.patches.points.size(); ++k) {
    const Vec3& p = here.patches.points[k];
    const gp_Pnt q = gp_Pnt(p.x(), p.y(), p.z()).Transformed(move);
    EXPECT_EQ(there.patches.points[k], Vec3(q.X(), q.Y(), q.Z()));
  }
  EXPECT_NEAR(there.facts.volume, here.facts.volume, 1e-14);
}

TEST(DocumentModel, ConvertedPlaneBecomesAPatch) {
  const auto document = shapes::document_of(BRepPrimAPI_MakeBox(1, 2, 3).Shape());
  ReadOptions options;
  options.convert = {2};
  const SolidModel model = document_model(document, options);
  EXPECT_TRUE(model.faces[0].convertible);
  EXPECT_EQ(model.faces[2].patch, 0);
  EXPECT_EQ(model.patches.locked_sides.size(), 4u);
  EXPECT_NEAR(model.facts.volume, 6.0, 1e-14);
  options.convert = {6};
  try {
    document_model(document, options);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("face:7: the file has 6 faces"));
  }
}

TEST_F(SolidFile, ReadsTheSameThroughTheChildProcess) {
  const auto solid = shapes::dome();
  ASSERT_TRUE(BRepTools::Write(solid, path_.c_str()));
  const SolidModel model = read_solid(path_);
  const SolidModel direct = document_model(load_document(path_));
  EXPECT_EQ(model.format, "BREP");
  EXPECT_EQ(model.patches.points, direct.patches.points);
  EXPECT_EQ(model.patches.ties, direct.patches.ties);
  EXPECT_EQ(model.facts.volume, direct.facts.volume);
  EXPECT_EQ(model.faces.size(), 2u);
  EXPECT_GT(model.facts.volume, 0.0);
}

TEST_F(SolidFile, DamagedFileIsAnInputErrorThatNamesIt) {
  std::ofstream(path_) << "DBRep_DrawableShape\n\nCASCADE Topology V1, (c) Matra-Datavision\n";
  try {
    read_solid(path_);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.file(), path_.string());
  }
}

}  // namespace
}  // namespace isochor::internal
