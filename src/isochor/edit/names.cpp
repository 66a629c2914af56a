#include "isochor/edit/names.h"

#include <algorithm>
#include <vector>

#include "isochor/base/error.h"
#include "isochor/bspline/joins.h"

namespace isochor {

int find_patch(const PatchModel& model, const std::string& name) {
  std::vector<int> found;
  for (size_t q = 0; q < model.patches.size(); ++q) {
    const Patch& patch = model.patches[q];
    const bool alias =
        std::find(patch.aliases.begin(), patch.aliases.end(), name) != patch.aliases.end();
    if (patch.handle == name) return static_cast<int>(q);  // handles are unique
    if ((patch.name == name && !name.empty()) || alias) found.push_back(static_cast<int>(q));
  }
  if (found.size() == 1) return found.front();
  constexpr size_t kMostListed = 12;
  std::string listed;
  size_t count = 0;
  for (size_t q = 0; q < model.patches.size(); ++q) {
    const bool candidate =
        found.empty() || std::find(found.begin(), found.end(), static_cast<int>(q)) != found.end();
    if (!candidate) continue;
    if (++count > kMostListed) {
      listed += ", ...";
      break;
    }
    listed += (listed.empty() ? "" : ", ") + label_of(model.patches[q]);
  }
  if (found.empty()) {
    throw InputError("", "patch \"" + name + "\"", "no such patch; there are: " + listed);
  }
  throw InputError("", "patch \"" + name + "\"", "the name is ambiguous, use one of: " + listed);
}

}  // namespace isochor
