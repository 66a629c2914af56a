// A CAD file in memory, with OpenCASCADE's types. Internal to `step`; to be used in a child process
// (see bridge.h), because reading may crash and sets global parameters.
//
// Coordinates are the file's own doubles: OpenCASCADE is told to work in the file's unit.
#pragma once

#include <TDF_Label.hxx>
#include <TDocStd_Document.hxx>
#include <TopTools_DataMapOfShapeShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <XSControl_WorkSession.hxx>
#include <string>
#include <unordered_map>
#include <vector>

#include "isochor/step/import_account.h"
#include "isochor/step/length_unit.h"

namespace isochor::internal {

enum class FileFormat { kStep, kIges, kBrep };
const char* name_of(FileFormat format);  // "STEP", "IGES", "BREP"

// By extension: .step .stp .p21, .igs .iges, .brep .brp, in any case. Throws InputError.
FileFormat format_of(const std::string& path);

struct Document {
  std::string path;
  FileFormat format = FileFormat::kBrep;
  LengthUnit unit;
  std::string schema;                     // of a STEP file, else empty
  Handle(TDocStd_Document) xde;           // names, colours, structure; null for BREP
  Handle(XSControl_WorkSession) session;  // the entities of a STEP or IGES file; else null
  TopoDS_Shape shape;                     // the free shape, or a compound of them in file order
  TopTools_IndexedMapOfShape faces;       // face number k (from 1) is faces(k)
  // By TShape, because names belong to the part and a part may be used in several places.
  std::unordered_map<const void*, std::string> names;
  std::vector<std::string> notices;
  ImportAccount account;
  TopTools_DataMapOfShapeShape origins;  // after sewing: the file's own face of each

  int face_count() const { return faces.Extent(); }
  // `k` counts from 0, as in FaceFacts.
  TopoDS_Face face(int k) const;
  std::string name_of(const TopoDS_Shape& shape) const;  // "" when it has none
  bool sewn() const { return account.sewing.done; }
};

// The name of the part that stores a face, by the face's TShape; only parts that have a name.
using PartNames = std::unordered_map<const void*, std::string>;
PartNames part_names(const Document& document);

// "the part 'nut', which is used 8 times; an edit would change all of them".
std::string used_part(const TopoDS_Face& face, int places, const PartNames& names);

// Reads a file. Throws InputError when it is missing, empty, cannot be parsed, or has no shape.
Document load_document(const std::string& path);

// The name of a label as UTF-8, or empty.
std::string label_name(const TDF_Label& label);

// Fills `shape`, `faces` and `names` from `xde` (or from `shape` when there is none).
void index_document(Document& document);

}  // namespace isochor::internal
