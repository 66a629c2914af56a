#include "isochor/step/bridge.h"
#include "isochor/step/document.h"
#include "isochor/step/document_model.h"
#include "isochor/step/model_bytes.h"
#include "isochor/step/solid_model.h"

namespace isochor {

SolidModel read_solid(const std::string& path, const ReadOptions& options) {
  return call_in_child<SolidModel>(
      path, [&] { return internal::document_model(internal::load_document(path), options); },
      options.limits);
}

}  // namespace isochor
