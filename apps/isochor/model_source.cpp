#include "model_source.h"

#include <algorithm>
#include <memory>

#include "busy_line.h"
#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/bspline/joins.h"
#include "isochor/io/file.h"
#include "isochor/io/model_json.h"
#include "isochor/volume/closing.h"
#include "isochor/volume/volume_form.h"
#include "terminal.h"

namespace isochor::app {
namespace {

// Applies closing planes to a model with these open edges: closed, or why not.
void close_by_planes(const std::vector<OpenEdge>& edges, const std::vector<ClosingPlane>& planes,
                     double tolerance, LoadedModel& loaded) {
  Surroundings& around = loaded.surroundings;
  loaded.opening = opening_text(edges, tolerance);
  if (planes.empty()) return;
  if (around.closed) {
    throw InputError(loaded.path, "close", "the model is closed: it needs no closing planes");
  }
  const ClosingCheck check = check_closing(edges, planes, tolerance);
  if (edges.empty()) return;  // open for another reason
  if (!check.closed) {
    throw InputError(loaded.path, "close",
                     "the model is not closed by " + text_of(planes) + ": " + check.why_open);
  }
  around.closed = true;
  around.closing = planes;
  loaded.opening.clear();
}

LoadedModel load_json(const std::string& path, int threads, const ShapeMeasures& measures) {
  LoadedModel loaded;
  loaded.path = path;
  loaded.patches = parse_model(read_file(path), path);
  const Closure closed = closure(loaded.patches);
  loaded.surroundings.closed = closed.closed;
  if (!closed.closed) {
    const auto& sides = !closed.overused_sides.empty()      ? closed.overused_sides
                        : !closed.misoriented_sides.empty() ? closed.misoriented_sides
                                                            : closed.open_sides;
    loaded.surroundings.why_open = sides.empty() ? "its sides do not close up" : sides.front();
    if (sides.size() > 1) {
      loaded.surroundings.why_open += " and " + std::to_string(sides.size() - 1) + " more";
    }
  }
  const bool only_open = closed.overused_sides.empty() && closed.misoriented_sides.empty();
  close_by_planes(only_open ? open_edges(loaded.patches, closed) : std::vector<OpenEdge>(),
                  measures.close, kCoincident * diagonal(loaded.patches), loaded);
  const VolumeForm form(loaded.patches, threads, require_field(measures.close));
  const Bounded volume = form.bounded_value(loaded.patches.points);
  loaded.volume = volume.value;
  loaded.volume_bound = volume.bound;
  return loaded;
}

#ifdef ISOCHOR_WITH_OCCT
LoadedModel from_solid(SolidModel solid, std::vector<int> converted,
                       const std::vector<ClosingPlane>& planes) {
  LoadedModel loaded;
  loaded.converted = std::move(converted);
  loaded.path = solid.path;
  loaded.patches = solid.patches;
  loaded.volume = solid.facts.volume;
  loaded.volume_bound = solid.facts.volume_bound;
  loaded.gap_tolerance = solid.facts.gap_tolerance();
  loaded.undefined_by_gaps = solid.facts.undefined_by_gaps();
  loaded.surroundings.closed = solid.facts.closed;
  if (!solid.facts.closed) {
    loaded.surroundings.why_open = std::to_string(solid.facts.free_edges) + " free edges, " +
                                   std::to_string(solid.facts.multiple_edges) +
                                   " edges of more than two faces";
  }
  const bool only_open = solid.facts.multiple_edges == 0;
  close_by_planes(only_open ? solid.open_edges : std::vector<OpenEdge>(), planes,
                  std::max(kCoincident * solid.facts.diagonal, solid.facts.max_tolerance), loaded);
  // As the session measures them, so that what it starts from is the volume of the file.
  const double whole_patches = VolumeForm(loaded.patches, 1, require_field(planes))
                                   .bounded_value(loaded.patches.points)
                                   .value;
  loaded.surroundings.outside_volume = loaded.volume - whole_patches;
  loaded.surroundings.outside_bound = solid.facts.volume_bound;
  loaded.solid = std::move(solid);
  return loaded;
}
#endif

}  // namespace

std::string gaps_text(const LoadedModel& loaded) {
  if (loaded.undefined_by_gaps == 0.0) return "";
  const char* unit = loaded.patches.unit.c_str();
  return format(
      "gaps of up to %.2g %s leave %.2g %s^3 of the volume undefined (tolerance times area)",
      loaded.gap_tolerance, unit, loaded.undefined_by_gaps, unit);
}

std::vector<ClosingPlane> parse_close(const std::vector<std::string>& options) {
  std::vector<ClosingPlane> planes;
  for (const std::string& text : options) {
    try {
      planes.push_back(parse_closing_plane(text));
    } catch (const InputError& error) {
      throw InputError("--close", error.entity(), error.reason());
    }
  }
  require_field(planes);
  return planes;
}

std::vector<std::string> closing_names(const LoadedModel& loaded) {
  std::vector<std::string> names;
  for (const ClosingPlane& plane : loaded.surroundings.closing) names.push_back(text_of(plane));
  return names;
}

std::string closing_text(const LoadedModel& loaded) {
  const auto& planes = loaded.surroundings.closing;
  return planes.empty() ? "" : "closed by " + text_of(planes);
}

bool is_cad_file(const std::string& path) {
  const std::string extension = extension_of(path);
  for (const char* known : {"step", "stp", "p21", "iges", "igs", "brep", "brp"}) {
    if (extension == known) return true;
  }
  return false;
}

#ifdef ISOCHOR_WITH_OCCT

ReadOptions read_options(const Common& common, BusyLine& busy) {
  ReadOptions options;
  options.watch = busy.watch();
  options.limits.seconds = common.bridge_seconds;
  options.limits.megabytes = common.bridge_megabytes;
  return options;
}

std::vector<EditedFace> edited_faces(const SolidModel& solid, const PatchModel& model,
                                     const std::vector<bool>& moved) {
  std::vector<EditedFace> faces;
  for (size_t f = 0; f < solid.faces.size(); ++f) {
    const int patch = solid.faces[f].patch;
    if (patch < 0 || !moved[static_cast<size_t>(patch)]) continue;
    faces.push_back({static_cast<int>(f), model.surface(patch)});
  }
  return faces;
}

int find_face(const SolidModel& solid, const std::string& name) {
  std::vector<int> found;
  for (size_t f = 0; f < solid.faces.size(); ++f) {
    const FaceFacts& face = solid.faces[f];
    if (face.handle == name) return static_cast<int>(f);
    const bool alias =
        std::find(face.aliases.begin(), face.aliases.end(), name) != face.aliases.end();
    if (face.name == name || alias) found.push_back(static_cast<int>(f));
  }
  if (found.size() == 1) return found.front();
  constexpr size_t kMostListed = 12;
  std::string listed;
  size_t count = 0;
  for (size_t f = 0; f < solid.faces.size() && count <= kMostListed; ++f) {
    const FaceFacts& face = solid.faces[f];
    if (!found.empty() && face.name != name) continue;
    if (++count > kMostListed) {
      listed += ", ...";
      break;
    }
    listed += (listed.empty() ? "" : ", ") + face.handle;
    if (!face.name.empty()) listed += " (\"" + face.name + "\")";
  }
  if (found.empty()) {
    throw InputError(solid.path, "face \"" + name + "\"", "no such face; there are: " + listed);
  }
  throw InputError(solid.path, "face \"" + name + "\"",
                   "the name is ambiguous, use one of: " + listed);
}

namespace {

// The solid with the faces named in `convert` turned into patches; `converted` gets their numbers.
SolidModel read_converted(const std::string& path, const Common& common,
                          const std::vector<std::string>& convert, const ShapeMeasures& measures,
                          std::vector<int>& converted) {
  BusyLine busy(common, "reading " + path);
  ReadOptions options = read_options(common, busy);
  options.moments = measures.moments;
  options.shared_trims = measures.shared_trims;
  options.section = measures.section;
  options.close = measures.close;
  options.below = measures.below;
  options.entities = measures.entities;
  options.crossings = measures.crossings;
  SolidModel solid = read_solid(path, options);
  for (const std::string& name : convert) {
    const int face = find_face(solid, name);
    const FaceFacts& facts = solid.faces[static_cast<size_t>(face)];
    if (facts.patch >= 0) continue;
    if (!facts.convertible) {
      throw InputError(path, facts.handle + (facts.name.empty() ? "" : " (\"" + facts.name + "\")"),
                       "cannot be edited: " + facts.not_editable);
    }
    if (std::find(options.convert.begin(), options.convert.end(), face) == options.convert.end()) {
      options.convert.push_back(face);
    }
  }
  if (!options.convert.empty()) solid = read_solid(path, options);
  converted = std::move(options.convert);
  return solid;
}

// Measures the solid of the file with other patches, in a child process.
std::function<MeasuredVolume(const PatchModel&, const std::vector<bool>&, double)> measurer(
    const LoadedModel& loaded, const Common& common) {
  const auto faces = std::make_shared<SolidModel>();
  faces->faces = loaded.solid->faces;
  return [faces, path = loaded.path, converted = loaded.converted, common](
             const PatchModel& model, const std::vector<bool>& moved, double tolerance) {
    BusyLine busy(common, "measuring the edited solid");
    ReadOptions options = read_options(common, busy);
    options.convert = converted;
    const EditedFacts edited =
        measure_edited(path, options, edited_faces(*faces, model, moved), tolerance);
    return MeasuredVolume{{edited.facts.volume, edited.facts.volume_bound}, edited.refusal};
  };
}

}  // namespace

#endif

LoadedModel load_model(const std::string& path, const Common& common,
                       const std::vector<std::string>& convert, const ShapeMeasures& measures) {
  if (extension_of(path) == "isochor.json") return load_json(path, common.threads, measures);
  if (!is_cad_file(path)) {
    read_file(path);  // a missing file is the better message
    throw InputError(path, "",
                     "unknown model format; known are .step .stp .iges .igs .brep .isochor.json");
  }
#ifdef ISOCHOR_WITH_OCCT
  std::vector<int> converted;
  SolidModel solid = read_converted(path, common, convert, measures, converted);
  for (const std::string& notice : solid.notices) detail(common, path + ": " + notice);
  LoadedModel loaded = from_solid(std::move(solid), std::move(converted), measures.close);
  if (measures.shared_trims) loaded.surroundings.measure = measurer(loaded, common);
  return loaded;
#else
  (void)common;
  (void)convert;
  (void)measures;
  throw InputError(path, "", "this build has no STEP, IGES and BREP support");
#endif
}

}  // namespace isochor::app
