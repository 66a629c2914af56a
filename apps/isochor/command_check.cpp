#include <algorithm>
#include <cmath>
#include <optional>

#include "commands.h"
#include "isochor/base/error.h"
#include "isochor/bspline/joins.h"
#include "model_source.h"
#include "terminal.h"
#ifdef ISOCHOR_WITH_OCCT
#include "import_output.h"
#endif

namespace isochor::app {
namespace {

// Findings of one model: empty when it is fit for use.
std::vector<std::string> findings_of(const LoadedModel& loaded) {
  std::vector<std::string> findings;
#ifdef ISOCHOR_WITH_OCCT
  if (loaded.solid) {
    const ShapeFacts& facts = loaded.solid->facts;
    findings = import_findings(loaded.solid->import);
    findings.insert(findings.end(), facts.defects.begin(), facts.defects.end());
    if (!facts.valid && facts.defects.empty()) findings.emplace_back("the shape is not valid");
    const bool closed = loaded.surroundings.closed;  // by itself or by planes
    if (!closed) findings.push_back("open: " + loaded.surroundings.why_open);
    if (closed && loaded.volume < 0.0) findings.emplace_back("oriented inwards");
    if (closed && loaded.volume_bound >= std::abs(loaded.volume)) {
      findings.push_back(format("the volume is not determined: %.3g, error at most %.2g",
                                loaded.volume, loaded.volume_bound));
    }
    return findings;
  }
#endif
  const Closure closed = closure(loaded.patches);
  if (!loaded.surroundings.closed) {
    for (const std::string& side : closed.open_sides) findings.push_back("open: " + side);
  }
  for (const std::string& side : closed.overused_sides) {
    findings.push_back("joined more than once: " + side);
  }
  for (const std::string& side : closed.misoriented_sides) findings.push_back(side);
  if (loaded.surroundings.closed && loaded.volume < 0.0) findings.emplace_back("oriented inwards");
  return findings;
}

struct Measures {
  double gap = 0.0, angle = 0.0, tolerance = 0.0;
  int joins = 0;
};

Measures measures_of(const LoadedModel& loaded) {
  Measures m;
  for (const Join& join : loaded.patches.joins) {
    ++m.joins;
    m.gap = std::max(m.gap, join.max_gap);
    if (join.smoothness >= Smoothness::kAlmost) m.angle = std::max(m.angle, join.max_angle_rad);
  }
#ifdef ISOCHOR_WITH_OCCT
  if (loaded.solid) {
    m = {};
    m.joins = static_cast<int>(loaded.solid->edges.size());
    m.gap = loaded.solid->facts.max_edge_gap;
    m.tolerance = loaded.solid->facts.max_tolerance;
    for (const EdgeFacts& edge : loaded.solid->edges) {
      if (edge.smoothness >= Smoothness::kAlmost) m.angle = std::max(m.angle, edge.max_angle_rad);
    }
  }
#endif
  return m;
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
  ShapeMeasures measures;
  measures.close = parse_close(options.close);
  const LoadedModel loaded = load_model(options.model, common, {}, measures);
  std::optional<LoadedModel> original;
  if (!options.against.empty()) original = load_model(options.against, common, {}, measures);
  const std::vector<std::string> findings = findings_of(loaded);
  const Measures m = measures_of(loaded);
  const std::string unit = loaded.patches.unit;
  print(common, findings.empty() ? "valid" : "not valid");
  for (const std::string& finding : findings) print(common, "  " + finding);
  print(common, format("edges or joins: %d, largest gap %.3g %s, largest angle across a smooth one "
                       "%.3g rad, largest tolerance %.3g %s",
                       m.joins, m.gap, unit.c_str(), m.angle, m.tolerance, unit.c_str()));
  if (loaded.surroundings.closed) {
    print(common, format("volume: %.15g %s^3, error at most %.2g", loaded.volume, unit.c_str(),
                         loaded.volume_bound));
    if (!gaps_text(loaded).empty()) print(common, gaps_text(loaded));
  }
  Value result = Value::object()
                     .set("valid", findings.empty())
                     .set("findings", findings)
                     .set("closed", loaded.surroundings.closed)
                     .set("max_gap", m.gap)
                     .set("max_smooth_angle_rad", m.angle)
                     .set("max_tolerance", m.tolerance)
                     .set("volume", loaded.surroundings.closed ? Value(loaded.volume) : Value())
                     .set("bound", loaded.volume_bound)
                     .set("undefined_by_gaps", loaded.undefined_by_gaps);
#ifdef ISOCHOR_WITH_OCCT
  if (loaded.solid) {
    result.set("area", loaded.solid->facts.area)
        .set("faces", static_cast<long>(loaded.solid->faces.size()))
        .set("import", to_value(loaded.solid->import));
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
  return findings.empty() ? kExitDone : kExitNo;
}

}  // namespace isochor::app
