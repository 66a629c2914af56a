// The one wall behind which OpenCASCADE's exceptions and signals stay. Internal to `step`.
//
// Standard_Failure of OpenCASCADE 7.6 is not a std::exception, and its algorithms dereference null
// handles on damaged files. To be used in a child process only: signal handlers are replaced.
#pragma once

#include <functional>
#include <string>

namespace isochor::internal {

struct OcctFault {
  enum Kind { kNone, kFailure, kSignal, kOutOfMemory };
  Kind kind = kNone;
  std::string text;  // kNone: the result of the work; else the failure in words
};

// Runs `work` with OpenCASCADE's messages silenced and its signal handlers installed. Exceptions
// that are not OpenCASCADE's pass through.
OcctFault behind_occt_wall(const std::function<std::string()>& work);

}  // namespace isochor::internal
