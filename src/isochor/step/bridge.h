// Runs work in a child process, so that no file can crash, hang or exhaust this one.
//
// Readers of CAD files die on damaged input (28 % of mutated STEP files end OpenCASCADE 7.6 by a
// signal or a loop). The work is a closure; the child sees a copy of this process's memory, so
// arguments need no copying and only the result travels back, as bytes (see bytes.h).
//
// Laws:
//  (1) the parent survives whatever the child does, and always learns how it ended;
//  (2) no child outlives the call, and no descriptor or zombie is left behind;
//  (3) an InputError thrown by the work arrives here as the same InputError;
//  (4) the child prints nothing: its standard streams lead nowhere;
//  (5) progress arrives in order and never goes back.
// The work must not wait for other threads of this process: they do not exist in the child.
#pragma once

#include <functional>
#include <string>

#include "isochor/base/error.h"
#include "isochor/base/progress.h"
#include "isochor/step/bytes.h"
#include "isochor/step/solid_model.h"

namespace isochor {

enum class ChildEnd {
  kFinished,  // `bytes` is the result
  kFailed,    // an exception; `reason` is its text, `file` and `entity` those of an InputError
  kDied,      // by `signal`
  kTimedOut,
  kOutOfMemory,
  kCancelled,
};

// How a child ended. `reason` says so in words unless it finished.
struct ChildResult {
  ChildEnd end = ChildEnd::kFailed;
  std::string bytes;
  std::string file, entity, reason;
  int signal = 0;
};

// Runs `work` in a child and waits. Elapsed time is limited too, to a multiple of the processor
// time, because a child may wait for ever. Address space is not limited under sanitizers, which
// reserve terabytes. The work tells its progress by child_progress.h. Throws std::system_error when
// no process can be started.
ChildResult run_child(const std::function<std::string()>& work, const BridgeLimits& limits = {},
                      const Watch& watch = {});

// The same for callers that can use only a result. Throws CancelledError, LimitError, or another
// InputError about `file` otherwise.
std::string run_in_child(const std::string& file, const std::function<std::string()>& work,
                         const BridgeLimits& limits = {}, const Watch& watch = {});

// A typed result: T must be known to bytes.h.
template <typename T>
T call_in_child(const std::string& file, const std::function<T()>& work,
                const BridgeLimits& limits = {}, const Watch& watch = {}) {
  std::string bytes = run_in_child(
      file, [&work] { return internal::to_bytes(work()); }, limits, watch);
  try {
    return internal::from_bytes<T>(std::move(bytes));
  } catch (const internal::BytesError& e) {
    throw InputError(file, "", e.what());
  }
}

}  // namespace isochor
