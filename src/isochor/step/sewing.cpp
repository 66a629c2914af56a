#include "isochor/step/sewing.h"

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepGProp.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Quantity_ColorRGBA.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "isochor/base/tolerance.h"
#include "isochor/step/exchange.h"

namespace isochor::internal {
namespace {

constexpr int kListedFaces = 8;

double diagonal_of(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  return box.IsVoid() ? 0.0 : std::sqrt(box.SquareExtent());
}

// Edges that one face uses once.
int free_edges(const TopoDS_Shape& shape) {
  TopTools_IndexedDataMapOfShapeListOfShape faces_of;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces_of);
  int count = 0;
  for (int k = 1; k <= faces_of.Extent(); ++k) {
    const TopoDS_Edge& edge = TopoDS::Edge(faces_of.FindKey(k));
    if (BRep_Tool::Degenerated(edge) || faces_of(k).Extent() != 1) continue;
    const TopoDS_Face& face = TopoDS::Face(faces_of(k).First());
    count += BRep_Tool::IsClosed(edge, face) ? 0 : 1;
  }
  return count;
}

double largest_tolerance(const TopoDS_Shape& shape) {
  double largest = 0.0;
  for (TopExp_Explorer it(shape, TopAbs_EDGE); it.More(); it.Next()) {
    largest = std::max(largest, BRep_Tool::Tolerance(TopoDS::Edge(it.Current())));
  }
  return largest;
}

// A strip no wider than the tolerance.
bool has_no_area(const TopoDS_Face& face, double tolerance) {
  GProp_GProps area, length;
  BRepGProp::SurfaceProperties(face, area);
  BRepGProp::LinearProperties(face, length);
  return std::abs(area.Mass()) <= 0.5 * tolerance * length.Mass();
}

// "face:3, face:7".
std::string listed(const std::vector<int>& faces) {
  std::string text;
  for (size_t k = 0; k < faces.size(); ++k) {
    if (k == kListedFaces) return text + ", ...";
    text += (k == 0 ? "face:" : ", face:") + std::to_string(faces[k] + 1);
  }
  return text;
}

std::string count_of(int count, const char* one, const char* more) {
  return std::to_string(count) + " " + (count == 1 ? one : more);
}

class Sewer {
 public:
  explicit Sewer(Document& document)
      : document_(document), tolerance_(kCoincident * diagonal_of(document.shape)) {}

  // False when nothing is gained.
  bool run() {
    const int before = free_edges(document_.shape);
    if (before == 0 || !(tolerance_ > 0.0)) return false;
    BRepBuilderAPI_Sewing sewing(tolerance_);
    for (int f = 0; f < document_.face_count(); ++f) {
      if (has_no_area(document_.face(f), tolerance_)) {
        dropped_.push_back(f);
      } else {
        sewing.Add(document_.face(f));
      }
    }
    if (static_cast<int>(dropped_.size()) == document_.face_count()) return false;
    sewing.Perform();
    const TopoDS_Shape sewn = sewing.SewedShape();
    if (sewn.IsNull()) return false;
    make_solids(sewn);
    const int after = free_edges(shape_);
    if (after >= before) return false;
    // Edges that only a large tolerance holds together are not one edge.
    const double allowed = std::max(largest_tolerance(document_.shape), 2.0 * tolerance_);
    if (largest_tolerance(shape_) > allowed) return false;
    number_faces(sewing);
    describe(before, after);
    return true;
  }

 private:
  // Closed shells become solids; everything goes into one compound (or is the one solid).
  void make_solids(const TopoDS_Shape& sewn) {
    BRep_Builder builder;
    TopoDS_Compound compound;
    builder.MakeCompound(compound);
    int parts = 0;
    TopoDS_Shape last;
    const auto add = [&](const TopoDS_Shape& part) {
      builder.Add(compound, part);
      last = part;
      ++parts;
    };
    for (TopExp_Explorer it(sewn, TopAbs_SHELL); it.More(); it.Next()) {
      const TopoDS_Shell& shell = TopoDS::Shell(it.Current());
      ++shells_;
      if (!BRep_Tool::IsClosed(shell)) {
        add(shell);
        continue;
      }
      ++closed_;
      TopoDS_Solid solid;
      builder.MakeSolid(solid);
      builder.Add(solid, shell);
      BRepLib::OrientClosedSolid(solid);
      add(solid);
    }
    for (TopExp_Explorer it(sewn, TopAbs_FACE, TopAbs_SHELL); it.More(); it.Next()) {
      add(it.Current());
      ++loose_;
    }
    shape_ = parts == 1 ? last : TopoDS_Shape(compound);
  }

  // The new faces in the order of the file, with names and labels of the old.
  void number_faces(const BRepBuilderAPI_Sewing& sewing) {
    TopTools_IndexedMapOfShape found;
    TopExp::MapShapes(shape_, TopAbs_FACE, found);
    const TopTools_IndexedMapOfShape old = document_.faces;
    auto names = document_.names;
    TopTools_IndexedMapOfShape faces;
    std::vector<std::pair<TopoDS_Shape, TopoDS_Shape>> pairs;  // old, new
    for (int k = 1; k <= old.Extent(); ++k) {
      TopoDS_Shape now = old(k);
      if (sewing.IsModified(now)) now = sewing.Modified(now);
      const int index = found.FindIndex(now);
      if (index == 0) continue;
      faces.Add(found(index));
      if (found(index).Orientation() != old(k).Orientation()) turned_.push_back(k - 1);
      if (const auto name = names.find(old(k).TShape().get()); name != names.end()) {
        names.emplace(found(index).TShape().get(), name->second);
      }
      pairs.emplace_back(old(k), found(index));
    }
    document_.names = std::move(names);
    if (!document_.xde.IsNull()) label(pairs);
    document_.shape = shape_;
    document_.faces = faces;
  }

  // A new structure: one part, with the faces' names and colours.
  void label(const std::vector<std::pair<TopoDS_Shape, TopoDS_Shape>>& pairs) {
    const auto old_colours = XCAFDoc_DocumentTool::ColorTool(document_.xde->Main());
    TDF_LabelSequence free;
    XCAFDoc_DocumentTool::ShapeTool(document_.xde->Main())->GetFreeShapes(free);
    const std::string title = free.Size() == 1 ? label_name(free.First()) : "";
    const Handle(TDocStd_Document) xde = new_xde();
    const auto shapes = XCAFDoc_DocumentTool::ShapeTool(xde->Main());
    const auto colours = XCAFDoc_DocumentTool::ColorTool(xde->Main());
    const TDF_Label root = shapes->AddShape(shape_, Standard_False);
    const auto set_name = [](const TDF_Label& at, const std::string& name) {
      if (name.empty()) return;
      TDataStd_Name::Set(at, TCollection_ExtendedString(name.c_str(), Standard_True));
    };
    set_name(root, title);
    for (const auto& [old, now] : pairs) {
      Quantity_ColorRGBA colour;
      const std::string name = document_.name_of(old);
      const bool coloured = old_colours->GetColor(old, XCAFDoc_ColorSurf, colour) ||
                            old_colours->GetColor(old, XCAFDoc_ColorGen, colour);
      if (name.empty() && !coloured) continue;
      const TDF_Label at = shapes->AddSubShape(root, now);
      if (at.IsNull()) continue;
      set_name(at, name);
      if (coloured) colours->SetColor(at, colour, XCAFDoc_ColorSurf);
    }
    document_.xde = xde;
  }

  void describe(int before, int after) {
    std::ostringstream text;
    text.precision(2);
    text << "sewn within " << tolerance_ << ": "
         << count_of(document_.face_count(), "face", "faces") << " in "
         << count_of(shells_, "shell", "shells") << ", " << closed_ << " closed and made "
         << (closed_ == 1 ? "a solid" : "solids") << "; "
         << count_of(after, "free edge is", "free edges are") << " left of " << before;
    if (loose_ > 0) text << "; " << count_of(loose_, "face stays", "faces stay") << " loose";
    document_.notices.push_back(text.str());
    if (!dropped_.empty()) {
      document_.notices.push_back(
          count_of(static_cast<int>(dropped_.size()), "face", "faces") +
          " without area dropped (numbers of the file: " + listed(dropped_) +
          "); the others are numbered without " + (dropped_.size() == 1 ? "it" : "them"));
    }
    if (!turned_.empty()) {
      document_.notices.push_back(
          count_of(static_cast<int>(turned_.size()), "face", "faces") +
          " turned round by sewing (numbers of the file: " + listed(turned_) + ")");
    }
  }

  Document& document_;
  double tolerance_;
  TopoDS_Shape shape_;
  int shells_ = 0, closed_ = 0, loose_ = 0;
  std::vector<int> dropped_, turned_;
};

}  // namespace

void sew(Document& document) {
  TopExp_Explorer solid(document.shape, TopAbs_SOLID);
  if (solid.More()) return;
  document.sewn = Sewer(document).run();
}

}  // namespace isochor::internal
