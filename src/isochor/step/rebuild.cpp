#include "isochor/step/rebuild.h"

#include <BRepTools_Modifier.hxx>
#include <BRep_Tool.hxx>
#include <TDF_ChildIterator.hxx>
#include <TDF_LabelSequence.hxx>
#include <TNaming_Builder.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <map>

#include "isochor/base/error.h"
#include "isochor/step/conversion.h"
#include "isochor/step/occt_surface.h"
#include "isochor/step/pole_modification.h"

namespace isochor::internal {
namespace {

// A part of the document whose geometry is stored once, and the changes to it.
struct Part {
  TDF_Label label;  // null for documents without labels
  TopoDS_Shape shape;
  std::vector<FaceChange> changes;
};

std::string handle_of(int face) { return "face:" + std::to_string(face + 1); }

std::vector<Part> parts_of(const Document& document) {
  if (document.xde.IsNull()) return {{TDF_Label(), document.shape, {}}};
  std::vector<Part> parts;
  TDF_LabelSequence labels;
  XCAFDoc_DocumentTool::ShapeTool(document.xde->Main())->GetShapes(labels);
  for (TDF_LabelSequence::Iterator it(labels); it.More(); it.Next()) {
    if (!XCAFDoc_ShapeTool::IsSimpleShape(it.Value())) continue;
    if (XCAFDoc_ShapeTool::IsSubShape(it.Value())) continue;
    parts.push_back({it.Value(), XCAFDoc_ShapeTool::GetShape(it.Value()), {}});
  }
  return parts;
}

// How often the geometry of a face occurs in the whole document.
int places_of(const TopoDS_Face& face, const Document& document) {
  int places = 0;
  for (int k = 0; k < document.face_count(); ++k)
    places += document.face(k).IsPartner(face) ? 1 : 0;
  return places;
}

Vec3 vector_of(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }
gp_Pnt point_of(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

// The surface that the file states for face `k`, when that is what was edited: else null, and what
// the reader made of it counts.
const Surface* stated_surface(const Surface& edited, const TopoDS_Face& face, int k,
                              const FileSurfaces& stated) {
  const auto found = stated.find(k);
  if (found == stated.end()) return nullptr;
  const Surface made = from_occt(*plain_bspline(face));
  const bool of_reader = made.u_knots() == edited.u_knots() && made.v_knots() == edited.v_knots();
  return of_reader ? nullptr : &found->second;
}

// Hands each edited face to the part that stores it; a refusal when that is not one part.
std::string distribute(const Document& document, const std::vector<EditedFace>& faces,
                       const std::map<int, Surface>& converted, std::vector<Part>& parts) {
  const FileSurfaces stated = changed_by_reader(document);
  for (const auto& edited : faces) {
    const TopoDS_Face face = document.face(edited.face);
    const int places = places_of(face, document);
    if (places != 1) {
      return handle_of(edited.face) + ": belongs to " +
             used_part(face, places, part_names(document));
    }
    bool found = false;
    for (auto& part : parts) {
      TopTools_IndexedMapOfShape own;
      TopExp::MapShapes(part.shape, TopAbs_FACE, own);
      for (int k = 1; k <= own.Extent() && !found; ++k) {
        if (!own(k).IsPartner(face)) continue;
        found = true;
        part.changes.push_back({TopoDS::Face(own(k)),
                                handle_of(edited.face),
                                local_surface(edited.surface, face, edited.face, stated),
                                {}});
        const auto before = converted.find(edited.face);
        if (before != converted.end()) {
          part.changes.back().before = local_surface(before->second, face);
        }
        const Surface* file = stated_surface(edited.surface, face, edited.face, stated);
        if (file != nullptr) {
          part.changes.back().before = cut_like(*file, edited.surface).value_or(*file);
        }
      }
    }
    if (!found) return handle_of(edited.face) + ": belongs to no part of the file";
  }
  return "";
}

// The surfaces of faces that are to be B-spline faces although the file has them as something else,
// as read_solid showed them: in the coordinates of the document.
std::string convert_all(const Document& document, const std::vector<int>& convert,
                        std::map<int, Surface>& converted) {
  if (convert.empty()) return "";
  BrepTable table = brep_table(document.shape, document.faces, part_names(document));
  const std::string refusal = convert_faces(table, convert);
  if (!refusal.empty()) return refusal;
  for (int f : convert) {
    const auto& surface = table.faces[static_cast<size_t>(f)].surface.surface;
    if (surface && plain_bspline(document.face(f)).IsNull()) converted.emplace(f, *surface);
  }
  return "";
}

// The old surfaces of faces that read_solid showed as a box cut out of their surface.
void add_cut_boxes(const Document& document, const std::vector<EditedFace>& faces,
                   std::map<int, Surface>& converted) {
  for (const EditedFace& edited : faces) {
    if (converted.count(edited.face) > 0) continue;
    const FaceSurface whole = face_surface(document.face(edited.face));
    if (!whole.surface) continue;
    std::optional<Surface> part = cut_like(*whole.surface, edited.surface);
    if (part) converted.emplace(edited.face, *std::move(part));
  }
}

// Labels of sub-shapes carry names and colours: each must point to what its shape became.
void repoint(const TDF_Label& label, BRepTools_Modifier& modifier,
             const TopTools_IndexedMapOfShape& known) {
  for (TDF_ChildIterator it(label); it.More(); it.Next()) {
    TopoDS_Shape old;
    if (XCAFDoc_ShapeTool::GetShape(it.Value(), old) && known.Contains(old)) {
      TopoDS_Shape changed = modifier.ModifiedShape(old);
      changed.Orientation(old.Orientation());
      TNaming_Builder(it.Value()).Generated(changed);
    }
    repoint(it.Value(), modifier, known);
  }
}

std::string rebuild_one(Document& document, const Part& part, std::vector<RebuildPlan>* plans,
                        double trim_tolerance) {
  RebuildPlan plan = plan_rebuild(part.shape, part.changes, trim_tolerance);
  if (!plan.refusal.empty()) return plan.refusal;
  BRepTools_Modifier modifier(part.shape, new PoleModification(plan));
  if (!modifier.IsDone()) return "the shape could not be rebuilt";
  const TopoDS_Shape changed = modifier.ModifiedShape(part.shape);
  if (plans != nullptr) plans->push_back(std::move(plan));
  if (part.label.IsNull()) {
    document.shape = changed;
    return "";
  }
  TopTools_IndexedMapOfShape known;
  TopExp::MapShapes(part.shape, known);
  repoint(part.label, modifier, known);
  XCAFDoc_DocumentTool::ShapeTool(document.xde->Main())->SetShape(part.label, changed);
  return "";
}

}  // namespace

Surface local_surface(const Surface& surface, const TopoDS_Face& face, int k,
                      const FileSurfaces& stated) {
  TopLoc_Location location;
  BRep_Tool::Surface(face, location);
  if (location.IsIdentity()) return surface;
  const gp_Trsf& out = location.Transformation();
  const gp_Trsf in = out.Inverted();
  const Surface* own = stated_surface(surface, face, k, stated);
  const auto old = own != nullptr ? to_occt(*own) : plain_bspline(face);
  const bool same_grid =
      !old.IsNull() && old->NbUPoles() == surface.u_size() && old->NbVPoles() == surface.v_size();
  std::vector<Vec3> poles = surface.poles();
  for (int i = 0; i < surface.u_size(); ++i) {
    for (int j = 0; j < surface.v_size(); ++j) {
      Vec3& pole = poles[surface.index(i, j)];
      const bool unmoved = same_grid && vector_of(old->Pole(i + 1, j + 1).Transformed(out)) == pole;
      pole = vector_of(unmoved ? old->Pole(i + 1, j + 1) : point_of(pole).Transformed(in));
    }
  }
  return Surface(surface.u_knots(), surface.v_knots(), std::move(poles), surface.weights());
}

TopoDS_Shape rebuild_part(const TopoDS_Shape& part, const RebuildPlan& plan) {
  ISOCHOR_REQUIRE(plan.refusal.empty(), plan.refusal);
  BRepTools_Modifier modifier(part, new PoleModification(plan));
  return modifier.ModifiedShape(part);
}

std::string rebuild(Document& document, const std::vector<EditedFace>& faces,
                    const std::vector<int>& convert, std::vector<RebuildPlan>* plans,
                    double trim_tolerance) {
  std::map<int, Surface> converted;
  std::string refusal = convert_all(document, convert, converted);
  if (!refusal.empty()) return refusal;
  add_cut_boxes(document, faces, converted);
  std::vector<Part> parts = parts_of(document);
  refusal = distribute(document, faces, converted, parts);
  for (const auto& part : parts) {
    if (refusal.empty() && !part.changes.empty()) {
      refusal = rebuild_one(document, part, plans, trim_tolerance);
    }
  }
  if (!refusal.empty()) return refusal;
  if (!document.xde.IsNull()) {
    XCAFDoc_DocumentTool::ShapeTool(document.xde->Main())->UpdateAssemblies();
  }
  index_document(document);
  return "";
}

}  // namespace isochor::internal
