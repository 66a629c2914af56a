#include "isochor/step/sewing.h"

#include <gtest/gtest.h>

#include <BRepBuilderAPI_Copy.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <gp_Pln.hxx>
#include <random>

#include "isochor/step/compare_faces.h"
#include "isochor/step/exchange.h"
#include "isochor/step/flux.h"
#include "isochor/step/shape_facts.h"
#include "isochor/step/solid_model.h"
#include "step/pulls.h"
#include "step/shapes.h"
#include "step/temp_folder.h"

namespace isochor::internal {
namespace {

// Copies of the faces of a solid that share no edge; every second one turned round.
std::vector<TopoDS_Shape> loose_faces(const TopoDS_Shape& solid) {
  std::vector<TopoDS_Shape> faces;
  for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next()) {
    faces.push_back(BRepBuilderAPI_Copy(it.Current()).Shape());
    if (faces.size() % 2 == 0) faces.back().Reverse();
  }
  return faces;
}

TopoDS_Shape box_at(double x) {
  return BRepPrimAPI_MakeBox(gp_Pnt(x, 0.0, 0.0), 1.0, 2.0, 3.0).Shape();
}

Document document_of(const std::vector<TopoDS_Shape>& faces) {
  Document document;
  document.path = "loose.brep";
  document.shape = shapes::together(faces);
  index_document(document);
  return document;
}

Document loose_box(size_t without = 0) {
  auto faces = loose_faces(box_at(0.0));
  faces.erase(faces.begin(), faces.begin() + static_cast<std::ptrdiff_t>(without));
  return document_of(faces);
}

// Faces as the table numbers them and as they stand in the shape; surfaces as they were.
void expect_in_order(const Document& before, const Document& after) {
  TopTools_IndexedMapOfShape stand;
  TopExp::MapShapes(after.shape, TopAbs_FACE, stand);
  ASSERT_EQ(stand.Extent(), after.face_count());
  ASSERT_EQ(after.face_count(), before.face_count());
  for (int f = 0; f < after.face_count(); ++f) {
    EXPECT_TRUE(stand(f + 1).IsSame(after.face(f))) << f;
    EXPECT_EQ(BRep_Tool::Surface(after.face(f)), BRep_Tool::Surface(before.face(f))) << f;
  }
}

void expect_declined(Document document, const std::string& reason) {
  const TopoDS_Shape own = document.shape;
  sew(document);
  EXPECT_FALSE(document.sewn());
  EXPECT_TRUE(document.shape.IsEqual(own));
  EXPECT_NE(document.account.sewing.declined.find(reason), std::string::npos)
      << document.account.sewing.declined;
  ASSERT_EQ(document.notices.size(), 1u);
  EXPECT_EQ(document.notices[0], "not sewn: " + document.account.sewing.declined);
}

std::string all(const std::vector<std::string>& notices) {
  std::string text;
  for (const std::string& notice : notices) text += notice + "\n";
  return text;
}

TEST(Sewing, LooseBoxBecomesASolidOfItsVolume) {
  Document document = loose_box();
  ASSERT_FALSE(shape_facts(document.shape).closed);
  sew(document);
  EXPECT_TRUE(document.sewn());
  EXPECT_EQ(document.face_count(), 6);
  const ShapeFacts facts = shape_facts(document.shape);
  EXPECT_TRUE(facts.closed);
  EXPECT_TRUE(facts.valid);
  EXPECT_EQ(facts.solids, 1);
  EXPECT_NEAR(facts.volume, 6.0, 1e-13);
  const std::string text = all(document.notices);
  EXPECT_NE(text.find("6 faces in 1 shell, 1 solid; 0 free edges are left of 24"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("turned round"), std::string::npos) << text;
}

TEST(Sewing, FacesStandInTheOrderOfTheFile) {
  auto faces = loose_faces(shapes::bicubic_cube(3.7));
  std::mt19937 random(5);
  for (int round = 0; round < 10; ++round) {
    SCOPED_TRACE(round);
    std::shuffle(faces.begin(), faces.end(), random);
    const Document before = document_of(faces);
    Document after = before;
    sew(after);
    ASSERT_TRUE(after.sewn()) << after.account.sewing.declined;
    expect_in_order(before, after);
  }
}

TEST(Sewing, EachClosedShellIsASolid) {
  auto faces = loose_faces(box_at(0.0));
  for (const TopoDS_Shape& face : loose_faces(box_at(5.0))) faces.push_back(face);
  const Document before = document_of(faces);
  Document after = before;
  sew(after);
  ASSERT_TRUE(after.sewn());
  expect_in_order(before, after);
  EXPECT_EQ(after.account.sewing.solids, 2);
  EXPECT_NEAR(shape_facts(after.shape).volume, 12.0, 1e-13);
  EXPECT_NE(all(after.notices).find("none is the hollow of another"), std::string::npos);
}

TEST(Sewing, ShellsThatTakeTurnsAreNotSewn) {
  const auto first = loose_faces(box_at(0.0)), second = loose_faces(box_at(5.0));
  std::vector<TopoDS_Shape> faces;
  for (size_t k = 0; k < first.size(); ++k) {
    faces.push_back(first[k]);
    faces.push_back(second[k]);
  }
  expect_declined(document_of(faces), "mixes the faces of several shells (face:2 comes before");
}

TEST(Sewing, ThreeFacesAtAnEdgeAreNotSewn) {
  auto faces = loose_faces(box_at(0.0));
  // A wall inside the box, from one edge along x to the one opposite.
  BRepBuilderAPI_MakePolygon outline(gp_Pnt(0, 0, 0), gp_Pnt(1, 0, 0), gp_Pnt(1, 2, 3),
                                     gp_Pnt(0, 2, 3), Standard_True);
  faces.push_back(BRepBuilderAPI_MakeFace(outline.Wire()).Shape());
  expect_declined(document_of(faces), "three or more faces meet along an edge");
}

TEST(Sewing, OneFaceInTwoPlacesIsNotSewn) {
  auto faces = loose_faces(box_at(0.0));
  gp_Trsf aside;
  aside.SetTranslation(gp_Vec(9.0, 0.0, 0.0));
  faces.push_back(faces[1].Moved(aside));
  expect_declined(document_of(faces), "face:2 and face:7 are one face in two places");
}

TEST(Sewing, AssembliesAreNotSewn) {
  const TempFolder folder;
  const auto faces = loose_faces(box_at(0.0));
  const TopoDS_Shape half = shapes::together({faces[0], faces[2]});
  gp_Trsf aside;
  aside.SetTranslation(gp_Vec(9.0, 0.0, 0.0));
  Document rack = shapes::placed(half, {gp_Trsf(), aside});
  write_document(rack, folder.file("rack.step"));
  const Document document = load_document(folder.file("rack.step"));
  EXPECT_FALSE(document.sewn());
  EXPECT_NE(document.account.sewing.declined.find("parts of an assembly"), std::string::npos)
      << document.account.sewing.declined;
}

// Of a file whose faces share nothing: by lines where no edge moves, else anew; both ways the
// output is read, and sewn, with the same faces at the same numbers.
TEST(Sewing, EditedFilesAreReadBackInOrder) {
  const TempFolder folder;
  auto faces = loose_faces(shapes::bicubic_cube(3.7));
  std::rotate(faces.begin(), faces.begin() + 2, faces.end());
  std::swap(faces[1], faces[4]);
  for (const std::string ending : {"step", "igs", "brep"}) {
    SCOPED_TRACE(ending);
    const std::string input = folder.file("in." + ending);
    Document loose = shapes::document_of(shapes::together(faces));
    write_document(loose, input);
    const Document document = load_document(input);
    ASSERT_TRUE(document.sewn()) << document.account.sewing.declined;
    EXPECT_EQ(document.account.sewing.solids, 1);
    for (const bool edge : {false, true}) {
      const std::string output = folder.file((edge ? "edge." : "inside.") + ending);
      const Vec3 place = shapes::pole_of(document, 1, edge ? 0 : 2, 2);
      const auto edits = shapes::pull(document, place, {0.05, 0.02, -0.03});
      ASSERT_EQ(edits.size(), edge ? 2u : 1u);
      const WriteReport report = write_edited(input, {}, edits, output);
      ASSERT_TRUE(report.written) << report.refusal;
      const bool lines = ending == "step" && !edge;
      EXPECT_EQ(report.written_by, lines ? "line by line" : "OpenCASCADE");
      EXPECT_EQ(report.edited_exact, static_cast<int>(edits.size()));
      EXPECT_EQ(report.faces_identical, report.faces_bspline_untouched);
      EXPECT_TRUE(report.reread.valid && report.reread.closed);
      EXPECT_NEAR(report.reread.volume, report.rebuilt.volume, 1e-12 * report.rebuilt.volume);
      const Document after = load_document(output);
      EXPECT_EQ(after.sewn(), lines);
      EXPECT_TRUE(compare_faces(document, after, edits).objection.empty());
      if (ending == "step" && edge) {
        EXPECT_NE(report.not_line_by_line.find("the faces were sewn"), std::string::npos);
      }
    }
  }
}

TEST(Sewing, OpenBoxBecomesAShellWithItsRimFree) {
  Document document = loose_box(1);
  sew(document);
  EXPECT_TRUE(document.sewn());
  const ShapeFacts facts = shape_facts(document.shape);
  EXPECT_EQ(facts.solids, 0);
  EXPECT_EQ(facts.shells, 1);
  EXPECT_EQ(facts.free_edges, 4);
}

TEST(Sewing, FacesKeepOrderAndNames) {
  Document document = loose_box();
  document.xde = new_xde();
  const auto tool = XCAFDoc_DocumentTool::ShapeTool(document.xde->Main());
  for (int f = 0; f < document.face_count(); ++f) {
    const TDF_Label label = tool->AddShape(document.face(f), Standard_False);
    TDataStd_Name::Set(label, ("side " + std::to_string(f)).c_str());
  }
  index_document(document);
  std::vector<gp_Pnt> corners;
  for (int f = 0; f < 6; ++f) {
    corners.push_back(
        BRep_Tool::Pnt(TopoDS::Vertex(TopExp_Explorer(document.face(f), TopAbs_VERTEX).Current())));
  }
  sew(document);
  ASSERT_TRUE(document.sewn());
  ASSERT_EQ(document.face_count(), 6);
  for (int f = 0; f < 6; ++f) {
    EXPECT_EQ(document.name_of(document.face(f)), "side " + std::to_string(f));
    bool found = false;
    for (TopExp_Explorer it(document.face(f), TopAbs_VERTEX); it.More(); it.Next()) {
      found =
          found ||
          BRep_Tool::Pnt(TopoDS::Vertex(it.Current())).Distance(corners[static_cast<size_t>(f)]) <
              1e-12;
    }
    EXPECT_TRUE(found) << f;
  }
  Document again = document;
  index_document(again);  // from the labels alone
  EXPECT_EQ(again.face_count(), 6);
  EXPECT_GE(shape_facts(again).names.size(), 6u);
}

TEST(Sewing, FacesWithoutAreaAreDropped) {
  Document document = loose_box();
  BRep_Builder builder;
  TopoDS_Shape shape = document.shape;
  builder.Add(shape, BRepBuilderAPI_MakeFace(gp_Pln(), 0.0, 1.0, 0.0, 1e-9).Shape());
  document.shape = shape;
  index_document(document);
  ASSERT_EQ(document.face_count(), 7);
  sew(document);
  EXPECT_TRUE(document.sewn());
  EXPECT_EQ(document.face_count(), 6);
  EXPECT_NE(all(document.notices)
                .find("1 face without area dropped (by the numbers of the file: face:7)"),
            std::string::npos)
      << all(document.notices);
}

TEST(Sewing, WhatGainsNothingIsNotTouched) {
  Document solid;
  solid.shape = BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape();
  index_document(solid);
  const TopoDS_Shape before = solid.shape;
  sew(solid);
  EXPECT_FALSE(solid.sewn());
  EXPECT_TRUE(solid.shape.IsEqual(before));
  Document single = loose_box(5);
  const TopoDS_Shape own = single.shape;
  sew(single);
  EXPECT_FALSE(single.sewn());
  EXPECT_TRUE(single.shape.IsEqual(own));
  EXPECT_TRUE(single.notices.empty());
}

}  // namespace
}  // namespace isochor::internal
