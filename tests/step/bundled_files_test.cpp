// The committed files of data/step as OpenCASCADE sees them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <BRepCheck_Analyzer.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <Quantity_Color.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <gp_Pnt2d.hxx>

#include "isochor/step/document.h"

namespace isochor {
namespace {

using internal::Document;
using internal::load_document;

struct Expected {
  const char* file;
  std::vector<std::string> names;  // of the faces, in order
};

std::vector<std::string> fuselage_names() {
  std::vector<std::string> names{"skin"};
  for (const char* side : {"left ", "right "}) {
    for (int k = 1; k <= 2; ++k) names.push_back("windscreen " + (side + std::to_string(k)));
    for (int k = 1; k <= 10; ++k) names.push_back("window " + (side + std::to_string(k)));
  }
  names.push_back("aft cap");
  return names;
}

std::vector<std::string> fuselage12_names() {
  std::vector<std::string> names;
  for (const char* part : {"nose ", "cabin ", "tail "}) {
    for (const char* quarter : {"left", "top", "right", "bottom"}) {
      names.push_back(std::string(part) + quarter);
    }
  }
  names.push_back("aft cap");
  return names;
}

class BundledFiles : public ::testing::TestWithParam<Expected> {};

TEST_P(BundledFiles, AreOneValidClosedSolidWithNamedColouredFaces) {
  const Document document =
      load_document(std::string(ISOCHOR_SOURCE_DIR) + "/data/step/" + GetParam().file);
  EXPECT_TRUE(BRepCheck_Analyzer(document.shape).IsValid());
  EXPECT_EQ(document.unit.name, "m");

  TopTools_IndexedMapOfShape solids, shells;
  TopExp::MapShapes(document.shape, TopAbs_SOLID, solids);
  TopExp::MapShapes(document.shape, TopAbs_SHELL, shells);
  EXPECT_EQ(solids.Extent(), 1);
  ASSERT_EQ(shells.Extent(), 1);
  EXPECT_TRUE(BRep_Tool::IsClosed(shells(1)));

  std::vector<std::string> names;
  const auto colours = XCAFDoc_DocumentTool::ColorTool(document.xde->Main());
  for (int k = 0; k < document.face_count(); ++k) {
    names.push_back(document.name_of(document.face(k)));
    Quantity_Color colour;
    EXPECT_TRUE(colours->GetColor(document.face(k), XCAFDoc_ColorSurf, colour)) << names.back();
  }
  EXPECT_EQ(names, GetParam().names);
}

TEST_P(BundledFiles, HaveCurvesThatAgreeWithTheirSurfaces) {
  const Document document =
      load_document(std::string(ISOCHOR_SOURCE_DIR) + "/data/step/" + GetParam().file);
  TopTools_IndexedDataMapOfShapeListOfShape faces_of;
  TopExp::MapShapesAndAncestors(document.shape, TopAbs_EDGE, TopAbs_FACE, faces_of);
  double gap = 0.0;
  for (int e = 1; e <= faces_of.Extent(); ++e) {
    const TopoDS_Edge edge = TopoDS::Edge(faces_of.FindKey(e));
    if (BRep_Tool::Degenerated(edge)) continue;
    EXPECT_EQ(faces_of(e).Extent(), 2) << "edge " << e;  // a seam counts its face twice
    EXPECT_LE(BRep_Tool::Tolerance(edge), 1e-7);
    double first = 0.0, last = 0.0;
    const auto curve = BRep_Tool::Curve(edge, first, last);
    for (const TopoDS_Shape& face : faces_of(e)) {
      double from = 0.0, to = 0.0;
      const auto flat = BRep_Tool::CurveOnSurface(edge, TopoDS::Face(face), from, to);
      const auto surface = BRep_Tool::Surface(TopoDS::Face(face));
      for (int k = 0; k <= 20; ++k) {
        const double t = first + (last - first) * k / 20;
        const gp_Pnt2d uv = flat->Value(t);
        gap = std::max(gap, curve->Value(t).Distance(surface->Value(uv.X(), uv.Y())));
      }
    }
  }
  EXPECT_LT(gap, 2e-14);
}

INSTANTIATE_TEST_SUITE_P(
    All, BundledFiles,
    ::testing::Values(Expected{"fuselage.step", fuselage_names()},
                      Expected{"fuselage12.step", fuselage12_names()},
                      Expected{"hull.step", {"starboard", "port", "transom", "deck"}},
                      Expected{
                          "patchwork.step",
                          {"top left", "top right", "bottom", "front", "back", "left", "right"}},
                      Expected{"canopy.step",
                               {"skin", "canopy", "port", "aft", "starboard", "fore", "mast",
                                "mast cover", "floor"}},
                      Expected{"cube.step", {"top", "bottom", "front", "back", "left", "right"}}),
    [](const auto& instance) {
      const std::string file = instance.param.file;
      return file.substr(0, file.find('.'));
    });

}  // namespace
}  // namespace isochor
