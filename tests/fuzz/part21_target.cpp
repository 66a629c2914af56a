// The text of STEP files: spans rise and stay inside, records are whole, and the shapes it states
// can be counted.
#include "isochor/base/error.h"
#include "isochor/step/import_text.h"
#include "isochor/step/part21.h"
#include "isochor/step/step_records.h"
#include "target.h"

namespace {

// The words lie inside the text, with a byte behind each; every list stands before the record
// around it and is an argument once.
void scan(const std::string& text) {
  using isochor::fuzz::promise;
  const auto found = isochor::internal::scan_step(text, 0);
  if (!found) return;
  const auto inside = [&](const isochor::internal::TextSpan& word) {
    promise(word.begin <= word.end && word.end < text.size(), "a word lies outside the text");
  };
  std::size_t arguments = 0;
  std::uint32_t lists = 0;  // that no record has taken yet
  for (const auto& record : found->records) {
    inside(record.ident);
    inside(record.type);
    promise(record.first == arguments && record.list <= found->lists,
            "records do not follow each other");
    arguments += record.count;
    promise(arguments <= found->arguments.size(), "a record has more arguments than there are");
    for (std::uint32_t k = 0; k < record.count; ++k) {
      const auto& argument = found->arguments[record.first + k];
      inside(argument.text);
      if (argument.kind != isochor::internal::Part21Kind::kList) continue;
      promise(lists > 0 && argument.list <= found->lists, "a list stands nowhere");
      --lists;
    }
    if (record.list > 0) ++lists;
    if (record.list == 0) promise(lists == 0, "a list belongs to no record");
  }
  promise(arguments == found->arguments.size() && found->header <= found->records.size(),
          "arguments belong to no record");
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using isochor::fuzz::promise;
  scan(isochor::fuzz::text_of(data, size));
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
