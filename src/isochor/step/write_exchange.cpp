#include <BRepTools.hxx>
#include <IGESCAFControl_Writer.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESData_IGESModel.hxx>
#include <IGESData_IGESWriter.hxx>
#include <IGESData_Protocol.hxx>
#include <IGESSelect_WorkLibrary.hxx>
#include <Interface_Static.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_StepWriter.hxx>
#include <TopExp_Explorer.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_WorkSession.hxx>
#include <fstream>

#include "isochor/base/error.h"
#include "isochor/step/exchange.h"
#include "isochor/step/written_torus.h"

namespace isochor::internal {
namespace {

// 17 significant digits: reading gives the same double.
constexpr const char* kAllDigits = "%.16E";

template <typename Writer>
void print(Writer& writer, const std::string& path) {
  std::ofstream out(path, std::ios::binary);
  if (!out) throw InputError(path, "", "cannot be opened for writing");
  const bool printed = writer.Print(out);
  out.close();
  if (!printed || !out) throw InputError(path, "", "cannot be written (disk full?)");
}

void write_step(Document& document, const std::string& path, const WriteSettings& settings) {
  STEPCAFControl_Controller::Init();
  // The unit and the schema are read when the writer makes its model, so they are set before; some
  // parameters of names exist only after it, so the unit is set twice.
  work_in(document.unit, document.xde);
  Interface_Static::SetCVal("write.step.schema", "AP242DIS");
  Interface_Static::SetIVal("write.surfacecurve.mode", settings.parameter_curves ? 1 : 0);
  STEPCAFControl_Writer writer;
  work_in(document.unit, document.xde);
  writer.SetColorMode(true);
  writer.SetNameMode(true);
  writer.SetLayerMode(true);
  writer.SetDimTolMode(true);
  writer.SetMaterialMode(true);
  writer.SetPropsMode(settings.stated_measures);
  if (!writer.Transfer(document.xde, STEPControl_AsIs)) {
    throw InputError(path, "", "the shape cannot be written as STEP");
  }
  const auto session = writer.ChangeWriter().WS();
  for (const auto& [face, surface] : settings.surfaces) {
    restore_numbers(session, document.face(face), surface);
  }
  restore_tori(session, document);
  const auto model = Handle(StepData_StepModel)::DownCast(session->Model());
  // The writer's own printing rounds to 12 digits, so print here.
  StepData_StepWriter printer(model);
  printer.FloatWriter().SetFormat(kAllDigits, Standard_True);
  printer.SendModel(Handle(StepData_Protocol)::DownCast(session->Protocol()));
  print(printer, path);
}

void write_iges(Document& document, const std::string& path) {
  IGESControl_Controller::Init();
  // Only the B-rep form says which faces share an edge; many writers put closed shells without a
  // solid into IGES. The other form would tear them into loose faces.
  const bool shells = TopExp_Explorer(document.shape, TopAbs_SHELL).More();
  Interface_Static::SetIVal("write.iges.brep.mode", shells ? 1 : 0);
  work_in(document.unit, document.xde);
  IGESCAFControl_Writer writer;
  writer.SetColorMode(true);
  writer.SetNameMode(true);
  writer.SetLayerMode(true);
  if (!writer.Transfer(document.xde)) {
    throw InputError(path, "", "the shape cannot be written as IGES");
  }
  writer.ComputeModel();
  IGESData_IGESWriter printer(writer.Model());
  printer.FloatWriter().SetFormat(kAllDigits, Standard_True);
  printer.SendModel(IGESSelect_WorkLibrary::DefineProtocol());
  print(printer, path);
}

void write_brep(const Document& document, const std::string& path) {
  if (!BRepTools::Write(document.shape, path.c_str())) {
    throw InputError(path, "", "cannot be written");
  }
}

}  // namespace

void require_xde(Document& document) {
  if (!document.xde.IsNull()) return;
  document.xde = new_xde();
  XCAFDoc_DocumentTool::ShapeTool(document.xde->Main())->AddShape(document.shape, Standard_False);
}

void write_document(Document& document, const std::string& path, const WriteSettings& settings) {
  switch (format_of(path)) {
    case FileFormat::kStep:
      require_xde(document);
      write_step(document, path, settings);
      break;
    case FileFormat::kIges:
      require_xde(document);
      write_iges(document, path);
      break;
    case FileFormat::kBrep:
      write_brep(document, path);
      break;
  }
}

}  // namespace isochor::internal
