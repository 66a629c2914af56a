// A running sum that carries its own rounding error along.
#pragma once

#include <cmath>

namespace isochor::internal {

// Neumaier's variant of Kahan's summation. After n terms, n < 2^50:
// |total() - exact| <= u |exact| + 2 n^2 u^2 sum |terms|, u the unit roundoff.
class CompensatedSum {
 public:
  void add(double term) {
    const double next = sum_ + term;
    lost_ += std::abs(sum_) >= std::abs(term) ? (sum_ - next) + term : (term - next) + sum_;
    sum_ = next;
  }
  double total() const { return sum_ + lost_; }

 private:
  double sum_ = 0.0;
  double lost_ = 0.0;
};

}  // namespace isochor::internal
