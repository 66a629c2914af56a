// Time that the thread itself has spent computing, so that other programs disturb little.
#pragma once

#include <ctime>
#include <limits>

namespace isochor::bench {

inline double seconds_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}
inline double thread_cpu_seconds() { return seconds_of(CLOCK_THREAD_CPUTIME_ID); }
inline double process_cpu_seconds() { return seconds_of(CLOCK_PROCESS_CPUTIME_ID); }

// How long to go on: at least so many repetitions, and at least so long altogether.
struct Patience {
  int repetitions = 5;
  double seconds = 0.3;
};

// The smallest time of one call of `work` by the given clock.
template <typename Work>
double best_seconds(clockid_t clock, const Work& work, const Patience& patience) {
  double best = std::numeric_limits<double>::infinity(), total = 0.0;
  for (int done = 0; done < patience.repetitions || total < patience.seconds; ++done) {
    const double begin = seconds_of(clock);
    work();
    const double taken = seconds_of(clock) - begin;
    if (taken < best) best = taken;
    total += taken;
  }
  return best;
}

template <typename Work>
double best_cpu_seconds(const Work& work, const Patience& patience) {
  return best_seconds(CLOCK_THREAD_CPUTIME_ID, work, patience);
}

}  // namespace isochor::bench
