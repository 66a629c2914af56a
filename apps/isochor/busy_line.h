// A moving bar on stderr while something takes longer than a second.
//
// The work is done by OpenCASCADE in a child process or by one factorisation: neither says how far
// it has come, so the bar shows that the program lives, at what, and for how long.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "commands.h"

namespace isochor::app {

// Shows `step` until it goes out of scope, then clears the line. Silent with --quiet, with
// --progress never, and where stderr is not a terminal.
class BusyLine {
 public:
  BusyLine(const Common& common, std::string step);
  ~BusyLine();
  BusyLine(const BusyLine&) = delete;
  BusyLine& operator=(const BusyLine&) = delete;

 private:
  void run();

  std::string step_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool done_ = false;
  std::thread thread_;
};

}  // namespace isochor::app
