#include "busy_line.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "terminal.h"

namespace isochor::app {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kSilent(1);
constexpr std::chrono::milliseconds kTick(100);
constexpr int kWidth = 20;
constexpr int kMark = 4;

// Straight to the descriptor: a child process may be forked at any time, and must not inherit the
// lock or the buffer of a stream.
void write_line(const std::string& text) {
  if (write(STDERR_FILENO, text.data(), text.size()) < 0) return;  // nothing is lost with it
}

// Filled from the left, or a mark that runs to and fro when `fraction` is not known.
std::string bar(double fraction, int tick) {
  if (fraction >= 0.0) {
    const auto filled = static_cast<size_t>(kWidth * std::min(fraction, 1.0));
    return std::string(filled, '=') + std::string(kWidth - filled, ' ');
  }
  const int way = kWidth - kMark;
  const int turn = tick % (2 * way);
  const int at = turn < way ? turn : 2 * way - turn;
  return std::string(static_cast<size_t>(at), ' ') + std::string(kMark, '=') +
         std::string(static_cast<size_t>(way - at), ' ');
}

}  // namespace

BusyLine::BusyLine(const Common& common, std::string step)
    : cancel_(common.cancel), step_(std::move(step)) {
  if (common.quiet || common.progress == "never" || !isatty(STDERR_FILENO)) return;
  thread_ = std::thread([this] { run(); });
}

BusyLine::~BusyLine() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    done_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

Watch BusyLine::watch() {
  return {cancel_, [this](double fraction, std::string_view stage) {
            const std::lock_guard<std::mutex> lock(mutex_);
            fraction_ = fraction;
            stage_ = stage;
          }};
}

void BusyLine::run() {
  const auto start = Clock::now();
  std::unique_lock<std::mutex> lock(mutex_);
  if (changed_.wait_for(lock, kSilent, [this] { return done_; })) return;
  for (int tick = 0; !done_; ++tick) {
    const std::chrono::duration<double> elapsed = Clock::now() - start;
    const std::string stage = stage_.empty() ? "" : ": " + stage_;
    write_line(format("\r\033[K[%s] %s%s  %.0f s", bar(fraction_, tick).c_str(), step_.c_str(),
                      stage.c_str(), elapsed.count()));
    changed_.wait_for(lock, kTick, [this] { return done_; });
  }
  write_line("\r\033[K");
}

}  // namespace isochor::app
