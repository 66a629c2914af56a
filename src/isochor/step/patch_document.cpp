#include "isochor/step/patch_document.h"

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>

#include "isochor/base/error.h"
#include "isochor/step/exchange.h"
#include "isochor/step/occt_surface.h"

namespace isochor::internal {
namespace {

// Sides that should meet differ by rounding only; larger gaps stay open and are reported as free
// edges. Relative to the diagonal.
constexpr double kSewing = 1e-9;

TopoDS_Face face_of(const PatchModel& model, int q, const std::string& name, double tolerance) {
  const Patch& patch = model.patches[static_cast<size_t>(q)];
  const BRepBuilderAPI_MakeFace maker(to_occt(model.surface(q)), tolerance);
  if (!maker.IsDone()) {
    throw InputError(name, patch.handle.empty() ? patch.name : patch.handle,
                     "cannot be made a face (fault " + std::to_string(maker.Error()) + ")");
  }
  TopoDS_Face face = maker.Face();
  if (patch.reversed) face.Reverse();
  return face;
}

TopoDS_Shape solid_of(const TopoDS_Shell& shell) {
  TopoDS_Solid solid = BRepBuilderAPI_MakeSolid(shell);
  BRepLib::OrientClosedSolid(solid);
  return solid;
}

// Closed shells become solids; everything else stays as it is.
TopoDS_Shape with_solids(const TopoDS_Shape& sewn) {
  std::vector<TopoDS_Shape> parts;
  for (TopExp_Explorer it(sewn, TopAbs_SHELL); it.More(); it.Next()) {
    const auto& shell = TopoDS::Shell(it.Current());
    parts.push_back(BRep_Tool::IsClosed(shell) ? solid_of(shell) : TopoDS_Shape(shell));
  }
  // Sewing leaves a face that meets nothing but itself without a shell: a torus, a sphere.
  for (TopExp_Explorer it(sewn, TopAbs_FACE, TopAbs_SHELL); it.More(); it.Next()) {
    TopoDS_Shell shell;
    BRep_Builder builder;
    builder.MakeShell(shell);
    builder.Add(shell, it.Current());
    const bool closed = BRep_Tool::IsClosed(shell);
    shell.Closed(closed);
    parts.push_back(closed ? solid_of(shell) : it.Current());
  }
  if (parts.size() == 1) return parts.front();
  TopoDS_Compound compound;
  BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const auto& part : parts) builder.Add(compound, part);
  return compound;
}

}  // namespace

Document patch_document(const PatchModel& model, const std::string& name) {
  Document document;
  document.path = name;
  document.unit = unit_of_name(model.unit);
  if (!document.unit.stated) {
    throw InputError(name, "unit", "'" + model.unit + "' is no length unit of CAD formats");
  }
  if (model.patches.empty()) throw InputError(name, "", "has no patch");
  const double tolerance = kSewing * diagonal(model);
  if (!(tolerance > 0.0)) throw InputError(name, "points", "all coincide");
  BRepBuilderAPI_Sewing sewing(tolerance);
  std::vector<TopoDS_Face> faces;
  for (size_t q = 0; q < model.patches.size(); ++q) {
    faces.push_back(face_of(model, static_cast<int>(q), name, tolerance));
    sewing.Add(faces.back());
  }
  sewing.Perform();
  document.xde = new_xde();
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document.xde->Main());
  const TDF_Label part = shapes->AddShape(with_solids(sewing.SewedShape()), Standard_False);
  for (size_t q = 0; q < faces.size(); ++q) {
    const std::string& patch_name = model.patches[q].name;
    if (patch_name.empty()) continue;
    const TopoDS_Shape sewn = sewing.IsModified(faces[q]) ? sewing.Modified(faces[q]) : faces[q];
    const TDF_Label label = shapes->AddSubShape(part, sewn);
    if (label.IsNull()) continue;  // sewing may drop a face without area
    TDataStd_Name::Set(label, TCollection_ExtendedString(patch_name.c_str(), Standard_True));
  }
  index_document(document);
  return document;
}

}  // namespace isochor::internal
