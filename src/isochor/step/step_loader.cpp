#include "isochor/step/step_loader.h"

#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_StepReaderData.hxx>
#include <StepData_StepReaderTool.hxx>
#include <StepSelect_WorkLibrary.hxx>
#include <XSControl_WorkSession.hxx>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "isochor/step/step_records.h"

namespace isochor::internal {
namespace {

Interface_ParamType type_of(Part21Kind kind) {
  switch (kind) {
    case Part21Kind::kReference:
      return Interface_ParamIdent;
    case Part21Kind::kString:
      return Interface_ParamText;
    case Part21Kind::kBinary:
      return Interface_ParamHexa;
    case Part21Kind::kInteger:
      return Interface_ParamInteger;
    case Part21Kind::kReal:
      return Interface_ParamReal;
    case Part21Kind::kEnumeration:
      return Interface_ParamEnum;
    case Part21Kind::kList:
    case Part21Kind::kTyped:
      return Interface_ParamSub;
    case Part21Kind::kOmitted:
      return Interface_ParamVoid;
    case Part21Kind::kDerived:
      return Interface_ParamMisc;
  }
  return Interface_ParamMisc;
}

// Where the session looks for models: gives it the one of these records, once.
class RecordsLibrary : public StepSelect_WorkLibrary {
 public:
  RecordsLibrary(std::string text, StepRecords records)
      : text_(std::move(text)), records_(std::move(records)) {
    for (std::uint32_t k = 0; k <= records_.lists; ++k)
      list_names_.push_back("$" + std::to_string(k));
    // OpenCASCADE takes words that end with a zero; behind each stands a blank or a sign that has
    // been read.
    for (const StepRecord& record : records_.records) {
      terminate(record.ident);
      terminate(record.type);
    }
    for (const StepArgument& argument : records_.arguments) terminate(argument.text);
  }

  Standard_Integer ReadFile(const Standard_CString /*path*/,
                            Handle(Interface_InterfaceModel) & model,
                            const Handle(Interface_Protocol) & protocol) const override {
    const auto step = Handle(StepData_Protocol)::DownCast(protocol);
    if (step.IsNull()) return 1;
    const Handle(StepData_StepModel) loaded = new StepData_StepModel;
    model = loaded;
    StepData_StepReaderTool tool(reader_data(*loaded), step);
    tool.SetErrorHandle(Standard_True);
    const Handle(StepData_FileRecognizer) by_protocol;
    tool.PrepareHeader(by_protocol);
    tool.Prepare(by_protocol);
    tool.LoadModel(loaded);
    if (loaded->Protocol().IsNull()) loaded->SetProtocol(step);
    tool.Clear();
    return 0;
  }

 private:
  void terminate(const TextSpan& word) {
    if (!word.empty()) text_[word.end] = '\0';
  }

  const char* at(const TextSpan& word) const { return text_.data() + word.begin; }

  Handle(StepData_StepReaderData) reader_data(const StepData_StepModel& model) const {
    const auto count = [](size_t n) { return static_cast<Standard_Integer>(n); };
    const Handle(StepData_StepReaderData) data =
        new StepData_StepReaderData(count(records_.header), count(records_.records.size()),
                                    count(records_.arguments.size()), model.SourceCodePage());
    Standard_Integer number = 0;
    for (const StepRecord& record : records_.records) {
      ++number;
      const char* const ident = record.list > 0        ? list_names_[record.list].c_str()
                                : record.ident.empty() ? "#0"
                                                       : at(record.ident);
      data->SetRecord(number, ident, record.type.empty() ? kList : at(record.type),
                      record.count > 0 ? 1 : 0);
      for (std::uint32_t k = 0; k < record.count; ++k) {
        const StepArgument& argument = records_.arguments[record.first + k];
        data->AddStepParam(number,
                           argument.kind == Part21Kind::kList ? list_names_[argument.list].c_str()
                                                              : at(argument.text),
                           type_of(argument.kind));
      }
      data->InitParams(number);
    }
    return data;
  }

  static constexpr const char* kList = "/* (SUB) */";  // OpenCASCADE's type of a list

  std::string text_;
  StepRecords records_;
  std::vector<std::string> list_names_;
};

}  // namespace

IFSelect_ReturnStatus load_step(STEPControl_Reader& reader, const std::string& path,
                                std::string text, size_t start) {
  std::optional<StepRecords> records = scan_step(text, start);
  if (!records) {
    if (start == 0) return reader.ReadFile(path.c_str());
    std::istringstream in(text.substr(start));
    return reader.ReadStream(path.c_str(), in);
  }
  const auto own = reader.WS()->WorkLibrary();
  reader.WS()->SetLibrary(new RecordsLibrary(std::move(text), *std::move(records)));
  const IFSelect_ReturnStatus status = reader.ReadFile(path.c_str());
  reader.WS()->SetLibrary(own);
  return status;
}

}  // namespace isochor::internal
