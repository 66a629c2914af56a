// Integers of any size.
//
// A value type over FLINT's fmpz; numbers below 2^62 need no allocation. No FLINT header appears
// here: the one machine word is FLINT's own handle, which only exact's sources interpret.
#pragma once

#include <optional>
#include <string>
#include <utility>

namespace isochor {

class Integer {
 public:
  Integer() = default;
  Integer(long value);  // NOLINT: an integer literal is an Integer
  Integer(const Integer& other);
  Integer(Integer&& other) noexcept : word_(std::exchange(other.word_, 0)) {}
  Integer& operator=(const Integer& other);
  Integer& operator=(Integer&& other) noexcept {
    std::swap(word_, other.word_);
    return *this;
  }
  ~Integer();

  Integer& operator+=(const Integer& b);
  Integer& operator-=(const Integer& b);
  Integer& operator*=(const Integer& b);
  friend Integer operator+(Integer a, const Integer& b) { return std::move(a += b); }
  friend Integer operator-(Integer a, const Integer& b) { return std::move(a -= b); }
  friend Integer operator*(Integer a, const Integer& b) { return std::move(a *= b); }
  Integer operator-() const;

  // *this += a b, without a temporary. The workhorse of exact contractions.
  void add_product(const Integer& a, const Integer& b);
  void add_product(const Integer& a, long b);
  // *this -= a b, likewise.
  void subtract_product(const Integer& a, const Integer& b);
  // *this 2^exponent; exponent >= 0.
  Integer shifted(unsigned long exponent) const;
  // *this / b where b is known to divide; PreconditionError when b is zero.
  Integer divided_exactly(const Integer& b) const;
  // The same in place.
  void divide_exactly(const Integer& b);
  // The largest integer not above *this / b, and the nearest one (ties upwards). PreconditionError
  // when b is zero.
  Integer divided_floor(const Integer& b) const;
  Integer divided_nearest(const Integer& b) const;
  // Whether b divides; zero divides only zero.
  bool is_multiple_of(const Integer& b) const;
  // The remainder in [0, modulus). PreconditionError when the modulus is zero.
  unsigned long modulo(unsigned long modulus) const;
  // The value when it fits a long.
  std::optional<long> to_long() const;
  // The nearest double towards zero; infinite beyond the range.
  double to_double() const;
  Integer abs() const { return sign() < 0 ? -*this : *this; }

  int sign() const;  // -1, 0, 1
  bool is_zero() const { return word_ == 0; }
  // Binary digits of |*this|; 0 for zero.
  unsigned long bits() const;
  // Decimal.
  std::string to_string() const;

  friend int compare(const Integer& a, const Integer& b);  // sign of a - b
  friend bool operator==(const Integer& a, const Integer& b) { return compare(a, b) == 0; }
  friend bool operator!=(const Integer& a, const Integer& b) { return compare(a, b) != 0; }
  friend bool operator<(const Integer& a, const Integer& b) { return compare(a, b) < 0; }
  friend int compare_magnitudes(const Integer& a, const Integer& b);  // sign of |a| - |b|
  friend Integer lcm(const Integer& a, const Integer& b);
  friend Integer gcd(const Integer& a, const Integer& b);

 private:
  friend class IntegerMatrix;
  friend class Rational;
  long word_ = 0;  // FLINT's fmpz
};

int compare(const Integer& a, const Integer& b);
int compare_magnitudes(const Integer& a, const Integer& b);
// The least common multiple, non-negative; zero when either is zero.
Integer lcm(const Integer& a, const Integer& b);
// The greatest common divisor, non-negative; |a| when b is zero.
Integer gcd(const Integer& a, const Integer& b);

}  // namespace isochor
