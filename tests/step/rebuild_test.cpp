#include "isochor/step/rebuild.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <gp_Ax1.hxx>
#include <gp_Trsf.hxx>

#include "isochor/base/error.h"
#include "isochor/bspline/refinement.h"
#include "isochor/step/checks.h"
#include "isochor/step/document_model.h"
#include "isochor/step/shape_facts.h"
#include "step/pulls.h"
#include "step/shapes.h"

namespace isochor {
namespace {

using internal::Document;
using internal::rebuild;
using internal::shape_facts;
using shapes::pole_of;
using shapes::pull;
using ::testing::HasSubstr;

// Rebuilds after a pull and expects what every good rebuild must show.
// Copies of a document share their labels, so each edit needs a document of its own.
void expect_good(const TopoDS_Shape& shape, const Vec3& place, const Vec3& move, size_t faces) {
  auto document = shapes::document_of(shape);
  const auto before = shape_facts(document);
  const TopoDS_Shape old = document.shape;
  const auto edits = pull(document, place, move);
  ASSERT_EQ(edits.size(), faces);
  ASSERT_EQ(rebuild(document, edits), "");
  const auto after = shape_facts(document);
  EXPECT_EQ(internal::objection_to_rebuilt(before, after), "");
  EXPECT_EQ(internal::objection_to_gaps(old, document.shape), "");
  EXPECT_TRUE(after.closed);
  EXPECT_EQ(after.names, before.names);
  for (const auto& edit : edits) {
    const auto spline = internal::plain_bspline(document.face(edit.face));
    ASSERT_FALSE(spline.IsNull());
    spline->Transform(document.face(edit.face).Location().Transformation());
    EXPECT_EQ(internal::from_occt(*spline).poles().size(), edit.surface.poles().size());
    EXPECT_EQ(internal::from_occt(*spline).poles(), edit.surface.poles());
  }
}

Document cube() { return shapes::document_of(shapes::bicubic_cube()); }

TEST(Rebuild, AnInteriorPoleMoves) {
  auto document = cube();
  expect_good(document.shape, pole_of(document, 1, 2, 3), {0.1, -0.02, 0.07}, 1);
}

TEST(Rebuild, APoleOnAnEdgeMovesBothFaces) {
  auto document = cube();
  for (int i : {0, 5}) {
    expect_good(document.shape, pole_of(document, 0, i, 2), {0.05, 0.02, -0.03}, 2);
    expect_good(document.shape, pole_of(document, 0, 3, i), {0.05, 0.02, -0.03}, 2);
  }
}

TEST(Rebuild, ACornerMovesThreeFaces) {
  auto document = cube();
  for (int f = 0; f < 6; ++f) {
    expect_good(document.shape, pole_of(document, f, 0, 5), {0.05, 0.02, -0.03}, 3);
  }
}

TEST(Rebuild, FacesWithAHoleMoveClearOfIt) {
  auto document = shapes::document_of(shapes::holed_cube());
  int moved = 0;
  for (int f = 0; f < document.face_count(); ++f) {
    if (internal::plain_bspline(document.face(f)).IsNull()) continue;
    expect_good(document.shape, pole_of(document, f, 1, 1), {0.01, 0.01, 0.02}, 1);
    ++moved;
  }
  EXPECT_EQ(moved, 6);
}

TEST(Rebuild, PolesAcrossATrimAreRefused) {
  auto document = shapes::document_of(shapes::holed_cube());
  int refused = 0;
  for (int f = 0; f < document.face_count(); ++f) {
    if (internal::plain_bspline(document.face(f)).IsNull()) continue;
    auto copy = shapes::document_of(shapes::holed_cube());
    const auto edits = pull(copy, pole_of(copy, f, 5, 5), {0.01, 0.01, 0.02});
    const std::string reason = rebuild(copy, edits);
    if (reason.empty()) continue;
    ++refused;
    EXPECT_THAT(reason, HasSubstr("face:" + std::to_string(f + 1)));
    EXPECT_THAT(reason, HasSubstr("edge"));
  }
  EXPECT_EQ(refused, 2);  // the two faces with the hole
}

TEST(Rebuild, SeamPolesMove) {
  for (bool periodic : {true, false}) {
    auto document = shapes::document_of(shapes::barrel(periodic));
    int face = 0;
    while (internal::plain_bspline(document.face(face)).IsNull()) ++face;
    expect_good(document.shape, pole_of(document, face, 0, 2), {0.05, 0.02, -0.03}, 1);
    expect_good(document.shape, pole_of(document, face, 1, 2), {0.05, 0.02, -0.03}, 1);
    expect_good(document.shape, pole_of(document, face, 4, 3), {0.05, 0.02, -0.03}, 1);
  }
}

TEST(Rebuild, ACollapsedSideMovesAsOnePoint) {
  auto document = shapes::document_of(shapes::dome());
  int face = 0;
  while (internal::plain_bspline(document.face(face)).IsNull()) ++face;
  expect_good(document.shape, pole_of(document, face, 3, 5), {0.02, 0.01, 0.05}, 1);
  expect_good(document.shape, pole_of(document, face, 3, 3), {0.02, 0.01, 0.05}, 1);
}

TEST(Rebuild, LocatedPartsAreEditedInPlace) {
  gp_Trsf turn, move;
  turn.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 1, 0)), 0.7);
  move.SetTranslation(gp_Vec(10, 0, -5));
  const TopoDS_Shape located = shapes::bicubic_cube().Moved(TopLoc_Location(move * turn));
  Document document;
  document.shape = located;
  index_document(document);
  const auto before = shape_facts(document);
  for (const auto& [i, j, faces] : {std::array<int, 3>{2, 2, 1}, {0, 2, 2}, {0, 0, 3}}) {
    Document copy = document;
    const auto edits = pull(copy, pole_of(copy, 0, i, j), {0.05, 0.02, -0.03});
    EXPECT_EQ(edits.size(), static_cast<size_t>(faces));
    ASSERT_EQ(rebuild(copy, edits), "");
    EXPECT_EQ(internal::objection_to_rebuilt(before, shape_facts(copy)), "") << i << j;
    EXPECT_LT((pole_of(copy, edits[0].face, i, j) - edits[0].surface.pole(i, j)).norm(),
              1e-14 * 20);
  }
}

TEST(Rebuild, AssembliesKeepNamesAndPlaces) {
  auto document = shapes::assembly();
  const auto before = shape_facts(document);
  ASSERT_EQ(before.coloured, 2);
  const auto edits = pull(document, pole_of(document, 0, 2, 2), {0.05, 0.02, -0.03});
  ASSERT_EQ(edits.size(), 1u);
  ASSERT_EQ(rebuild(document, edits), "");
  const auto after = shape_facts(document);
  EXPECT_EQ(internal::objection_to_rebuilt(before, after), "");
  EXPECT_EQ(after.names, before.names);
  EXPECT_EQ(after.coloured, before.coloured);
  EXPECT_EQ(document.name_of(document.face(0)), "lid");
  EXPECT_EQ(pole_of(document, 0, 2, 2), edits[0].surface.pole(2, 2));
}

TEST(Rebuild, PartsUsedTwiceAreRefused) {
  Document document;
  {
    auto twice = shapes::bicubic_cube();
    gp_Trsf move;
    move.SetTranslation(gp_Vec(10, 0, 0));
    TopoDS_Compound compound;
    BRep_Builder builder;
    builder.MakeCompound(compound);
    builder.Add(compound, twice);
    builder.Add(compound, twice.Moved(TopLoc_Location(move)));
    document.shape = compound;
    index_document(document);
  }
  const auto edits = pull(document, pole_of(document, 0, 2, 2), {0.05, 0.02, -0.03});
  EXPECT_THAT(rebuild(document, edits),
              HasSubstr("face:1: belongs to a part that is used 2 times"));
}

TEST(Rebuild, APartUsedSeveralTimesIsNamedAndCounted) {
  gp_Trsf shift, further;
  shift.SetTranslation(gp_Vec(10, 0, 0));
  further.SetTranslation(gp_Vec(20, 0, 0));
  Document document = shapes::placed(shapes::bicubic_cube(), {gp_Trsf(), shift, further});
  const auto edits = pull(document, pole_of(document, 0, 2, 2), {0.05, 0.02, -0.03});
  EXPECT_EQ(rebuild(document, edits),
            "face:1: belongs to the part 'bar', which is used 3 times; an edit would change all of "
            "them");
}

TEST(Rebuild, MovingOneSideOfAnEdgeIsRefused) {
  auto document = cube();
  auto edits = pull(document, pole_of(document, 0, 0, 2), {0.05, 0.02, -0.03});
  ASSERT_EQ(edits.size(), 2u);
  edits.pop_back();
  EXPECT_THAT(rebuild(document, edits), HasSubstr("which is not edited"));
}

TEST(Rebuild, PlanesAreNotBSplines) {
  auto document = shapes::document_of(shapes::cylinder());
  auto edits = pull(cube(), pole_of(cube(), 0, 2, 2), {0.05, 0.02, -0.03});
  EXPECT_THAT(rebuild(document, edits), HasSubstr("not a B-spline"));
  edits[0].face = 99;
  EXPECT_THROW(rebuild(document, edits), PreconditionError);
}

// A face on a box of its surface comes back as the surface of the box; its border moves with it.
TEST(Rebuild, BoxesOfASurfaceMoveWithTheirBorder) {
  const auto whole = internal::plain_bspline(cube().face(0));
  const auto middle = [](double low, double high, double share) {
    return low + share * (high - low);
  };
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  whole->Bounds(u0, u1, v0, v1);
  const TopoDS_Face face = BRepBuilderAPI_MakeFace(whole, middle(u0, u1, 0.2), middle(u0, u1, 0.9),
                                                   v0, middle(v0, v1, 0.6), 1e-9);
  auto document = shapes::document_of(face);
  const auto model = internal::document_model(document, {});
  ASSERT_EQ(model.patches.patches.size(), 1u);
  EXPECT_EQ(model.faces[0].trim, TrimKind::kNatural);
  EXPECT_TRUE(model.patches.locks.empty());
  const Surface part = model.patches.surface(0);
  std::vector<Vec3> poles = part.poles();
  poles[part.index(0, 2)] += Vec3(0.02, 0.01, 0.03);
  poles[part.index(part.u_size() - 1, part.v_size() - 1)] += Vec3(0.0, 0.01, 0.03);
  const EditedFace edit{0, Surface(part.u_knots(), part.v_knots(), poles)};
  const auto before = shape_facts(document);
  const TopoDS_Shape old = document.shape;
  ASSERT_EQ(rebuild(document, {edit}), "");
  EXPECT_EQ(internal::objection_to_rebuilt(before, shape_facts(document)), "");
  EXPECT_EQ(internal::objection_to_gaps(old, document.shape), "");
  const auto spline = internal::plain_bspline(document.face(0));
  ASSERT_FALSE(spline.IsNull());
  EXPECT_EQ(internal::from_occt(*spline).poles(), poles);
}

// The trap that makes checks before writing necessary: only the surface is replaced.
TEST(Rebuild, ARebuildWithoutItsCurvesIsObjectedTo) {
  auto document = cube();
  const auto before = shape_facts(document);
  const auto edits = pull(document, pole_of(document, 0, 0, 2), {0.05, 0.02, -0.03});
  internal::RebuildPlan plan;
  for (const auto& edit : edits) {
    plan.surfaces.push_back({document.face(edit.face), internal::to_occt(edit.surface), "", false,
                             edit.surface, edit.surface});
  }
  const TopoDS_Shape bad = internal::rebuild_part(document.shape, plan);
  EXPECT_NE(internal::objection_to_rebuilt(before, shape_facts(bad)), "");
  EXPECT_NE(internal::objection_to_gaps(document.shape, bad), "");
}

TEST(Rebuild, RefinedSurfacesKeepUntouchedEdges) {
  auto document = cube();
  const auto old = internal::from_occt(*internal::plain_bspline(document.face(0)));
  Surface fine =
      refine(old, refined_to_spans(old.u_knots(), 12), refined_to_spans(old.v_knots(), 12));
  std::vector<Vec3> poles = fine.poles();
  poles[fine.index(6, 6)] += Vec3(0.1, 0, 0);
  const EditedFace edit{0, Surface(fine.u_knots(), fine.v_knots(), poles)};
  const auto before = shape_facts(document);
  TopTools_IndexedMapOfShape old_edges, new_edges;
  TopExp::MapShapes(document.shape, TopAbs_EDGE, old_edges);
  ASSERT_EQ(rebuild(document, {edit}), "");
  EXPECT_EQ(internal::objection_to_rebuilt(before, shape_facts(document)), "");
  TopExp::MapShapes(document.shape, TopAbs_EDGE, new_edges);
  ASSERT_EQ(new_edges.Extent(), old_edges.Extent());
  for (int k = 1; k <= old_edges.Extent(); ++k) {
    double a = 0, b = 0;
    EXPECT_EQ(BRep_Tool::Curve(TopoDS::Edge(old_edges(k)), a, b),
              BRep_Tool::Curve(TopoDS::Edge(new_edges(k)), a, b))
        << "the very same curve object";
  }
}

}  // namespace
}  // namespace isochor
