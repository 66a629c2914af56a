#include <cmath>

#include "isochor/base/error.h"
#include "isochor/step/checked_write.h"
#include "isochor/step/solid_model.h"

namespace isochor {

WriteReport write_edited(const std::string& input, const ReadOptions& options,
                         const std::vector<EditedFace>& faces, const std::string& output) {
  for (const auto& edit : faces) {
    ISOCHOR_REQUIRE(edit.face >= 0, edit.face);
    for (const Vec3& p : edit.surface.poles()) ISOCHOR_REQUIRE(p.allFinite(), edit.face);
  }
  internal::WriteJob job;
  job.input = input;
  job.source = [input] { return internal::load_document(input); };
  job.edits = faces;
  job.convert = options.convert;
  job.output = output;
  if (internal::format_of(input) == internal::FileFormat::kStep) job.step_text = input;
  job.limits = options.limits;
  job.watch = options.watch;
  return internal::write_checked(job);
}

}  // namespace isochor
