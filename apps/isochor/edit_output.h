// Writing what an edit made: the model in the asked format.
#pragma once

#include <string>
#include <vector>

#include "isochor/edit/edit_session.h"
#include "isochor/io/value.h"
#include "model_source.h"

namespace isochor::app {

// What came of writing the model.
struct WrittenModel {
  bool written = false;
  std::string refusal;             // when not written: why
  Value::Object report;            // top-level keys for the report
  std::vector<std::string> lines;  // for people
};

// Writes the session's model to `output`, complete or not at all.
// `trim_tolerance`: how far faces may part at trimming curves that have moved; 0: none has.
// Throws InputError when the file cannot be written.
WrittenModel write_edited_model(const LoadedModel& before, const EditSession& session,
                                const std::string& output, double trim_tolerance,
                                const Common& common);

}  // namespace isochor::app
