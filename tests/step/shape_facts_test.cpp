#include "isochor/step/shape_facts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_Plane.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Shell.hxx>
#include <gp_Pln.hxx>

#include "isochor/step/checks.h"
#include "isochor/step/gaps.h"
#include "step/shapes.h"

namespace isochor {
namespace {

using internal::measure_gaps;
using internal::shape_facts;
using ::testing::Contains;
using ::testing::HasSubstr;

TEST(ShapeFacts, AClosedSolidIsDescribed) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Solid();
  const auto facts = shape_facts(box);
  EXPECT_TRUE(facts.valid);
  EXPECT_TRUE(facts.closed);
  EXPECT_TRUE(facts.defects.empty());
  EXPECT_EQ(facts.solids, 1);
  EXPECT_EQ(facts.shells, 1);
  EXPECT_EQ(facts.closed_shells, 1);
  EXPECT_EQ(facts.free_edges, 0);
  EXPECT_EQ(facts.multiple_edges, 0);
  EXPECT_NEAR(facts.volume, 6.0, 1e-13);
  EXPECT_NEAR(facts.area, 22.0, 1e-12);
  EXPECT_NEAR(facts.diagonal, std::sqrt(14.0), 1e-5);
  EXPECT_LT(facts.max_edge_gap, 1e-14);
}

TEST(ShapeFacts, SeamsAndPolesAreNotFree) {
  for (const auto& shape : {TopoDS_Shape(shapes::barrel(true)), TopoDS_Shape(shapes::barrel(false)),
                            TopoDS_Shape(shapes::dome()), TopoDS_Shape(shapes::cylinder())}) {
    const auto facts = shape_facts(shape);
    EXPECT_TRUE(facts.valid);
    EXPECT_TRUE(facts.closed);
    EXPECT_EQ(facts.free_edges, 0);
    EXPECT_LE(facts.max_edge_gap, facts.max_tolerance);
  }
}

TEST(ShapeFacts, AMissingFaceLeavesFreeEdges) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Solid();
  TopoDS_Shell open;
  TopoDS_Compound loose;
  BRep_Builder builder;
  builder.MakeShell(open);
  builder.MakeCompound(loose);
  int k = 0;
  for (TopExp_Explorer it(box, TopAbs_FACE); it.More(); it.Next()) {
    if (k++ > 0) builder.Add(open, it.Current());
    builder.Add(loose, it.Current());
  }
  const auto facts = shape_facts(open);
  EXPECT_FALSE(facts.closed);
  EXPECT_EQ(facts.free_edges, 4);
  EXPECT_EQ(facts.solids, 0);
  EXPECT_FALSE(shape_facts(loose).closed) << "faces without a shell enclose nothing";
}

TEST(ShapeFacts, AnEdgeOfThreeFacesIsMultiple) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Solid();
  TopoDS_Shell shell;
  BRep_Builder builder;
  builder.MakeShell(shell);
  TopoDS_Shape first;
  for (TopExp_Explorer it(box, TopAbs_FACE); it.More(); it.Next()) {
    if (first.IsNull()) first = it.Current();
    builder.Add(shell, it.Current());
  }
  builder.Add(shell, first);
  const auto facts = shape_facts(shell);
  EXPECT_EQ(facts.multiple_edges, 4);
  EXPECT_FALSE(facts.closed);
}

TEST(ShapeFacts, AnOutlineThatIsNotClosedIsTheOneDefectOfItsFace) {
  const TopoDS_Shape open = BRepBuilderAPI_MakePolygon(gp_Pnt(0, 0, 0), gp_Pnt(1, 0, 0),
                                                       gp_Pnt(1, 1, 0), gp_Pnt(0, 1, 0), false)
                                .Wire();
  BRep_Builder builder;
  TopoDS_Face face;
  builder.MakeFace(face, new Geom_Plane(gp_Pln()), 1e-7);
  builder.Add(face, open);
  const auto facts = shape_facts(face);
  EXPECT_FALSE(facts.valid);
  EXPECT_THAT(facts.defects, ::testing::ElementsAre("face:1: outline: not closed"));
}

TEST(ShapeFacts, DefectsNameTheFace) {
  TopoDS_Shape box = BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Solid();
  TopTools_IndexedMapOfShape vertices;
  TopExp::MapShapes(box, TopAbs_VERTEX, vertices);
  BRep_Builder().UpdateVertex(TopoDS::Vertex(vertices(1)), gp_Pnt(0.2, 0.1, 0.0), 1e-7);
  const auto facts = shape_facts(box);
  EXPECT_FALSE(facts.valid);
  EXPECT_THAT(facts.defects, Contains(HasSubstr("face:1: ")));
  EXPECT_THAT(facts.defects, Contains(HasSubstr("vertex")));
  EXPECT_GT(facts.max_vertex_gap, 0.1);
}

TEST(Gaps, AShiftedSurfaceIsMeasured) {
  const TopoDS_Shape cube = shapes::bicubic_cube();
  const auto clean = measure_gaps(cube);
  EXPECT_THAT(clean.edges, ::testing::Each(::testing::Le(1e-12)));
  EXPECT_EQ(clean.edges.size(), 12u);
  EXPECT_EQ(clean.vertices.size(), 8u);
  TopExp_Explorer face(cube, TopAbs_FACE);
  const auto spline =
      Handle(Geom_BSplineSurface)::DownCast(BRep_Tool::Surface(TopoDS::Face(face.Current())));
  spline->SetPole(1, 3, spline->Pole(1, 3).Translated(gp_Vec(0, 0.01, 0)));
  const auto gaps = measure_gaps(cube);
  int wide = 0;
  for (double gap : gaps.edges) wide += gap > 1e-12 ? 1 : 0;
  EXPECT_EQ(wide, 1);
  // The largest value of a cubic basis function with simple knots next to a clamped end is known to
  // lie between a third and one.
  const double largest = *std::max_element(gaps.edges.begin(), gaps.edges.end());
  EXPECT_GT(largest, 0.01 / 3);
  EXPECT_LT(largest, 0.01);
}

TEST(ShapeFacts, NamesAndColoursAreCounted) {
  const auto facts = shape_facts(shapes::assembly());
  EXPECT_THAT(facts.names, ::testing::IsSupersetOf({"pair", "box", "lid", "pin"}));
  EXPECT_EQ(facts.coloured, 2);
  EXPECT_EQ(facts.solids, 3);
}

ShapeFacts good() {
  ShapeFacts facts;
  facts.valid = facts.closed = true;
  facts.solids = facts.shells = facts.closed_shells = 1;
  facts.max_tolerance = 1e-7;
  facts.max_edge_gap = facts.max_vertex_gap = 1e-9;
  facts.area = 6;
  facts.volume = 1;
  facts.diagonal = 2;
  facts.names = {"a", "b"};
  facts.coloured = 1;
  return facts;
}

TEST(Checks, EachPromiseIsWatchedBeforeWriting) {
  const ShapeFacts before = good();
  EXPECT_EQ(internal::objection_to_rebuilt(before, before), "");
  const auto objection = [&](auto&& spoil) {
    ShapeFacts rebuilt = before;
    spoil(rebuilt);
    return internal::objection_to_rebuilt(before, rebuilt);
  };
  EXPECT_THAT(objection([](ShapeFacts& f) {
                f.valid = false;
                f.defects = {"face:3: odd"};
              }),
              HasSubstr("not valid (face:3: odd)"));
  EXPECT_THAT(objection([](ShapeFacts& f) { f.max_tolerance = 2e-7; }), HasSubstr("tolerance"));
  EXPECT_THAT(objection([](ShapeFacts& f) { f.max_edge_gap = 2e-9; }), HasSubstr("gap"));
  EXPECT_THAT(objection([](ShapeFacts& f) { f.max_vertex_gap = 2e-9; }), HasSubstr("vertex"));
  EXPECT_THAT(objection([](ShapeFacts& f) { f.closed = false; }), HasSubstr("closed"));
  EXPECT_THAT(objection([](ShapeFacts& f) { f.solids = 2; }), HasSubstr("solids"));
  EXPECT_EQ(objection([](ShapeFacts& f) { f.max_edge_gap += 1e-12; }), "");
  ShapeFacts invalid = before;
  invalid.valid = false;
  EXPECT_THAT(internal::objection_to_rebuilt(invalid, before), HasSubstr("the input is not"));
}

TEST(Checks, EachPromiseIsWatchedAfterReading) {
  const ShapeFacts before = good();
  EXPECT_EQ(internal::objection_to_reread(before, before, true), "");
  const auto objection = [&](auto&& spoil) {
    ShapeFacts reread = before;
    spoil(reread);
    return internal::objection_to_reread(before, reread, true);
  };
  EXPECT_THAT(objection([](ShapeFacts& f) { f.volume = 0.75; }), HasSubstr("volume"));
  EXPECT_THAT(objection([](ShapeFacts& f) { f.area = 5.9; }), HasSubstr("area"));
  EXPECT_THAT(objection([](ShapeFacts& f) { f.names = {"a"}; }), HasSubstr("name 'b' was lost"));
  EXPECT_THAT(objection([](ShapeFacts& f) { f.coloured = 0; }), HasSubstr("coloured"));
  EXPECT_THAT(objection([](ShapeFacts& f) { f.shells = 3; }), HasSubstr("shells"));
  ShapeFacts loose = before;
  EXPECT_EQ(internal::tolerance_growth(before, loose), "");
  loose.max_tolerance = 1e-3;
  EXPECT_THAT(internal::tolerance_growth(before, loose), HasSubstr("tolerance grew"));
  ShapeFacts nameless = before;
  nameless.names.clear();
  EXPECT_EQ(internal::objection_to_reread(before, nameless, false), "");
}

TEST(Checks, GapsThatAReaderFindsAnewMustStayInsideTheTolerance) {
  const ShapeFacts before = good();
  const auto growth = [&](double edge, double vertex) {
    ShapeFacts reread = before;
    reread.max_edge_gap = edge;
    reread.max_vertex_gap = vertex;
    return internal::gap_growth(before, reread);
  };
  EXPECT_EQ(growth(1e-9, 1e-9).inside + growth(1e-9, 1e-9).beyond, "");
  EXPECT_EQ(growth(1e-12, 0.0).inside, "") << "smaller gaps are welcome";
  const auto small = growth(1e-9, 5e-8);
  EXPECT_THAT(small.inside, HasSubstr("gap at a vertex grew from 1e-09 by 4.9e-08, inside the "
                                      "tolerance of 1e-07"));
  EXPECT_EQ(small.beyond, "");
  const auto large = growth(2e-7, 5e-8);
  EXPECT_THAT(large.beyond, HasSubstr("between an edge and its faces grew"));
  EXPECT_THAT(large.beyond, HasSubstr("beyond the tolerance of 1e-07"));
  EXPECT_THAT(large.inside, HasSubstr("vertex"));
}

}  // namespace
}  // namespace isochor
