#include <IGESCAFControl_Reader.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Check.hxx>
#include <Interface_CheckIterator.hxx>
#include <Interface_Static.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPControl_Reader.hxx>
#include <StepData_StepModel.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDocStd_Application.hxx>
#include <Transfer_TransientProcess.hxx>
#include <UnitsMethods.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <algorithm>
#include <map>

#include "isochor/base/error.h"
#include "isochor/step/exchange.h"
#include "isochor/step/occt_progress.h"
#include "isochor/step/part21.h"
#include "isochor/step/step_loader.h"
#include "isochor/step/step_unit.h"

namespace isochor::internal {
namespace {

// Messages of one kind that are listed before the rest are counted.
constexpr size_t kListedNotices = 20;

// The share of parsing in the time of reading, roughly.
constexpr double kParsed = 0.25;

// The name in FILE_SCHEMA(('...')).
std::string schema_of(const std::string& text) {
  const size_t key = text.find("FILE_SCHEMA");
  if (key == std::string::npos) return "";
  const size_t open = text.find('\'', key);
  const size_t close = open == std::string::npos ? open : text.find('\'', open + 1);
  if (close == std::string::npos || close - open > 300) return "";
  return text.substr(open + 1, close - open - 1);
}

IFSelect_ReturnStatus parse_step(Document& document, STEPControl_Reader& reader) {
  constexpr const char* kMagic = "ISO-10303-21";
  std::string text = file_bytes(document.path);
  const size_t start = text.find(kMagic);
  if (start == std::string::npos) {
    throw InputError(document.path, "", "is not a STEP file: 'ISO-10303-21' is missing");
  }
  document.schema = schema_of(text);
  // A byte order mark is too common to mention; anything else may be a sign of damage.
  if (start > 0 && text.compare(0, start, "\xEF\xBB\xBF") != 0) {
    document.account.junk_bytes = static_cast<int>(start);
    document.notices.push_back("skipped " + std::to_string(start) + " bytes before 'ISO-10303-21'");
  }
  return load_step(reader, document.path, std::move(text), start);
}

LengthUnit iges_unit(const IGESData_IGESModel& model) {
  const double millimetres = UnitsMethods::GetLengthFactorValue(model.GlobalSection().UnitFlag());
  if (model.GlobalSection().UnitFlag() == 3) {  // "see the name"
    const auto name = model.GlobalSection().UnitName();
    return name.IsNull() ? LengthUnit() : unit_of_name(name->ToCString());
  }
  return millimetres > 0.0 ? unit_of_millimetres(millimetres) : LengthUnit();
}

// From entities to shapes, with progress.
template <typename Reader>
bool transfer(Reader& reader, Document& document) {
  const ProgressPart part(kParsed, 1.0);
  const Handle(OcctProgress) progress = new OcctProgress("making shapes");
  return reader.Transfer(document.xde, progress->Start());
}

void collect(const Interface_CheckIterator& checks, bool fails,
             std::map<std::string, int>& counts) {
  for (Interface_CheckIterator it = checks; it.More(); it.Next()) {
    const Handle(Interface_Check) check = it.Value();
    const int count = fails ? check->NbFails() : check->NbWarnings();
    for (int k = 1; k <= count; ++k) {
      ++counts[fails ? check->CFail(k) : check->CWarning(k)];
    }
  }
}

void note(const std::map<std::string, int>& counts, const std::string& what,
          std::vector<std::string>& notices) {
  size_t listed = 0;
  for (const auto& [text, count] : counts) {
    if (++listed > kListedNotices) {
      notices.push_back(what + ": " + std::to_string(counts.size() - kListedNotices) +
                        " further kinds");
      return;
    }
    notices.push_back(what + ": " + text + (count > 1 ? " (" + std::to_string(count) + "x)" : ""));
  }
}

}  // namespace

Handle(TDocStd_Document) new_xde() {
  // Else every shape without a name is called "SOLID" or so, and that is not in the file.
  XCAFDoc_ShapeTool::SetAutoNaming(Standard_False);
  Handle(TDocStd_Document) xde;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", xde);
  return xde;
}

void work_in(const LengthUnit& unit, const Handle(TDocStd_Document) & xde) {
  // A unit without a name of OpenCASCADE's is known to the document only, as a number.
  const std::string name = unit.occt.empty() ? "MM" : unit.occt;
  Interface_Static::SetCVal("xstep.cascade.unit", name.c_str());
  Interface_Static::SetCVal("write.step.unit", name.c_str());
  Interface_Static::SetCVal("write.iges.unit", name.c_str());
  UnitsMethods::SetCasCadeLengthUnit(unit.millimetres);
  if (!xde.IsNull()) {
    XCAFDoc_DocumentTool::SetLengthUnit(xde, unit.millimetres, UnitsMethods_LengthUnit_Millimeter);
  }
  Interface_Static::SetIVal("read.stepcaf.subshapes.name", 1);
  Interface_Static::SetIVal("write.stepcaf.subshapes.name", 1);
}

void note_checks(Document& document) {
  const Handle(Interface_InterfaceModel) model = document.session->Model();
  int errors = 0;
  for (int k = 1; k <= model->NbEntities(); ++k) errors += model->IsErrorEntity(k) ? 1 : 0;
  if (errors > 0) {
    // One file in eight has such entities and is complete; it may also mean damage.
    document.notices.push_back(
        std::to_string(errors) + " of " + std::to_string(model->NbEntities()) +
        " entities break the rules of the format; see that nothing is missing");
  }
  document.account.error_entities = errors;
  document.account.entities = model->NbEntities();
  const auto checks = document.session->TransferReader()->LastCheckList();
  std::map<std::string, int> fails, warnings;
  collect(checks, true, fails);
  collect(checks, false, warnings);
  document.account.failures.assign(fails.begin(), fails.end());
  document.account.repairs.assign(warnings.begin(), warnings.end());
  note(fails, "could not be read", document.notices);
  note(warnings, "repaired while reading", document.notices);
}

void read_step(Document& document) {
  STEPCAFControl_Reader reader;
  reader.SetColorMode(true);
  reader.SetNameMode(true);
  reader.SetLayerMode(true);
  reader.SetGDTMode(true);
  reader.SetMatMode(true);
  tell_progress(0.0, "reading");
  if (parse_step(document, reader.ChangeReader()) != IFSelect_RetDone) {
    throw InputError(document.path, "", "cannot be parsed as STEP (truncated or damaged?)");
  }
  document.session = reader.ChangeReader().WS();
  const auto model = Handle(StepData_StepModel)::DownCast(document.session->Model());
  document.unit = step_unit(*model, document.notices);
  document.xde = new_xde();
  work_in(document.unit, document.xde);
  const int roots = reader.NbRootsForTransfer();
  if (roots == 0) throw InputError(document.path, "", "has no shape (no root to read)");
  document.account.roots = roots;
  if (roots > 1) document.notices.push_back(std::to_string(roots) + " separate roots");
  if (!transfer(reader, document)) throw InputError(document.path, "", "has no shape");
  note_checks(document);
}

void read_iges(Document& document) {
  IGESCAFControl_Reader reader;
  reader.SetColorMode(true);
  reader.SetNameMode(true);
  reader.SetLayerMode(true);
  tell_progress(0.0, "reading");
  if (reader.ReadFile(document.path.c_str()) != IFSelect_RetDone) {
    throw InputError(document.path, "", "cannot be parsed as IGES (truncated or damaged?)");
  }
  document.session = reader.WS();
  const auto model = Handle(IGESData_IGESModel)::DownCast(document.session->Model());
  document.unit = iges_unit(*model);
  if (!document.unit.stated) document.notices.push_back("names no known length unit; taken as mm");
  document.xde = new_xde();
  work_in(document.unit, document.xde);
  if (reader.NbRootsForTransfer() == 0) {
    throw InputError(document.path, "", "has no shape (no root to read)");
  }
  if (!transfer(reader, document)) throw InputError(document.path, "", "has no shape");
  note_checks(document);
}

}  // namespace isochor::internal
