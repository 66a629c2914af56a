// Patch models: what is accepted is written and read again without change.
#include "isochor/base/error.h"
#include "isochor/io/model_json.h"
#include "target.h"

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  isochor::PatchModel model;
  try {
    model = isochor::parse_model(isochor::fuzz::text_of(data, size), "fuzz.isochor.json");
  } catch (const isochor::InputError&) {
    return 0;
  }
  ++isochor::fuzz::accepted;
  const std::string once = isochor::format_model(model);
  const std::string twice = isochor::format_model(isochor::parse_model(once, "again.isochor.json"));
  isochor::fuzz::promise(once == twice, "a model changes when it is written and read");
  return 0;
}
