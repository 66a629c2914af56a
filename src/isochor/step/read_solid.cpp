#include "isochor/step/bridge.h"
#include "isochor/step/child_progress.h"
#include "isochor/step/document.h"
#include "isochor/step/document_model.h"
#include "isochor/step/model_bytes.h"
#include "isochor/step/solid_model.h"

namespace isochor {
namespace {

// The share of reading in the time, roughly; the rest is checking and measuring.
constexpr double kRead = 0.4;

// In a child process, which ends without destructors: to take OpenCASCADE's many small objects
// apart one by one before would be for nothing.
SolidModel read_and_measure(const std::string& path, const ReadOptions& options) {
  auto* const document = new internal::Document;
  {
    const internal::ProgressPart part(0.0, kRead);
    *document = internal::load_document(path);
  }
  const internal::ProgressPart part(kRead, 1.0);
  return internal::document_model(*document, options);
}

}  // namespace

SolidModel read_solid(const std::string& path, const ReadOptions& options) {
  return call_in_child<SolidModel>(
      path, [&] { return read_and_measure(path, options); }, options.limits, options.watch);
}

}  // namespace isochor
