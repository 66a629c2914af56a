#include "isochor/step/solid_findings.h"

namespace isochor {
namespace {

std::string label_of(const FaceFacts& face) {
  return face.handle + (face.name.empty() ? "" : " (\"" + face.name + "\")");
}

// The face's number in a STEP file; empty when there is none.
std::string entity_of(const FaceFacts& face) {
  for (const std::string& alias : face.aliases) {
    if (alias.rfind('#', 0) == 0) return alias;
  }
  return "";
}

std::string label_of(const SolidModel& solid, const EdgeFacts& edge) {
  std::string text;
  for (size_t k = 0; k < edge.faces.size(); ++k) {
    const std::string face = label_of(solid.faces[static_cast<size_t>(edge.faces[k])]);
    text += (k == 0 ? "the edge of " : k + 1 == edge.faces.size() ? " and " : ", ") + face;
  }
  if (edge.faces.size() == 2 && edge.faces[0] == edge.faces[1]) {
    return "the seam of " + label_of(solid.faces[static_cast<size_t>(edge.faces[0])]);
  }
  return text;
}

}  // namespace

CheckedModel checked(const SolidModel& solid, bool closed, const std::string& why_open) {
  CheckedModel model;
  model.unit = solid.unit;
  model.defects = solid.facts.defects;
  if (!solid.facts.valid && model.defects.empty()) model.defects = {"the shape is not valid"};
  model.closed = closed;
  model.why_open = why_open;
  model.volume = solid.facts.volume;
  model.volume_bound = solid.facts.volume_bound;
  model.diagonal = solid.facts.diagonal;
  for (const FaceFacts& face : solid.faces) {
    model.faces.push_back({label_of(face), face.area, 0.0, face.tolerance, entity_of(face)});
  }
  for (const EdgeFacts& facts : solid.edges) {
    if (facts.degenerated) continue;
    CheckedEdge edge;
    edge.label = label_of(solid, facts);
    edge.points = facts.points;
    edge.uses = static_cast<int>(facts.faces.size());
    edge.measured = edge.uses == 2 && facts.length > 0.0;
    edge.length = facts.length;
    edge.gap = facts.max_gap;
    edge.tolerance = facts.tolerance;
    edge.angle_deg = facts.max_angle_rad * kDegreesPerRadian;
    edge.smoothness = facts.smoothness;
    if (facts.entity != 0) edge.entity = "#" + std::to_string(facts.entity);
    edge.faces = facts.faces;
    if (edge.faces.size() == 2 && edge.faces[0] == edge.faces[1]) edge.faces.pop_back();  // a seam
    for (int face : facts.faces) model.faces[static_cast<size_t>(face)].perimeter += facts.length;
    model.edges.push_back(std::move(edge));
  }
  if (solid.crossings) {
    for (const Crossing& found : solid.crossings->found) {
      model.crossings.push_back(
          {found.face_a, found.face_b, found.at, found.depth, found.limit, found.one_body});
    }
  }
  return model;
}

}  // namespace isochor
