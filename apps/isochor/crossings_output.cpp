#include "crossings_output.h"

#include <algorithm>

#include "terminal.h"

namespace isochor::app {

Value to_value(const SolidModel& solid, const CrossingsAccount& account) {
  Value undecided = Value::list();
  for (const auto& [a, b] : account.undecided_pairs) {
    undecided.push(std::vector<std::string>{solid.faces[static_cast<size_t>(a)].handle,
                                            solid.faces[static_cast<size_t>(b)].handle});
  }
  return Value::object()
      .set("pairs", account.pairs)
      .set("apart", account.apart)
      .set("neighbours_apart", account.neighbours)
      .set("crossing", account.crossing)
      .set("undecided", account.undecided)
      .set("undecided_pairs", undecided)
      .set("faces", account.faces)
      .set("faces_free", account.faces_free)
      .set("faces_crossing", account.faces_crossing)
      .set("faces_undecided", account.faces_undecided);
}

std::string crossings_text(const SolidModel& solid, const CrossingsAccount& account) {
  std::string text = format(
      "%ld pairs of faces: %ld proven apart, %ld neighbours proven apart but along what they "
      "share, %ld cut through each other, %ld undecided",
      account.pairs, account.apart, account.neighbours, account.crossing, account.undecided);
  constexpr size_t kListed = 3;
  for (size_t k = 0; k < std::min(kListed, account.undecided_pairs.size()); ++k) {
    const auto& [a, b] = account.undecided_pairs[k];
    text += (k == 0 ? " (" : ", ") + solid.faces[static_cast<size_t>(a)].handle + " and " +
            solid.faces[static_cast<size_t>(b)].handle;
  }
  if (!account.undecided_pairs.empty()) {
    text += account.undecided > static_cast<long>(kListed) ? ", ...)" : ")";
  }
  return text + format("; of %ld faces %ld proven free of themselves, %ld not, %ld undecided",
                       account.faces, account.faces_free, account.faces_crossing,
                       account.faces_undecided);
}

}  // namespace isochor::app
