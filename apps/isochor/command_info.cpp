#include <algorithm>
#include <map>
#include <numeric>

#include "commands.h"
#include "isochor/bspline/joins.h"
#include "model_source.h"
#include "terminal.h"
#ifdef ISOCHOR_WITH_OCCT
#include "import_output.h"
#endif

namespace isochor::app {
namespace {

std::string surface_text(const Patch& patch) {
  return format("%sB-spline %dx%d", patch.weights.empty() ? "" : "rational ",
                patch.u_knots.degree(), patch.v_knots.degree());
}

// Locked points of a patch by reason.
std::map<std::string, int> locks_of(const PatchModel& model, const Patch& patch) {
  std::vector<char> mine(model.points.size(), 0);
  for (int id : patch.points) mine[static_cast<size_t>(id)] = 1;
  std::map<std::string, int> reasons;
  for (const Lock& lock : model.locks) {
    if (!mine[static_cast<size_t>(lock.point)]) continue;
    ++reasons[model.lock_reasons[static_cast<size_t>(lock.reason)].text];
  }
  return reasons;
}

int free_poles(const PatchModel& model, const Patch& patch) {
  std::vector<char> locked(model.points.size(), 0);
  for (const Lock& lock : model.locks) locked[static_cast<size_t>(lock.point)] = 1;
  return static_cast<int>(std::count_if(patch.points.begin(), patch.points.end(),
                                        [&](int id) { return !locked[static_cast<size_t>(id)]; }));
}

void print_patches(const LoadedModel& loaded, const Common& common) {
  const PatchModel& model = loaded.patches;
  print(common, format("editable patches: %zu", model.patches.size()));
  int row = 0;
  for (const Patch& patch : model.patches) {
    const int count = patch.u_size() * patch.v_size();
    print(
        common,
        format("  %-10s %-24s %-22s %3d x %-3d poles, rows %d-%d%s, %d free", patch.handle.c_str(),
               patch.name.empty() ? "-" : ("\"" + patch.name + "\"").c_str(),
               surface_text(patch).c_str(), patch.u_size(), patch.v_size(), row, row + count - 1,
               patch.reversed ? ", reversed" : "", free_poles(model, patch)));
    for (const auto& [reason, poles] : locks_of(model, patch)) {
      print(common, format("      %4d poles locked: %s", poles, reason.c_str()));
    }
    row += count;
  }
}

// What equations keep, equal sentences once.
void print_relations(const PatchModel& model, const Common& common) {
  if (model.relations.empty()) return;
  std::map<std::string, int> sentences;
  size_t smooth = 0;
  for (const SmoothRelation& relation : model.relations) {
    if (relation.order == 0) continue;  // a tie in a common basis: listed with the joins
    ++sentences[relation.text];
    ++smooth;
  }
  if (smooth == 0) return;
  print(common, format("kept smooth by equations: %zu", smooth));
  for (const auto& [text, count] : sentences) {
    const std::string times = count > 1 ? format(" (%d times)", count) : "";
    print(common, format("  %s%s", text.c_str(), times.c_str()));
  }
}

Value relations_value(const PatchModel& model) {
  Value relations = Value::list();
  for (const SmoothRelation& relation : model.relations) {
    relations.push(Value::object()
                       .set("text", relation.text)
                       .set("order", relation.order)
                       .set("lambda", relation.lambda.to_string())
                       .set("mu", relation.mu.to_string())
                       .set("residual", relation.residual));
  }
  return relations;
}

void print_joins(const LoadedModel& loaded, const Common& common) {
  const PatchModel& model = loaded.patches;
  if (model.joins.empty()) return;
  print(common, format("joins between editable patches: %zu", model.joins.size()));
  for (const Join& join : model.joins) {
    print(common,
          format("  %s %s - %s %s: %s, gap %.2g, angle %.2g rad%s%s%s",
                 model.patches[static_cast<size_t>(join.a.patch)].handle.c_str(),
                 name_of(join.a.side),
                 model.patches[static_cast<size_t>(join.b.patch)].handle.c_str(),
                 name_of(join.b.side), name_of(join.smoothness), join.max_gap, join.max_angle_rad,
                 join.matching ? ""
                 : join.common ? ", tied in a common basis ("
                               : ", not tied: ",
                 join.matching ? "" : join.mismatch.c_str(), join.common ? ")" : ""));
  }
}

Value join_value(const PatchModel& model, const Join& join) {
  Value value =
      Value::object()
          .set("patches", Value::list()
                              .push(model.patches[static_cast<size_t>(join.a.patch)].handle)
                              .push(model.patches[static_cast<size_t>(join.b.patch)].handle))
          .set("sides", Value::list().push(name_of(join.a.side)).push(name_of(join.b.side)))
          .set("continuity", name_of(join.smoothness))
          .set("tied", join.matching || join.common)
          .set("common_basis", join.common)
          .set("max_gap", join.max_gap)
          .set("max_angle_rad", join.max_angle_rad)
          .set("max_curvature_jump", join.max_curvature_jump);
  if (join.common) value.set("bases", join.mismatch);
  if (!join.matching && !join.common) value.set("why_not_tied", join.mismatch);
  return value;
}

Value patches_value(const PatchModel& model) {
  Value patches = Value::list();
  int row = 0;
  for (const Patch& patch : model.patches) {
    const int count = patch.u_size() * patch.v_size();
    Value locks = Value::list();
    for (const auto& [reason, poles] : locks_of(model, patch)) {
      locks.push(Value::object().set("reason", reason).set("poles", poles));
    }
    patches.push(
        Value::object()
            .set("handle", patch.handle)
            .set("name", patch.name)
            .set("aliases", patch.aliases)
            .set("degree", std::vector<int>{patch.u_knots.degree(), patch.v_knots.degree()})
            .set("poles", std::vector<int>{patch.u_size(), patch.v_size()})
            .set("domain", std::vector<double>{patch.u_knots.begin(), patch.u_knots.end(),
                                               patch.v_knots.begin(), patch.v_knots.end()})
            .set("rational", !patch.weights.empty())
            .set("reversed", patch.reversed)
            .set("rows", std::vector<int>{row, row + count - 1})
            .set("free_poles", free_poles(model, patch))
            .set("locked", locks));
    row += count;
  }
  return patches;
}

#ifdef ISOCHOR_WITH_OCCT

const char* name_of_trim(TrimKind kind) {
  switch (kind) {
    case TrimKind::kNatural:
      return "natural";
    case TrimKind::kIsoBox:
      return "iso-box";
    case TrimKind::kTrimmed:
      return "trimmed";
    case TrimKind::kTrimmedWithHoles:
      return "trimmed, with holes";
  }
  return "?";
}

void print_faces(const SolidModel& solid, const Common& common) {
  print(common,
        format("%s file, unit %s, %zu faces, %d solids, %s, %s", solid.format.c_str(),
               solid.unit.c_str(), solid.faces.size(), solid.facts.solids,
               solid.facts.closed ? "closed" : "open", solid.facts.valid ? "valid" : "not valid"));
  for (const FaceFacts& face : solid.faces) {
    const std::string state = face.patch >= 0    ? "editable"
                              : face.convertible ? "editable after conversion (name it in an edit)"
                                                 : "not editable: " + face.not_editable;
    std::string aliases;
    for (const std::string& alias : face.aliases) aliases += " " + alias;
    print(common, format("  %-10s %-24s %-22s %-20s %s%s%s", face.handle.c_str(),
                         face.name.empty() ? "-" : ("\"" + face.name + "\"").c_str(),
                         face.surface.c_str(), name_of_trim(face.trim), state.c_str(),
                         aliases.empty() ? "" : "; also", aliases.c_str()));
  }
  std::map<std::string, int> kinds;
  for (const EdgeFacts& edge : solid.edges) {
    if (edge.faces.size() == 2) ++kinds[name_of(edge.smoothness)];
  }
  for (const auto& [kind, count] : kinds) {
    print(common, format("edges that are %s: %d", kind.c_str(), count));
  }
}

Value faces_value(const SolidModel& solid) {
  Value faces = Value::list();
  for (const FaceFacts& face : solid.faces) {
    faces.push(Value::object()
                   .set("handle", face.handle)
                   .set("name", face.name)
                   .set("aliases", face.aliases)
                   .set("surface", face.surface)
                   .set("trim", name_of_trim(face.trim))
                   .set("editable", face.patch >= 0)
                   .set("convertible", face.convertible)
                   .set("reason", face.not_editable)
                   .set("area", face.area));
  }
  return faces;
}

#endif

}  // namespace

int run_info(const InfoOptions& options, const Common& common) {
  ShapeMeasures measures;
  measures.close = parse_close(options.close);
  const LoadedModel loaded = load_model(options.model, common, {}, measures);
  const PatchModel& model = loaded.patches;
  Value result = Value::object().set("model", options.model);
  std::string unit = model.unit;
#ifdef ISOCHOR_WITH_OCCT
  if (loaded.solid) {
    unit = loaded.solid->unit;
    print_faces(*loaded.solid, common);
    print_import(common, loaded.solid->import);
    result.set("format", loaded.solid->format)
        .set("valid", loaded.solid->facts.valid)
        .set("solids", loaded.solid->facts.solids)
        .set("faces", faces_value(*loaded.solid))
        .set("import", to_value(loaded.solid->import))
        .set("notices", loaded.solid->notices);
  }
#endif
  print_patches(loaded, common);
  print_relations(model, common);
  print_joins(loaded, common);
  print(common, format("unit: %s", unit.c_str()));
  print(common, loaded.surroundings.closed
                    ? format("volume: %.15g %s^3, error at most %.2g, %s", loaded.volume,
                             unit.c_str(), loaded.volume_bound,
                             loaded.volume >= 0 ? "oriented outwards" : "oriented inwards")
                    : "open: " + loaded.surroundings.why_open);
  if (!loaded.opening.empty()) print(common, loaded.opening);
  if (!closing_text(loaded).empty()) print(common, closing_text(loaded));
  if (loaded.surroundings.closed && !gaps_text(loaded).empty()) {
    print(common, gaps_text(loaded));
  }
  Value joins = Value::list();
  for (const Join& join : model.joins) joins.push(join_value(model, join));
  result.set("unit", unit)
      .set("patches", patches_value(model))
      .set("joins", joins)
      .set("relations", relations_value(model))
      .set("closed", loaded.surroundings.closed)
      .set("why_open", loaded.surroundings.closed ? "" : loaded.surroundings.why_open)
      .set("opening", loaded.opening)
      .set("closed_by", closing_names(loaded))
      .set("volume", loaded.surroundings.closed ? Value(loaded.volume) : Value())
      .set("bound", loaded.volume_bound)
      .set("undefined_by_gaps", loaded.undefined_by_gaps);
  print_json(common, result);
  return kExitDone;
}

}  // namespace isochor::app
