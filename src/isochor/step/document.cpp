#include "isochor/step/document.h"

#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <TDF_ChildIterator.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

#include "isochor/base/error.h"
#include "isochor/step/exchange.h"
#include "isochor/step/import_faces.h"
#include "isochor/step/sewing.h"

namespace isochor::internal {
namespace {

std::string extension(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

void require_readable(const std::string& path) {
  std::error_code fault;
  const auto status = std::filesystem::status(path, fault);
  if (!std::filesystem::exists(status)) throw InputError(path, "", "no such file");
  if (std::filesystem::is_directory(status)) throw InputError(path, "", "is a folder, not a file");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path, "", "cannot be opened for reading");
  if (in.peek() == std::ifstream::traits_type::eof()) throw InputError(path, "", "is empty");
}

void read_brep(Document& document) {
  BRep_Builder builder;
  // Errors of format are reported by exceptions of many kinds, or not at all.
  if (!BRepTools::Read(document.shape, document.path.c_str(), builder) || document.shape.IsNull()) {
    throw InputError(document.path, "", "is not a readable BREP file");
  }
}

void collect_names(Document& document, const TDF_Label& label) {
  TopoDS_Shape shape;
  if (XCAFDoc_ShapeTool::GetShape(label, shape) && !shape.IsNull() &&
      !XCAFDoc_ShapeTool::IsReference(label)) {
    const std::string name = label_name(label);
    if (!name.empty()) document.names.emplace(shape.TShape().get(), name);
  }
  for (TDF_ChildIterator it(label); it.More(); it.Next()) collect_names(document, it.Value());
}

// The structure of an assembly keeps its own names; here a shape is found in the free shapes.
TopoDS_Shape free_shape(const Document& document) {
  TDF_LabelSequence labels;
  XCAFDoc_DocumentTool::ShapeTool(document.xde->Main())->GetFreeShapes(labels);
  std::vector<TopoDS_Shape> shapes;
  for (TDF_LabelSequence::Iterator it(labels); it.More(); it.Next()) {
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(it.Value());
    if (!shape.IsNull()) shapes.push_back(shape);
  }
  if (shapes.empty()) return {};
  if (shapes.size() == 1) return shapes.front();
  TopoDS_Compound compound;
  BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const auto& shape : shapes) builder.Add(compound, shape);
  return compound;
}

}  // namespace

const char* name_of(FileFormat format) {
  switch (format) {
    case FileFormat::kStep:
      return "STEP";
    case FileFormat::kIges:
      return "IGES";
    case FileFormat::kBrep:
      return "BREP";
  }
  return "unknown";
}

FileFormat format_of(const std::string& path) {
  const std::string ending = extension(path);
  if (ending == ".step" || ending == ".stp" || ending == ".p21") return FileFormat::kStep;
  if (ending == ".igs" || ending == ".iges") return FileFormat::kIges;
  if (ending == ".brep" || ending == ".brp") return FileFormat::kBrep;
  throw InputError(path, "",
                   "the ending '" + ending +
                       "' names no CAD format; use .step, .stp, .p21, .igs, .iges, .brep or .brp");
}

TopoDS_Face Document::face(int k) const {
  ISOCHOR_REQUIRE(k >= 0 && k < faces.Extent(), k, faces.Extent());
  return TopoDS::Face(faces(k + 1));
}

std::string Document::name_of(const TopoDS_Shape& of) const {
  const auto found = names.find(of.TShape().get());
  return found == names.end() ? "" : found->second;
}

std::string label_name(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return "";
  const TCollection_ExtendedString& wide = name->Get();
  std::string text(static_cast<size_t>(wide.LengthOfCString()), '\0');
  Standard_PCharacter at = text.data();
  wide.ToUTF8CString(at);
  return text;
}

PartNames part_names(const Document& document) {
  PartNames names;
  if (document.xde.IsNull()) return names;
  TDF_LabelSequence labels;
  XCAFDoc_DocumentTool::ShapeTool(document.xde->Main())->GetShapes(labels);
  for (TDF_LabelSequence::Iterator it(labels); it.More(); it.Next()) {
    const std::string name = label_name(it.Value());
    if (name.empty() || !XCAFDoc_ShapeTool::IsSimpleShape(it.Value())) continue;
    if (XCAFDoc_ShapeTool::IsSubShape(it.Value())) continue;
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(XCAFDoc_ShapeTool::GetShape(it.Value()), TopAbs_FACE, faces);
    for (int k = 1; k <= faces.Extent(); ++k) names.emplace(faces(k).TShape().get(), name);
  }
  return names;
}

std::string used_part(const TopoDS_Face& face, int places, const PartNames& names) {
  const auto name = names.find(face.TShape().get());
  return (name == names.end() ? "a part that" : "the part '" + name->second + "', which") +
         " is used " + std::to_string(places) + " times; an edit would change all of them";
}

void index_document(Document& document) {
  if (!document.xde.IsNull()) {
    document.shape = free_shape(document);
    document.names.clear();
    collect_names(document, XCAFDoc_DocumentTool::ShapesLabel(document.xde->Main()));
  }
  document.faces.Clear();
  if (!document.shape.IsNull()) TopExp::MapShapes(document.shape, TopAbs_FACE, document.faces);
}

Document load_document(const std::string& path) {
  Document document;
  document.path = path;
  document.format = format_of(path);
  require_readable(path);
  switch (document.format) {
    case FileFormat::kStep:
      read_step(document);
      break;
    case FileFormat::kIges:
      read_iges(document);
      break;
    case FileFormat::kBrep:
      read_brep(document);
      break;
  }
  index_document(document);
  if (document.shape.IsNull()) throw InputError(path, "", "has no shape");
  if (document.faces.IsEmpty()) throw InputError(path, "", "has no face");
  account_for_import(document);
  sew(document);
  return document;
}

}  // namespace isochor::internal
