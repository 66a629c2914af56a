#include "isochor/step/document_model.h"

#include <BRep_Tool.hxx>
#include <Interface_InterfaceModel.hxx>
#include <Standard_Failure.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <XSControl_TransferReader.hxx>
#include <sstream>

#include "isochor/base/error.h"
#include "isochor/step/brep_joins.h"
#include "isochor/step/child_progress.h"
#include "isochor/step/conversion.h"
#include "isochor/step/edge_measures.h"
#include "isochor/step/entity_index.h"
#include "isochor/step/flux.h"
#include "isochor/step/self_intersections.h"
#include "isochor/step/shape_facts.h"
#include "isochor/step/solid_below.h"
#include "isochor/step/solid_moments.h"
#include "isochor/step/solid_section.h"

namespace isochor::internal {
namespace {

// Of the squared diagonal: faces below are lines or points but for rounding.
constexpr double kNoArea = 1e-14;

void add_entity_names(const Document& document, std::vector<std::vector<std::string>>& aliases) {
  if (document.session.IsNull() || document.session->TransferReader().IsNull()) return;
  const Handle(Interface_InterfaceModel) model = document.session->Model();
  for (int k = 0; k < document.face_count(); ++k) {
    TopoDS_Shape own = document.face(k);
    document.origins.Find(document.face(k), own);
    const Handle(Standard_Transient) entity =
        document.session->TransferReader()->EntityFromShapeResult(own, 1);
    if (entity.IsNull() || !model->Contains(entity)) continue;
    aliases[static_cast<size_t>(k)].push_back(model->StringLabel(entity)->ToCString());
  }
}

// Walks down the parts; `path` names the named parts above, `local` numbers the faces of the last.
void add_paths(const Document& document, const TopoDS_Shape& shape, const std::string& path,
               const TopTools_IndexedMapOfShape& local,
               std::vector<std::vector<std::string>>& aliases) {
  if (shape.ShapeType() == TopAbs_FACE) {
    const int number = document.faces.FindIndex(shape);
    if (number == 0 || path.empty()) return;
    auto& names = aliases[static_cast<size_t>(number) - 1];
    names.push_back(path + "/face:" + std::to_string(local.FindIndex(shape)));
    return;
  }
  const std::string name = shape.ShapeType() <= TopAbs_SHELL ? document.name_of(shape) : "";
  TopTools_IndexedMapOfShape own;
  if (!name.empty()) TopExp::MapShapes(shape, TopAbs_FACE, own);
  const std::string below = name.empty() ? path : path.empty() ? name : path + "/" + name;
  for (TopoDS_Iterator it(shape); it.More(); it.Next()) {
    if (it.Value().ShapeType() > TopAbs_FACE) continue;
    add_paths(document, it.Value(), below, name.empty() ? local : own, aliases);
  }
}

FaceFacts face_facts(const BrepTable& table, int f, const Document& document) {
  const FaceRecord& face = table.faces[static_cast<size_t>(f)];
  FaceFacts facts;
  facts.handle = "face:" + std::to_string(f + 1);
  facts.name = document.name_of(face.face);
  facts.surface = face.surface.kind;
  facts.trim = face.trim.kind;
  facts.bspline = face.surface.bspline;
  facts.rational = face.surface.rational;
  facts.patch = face.patch;
  facts.not_editable = face.patch < 0 ? face.surface.refusal : "";
  facts.tolerance = BRep_Tool::Tolerance(face.face);
  if (!face.surface.bspline) {
    facts.convertible = !convert_face(face, table.diagonal).surface.IsNull();
  }
  return facts;
}

// Fluxes of all faces; volume and area of the shape, where a face may occur more than once.
void integrate(const BrepTable& table, const Document& document,
               const std::vector<ClosingPlane>& close, SolidModel& model) {
  std::vector<FaceIntegrals> integrals;
  const FluxField field = require_field(close);
  const double z0 = close.empty() ? table.z0 : 0.0;
  for (size_t f = 0; f < table.faces.size(); ++f) {
    const FaceRecord& face = table.faces[f];
    tell_progress(static_cast<double>(f) / static_cast<double>(table.faces.size()), "measuring");
    integrals.push_back(face.surface.geometry.IsNull()
                            ? FaceIntegrals{}
                            : integrate_face(face.surface.geometry, face.loops, face.trim.kind,
                                             face.reversed(), z0, field));
    model.faces[f].area = integrals.back().area;
    model.faces[f].flux = integrals.back().flux_about_zero(z0);
    model.faces[f].flux_bound = integrals.back().bound_about_zero(z0);
  }
  for (TopExp_Explorer it(document.shape, TopAbs_FACE); it.More(); it.Next()) {
    const auto f = static_cast<size_t>(document.faces.FindIndex(it.Current())) - 1;
    const bool same = it.Current().Orientation() == table.faces[f].face.Orientation();
    model.facts.volume += same ? integrals[f].flux : -integrals[f].flux;
    model.facts.volume_bound += integrals[f].bound;
    model.facts.area += integrals[f].area;
  }
}

void note_faces_without_area(SolidModel& model, double diagonal) {
  for (const FaceFacts& face : model.faces) {
    if (!(face.area > kNoArea * diagonal * diagonal)) model.import.no_area.push_back(face.handle);
  }
}

// The entities of the file that became the edges.
void number_edges(const Document& document, const BrepTable& table, std::vector<EdgeFacts>& edges) {
  const EntityIndex index(document);
  for (size_t e = 0; e < edges.size(); ++e) edges[e].entity = index.number(table.edges[e].edge);
}

// Edges of one face only, with points along them.
std::vector<OpenEdge> open_edges(const BrepTable& table, const std::vector<EdgeFacts>& facts) {
  std::vector<OpenEdge> edges;
  for (const EdgeFacts& edge : facts) {
    if (edge.faces.size() != 1 || edge.points.empty()) continue;
    std::ostringstream label;
    label.precision(4);
    label << "the edge of " << table.label(edge.faces.front()) << " at ("
          << edge.points[edge.points.size() / 2].transpose() << ")";
    edges.push_back({label.str(), edge.points});
  }
  return edges;
}

void convert(BrepTable& table, const std::vector<int>& faces, const std::string& path) {
  for (int f : faces) {
    if (f < 0 || f >= static_cast<int>(table.faces.size())) {
      throw InputError(path, "face:" + std::to_string(f + 1),
                       "the file has " + std::to_string(table.faces.size()) + " faces");
    }
  }
  const std::string refusal = convert_faces(table, faces);
  if (!refusal.empty()) throw InputError(path, "", refusal);
}

}  // namespace

std::vector<std::vector<std::string>> face_aliases(const Document& document) {
  std::vector<std::vector<std::string>> aliases(static_cast<size_t>(document.face_count()));
  add_entity_names(document, aliases);
  add_paths(document, document.shape, "", {}, aliases);
  return aliases;
}

SolidModel document_model(const Document& document, const ReadOptions& options) {
  SolidModel model;
  model.path = document.path;
  model.format = name_of(document.format);
  model.unit = document.unit.name;
  model.schema = document.schema;
  model.notices = document.notices;
  model.import = document.account;
  tell_progress(0.0, "checking");
  model.facts = shape_facts(document, false);  // integrals follow, face by face
  BrepTable table =
      brep_table(document.shape, document.faces, part_names(document), changed_by_reader(document));
  convert(table, options.convert, document.path);
  cut_iso_boxes(table);
  tell_progress(0.3, "looking at edges");
  for (const EdgeRecord& edge : table.edges) model.edges.push_back(measure_edge(table, edge));
  if (options.entities) number_edges(document, table, model.edges);
  model.patches = patch_model(table, model.edges, options.shared_trims);
  model.patches.unit = model.unit;
  const auto aliases = face_aliases(document);
  tell_progress(0.5, "measuring");
  for (int f = 0; f < document.face_count(); ++f) {
    model.faces.push_back(face_facts(table, f, document));
    FaceFacts& facts = model.faces.back();
    facts.aliases = aliases[static_cast<size_t>(f)];
    if (facts.patch < 0) continue;
    Patch& patch = model.patches.patches[static_cast<size_t>(facts.patch)];
    patch.name = facts.name;
    patch.aliases = facts.aliases;
  }
  {
    const ProgressPart part(0.5, 1.0);
    integrate(table, document, options.close, model);
  }
  note_faces_without_area(model, table.diagonal);
  model.open_edges = open_edges(table, model.edges);
  if (options.moments && model.facts.closed) model.moments = shape_moments(document.shape);
  if (const auto origin = common_point(options.close); options.moments && origin) {
    model.moments = shape_moments(document.shape, *origin);
  }
  if (!options.section.empty() && model.facts.closed) {
    const auto& plane = options.section;
    model.section = shape_section(document.shape, Vec3(plane[0], plane[1], plane[2]), plane[3]);
  }
  if (options.below && (model.facts.closed || !options.close.empty())) {
    model.below = shape_below(document.shape, *options.below, options.close);
  }
  if (options.crossings) model.crossings = self_intersections(table, model.edges);
  return model;
}

}  // namespace isochor::internal
