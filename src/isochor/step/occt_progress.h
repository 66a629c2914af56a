// OpenCASCADE's progress, passed on to the parent process. Internal to `step`.
#pragma once

#include <Message_ProgressIndicator.hxx>
#include <Message_ProgressRange.hxx>
#include <string>

#include "isochor/step/child_progress.h"

namespace isochor::internal {

// Tells how far `step` is within the innermost ProgressPart. To be kept while the work runs:
//   const Handle(OcctProgress) progress = new OcctProgress("reading");
//   reader.Transfer(document, progress->Start());
class OcctProgress : public Message_ProgressIndicator {
  DEFINE_STANDARD_RTTI_INLINE(OcctProgress, Message_ProgressIndicator)

 public:
  explicit OcctProgress(std::string step) : step_(std::move(step)) {}

 protected:
  void Show(const Message_ProgressScope& /*scope*/, Standard_Boolean /*forced*/) override {
    tell_progress(GetPosition(), step_);
  }

 private:
  std::string step_;
};

}  // namespace isochor::internal
