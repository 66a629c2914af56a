#include "interrupt.h"

#include <csignal>

namespace isochor::app {
namespace {

// A handler has no arguments of ours. Raising a token is one store into a lock-free atomic.
const CancelToken* raised_by_signals = nullptr;

void on_signal(int /*signal*/) { raised_by_signals->cancel(); }

}  // namespace

void cancel_on_signals(const CancelToken& token) {
  static CancelToken kept;
  kept = token;
  raised_by_signals = &kept;
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESETHAND | SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace isochor::app
