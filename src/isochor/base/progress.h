// Progress reports and cancellation, passed by value through long computations.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string_view>

namespace isochor {

// A flag that any thread may raise; copies share it.
class CancelToken {
 public:
  CancelToken() : flag_(std::make_shared<std::atomic<bool>>(false)) {}
  void cancel() const { flag_->store(true, std::memory_order_relaxed); }
  bool cancelled() const { return flag_->load(std::memory_order_relaxed); }

 private:
  std::shared_ptr<std::atomic<bool>> flag_;
};

// Called with a fraction in [0, 1] and a short name of the step; may be empty.
using ProgressCallback = std::function<void(double fraction, std::string_view step)>;

// What long work is handed: whom to tell how far it has come, and where to see that it should end.
struct Watch {
  CancelToken cancel;
  ProgressCallback progress;

  // For a part of the work that takes the fractions from `begin` to `end`.
  Watch part(double begin, double end) const {
    if (!progress) return *this;
    const ProgressCallback whole = progress;
    return {cancel, [=](double fraction, std::string_view step) {
              whole(begin + fraction * (end - begin), step);
            }};
  }
};

}  // namespace isochor
