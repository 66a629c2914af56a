#include "isochor/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace isochor {
namespace {

// The tasks of one call, and what went wrong with them.
class Queue {
 public:
  Queue(int count, const std::function<void(int)>& task) : count_(count), task_(task) {}

  void work() {
    for (int k = next_++; k < count_; k = next_++) {
      try {
        task_(k);
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (k < failed_) {
          failed_ = k;
          error_ = std::current_exception();
        }
        next_ = count_;
      }
    }
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  const int count_;
  const std::function<void(int)>& task_;
  std::atomic<int> next_{0};
  std::mutex mutex_;
  int failed_ = std::numeric_limits<int>::max();
  std::exception_ptr error_;
};

}  // namespace

void run_tasks(int count, int threads, const std::function<void(int)>& task) {
  Queue queue(count, task);
  std::vector<std::thread> others;
  for (int t = 1; t < std::min(threads, count); ++t) {
    try {
      others.emplace_back([&queue] { queue.work(); });
    } catch (const std::system_error&) {
      break;  // no more threads to be had: those that run do the work
    }
  }
  queue.work();
  for (std::thread& other : others) other.join();
  queue.rethrow();
}

}  // namespace isochor
