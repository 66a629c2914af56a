// The text of STEP files: spans rise and stay inside, and the shapes it states can be counted.
#include "isochor/base/error.h"
#include "isochor/step/import_text.h"
#include "isochor/step/part21.h"
#include "target.h"

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using isochor::fuzz::promise;
  try {
    const isochor::internal::Part21File file("fuzz.step", isochor::fuzz::text_of(data, size));
    ++isochor::fuzz::accepted;
    std::size_t behind = 0;
    for (const auto& instance : file.instances()) {
      promise(behind <= instance.span.begin && instance.span.begin <= instance.body.begin &&
                  instance.body.begin <= instance.body.end &&
                  instance.body.end <= instance.span.end && instance.span.end <= size,
              "the span of an instance lies outside the text or overlaps another");
      promise(file.find(instance.number) == &instance, "an instance is not found by its number");
      behind = instance.span.end;
    }
    const auto shapes = isochor::internal::stated_shapes(file);
    promise(shapes.counts.faces == static_cast<int>(shapes.faces.size()), "faces are miscounted");
    promise(shapes.counts.faces + shapes.unused.size() <= file.instances().size(),
            "more faces than instances");
  } catch (const isochor::InputError&) {
    return 0;
  }
  return 0;
}
