#include "isochor/step/convert.h"

#include "isochor/base/error.h"
#include "isochor/step/checked_write.h"
#include "isochor/step/patch_document.h"

namespace isochor {

WriteReport convert_file(const std::string& input, const std::string& output,
                         const BridgeLimits& limits, const Watch& watch, bool rewrite) {
  internal::WriteJob job;
  job.input = input;
  job.source = [input] { return internal::load_document(input); };
  job.output = output;
  const bool lines = internal::format_of(input) == internal::FileFormat::kStep && !rewrite;
  if (lines) job.step_text = input;
  job.limits = limits;
  job.watch = watch;
  job.must_be_valid = false;
  return internal::write_checked(job);
}

WriteReport write_patch_model(const PatchModel& model, const std::string& name,
                              const std::string& output, const BridgeLimits& limits,
                              const Watch& watch) {
  validate(model);
  internal::WriteJob job;
  job.input = name;
  job.source = [&] { return internal::patch_document(model, name); };
  job.output = output;
  job.limits = limits;
  job.watch = watch;
  job.must_be_valid = false;
  return internal::write_checked(job);
}

PatchModel whole_patches(const SolidModel& solid) {
  for (const auto& face : solid.faces) {
    const std::string entity = face.handle + " (" + face.surface + ")";
    if (face.patch < 0 || face.trim != TrimKind::kNatural) {
      throw InputError(solid.path, entity,
                       face.patch < 0 ? "is not a B-spline face: .isochor.json holds B-spline "
                                        "patches only"
                                      : "is trimmed: .isochor.json holds whole patches only");
    }
  }
  PatchModel model = solid.patches;
  model.unit = solid.unit;
  model.joins.clear();
  model.locked_sides.clear();
  model.lock_reasons.clear();
  model.relations.clear();
  model.locks.clear();
  for (auto& patch : model.patches) patch.trim = {};
  return model;
}

}  // namespace isochor
