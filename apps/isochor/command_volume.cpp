#include "commands.h"
#include "isochor/base/error.h"
#include "isochor/io/file.h"
#include "isochor/volume/exact_volume.h"
#include "isochor/volume/volume_form.h"
#include "model_source.h"
#include "moment_output.h"
#include "terminal.h"

namespace isochor::app {
namespace {

// The rational volume when every face is a whole polynomial patch; else an InputError that says
// which face is in the way.
std::string exact_text(const LoadedModel& loaded) {
  const FluxFrame frame(require_field(loaded.surroundings.closing));
  if (!frame.exact()) {
    throw InputError(loaded.path, closing_text(loaded),
                     "the exact volume needs closing planes of which one passes through the origin "
                     "and all are coordinate planes; omit --exact");
  }
#ifdef ISOCHOR_WITH_OCCT
  if (loaded.solid) {
    for (const FaceFacts& face : loaded.solid->faces) {
      if (face.patch >= 0 && face.trim == TrimKind::kNatural && !face.rational) continue;
      throw InputError(loaded.path, face.handle,
                       "is no whole polynomial B-spline face (" + face.surface +
                           "), so the volume is not known to be rational; omit --exact");
    }
  }
#endif
  return ExactVolume(loaded.patches).value(frame.points(loaded.patches.points)).to_string();
}

// Says why an open model has no volume, and what would close it.
void refuse_open(const LoadedModel& loaded, bool measured, const Common& common) {
  refuse(loaded.path + ": the model is open (" + loaded.surroundings.why_open +
         ") and encloses no volume; " +
         (measured ? "it has no moments, no sections and nothing below a plane"
                   : "--open prints the integral of z dx dy"));
  if (!loaded.opening.empty()) refuse(loaded.path + ": " + loaded.opening);
  print_json(common, Value::object()
                         .set("outcome", "refused")
                         .set("reason", "open: " + loaded.surroundings.why_open)
                         .set("opening", loaded.opening));
}

}  // namespace

int run_volume(const VolumeOptions& options, const Common& common) {
  if (!options.section.empty()) require_plane(options.section);
  const std::vector<ClosingPlane> close = parse_close(options.close);
  const std::optional<ClosingPlane> waterline = parse_below(options.below);
  const LoadedModel loaded =
      load_model(options.model, common, {}, {options.moments, options.section, close, waterline});
  const bool measured = options.moments || !options.section.empty() || waterline;
  if (!loaded.surroundings.closing.empty() && !options.section.empty()) {
    throw InputError(options.model, "--section",
                     "cuts an open curve out of a model that planes close: sections of those are "
                     "not available in this version");
  }
  if (!loaded.surroundings.closed && (measured || !options.open)) {
    refuse_open(loaded, measured, common);
    return kExitNo;
  }
  Value result = Value::object().set("volume", loaded.volume).set("bound", loaded.volume_bound);
  result.set("undefined_by_gaps", loaded.undefined_by_gaps);
  if (!loaded.surroundings.closing.empty()) result.set("closed_by", closing_names(loaded));
  std::string exact;
  try {
    if (options.exact) exact = exact_text(loaded);
  } catch (const InputError& error) {
    throw error.in_file(options.model);
  }
  result.set("exact", options.exact ? Value(exact) : Value());
  std::optional<Moments> moments;
  if (options.moments) {
    moments = moments_of(loaded);
    result.set("moments", to_value(*moments));
  }
  std::optional<Section> section;
  if (!options.section.empty()) {
    section = section_of(loaded, options.section);
    result.set("section", to_value(*section));
  }
  std::optional<PartBelow> below;
  if (waterline) {
    below = below_of(loaded, *waterline);
    result.set("below", to_value(*below, loaded));
  }
  if (!options.gradient.empty()) {
    Value rows = Value::list();
    for (const Vec3& row :
         VolumeForm(loaded.patches, common.threads, require_field(loaded.surroundings.closing))
             .gradient(loaded.patches.points)) {
      rows.push(row);
    }
    write_file(options.gradient, to_json(rows, -1));
  }
  print(common, format("%.17g (error at most %.2g)", loaded.volume, loaded.volume_bound));
  if (!closing_text(loaded).empty()) print(common, closing_text(loaded));
  if (!gaps_text(loaded).empty()) print(common, gaps_text(loaded));
  if (options.exact) print(common, "exact: " + exact);
  if (moments) print_moments(common, *moments, loaded.patches.unit);
  if (section) print_section(common, *section, loaded.patches.unit);
  if (below) print_below(common, *below, loaded);
  if (!options.gradient.empty()) print(common, "gradient: " + options.gradient);
  print_json(common, result);
  return kExitDone;
}

}  // namespace isochor::app
