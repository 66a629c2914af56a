#include "isochor/step/written_torus.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <TopoDS_Compound.hxx>

#include <fstream>

#include "isochor/step/compare_faces.h"
#include "isochor/step/exchange.h"
#include "isochor/step/solid_model.h"
#include "step/pulls.h"
#include "step/shapes.h"
#include "step/temp_folder.h"

namespace isochor {
namespace {

using internal::Document;
using internal::load_document;
using ::testing::HasSubstr;
using ::testing::Not;

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

int tori(const Document& document) {
  int count = 0;
  for (int k = 0; k < document.face_count(); ++k) {
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(document.face(k));
    count += Handle(Geom_ToroidalSurface)::DownCast(surface).IsNull() ? 0 : 1;
  }
  return count;
}

// Writes with and without parameter curves; `count` tori are expected to be where they were.
void expect_kept(Document document, int count) {
  const TempFolder folder;
  ASSERT_EQ(tori(document), count);
  for (bool parameter_curves : {true, false}) {
    internal::WriteSettings settings;
    settings.parameter_curves = parameter_curves;
    const std::string path = folder.file("out.step");
    write_document(document, path, settings);
    const Document after = load_document(path);
    EXPECT_EQ(tori(after), count);
    const auto faces = compare_faces(document, after, {});
    EXPECT_EQ(faces.objection, "");
    EXPECT_LE(faces.analytic_ulps, 4.0);
    EXPECT_TRUE(BRepCheck_Analyzer(after.shape).IsValid());
    const std::string text = text_of(path);
    EXPECT_THAT(text, HasSubstr("TOROIDAL_SURFACE"));
    for (const char* left_over : {"SURFACE_OF_REVOLUTION", "AXIS1_PLACEMENT"}) {
      EXPECT_THAT(text, Not(HasSubstr(left_over)));
    }
  }
}

TEST(WrittenTorus, ATubeWiderThanItsHoleStaysATorus) {
  expect_kept(shapes::document_of(shapes::lens()), 1);
  expect_kept(shapes::document_of(shapes::lens(), "inch"), 1);
}

TEST(WrittenTorus, PlacesAndLeftHandedAxesDoNotMatter) {
  gp_Trsf turn, mirror;
  turn.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 1, 0)), 0.4);
  mirror.SetMirror(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 2, 3)));
  TopoDS_Compound both;
  BRep_Builder builder;
  builder.MakeCompound(both);
  builder.Add(both, shapes::lens());
  builder.Add(both, shapes::lens().Moved(TopLoc_Location(turn)));
  expect_kept(shapes::document_of(both), 2);
  expect_kept(shapes::document_of(BRepBuilderAPI_Transform(shapes::lens(), mirror, true).Shape()),
              1);
}

TEST(WrittenTorus, APartUsedTwiceIsWrittenOnce) {
  gp_Trsf turn;
  turn.SetRotation(gp_Ax1(gp_Pnt(7, 0, 0), gp_Dir(1, 1, 0)), 0.4);
  Document document = shapes::placed(shapes::lens(), {gp_Trsf(), turn});
  expect_kept(document, 2);
  const TempFolder folder;
  write_document(document, folder.file("pair.step"));
  const std::string text = text_of(folder.file("pair.step"));
  const size_t first = text.find("TOROIDAL_SURFACE");
  EXPECT_EQ(text.find("TOROIDAL_SURFACE", first + 1), std::string::npos);
}

TEST(WrittenTorus, OrdinaryToriAreLeftToTheWriter) {
  expect_kept(shapes::document_of(BRepPrimAPI_MakeTorus(2.0, 0.5).Solid()), 1);
}

TEST(WrittenTorus, ANeighbourOfOneCanBeEdited) {
  const TempFolder folder;
  TopoDS_Compound both;
  BRep_Builder builder;
  builder.MakeCompound(both);
  builder.Add(both, shapes::bicubic_cube());
  gp_Trsf away;
  away.SetTranslation(gp_Vec(9, 0, 0));
  builder.Add(both, shapes::lens().Moved(TopLoc_Location(away)));
  auto document = shapes::document_of(both);
  write_document(document, folder.file("in.step"));
  document = load_document(folder.file("in.step"));
  const auto edits = shapes::pull(document, shapes::pole_of(document, 0, 2, 3), {0.1, 0.02, 0.0});
  const auto report = write_edited(folder.file("in.step"), {}, edits, folder.file("out.step"));
  ASSERT_TRUE(report.written) << report.refusal;
  EXPECT_LE(report.analytic_ulps, 4.0);
}

}  // namespace
}  // namespace isochor
