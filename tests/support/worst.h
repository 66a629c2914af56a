// The worst deviation from a law that a test measured, kept in its record for
// tools/acceptance/laws.py.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

namespace isochor::testing {

// Usage: Worst worst("gradient", 1e-14); ... EXPECT_TRUE(worst.see(error)) << where;
// When it goes out of scope it records the test's properties worst_NAME and bound_NAME.
class Worst {
 public:
  Worst(std::string name, double bound) : name_(std::move(name)), bound_(bound) {}
  Worst(const Worst&) = delete;
  Worst& operator=(const Worst&) = delete;
  ~Worst() {
    EXPECT_TRUE(seen_) << name_ << " was never measured";
    ::testing::Test::RecordProperty("worst_" + name_, text(worst_));
    ::testing::Test::RecordProperty("bound_" + name_, text(bound_));
  }

  // Whether the deviation is within the bound; NaN is not, and stays the worst.
  ::testing::AssertionResult see(double deviation) {
    seen_ = true;
    if (!std::isnan(worst_) && !(deviation <= worst_)) worst_ = deviation;
    if (deviation <= bound_) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure()
           << name_ << " deviates by " << text(deviation) << ", more than " << text(bound_);
  }

 private:
  static std::string text(double x) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.17g", x);
    return buffer;
  }

  std::string name_;
  double bound_;
  double worst_ = 0.0;
  bool seen_ = false;
};

}  // namespace isochor::testing
