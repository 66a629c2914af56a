#include "step/shapes.h"

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepLib.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Quantity_Color.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Shell.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Pln.hxx>

#include "isochor/step/exchange.h"

namespace isochor::shapes {
namespace {

constexpr int kDegree = 3;
constexpr double kPi = 3.14159265358979323846;

// Knots and multiplicities over [0,1] for n poles.
struct Knots {
  TColStd_Array1OfReal values;
  TColStd_Array1OfInteger multiplicities;
  Knots(int n, bool periodic)
      : values(1, periodic ? n + 1 : n - kDegree + 1),
        multiplicities(1, periodic ? n + 1 : n - kDegree + 1) {
    const int last = values.Length();
    for (int k = 1; k <= last; ++k) {
      values(k) = static_cast<double>(k - 1) / (last - 1);
      multiplicities(k) = 1;
    }
    if (!periodic) multiplicities(1) = multiplicities(last) = kDegree + 1;
  }
};

// Greville abscissa of pole i (from 0) of n clamped poles on [0,1].
double greville(int i, int n) {
  const int spans = n - kDegree;
  double sum = 0.0;
  for (int k = 1; k <= kDegree; ++k) {
    sum += std::clamp(static_cast<double>(i + k - kDegree) / spans, 0.0, 1.0);
  }
  return sum / kDegree;
}

Handle(Geom_BSplineSurface) surface(const TColgp_Array2OfPnt& poles, bool u_periodic) {
  const Knots u(poles.ColLength(), u_periodic), v(poles.RowLength(), false);
  return new Geom_BSplineSurface(poles, u.values, v.values, u.multiplicities, v.multiplicities,
                                 kDegree, kDegree, u_periodic);
}

// One face of the cube: `axis` is constant at 0 or 1; outward.
Handle(Geom_BSplineSurface) cube_face(int axis, bool high, double size, int n) {
  TColgp_Array2OfPnt poles(1, n, 1, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double a = greville(i, n), b = greville(j, n);
      const double bulge = 0.3 * a * (1 - a) * b * (1 - b) * (1.0 + 0.1 * std::sin(i + 2.0 * j));
      double p[3];
      p[axis] = high ? 1.0 + bulge : -bulge;
      p[(axis + 1) % 3] = high ? a : b;
      p[(axis + 2) % 3] = high ? b : a;
      poles(i + 1, j + 1) = gp_Pnt(size * p[0], size * p[1], size * p[2]);
    }
  }
  return surface(poles, false);
}

TopoDS_Solid solid_of(const std::vector<TopoDS_Face>& faces) {
  BRepBuilderAPI_Sewing sewing(1e-7);
  for (const auto& face : faces) sewing.Add(face);
  sewing.Perform();
  TopoDS_Shape sewn = sewing.SewedShape();
  TopExp_Explorer shell(sewn, TopAbs_SHELL);
  TopoDS_Solid solid = BRepBuilderAPI_MakeSolid(TopoDS::Shell(shell.Current()));
  BRepLib::OrientClosedSolid(solid);
  return solid;
}

TopoDS_Face cap(const TopoDS_Face& side, double z, bool up) {
  for (TopExp_Explorer it(side, TopAbs_EDGE); it.More(); it.Next()) {
    const auto edge = TopoDS::Edge(it.Current());
    if (BRep_Tool::Degenerated(edge) || BRep_Tool::IsClosed(edge, side)) continue;
    double first = 0.0, last = 0.0;
    const auto curve = BRep_Tool::Curve(edge, first, last);
    if (std::abs(curve->Value(first).Z() - z) > 1e-9) continue;
    const gp_Pln plane(gp_Pnt(0, 0, z), gp_Dir(0, 0, up ? 1 : -1));
    return BRepBuilderAPI_MakeFace(plane, BRepBuilderAPI_MakeWire(edge).Wire());
  }
  throw std::logic_error("no such edge");
}

}  // namespace

TopoDS_Solid bicubic_cube(double size, int n) {
  std::vector<TopoDS_Face> faces;
  for (int axis = 0; axis < 3; ++axis) {
    for (bool high : {false, true}) {
      faces.push_back(BRepBuilderAPI_MakeFace(cube_face(axis, high, size, n), 1e-9));
    }
  }
  return solid_of(faces);
}

TopoDS_Solid barrel(bool periodic) {
  constexpr int kAround = 10, kUp = 6;
  TColgp_Array2OfPnt poles(1, kAround, 1, kUp);
  for (int i = 0; i < kAround; ++i) {
    for (int j = 0; j < kUp; ++j) {
      const double angle = 2 * kPi * i / kAround, z = greville(j, kUp);
      const double radius = 1.0 + 0.3 * z * (1 - z);
      poles(i + 1, j + 1) = gp_Pnt(radius * std::cos(angle), radius * std::sin(angle), 2 * z);
    }
  }
  auto side = surface(poles, true);
  if (!periodic) side->SetUNotPeriodic();
  const TopoDS_Face face = BRepBuilderAPI_MakeFace(side, 1e-9);
  return solid_of({face, cap(face, 0.0, false), cap(face, 2.0, true)});
}

TopoDS_Solid dome() {
  constexpr int kAround = 8, kUp = 6;
  TColgp_Array2OfPnt poles(1, kAround, 1, kUp);
  for (int i = 0; i < kAround; ++i) {
    for (int j = 0; j < kUp; ++j) {
      const double angle = 2 * kPi * i / kAround, t = static_cast<double>(j) / (kUp - 1);
      const double radius = std::sqrt(std::max(0.0, 1 - t)), z = t;
      poles(i + 1, j + 1) = gp_Pnt(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
  auto skin = surface(poles, true);
  skin->SetUNotPeriodic();
  const TopoDS_Face face = BRepBuilderAPI_MakeFace(skin, 1e-9);
  return solid_of({face, cap(face, 0.0, false)});
}

TopoDS_Shape holed_cube() {
  const gp_Ax2 axis(gp_Pnt(0.5, 0.5, -1.0), gp_Dir(0, 0, 1));
  return BRepAlgoAPI_Cut(bicubic_cube(1.0, 12), BRepPrimAPI_MakeCylinder(axis, 0.11, 3.0).Solid())
      .Shape();
}

TopoDS_Shape holed_plate() {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(gp_Pnt(-2, -3, -1), 4, 6, 2).Shape();
  const TopoDS_Shape hole =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0.3, 0.4, -5), gp::DZ()), 0.7, 10).Shape();
  return BRepAlgoAPI_Cut(box, hole).Shape();
}

TopoDS_Shape together(const std::vector<TopoDS_Shape>& parts) {
  BRep_Builder builder;
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  for (const TopoDS_Shape& part : parts) builder.Add(compound, part);
  return compound;
}

TopoDS_Solid cylinder(double radius, double height) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0.1, 0.2, 0.3), gp_Dir(1, 2, 3)), radius, height)
      .Solid();
}

TopoDS_Solid lens() {
  constexpr double kHole = 0.7, kTube = 2.1, kLow = 0.2, kHigh = 1.1;
  const gp_Ax3 axes(gp_Pnt(0.1, 0.2, 0.3), gp_Dir(0, 0, 1), gp_Dir(1, 2, 0));
  const Handle(Geom_Surface) torus = new Geom_ToroidalSurface(axes, kHole, kTube);
  const TopoDS_Face side = BRepBuilderAPI_MakeFace(torus, 0.0, 2 * kPi, kLow, kHigh, 1e-9);
  const double low = 0.3 + kTube * std::sin(kLow), high = 0.3 + kTube * std::sin(kHigh);
  return solid_of({side, cap(side, low, false), cap(side, high, true)});
}

gp_Trsf some_pose() {
  gp_Trsf pose;
  pose.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, -2, 0.5)), 1.1);
  pose.SetTranslationPart(gp_Vec(30, -20, 10));
  return pose;
}

Vec3 posed(const gp_Trsf& pose, const Vec3& at, bool vector) {
  gp_XYZ p(at.x(), at.y(), at.z());
  if (vector) {
    p.Multiply(pose.VectorialPart());
  } else {
    pose.Transforms(p);
  }
  return {p.X(), p.Y(), p.Z()};
}

internal::Document document_of(const TopoDS_Shape& shape, const std::string& unit) {
  internal::Document document;
  document.unit = internal::unit_of_name(unit);
  document.shape = shape;
  internal::require_xde(document);
  internal::index_document(document);
  return document;
}

internal::Document assembly(const std::string& unit) {
  internal::Document document;
  document.unit = internal::unit_of_name(unit);
  document.xde = internal::new_xde();
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document.xde->Main());
  const auto colours = XCAFDoc_DocumentTool::ColorTool(document.xde->Main());
  const auto box = bicubic_cube();
  const TDF_Label box_label = shapes->AddShape(box, Standard_False);
  TDataStd_Name::Set(box_label, "box");
  TopExp_Explorer face(box, TopAbs_FACE);
  const TDF_Label lid = shapes->AddSubShape(box_label, face.Current());
  TDataStd_Name::Set(lid, "lid");
  colours->SetColor(lid, Quantity_Color(Quantity_NOC_RED), XCAFDoc_ColorSurf);
  const TDF_Label pin = shapes->AddShape(cylinder(), Standard_False);
  TDataStd_Name::Set(pin, "pin");
  colours->SetColor(pin, Quantity_Color(Quantity_NOC_BLUE), XCAFDoc_ColorGen);
  const TDF_Label pair = shapes->NewShape();
  TDataStd_Name::Set(pair, "pair");
  shapes->AddComponent(pair, box_label, TopLoc_Location());
  gp_Trsf move, turn;
  move.SetTranslation(gp_Vec(5.25, 0, 0));
  turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), 0.3);
  shapes->AddComponent(pair, pin, TopLoc_Location(move));
  shapes->AddComponent(pair, pin, TopLoc_Location(move * turn));
  shapes->UpdateAssemblies();
  internal::index_document(document);
  return document;
}

internal::Document placed(const TopoDS_Shape& part, const std::vector<gp_Trsf>& places) {
  internal::Document document;
  document.unit = internal::unit_of_name("mm");
  document.xde = internal::new_xde();
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document.xde->Main());
  const TDF_Label bar = shapes->AddShape(part, Standard_False);
  TDataStd_Name::Set(bar, "bar");
  const TDF_Label rack = shapes->NewShape();
  TDataStd_Name::Set(rack, "rack");
  for (const gp_Trsf& place : places) shapes->AddComponent(rack, bar, TopLoc_Location(place));
  shapes->UpdateAssemblies();
  internal::index_document(document);
  return document;
}

}  // namespace isochor::shapes
