// Edit scripts: what is accepted is written and read again without change.
#include "isochor/base/error.h"
#include "isochor/io/edits_json.h"
#include "target.h"

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  isochor::EditScript script;
  try {
    script = isochor::parse_edits(isochor::fuzz::text_of(data, size), "fuzz.json");
  } catch (const isochor::InputError&) {
    return 0;
  }
  ++isochor::fuzz::accepted;
  const std::string once = isochor::format_edits(script);
  const std::string twice = isochor::format_edits(isochor::parse_edits(once, "again.json"));
  isochor::fuzz::promise(once == twice, "an edit script changes when it is written and read");
  return 0;
}
