#include "isochor/step/import_account.h"

namespace isochor {
namespace {

constexpr size_t kNamed = 5;

std::string first_of(const std::vector<std::string>& texts, const char* between) {
  std::string text;
  for (size_t k = 0; k < texts.size() && k < kNamed; ++k) text += (k > 0 ? between : "") + texts[k];
  if (texts.size() > kNamed) text += between + std::to_string(texts.size() - kNamed) + " more";
  return text;
}

}  // namespace

std::string ImportAccount::objection() const {
  if (!lost.empty()) {
    return std::to_string(lost.size()) + " of the " + std::to_string(stated.faces) +
           " faces that the file states could not be read: " + first_of(lost, ", ");
  }
  if (!broken.empty()) {
    return "the text breaks the rules of STEP, so it is not known what was read: " +
           first_of(broken, "; ");
  }
  return "";
}

}  // namespace isochor
