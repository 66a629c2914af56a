#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "check_picture.h"
#include "commands.h"
#include "isochor/base/error.h"
#include "isochor/volume/findings.h"
#include "model_picture.h"
#include "model_source.h"
#include "terminal.h"
#ifdef ISOCHOR_WITH_OCCT
#include "crossings_output.h"
#include "import_output.h"
#include "isochor/step/solid_findings.h"
#endif

namespace isochor::app {
namespace {

CheckedModel subject_of(const LoadedModel& loaded) {
  const Surroundings& around = loaded.surroundings;
#ifdef ISOCHOR_WITH_OCCT
  if (loaded.solid) {
    CheckedModel model = checked(*loaded.solid, around.closed, around.why_open);
    model.import_faults = import_findings(loaded.solid->import);
    model.import_warnings = loaded.solid->import.sewing.lines();
    return model;
  }
#endif
  CheckedModel model = checked(loaded.patches);
  model.closed = around.closed;
  model.why_open = around.why_open;
  model.volume = loaded.volume;
  model.volume_bound = loaded.volume_bound;
  return model;
}

bool crossings_known(const LoadedModel& loaded) {
#ifdef ISOCHOR_WITH_OCCT
  return loaded.solid && loaded.solid->crossings;
#else
  (void)loaded;
  return false;
#endif
}

void print_crossings(const LoadedModel& loaded, const Common& common) {
#ifdef ISOCHOR_WITH_OCCT
  print(common, crossings_text(*loaded.solid, *loaded.solid->crossings));
#else
  (void)loaded, (void)common;
#endif
}

struct Measures {
  double gap = 0.0, angle_deg = 0.0, tolerance = 0.0;
};

Measures measures_of(const CheckedModel& model) {
  Measures m;
  for (const CheckedEdge& edge : model.edges) {
    m.gap = std::max(m.gap, edge.gap);
    m.tolerance = std::max(m.tolerance, edge.tolerance);
    if (edge.measured && edge.smoothness >= Smoothness::kAlmost) {
      m.angle_deg = std::max(m.angle_deg, edge.angle_deg);
    }
  }
  return m;
}

Value to_value(const std::vector<Finding>& findings) {
  Value list = Value::list();
  for (const Finding& f : findings) {
    list.push(Value::object()
                  .set("kind", f.kind)
                  .set("severity", name_of(f.severity))
                  .set("place", f.place)
                  .set("entity", f.entity.empty() ? Value() : Value(f.entity))
                  .set("face_entities", f.face_entities)
                  .set("at", f.at ? Value(*f.at) : Value())
                  .set("value", f.value ? Value(*f.value) : Value())
                  .set("limit", f.limit ? Value(*f.limit) : Value())
                  .set("text", f.text));
  }
  return list;
}

Value to_value(const std::vector<AngleBin>& bins) {
  Value list = Value::list();
  for (const AngleBin& bin : bins) {
    list.push(Value::object()
                  .set("from_deg", bin.from)
                  .set("to_deg", bin.to)
                  .set("edges", static_cast<long>(bin.edges)));
  }
  return list;
}

// The first few of every kind; --json has all.
void print_findings(const std::vector<Finding>& findings, const Common& common) {
  constexpr int kShown = 6;
  std::map<std::string, int> shown, all;
  for (const Finding& f : findings) ++all[f.kind];
  for (const Finding& f : findings) {
    const int count = ++shown[f.kind];
    if (count <= kShown) print(common, format("  %-8s %s", name_of(f.severity), f.text.c_str()));
    if (count == kShown + 1) {
      print(common, format("  %-8s ... and %d more of this kind (%s)", name_of(f.severity),
                           all[f.kind] - kShown, f.kind.c_str()));
    }
  }
}

void print_histogram(const std::vector<AngleBin>& bins, const Common& common) {
  std::string line;
  for (const AngleBin& bin : bins) {
    if (bin.edges == 0) continue;
    line += (line.empty() ? "" : ", ") +
            format("%d from %.2g to %.3g", bin.edges, bin.from, std::min(bin.to, 180.0));
  }
  if (!line.empty()) print(common, "edges by angle between their faces, degrees: " + line);
}

// What changed of the patches, by handle.
Value compare(const LoadedModel& now, const LoadedModel& then, const Common& common) {
  Value list = Value::list();
  for (const Patch& patch : now.patches.patches) {
    const Patch* old = nullptr;
    for (const Patch& candidate : then.patches.patches) {
      if (candidate.handle == patch.handle) old = &candidate;
    }
    Value entry = Value::object().set("handle", patch.handle).set("name", patch.name);
    std::string text;
    if (old == nullptr) {
      text = "not a B-spline face in the original";
    } else if (old->u_knots != patch.u_knots || old->v_knots != patch.v_knots) {
      text = format("%d x %d poles instead of %d x %d", patch.u_size(), patch.v_size(),
                    old->u_size(), old->v_size());
    } else {
      int moved = 0;
      double farthest = 0.0;
      for (size_t k = 0; k < patch.points.size(); ++k) {
        const Vec3 d = now.patches.points[static_cast<size_t>(patch.points[k])] -
                       then.patches.points[static_cast<size_t>(old->points[k])];
        moved += d != Vec3::Zero();
        farthest = std::max(farthest, d.norm());
      }
      entry.set("moved_poles", moved).set("max_distance", farthest);
      text = moved == 0 ? "the same bit for bit"
                        : format("%d of %zu poles moved, at most by %.6g", moved,
                                 patch.points.size(), farthest);
    }
    entry.set("text", text);
    print(common, "  " + patch.handle + (patch.name.empty() ? "" : " (\"" + patch.name + "\")") +
                      ": " + text);
    list.push(entry);
  }
  return list;
}

}  // namespace

int run_check(const CheckOptions& options, const Common& common) {
  if (!options.picture.empty()) require_picture(options.picture);
  ShapeMeasures measures;
  measures.close = parse_close(options.close);
  measures.entities = true;
  measures.crossings = options.self_intersections;
  const LoadedModel loaded = load_model(options.model, common, {}, measures);
  measures.crossings = false;
  if (options.self_intersections && !crossings_known(loaded)) {
    throw InputError(options.model, "",
                     "self-intersections are looked for in STEP, IGES and BREP files only; "
                     "\"isochor convert\" makes one");
  }
  std::optional<LoadedModel> original;
  if (!options.against.empty()) original = load_model(options.against, common, {}, measures);
  const CheckedModel subject = subject_of(loaded);
  const std::vector<Finding> findings = findings_of(subject);
  const bool valid = std::none_of(findings.begin(), findings.end(),
                                  [](const Finding& f) { return f.severity == Severity::kFault; });
  const Measures m = measures_of(subject);
  const std::vector<AngleBin> bins = angle_histogram(subject);
  const std::string unit = loaded.patches.unit;
  if (!options.picture.empty()) {
    write_png(options.picture, draw_check(loaded, subject, findings, common));
  }
  print(common, valid ? "valid" : "not valid");
  print_findings(findings, common);
  if (options.self_intersections) print_crossings(loaded, common);
  if (!loaded.opening.empty()) print(common, loaded.opening);
  if (!closing_text(loaded).empty()) print(common, closing_text(loaded));
  print(common,
        format("%zu edges: largest gap %.3g %s, largest angle across a smooth one %.3g "
               "degrees, largest tolerance %.3g %s",
               subject.edges.size(), m.gap, unit.c_str(), m.angle_deg, m.tolerance, unit.c_str()));
  print_histogram(bins, common);
  if (loaded.surroundings.closed) {
    print(common, format("volume: %.15g %s^3, error at most %.2g", loaded.volume, unit.c_str(),
                         loaded.volume_bound));
    if (!gaps_text(loaded).empty()) print(common, gaps_text(loaded));
  }
  Value result = Value::object()
                     .set("valid", valid)
                     .set("findings", to_value(findings))
                     .set("edges_by_angle", to_value(bins))
                     .set("opening", loaded.opening)
                     .set("closed_by", closing_names(loaded))
                     .set("closed", loaded.surroundings.closed)
                     .set("max_gap", m.gap)
                     .set("max_smooth_angle_rad", m.angle_deg / kDegreesPerRadian)
                     .set("max_tolerance", m.tolerance)
                     .set("volume", loaded.surroundings.closed ? Value(loaded.volume) : Value())
                     .set("bound", loaded.volume_bound)
                     .set("undefined_by_gaps", loaded.undefined_by_gaps);
#ifdef ISOCHOR_WITH_OCCT
  if (loaded.solid) {
    result.set("area", loaded.solid->facts.area)
        .set("faces", static_cast<long>(loaded.solid->faces.size()))
        .set("import", to_value(loaded.solid->import));
    if (loaded.solid->crossings) {
      result.set("self_intersections", to_value(*loaded.solid, *loaded.solid->crossings));
    }
  }
#endif
  if (original) {
    print(common, "against " + options.against + ":");
    result.set("against", compare(loaded, *original, common));
    const double change = loaded.volume - original->volume;
    print(common, format("  volume: %.15g instead of %.15g, relative change %.3g", loaded.volume,
                         original->volume, change / std::abs(original->volume)));
    result.set("volume_change", change);
  }
  print_json(common, result);
  if (!options.picture.empty()) print(common, "picture: " + options.picture);
  return valid ? kExitDone : kExitNo;
}

}  // namespace isochor::app
