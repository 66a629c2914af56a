// Faces that cut through each other, in known places, and faces that do not.
#include "isochor/step/self_intersections.h"

#include <gtest/gtest.h>

#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <cmath>
#include <gp_Pln.hxx>

#include "isochor/step/document_model.h"
#include "isochor/step/model_bytes.h"
#include "isochor/step/occt_surface.h"
#include "shapes.h"

namespace isochor::internal {
namespace {

CrossingsAccount crossings_of(const TopoDS_Shape& shape) {
  ReadOptions options;
  options.crossings = true;
  const SolidModel model = document_model(shapes::document_of(shape), options);
  const CrossingsAccount account = model.crossings.value();
  const auto count = static_cast<long>(model.faces.size());
  EXPECT_EQ(account.pairs, count * (count - 1) / 2);
  EXPECT_EQ(account.pairs,
            account.apart + account.neighbours + account.crossing + account.undecided);
  EXPECT_EQ(account.faces, count);
  EXPECT_EQ(account.faces, account.faces_free + account.faces_crossing + account.faces_undecided);
  EXPECT_EQ(account.crossing + account.faces_crossing, static_cast<long>(account.found.size()));
  return account;
}

TopoDS_Shape posed(const TopoDS_Shape& shape) {
  return BRepBuilderAPI_Transform(shape, shapes::some_pose(), true).Shape();
}

TopoDS_Shape splines(const TopoDS_Shape& shape) {
  return BRepBuilderAPI_NurbsConvert(shape, true).Shape();
}

// A rectangle in the plane through `at` with this normal and x direction, of half sizes a and b.
TopoDS_Shape sheet(const gp_Pnt& at, const gp_Dir& normal, const gp_Dir& x, double a, double b) {
  return BRepBuilderAPI_MakeFace(gp_Pln(gp_Ax3(at, normal, x)), -a, a, -b, b).Shape();
}

TEST(SelfIntersections, SoundSolidsAreProvenSound) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(2, 3, 4).Shape();
  const TopoDS_Shape drilled =
      BRepAlgoAPI_Fuse(
          box, BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(1, 1.5, 3), gp::DZ()), 0.7, 3).Shape())
          .Shape();
  int number = 0;
  for (const TopoDS_Shape& shape : std::vector<TopoDS_Shape>{
           box, posed(box), splines(box), shapes::cylinder(), splines(shapes::cylinder()),
           shapes::bicubic_cube(), shapes::barrel(true), shapes::barrel(false), shapes::dome(),
           shapes::holed_cube(), drilled, posed(drilled)}) {
    const CrossingsAccount account = crossings_of(shape);
    EXPECT_EQ(account.crossing, 0) << "shape " << number;
    EXPECT_EQ(account.undecided, 0) << "shape " << number;
    EXPECT_EQ(account.faces_free, account.faces) << "shape " << number;
    ++number;
  }
  const CrossingsAccount account = crossings_of(box);
  EXPECT_EQ(account.apart, 3);
  EXPECT_EQ(account.neighbours, 12);
}

TEST(SelfIntersections, CrossingSheetsAreFoundOnTheirLine) {
  const TopoDS_Shape flat = sheet(gp_Pnt(0, 0, 0), gp::DZ(), gp::DX(), 1, 1);
  for (double tilt : {0.02, 0.3, 1.2}) {
    const TopoDS_Shape other =
        sheet(gp_Pnt(0.25, 0, 0), gp_Dir(std::sin(tilt), 0, std::cos(tilt)), gp::DY(), 0.5, 0.5);
    const CrossingsAccount account = crossings_of(shapes::together({flat, other}));
    ASSERT_EQ(account.found.size(), 1u) << tilt;
    const Crossing& found = account.found.front();
    EXPECT_NEAR(found.at.x(), 0.25, 1e-8);  // the line x = 0.25, z = 0
    EXPECT_NEAR(found.at.z(), 0.0, 1e-9);
    EXPECT_LT(std::abs(found.at.y()), 0.5);
    EXPECT_GT(found.depth, found.limit);
    EXPECT_LT(found.depth, 0.5 * std::sin(tilt));
    EXPECT_TRUE(found.one_body);
  }
}

// On both surfaces: the sphere of radius 1 about (0.4, 0.3, 2) and the plane z = 2.8 of the box.
TEST(SelfIntersections, ASphereThroughABoxMeetsItInCircles) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(gp_Pnt(-3, -3, -3), gp_Pnt(3, 3, 2.8)).Shape();
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(gp_Pnt(0.4, 0.3, 2), 1.0).Shape();
  for (bool spline : {false, true}) {
    const TopoDS_Shape both = shapes::together({box, ball});
    const CrossingsAccount account = crossings_of(spline ? splines(both) : both);
    ASSERT_EQ(account.found.size(), 1u);
    EXPECT_EQ(account.undecided, 0);
    const Vec3 at = account.found.front().at;
    EXPECT_NEAR(at.z(), 2.8, 1e-9);
    EXPECT_NEAR(std::hypot(at.x() - 0.4, at.y() - 0.3), 0.6, 1e-9);
    EXPECT_FALSE(account.found.front().one_body);
  }
}

TEST(SelfIntersections, HolesAreNoFaces) {
  // A pin through the hole of a plate, with a gap all round.
  const TopoDS_Shape pin =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0.5, 0.5, -1), gp::DZ()), 0.05, 4).Shape();
  const CrossingsAccount clear = crossings_of(shapes::together({shapes::holed_cube(), pin}));
  EXPECT_EQ(clear.crossing, 0);
  EXPECT_EQ(clear.undecided, 0);
}

TEST(SelfIntersections, NearMissesAreApart) {
  const TopoDS_Shape flat = sheet(gp_Pnt(0, 0, 0), gp::DZ(), gp::DX(), 1, 1);
  for (double gap : {1e-2, 1e-4, 1e-6}) {
    const TopoDS_Shape above = sheet(gp_Pnt(0.3, 0.2, gap), gp::DZ(), gp::DX(), 1, 1);
    EXPECT_EQ(crossings_of(posed(shapes::together({flat, above}))).apart, 1) << gap;
    const TopoDS_Shape wall = sheet(gp_Pnt(0.3, 0.2, 1 + gap), gp::DX(), gp::DZ(), 1, 0.5);
    EXPECT_EQ(crossings_of(posed(shapes::together({flat, wall}))).apart, 1) << gap;
  }
  const TopoDS_Shape inner = BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, 0), 0.99).Shape();
  const TopoDS_Shape outer = BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, 0), 1.0).Shape();
  EXPECT_EQ(crossings_of(splines(shapes::together({inner, outer}))).apart, 1);
}

TEST(SelfIntersections, TouchesAreNeverCalledCrossings) {
  const TopoDS_Shape flat = sheet(gp_Pnt(0, 0, 0), gp::DZ(), gp::DX(), 2, 2);
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(gp_Pnt(0.1, 0.2, 1), 1.0).Shape();
  const TopoDS_Shape lying =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(-1, 0.1, 0.5), gp::DX()), 0.5, 2).Shape();
  const TopoDS_Shape standing = sheet(gp_Pnt(0.3, 0.2, 1), gp::DX(), gp::DZ(), 1, 0.5);
  const TopoDS_Shape again = sheet(gp_Pnt(0.5, 0, 0), gp::DZ(), gp::DY(), 1, 1);
  const TopoDS_Shape dented = BRepPrimAPI_MakeSphere(gp_Pnt(0.1, 0.2, 1 - 1e-9), 1.0).Shape();
  for (const TopoDS_Shape& other : {ball, lying, standing, again, dented}) {
    const CrossingsAccount account = crossings_of(shapes::together({flat, posed(ball), other}));
    for (const Crossing& found : account.found) EXPECT_NE(found.face_a, 0) << found.at.transpose();
    EXPECT_GE(account.undecided, 1);
  }
}

// The cubic with poles (-1, 0), (a, 3), (-a, 3), (1, 0), carried along y. With s = t - 1/2 it has
// x = 2 s (3/4 + s^2 - 3 a (1/4 - s^2)) and z = 9 (1/4 - s^2).
TopoDS_Shape ribbon(double a, bool weighted) {
  std::vector<Vec3> poles;
  std::vector<double> weights;
  for (const Vec3& p : {Vec3(-1, 0, 0), Vec3(a, 0, 3), Vec3(-a, 0, 3), Vec3(1, 0, 0)}) {
    for (int j = 0; j < 2; ++j) {
      poles.push_back(p + 2.0 * j * Vec3(0, 1, 0));
      // Weights that differ along y only change parameters, not the surface.
      if (weighted) weights.push_back(1.0 + 0.5 * j);
    }
  }
  const Surface surface(KnotVector(3, {0, 0, 0, 0, 1, 1, 1, 1}), KnotVector(1, {0, 0, 1, 1}), poles,
                        weights);
  return BRepBuilderAPI_MakeFace(to_occt(surface), 1e-7).Shape();
}

TEST(SelfIntersections, AFoldedFaceMeetsItselfWhereItsCurveDoes) {
  for (bool weights : {false, true}) {
    const CrossingsAccount account = crossings_of(ribbon(3.0, weights));
    ASSERT_EQ(account.faces_crossing, 1);
    const Crossing& found = account.found.front();
    EXPECT_EQ(found.face_a, found.face_b);
    EXPECT_NEAR(found.at.x(), 0.0, 1e-9);
    EXPECT_NEAR(found.at.z(), 0.9, 1e-8);  // s^2 = 0.15
    EXPECT_GT(found.depth, found.limit);
    // x rises all the way; then one that turns back without meeting itself: x = 0 at s = 0 alone.
    EXPECT_EQ(crossings_of(ribbon(0.5, weights)).faces_free, 1);
    EXPECT_EQ(crossings_of(ribbon(-2.0, weights)).faces_free, 1);
  }
}

TEST(SelfIntersections, TwoBoxesOverEachOther) {
  const TopoDS_Shape a = BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), gp_Pnt(2, 2, 2)).Shape();
  const TopoDS_Shape b = BRepPrimAPI_MakeBox(gp_Pnt(1, 1, 1), gp_Pnt(3, 3, 3)).Shape();
  const CrossingsAccount account = crossings_of(shapes::together({a, b}));
  EXPECT_EQ(account.crossing, 6);  // three faces of each, each with two of the other
  EXPECT_EQ(account.undecided, 0);
  for (const Crossing& found : account.found) {
    int at_two = 0, at_one = 0;
    for (double x : {found.at.x(), found.at.y(), found.at.z()}) {
      at_two += std::abs(x - 2) < 1e-9 ? 1 : 0;
      at_one += std::abs(x - 1) < 1e-9 ? 1 : 0;
    }
    EXPECT_EQ(at_two, 1);
    EXPECT_EQ(at_one, 1);
    EXPECT_FALSE(found.one_body);
  }
}

TEST(SelfIntersections, GoesThroughTheBridge) {
  SolidModel model;
  model.crossings = CrossingsAccount{};
  model.crossings->pairs = 15;
  model.crossings->found.push_back({3, 7, Vec3(1, 2, 3), 0.5, 1e-6, false});
  model.crossings->undecided_pairs.emplace_back(1, 2);
  const SolidModel after = from_bytes<SolidModel>(to_bytes(model));
  ASSERT_TRUE(after.crossings.has_value());
  EXPECT_EQ(after.crossings->pairs, 15);
  EXPECT_EQ(after.crossings->found.at(0).at, Vec3(1, 2, 3));
  EXPECT_FALSE(after.crossings->found.at(0).one_body);
  EXPECT_EQ(after.crossings->undecided_pairs.at(0).second, 2);
}

}  // namespace
}  // namespace isochor::internal
