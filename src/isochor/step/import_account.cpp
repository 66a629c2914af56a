#include "isochor/step/import_account.h"

#include <sstream>

namespace isochor {
namespace {

constexpr size_t kNamed = 5;

std::string first_of(const std::vector<std::string>& texts, const char* between) {
  std::string text;
  for (size_t k = 0; k < texts.size() && k < kNamed; ++k) text += (k > 0 ? between : "") + texts[k];
  if (texts.size() > kNamed) text += between + std::to_string(texts.size() - kNamed) + " more";
  return text;
}

std::string counted(int count, const char* one, const char* more) {
  return std::to_string(count) + " " + (count == 1 ? one : more);
}

std::string counted(const std::vector<std::string>& faces) {
  return counted(static_cast<int>(faces.size()), "face", "faces");
}

}  // namespace

std::vector<std::string> SewingAccount::lines() const {
  if (!declined.empty()) return {"not sewn: " + declined};
  if (!done) return {};
  std::ostringstream text;
  text.precision(2);
  text << "sewn within " << tolerance << ": " << counted(faces, "face", "faces") << " in "
       << counted(shells, "shell", "shells") << ", " << counted(solids, "solid", "solids") << "; "
       << counted(free_edges_after, "free edge is", "free edges are") << " left of "
       << free_edges_before;
  std::vector<std::string> lines = {text.str()};
  if (solids > 1) lines.push_back("each closed shell is a solid: none is the hollow of another");
  if (!dropped.empty()) {
    lines.push_back(counted(dropped) + " without area dropped (by the numbers of the file: " +
                    first_of(dropped, ", ") + "); the others are numbered without " +
                    (dropped.size() == 1 ? "it" : "them"));
  }
  if (!turned.empty()) {
    lines.push_back(counted(turned) + " turned round by sewing (by the numbers of the file: " +
                    first_of(turned, ", ") + ")");
  }
  return lines;
}

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
