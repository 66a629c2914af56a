#include <cmath>

#include "isochor/base/error.h"
#include "isochor/step/bridge.h"
#include "isochor/step/checked_write.h"
#include "isochor/step/model_bytes.h"
#include "isochor/step/rebuild.h"
#include "isochor/step/shape_facts.h"
#include "isochor/step/solid_model.h"

namespace isochor {

namespace {

void check_faces(const std::vector<EditedFace>& faces) {
  for (const auto& edit : faces) {
    ISOCHOR_REQUIRE(edit.face >= 0, edit.face);
    for (const Vec3& p : edit.surface.poles()) ISOCHOR_REQUIRE(p.allFinite(), edit.face);
  }
}

}  // namespace

EditedFacts measure_edited(const std::string& input, const ReadOptions& options,
                           const std::vector<EditedFace>& faces, double trim_tolerance) {
  check_faces(faces);
  const auto measure = [&] {
    EditedFacts result;
    internal::Document document = internal::load_document(input);
    result.refusal = internal::rebuild(document, faces, options.convert, nullptr, trim_tolerance);
    if (result.refusal.empty()) result.facts = internal::shape_facts(document);
    return result;
  };
  return call_in_child<EditedFacts>(input, measure, options.limits, options.watch);
}

WriteReport write_edited(const std::string& input, const ReadOptions& options,
                         const std::vector<EditedFace>& faces, const std::string& output,
                         double trim_tolerance) {
  check_faces(faces);
  internal::WriteJob job;
  job.input = input;
  job.source = [input] { return internal::load_document(input); };
  job.edits = faces;
  job.convert = options.convert;
  job.output = output;
  job.trim_tolerance = trim_tolerance;
  if (internal::format_of(input) == internal::FileFormat::kStep) job.step_text = input;
  job.limits = options.limits;
  job.watch = options.watch;
  return internal::write_checked(job);
}

}  // namespace isochor
