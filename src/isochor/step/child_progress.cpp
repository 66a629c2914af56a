#include "isochor/step/child_progress.h"

#include <algorithm>
#include <chrono>
#include <string>

namespace isochor::internal {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kLeastAdvance = 0.005;
constexpr std::chrono::milliseconds kLeastPause(10);

struct Teller {
  ProgressSink sink;
  double begin = 0.0, end = 1.0;  // of the innermost part
  double told = -1.0;
  Clock::time_point when;
  std::string step;
};

Teller& teller() {
  static Teller of_this_process;
  return of_this_process;
}

}  // namespace

void tell_progress(double fraction, std::string_view step) {
  Teller& t = teller();
  if (!t.sink) return;
  const double inside = std::clamp(fraction, 0.0, 1.0);
  const double whole = std::max(t.told, t.begin + inside * (t.end - t.begin));
  if (step == t.step && whole < 1.0) {
    if (whole < t.told + kLeastAdvance || Clock::now() < t.when + kLeastPause) return;
  }
  t.told = whole;
  t.when = Clock::now();
  t.step = step;
  t.sink(whole, step);
}

ProgressPart::ProgressPart(double begin, double end)
    : outer_begin_(teller().begin), outer_end_(teller().end) {
  const double length = outer_end_ - outer_begin_;
  teller().begin = outer_begin_ + begin * length;
  teller().end = outer_begin_ + end * length;
}

ProgressPart::~ProgressPart() {
  teller().begin = outer_begin_;
  teller().end = outer_end_;
}

void set_progress_sink(ProgressSink sink) {
  teller() = Teller{};
  teller().sink = std::move(sink);
}

}  // namespace isochor::internal
