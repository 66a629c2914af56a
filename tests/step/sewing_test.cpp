#include "isochor/step/sewing.h"

#include <gtest/gtest.h>

#include <BRepBuilderAPI_Copy.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <gp_Pln.hxx>

#include "isochor/step/exchange.h"
#include "isochor/step/flux.h"
#include "isochor/step/shape_facts.h"

namespace isochor::internal {
namespace {

// Copies of the faces of a box that share no edge; every second one turned round; some left out.
Document loose_box(int without = 0) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape();
  BRep_Builder builder;
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  int count = 0;
  for (TopExp_Explorer it(box, TopAbs_FACE); it.More(); it.Next()) {
    if (count++ < without) continue;
    TopoDS_Shape face = BRepBuilderAPI_Copy(it.Current()).Shape();
    if (count % 2 == 0) face.Reverse();
    builder.Add(compound, face);
  }
  Document document;
  document.path = "loose.brep";
  document.shape = compound;
  index_document(document);
  return document;
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
  EXPECT_TRUE(document.sewn);
  EXPECT_EQ(document.face_count(), 6);
  const ShapeFacts facts = shape_facts(document.shape);
  EXPECT_TRUE(facts.closed);
  EXPECT_TRUE(facts.valid);
  EXPECT_EQ(facts.solids, 1);
  EXPECT_NEAR(facts.volume, 6.0, 1e-13);
  const std::string text = all(document.notices);
  EXPECT_NE(text.find("6 faces in 1 shell, 1 closed and made a solid; 0 free edges are left of 24"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("turned round"), std::string::npos) << text;
}

TEST(Sewing, OpenBoxBecomesAShellWithItsRimFree) {
  Document document = loose_box(1);
  sew(document);
  EXPECT_TRUE(document.sewn);
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
  ASSERT_TRUE(document.sewn);
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
  EXPECT_TRUE(document.sewn);
  EXPECT_EQ(document.face_count(), 6);
  EXPECT_NE(all(document.notices).find("1 face without area dropped (numbers of the file: face:7)"),
            std::string::npos)
      << all(document.notices);
}

TEST(Sewing, WhatGainsNothingIsNotTouched) {
  Document solid;
  solid.shape = BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape();
  index_document(solid);
  const TopoDS_Shape before = solid.shape;
  sew(solid);
  EXPECT_FALSE(solid.sewn);
  EXPECT_TRUE(solid.shape.IsEqual(before));
  Document single = loose_box(5);
  const TopoDS_Shape own = single.shape;
  sew(single);
  EXPECT_FALSE(single.sewn);
  EXPECT_TRUE(single.shape.IsEqual(own));
  EXPECT_TRUE(single.notices.empty());
}

}  // namespace
}  // namespace isochor::internal
