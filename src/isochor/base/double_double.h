// Numbers of twice the precision of double: the unevaluated sum of two doubles.
//
// The algorithms are the classical ones without fused multiply-add (Dekker 1971; error bounds from
// M. Joldes, J.-M. Muller, V. Popescu, "Tight and rigorous error bounds for basic building blocks
// of double-word arithmetic", ACM TOMS 44(2), 2017): sums, products and quotients carry a relative
// error below kUnit. Valid while no intermediate result overflows or becomes subnormal.
//
// Laws (tests/base/double_double_test.cpp, against rationals):
//  (1) normal:   |low| <= half a unit in the last place of high, so high is the nearest double
//  (2) accuracy: every operation is within kUnit, relative, of the exact result
#pragma once

#include <cmath>

namespace isochor {

class DoubleDouble {
 public:
  // 15 u^2 with u = 2^-53 holds for all four operations; rounded up to a power of two.
  static constexpr double kUnit = 0x1p-102;

  DoubleDouble() = default;
  DoubleDouble(double value) : high_(value) {}  // exact, so implicit

  double high() const { return high_; }
  double low() const { return low_; }

  friend DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble s = two_sum(a.high_, b.high_);
    const DoubleDouble t = two_sum(a.low_, b.low_);
    const DoubleDouble v = fast_two_sum(s.high_, s.low_ + t.high_);
    return fast_two_sum(v.high_, t.low_ + v.low_);
  }
  friend DoubleDouble operator-(const DoubleDouble& a) { return {-a.high_, -a.low_}; }
  friend DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + (-b); }
  friend DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble p = two_product(a.high_, b.high_);
    const double cross = a.high_ * b.low_ + a.low_ * b.high_;
    return fast_two_sum(p.high_, p.low_ + cross);
  }
  friend DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
    const double first = a.high_ / b.high_;
    const DoubleDouble rest = a - b * DoubleDouble(first);
    const double second = rest.high_ / b.high_;
    const double third = (rest - b * DoubleDouble(second)).high_ / b.high_;
    return fast_two_sum(first, second) + DoubleDouble(third);
  }
  DoubleDouble& operator+=(const DoubleDouble& b) { return *this = *this + b; }
  DoubleDouble& operator-=(const DoubleDouble& b) { return *this = *this - b; }
  DoubleDouble& operator*=(const DoubleDouble& b) { return *this = *this * b; }

  // a + b and a b exactly.
  static DoubleDouble two_sum(double a, double b) {
    const double s = a + b;
    const double b_part = s - a;
    const double a_part = s - b_part;
    return {s, (a - a_part) + (b - b_part)};
  }
  static DoubleDouble two_product(double a, double b) {
    const double p = a * b;
    const Halves x = split(a), y = split(b);
    return {p, ((x.top * y.top - p) + x.top * y.rest + x.rest * y.top) + x.rest * y.rest};
  }

 private:
  struct Halves {
    double top, rest;
  };
  DoubleDouble(double high, double low) : high_(high), low_(low) {}
  // a + b exactly for |a| >= |b|, or a zero.
  static DoubleDouble fast_two_sum(double a, double b) {
    const double s = a + b;
    return {s, b - (s - a)};
  }
  // a as the sum of two numbers of 26 bits.
  static Halves split(double a) {
    const double scaled = 0x1.0000002p+27 * a;  // 2^27 + 1
    const double top = scaled - (scaled - a);
    return {top, a - top};
  }

  double high_ = 0.0;
  double low_ = 0.0;
};

inline DoubleDouble abs(const DoubleDouble& a) { return a.high() < 0.0 ? -a : a; }
inline double to_double(const DoubleDouble& a) { return a.high(); }
inline double to_double(double a) { return a; }

}  // namespace isochor
