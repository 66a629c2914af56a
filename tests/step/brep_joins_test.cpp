#include "isochor/step/brep_joins.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <set>

#include "isochor/base/tolerance.h"
#include "isochor/step/edge_measures.h"
#include "step/shapes.h"

namespace isochor::internal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct Read {
  BrepTable table;
  std::vector<EdgeFacts> edges;
  PatchModel model;
};

Read read(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  Read result{brep_table(shape, faces), {}, {}};
  for (const EdgeRecord& edge : result.table.edges) {
    result.edges.push_back(measure_edge(result.table, edge));
  }
  result.model = patch_model(result.table, result.edges);
  validate(result.model);
  return result;
}

void expect_ties_are_close(const Read& r) {
  for (const auto& [a, b] : r.model.ties) {
    EXPECT_LE(
        (r.model.points[static_cast<size_t>(a)] - r.model.points[static_cast<size_t>(b)]).norm(),
        kCoincident * r.table.diagonal);
  }
}

// A flat bicubic sheet over [x0, x1] x [y0, y1] with `n` poles each way; z = slope * x. `uneven`:
// how much slower y starts than it ends.
TopoDS_Face sheet(double x0, double x1, double y0, double y1, int n, double slope = 0.0,
                  double uneven = 0.0) {
  TColgp_Array2OfPnt poles(1, n, 1, n);
  TColStd_Array1OfReal knots(1, n - 2);
  TColStd_Array1OfInteger counts(1, n - 2);
  counts.Init(1);
  counts(1) = counts(n - 2) = 4;
  for (int k = 1; k <= n - 2; ++k) knots(k) = k - 1.0;
  const auto greville = [&](int i) {
    double sum = 0.0;
    for (int k = 1; k <= 3; ++k) sum += std::min(std::max(i + k - 3.0, 0.0), n - 3.0);
    return sum / (3.0 * (n - 3));
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double x = x0 + (x1 - x0) * greville(i);
      const double t = greville(j) * (1.0 - uneven * (1.0 - greville(j)));
      poles(i + 1, j + 1) = gp_Pnt(x, y0 + (y1 - y0) * t, slope * x);
    }
  }
  const Handle(Geom_BSplineSurface) surface =
      new Geom_BSplineSurface(poles, knots, knots, counts, counts, 3, 3);
  return BRepBuilderAPI_MakeFace(surface, 1e-9);
}

TopoDS_Shape sewn(const std::vector<TopoDS_Face>& faces) {
  BRepBuilderAPI_Sewing sewing(1e-7);
  for (const TopoDS_Face& face : faces) sewing.Add(face);
  sewing.Perform();
  return sewing.SewedShape();
}

TEST(BrepJoins, CubeOfSixPatchesIsTiedAllAround) {
  const Read r = read(shapes::bicubic_cube(1.0, 6));
  EXPECT_EQ(r.model.patches.size(), 6u);
  EXPECT_EQ(r.model.joins.size(), 12u);
  EXPECT_TRUE(r.model.locked_sides.empty());
  EXPECT_TRUE(r.model.locks.empty());
  for (const Join& join : r.model.joins) {
    EXPECT_TRUE(join.matching) << join.mismatch;
    EXPECT_EQ(join.smoothness, Smoothness::kSharp);
  }
  // 6 n^2 poles; an edge of n - 2 inner poles counts twice, a corner three times.
  EXPECT_EQ(point_classes(r.model).representative.size(), 6u * 36u - 12u * 4u - 8u * 2u);
  expect_ties_are_close(r);
}

TEST(BrepJoins, SeamTiesAPatchToItselfAndCapsLockItsOtherSides) {
  for (bool periodic : {true, false}) {
    const Read r = read(shapes::barrel(periodic));
    ASSERT_EQ(r.model.patches.size(), 1u) << periodic;
    ASSERT_EQ(r.model.joins.size(), 1u);
    const Join& seam = r.model.joins[0];
    EXPECT_EQ(seam.a.patch, seam.b.patch);
    EXPECT_FALSE(seam.opposed);
    EXPECT_TRUE(seam.matching);
    ASSERT_EQ(r.model.locked_sides.size(), 2u);
    for (const LockedSide& side : r.model.locked_sides) {
      EXPECT_THAT(side.reason, AllOf(HasSubstr("(plane)"), HasSubstr("is not edited")));
      EXPECT_EQ(side.smoothness, Smoothness::kSharp);
    }
    // Three rows wrap: 13 of the 10 poles around, on 6 levels.
    EXPECT_EQ(point_classes(r.model).representative.size(), 60u);
    ASSERT_FALSE(r.model.fixed_points.empty());
    EXPECT_THAT(r.model.fixed_points[0].second, HasSubstr("a corner shared with face:"));
    expect_ties_are_close(r);
  }
}

TEST(BrepJoins, CollapsedSideMovesAsOnePoint) {
  const Read r = read(shapes::dome());
  ASSERT_EQ(r.model.patches.size(), 1u);
  const Patch& patch = r.model.patches[0];
  const PointClasses classes = point_classes(r.model);
  std::set<int> top;
  for (const auto& [i, j] : side_indices(patch, Side::kVEnd)) {
    top.insert(classes.class_of[static_cast<size_t>(patch.point(i, j))]);
  }
  EXPECT_EQ(top.size(), 1u);
  for (const Lock& lock : r.model.locks) {
    EXPECT_EQ(top.count(classes.class_of[static_cast<size_t>(lock.point)]), 0u);
  }
  ASSERT_EQ(r.model.locked_sides.size(), 1u);
  EXPECT_EQ(r.model.locked_sides[0].side.side, Side::kVBegin);
}

TEST(BrepJoins, TangentPatchesJoinSmoothlyAndOpenSidesStayFree) {
  const Read r = read(sewn({sheet(0, 1, 0, 1, 6, 0.3), sheet(1, 2, 0, 1, 6, 0.3)}));
  ASSERT_EQ(r.model.joins.size(), 1u);
  EXPECT_TRUE(r.model.joins[0].matching);
  EXPECT_EQ(r.model.joins[0].smoothness, Smoothness::kCurvature);
  EXPECT_TRUE(r.model.locked_sides.empty());
  EXPECT_TRUE(r.model.fixed_points.empty());
  EXPECT_EQ(r.model.ties.size(), 6u);
}

TEST(BrepJoins, PatchesWithDifferentKnotsAreTiedInACommonBasis) {
  const Read r = read(sewn({sheet(0, 1, 0, 1, 6, 0.3), sheet(1, 2, 0, 1, 8, 0.3)}));
  ASSERT_EQ(r.model.joins.size(), 1u);
  const Join& join = r.model.joins[0];
  EXPECT_FALSE(join.matching);
  EXPECT_TRUE(join.common);
  EXPECT_EQ(join.mismatch, "6 poles against 8");
  EXPECT_EQ(join.smoothness, Smoothness::kCurvature);
  EXPECT_TRUE(r.model.locked_sides.empty());
  EXPECT_TRUE(r.model.fixed_points.empty());
  EXPECT_TRUE(r.model.locks.empty());
  EXPECT_EQ(r.model.ties.size(), 2u);  // both ends
  ASSERT_EQ(r.model.relations.size(), 2u);
  EXPECT_EQ(r.model.relations[0].kind, SmoothRelation::Kind::kTie);
  EXPECT_EQ(r.model.relations[1].order, 2);
  expect_ties_are_close(r);
}

TEST(BrepJoins, CurvesThatRunDifferentlyLockTheirCommonSide) {
  const Read r = read(sewn({sheet(0, 1, 0, 1, 6), sheet(1, 2, 0, 1, 8, 0.0, 0.3)}));
  ASSERT_EQ(r.model.joins.size(), 1u);
  EXPECT_FALSE(r.model.joins[0].common);
  EXPECT_FALSE(r.model.joins[0].matching);
  EXPECT_FALSE(r.model.joins[0].mismatch.empty());
  ASSERT_EQ(r.model.locked_sides.size(), 2u);
  EXPECT_THAT(r.model.locked_sides[0].reason, HasSubstr("does not match side"));
  EXPECT_TRUE(r.model.ties.empty());
  EXPECT_EQ(r.model.fixed_points.size(), 4u);
}

TEST(BrepJoins, TwoPatchesAgainstOneMoveWithIt) {
  const Read r = read(sewn({sheet(0, 1, 0, 1, 6), sheet(1, 2, 0, 0.5, 6), sheet(1, 2, 0.5, 1, 6)}));
  ASSERT_EQ(r.model.patches.size(), 3u);
  EXPECT_TRUE(r.model.locked_sides.empty());
  EXPECT_TRUE(r.model.fixed_points.empty());
  EXPECT_TRUE(r.model.locks.empty());
  ASSERT_EQ(r.model.joins.size(), 3u);
  int parts = 0;
  for (const Join& join : r.model.joins) {
    if (join.matching) continue;
    EXPECT_TRUE(join.common);
    const bool first_is_long = !join.part_a.whole();
    EXPECT_NE(first_is_long, !join.part_b.whole());
    const SidePart& part = first_is_long ? join.part_a : join.part_b;
    EXPECT_TRUE(part == (SidePart{0.0, 1.5}) || part == (SidePart{1.5, 3.0})) << part.from;
    ++parts;
  }
  EXPECT_EQ(parts, 2);
  expect_ties_are_close(r);
}

TEST(BrepJoins, APartThatDoesNotFitLocksOnlyWhatShapesIt) {
  const Read r =
      read(sewn({sheet(0, 1, 0, 1, 12), sheet(1, 2, 0, 0.5, 6), sheet(1, 2, 0.5, 1, 6, 0.0, 0.3)}));
  ASSERT_EQ(r.model.patches.size(), 3u);
  int parts = 0;
  int several = 0;
  for (const LockedSide& side : r.model.locked_sides) {
    parts += side.reason.find("meets only a part of a side of face:") == 0 ? 1 : 0;
    several += side.reason.find("is shared by several faces, among them face:") == 0 ? 1 : 0;
  }
  EXPECT_EQ(parts, 1);
  EXPECT_EQ(several, 1);
  EXPECT_EQ(r.model.joins.size(), 2u);  // of the two small ones, and of the part that fits
  // Nine spans, twelve functions: those that begin before the middle of the fifth span and end
  // after it or later are locked, eight of them, in one row. The normals agree: two more rows.
  std::set<int> rows[3];
  int large = 0;
  for (int q = 0; q < 3; ++q) {
    if (r.model.patches[static_cast<size_t>(q)].u_size() == 12) large = q;
  }
  const Patch& patch = r.model.patches[static_cast<size_t>(large)];
  for (const Lock& lock : r.model.locks) {
    for (Side side : kSides) {
      for (int row = 0; row < 3; ++row) {
        for (const auto& [i, j] : side_indices(patch, side, row)) {
          if (patch.point(i, j) == lock.point && side == Side::kUEnd) rows[row].insert(j);
        }
      }
    }
  }
  for (const std::set<int>& locked : rows) EXPECT_EQ(locked.size(), 8u);
}

TEST(BrepJoins, HoleLeavesTheOuterSidesTied) {
  const Read r = read(shapes::holed_cube());
  EXPECT_EQ(r.model.patches.size(), 6u);
  EXPECT_EQ(r.model.joins.size(), 12u);
  EXPECT_TRUE(r.model.locked_sides.empty());
  int trimmed = 0;
  for (const Patch& patch : r.model.patches) trimmed += patch.trim.empty() ? 0 : 1;
  EXPECT_EQ(trimmed, 2);
}

TEST(BrepJoins, FacesWithoutBSplinesSayWhy) {
  const Read r = read(BRepPrimAPI_MakeBox(1, 2, 3).Shape());
  EXPECT_TRUE(r.model.patches.empty());
  EXPECT_EQ(r.table.faces[0].surface.refusal, "it is a plane, not a B-spline surface");
  EXPECT_EQ(r.table.label(2), "face:3 (plane)");
}

TEST(EdgeMeasures, BoxEdgesAreRightAnglesWithoutGaps) {
  const Read r = read(BRepPrimAPI_MakeBox(1, 2, 3).Shape());
  ASSERT_EQ(r.edges.size(), 12u);
  double length = 0.0;
  for (const EdgeFacts& edge : r.edges) {
    EXPECT_NEAR(edge.max_angle_rad, 1.5707963267948966, 1e-15);
    EXPECT_LT(edge.max_gap, 1e-15);
    EXPECT_EQ(edge.faces.size(), 2u);
    length += edge.length;
  }
  EXPECT_NEAR(length, 24.0, 1e-12);
}

TEST(EdgeMeasures, KinkIsMeasuredBelowTheSmoothAngle) {
  const double kink = 3e-5;
  const Read r = read(sewn({sheet(-1, 0, 0, 1, 6), sheet(0, 1, 0, 1, 6, kink)}));
  for (const EdgeFacts& edge : r.edges) {
    if (edge.faces.size() != 2) continue;
    EXPECT_NEAR(edge.max_angle_rad, kink, 1e-12);
    EXPECT_EQ(edge.smoothness, Smoothness::kCurvature);
  }
}

}  // namespace
}  // namespace isochor::internal
