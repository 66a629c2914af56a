// A moving bar on stderr while something takes longer than a second.
//
// Reading and writing CAD files tells how far it has come; a factorisation does not, and the bar
// then shows only that the program lives, at what, and for how long.
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

  // For the work that is shown; it must not outlive the line.
  Watch watch();

 private:
  void run();

  const CancelToken cancel_;
  std::string step_;
  double fraction_ = -1.0;  // negative: not known
  std::string stage_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool done_ = false;
  std::thread thread_;
};

}  // namespace isochor::app
