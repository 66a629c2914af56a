// Constraint problems: what is accepted is written and read again without change.
#include "isochor/base/error.h"
#include "isochor/io/problem_json.h"
#include "target.h"

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  isochor::ProblemFile file;
  try {
    file = isochor::parse_problem(isochor::fuzz::text_of(data, size), "fuzz.json");
  } catch (const isochor::InputError&) {
    return 0;
  }
  ++isochor::fuzz::accepted;
  const std::string once = isochor::format_problem(file.problem);
  const std::string twice =
      isochor::format_problem(isochor::parse_problem(once, "again.json").problem);
  isochor::fuzz::promise(once == twice, "a problem changes when it is written and read");
  return 0;
}
