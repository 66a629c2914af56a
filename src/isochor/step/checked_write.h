// Writing that proves itself: change, check, write, read back in a fresh process, compare, and only
// then put the file in its place. Internal to `step`.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "isochor/step/document.h"
#include "isochor/step/solid_model.h"

namespace isochor::internal {

struct WriteJob {
  std::string input;                 // named in errors
  std::function<Document()> source;  // called in child processes, more than once
  std::vector<EditedFace> edits;     // may be empty
  std::vector<int> convert;          // faces to turn into B-spline before they are edited
  std::string output;
  double trim_tolerance = 0.0;  // as in write_edited
  // The STEP file that `source` reads, when its own lines may be edited; else empty.
  std::string step_text;
  BridgeLimits limits;
  Watch watch;
  bool must_be_valid = true;  // false: an invalid input may be written as it is
};

// STEP to STEP goes line by line (see surgical.h). Where that cannot be done, or what is read back
// is not what was meant, OpenCASCADE's writer is tried: with parameter curves, then without. The
// report says which way was taken, and why not the ones before.
// Throws InputError when the input cannot be read or the output cannot be created.
WriteReport write_checked(const WriteJob& job);

}  // namespace isochor::internal
