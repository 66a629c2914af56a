#include "isochor/base/error.h"

namespace isochor {
namespace {

std::string compose(const std::string& file, const std::string& entity, const std::string& reason) {
  std::string text;
  if (!file.empty()) text += file + ": ";
  if (!entity.empty()) text += entity + ": ";
  return text + reason;
}

}  // namespace

InputError::InputError(std::string file, std::string entity, std::string reason)
    : std::runtime_error(compose(file, entity, reason)),
      file_(std::move(file)),
      entity_(std::move(entity)),
      reason_(std::move(reason)) {}

InputError InputError::in_file(const std::string& file) const {
  return InputError(file_.empty() ? file : file_, entity_, reason_);
}

namespace internal {

void throw_precondition(const char* condition, const char* file, int line,
                        const std::string& values) {
  std::ostringstream text;
  text << "requirement failed: " << condition << " at " << file << ':' << line;
  if (!values.empty()) text << " with " << values;
  throw PreconditionError(text.str());
}

}  // namespace internal
}  // namespace isochor
