// Integers of any size.
//
// A value type over FLINT's fmpz; numbers below 2^62 need no allocation. No FLINT header appears
// here: the one machine word is FLINT's own handle, which only exact's sources interpret.
#pragma once

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
  // *this 2^exponent; exponent >= 0.
  Integer shifted(unsigned long exponent) const;
  // *this / b where b is known to divide; PreconditionError when b is zero.
  Integer divided_exactly(const Integer& b) const;

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
  friend Integer lcm(const Integer& a, const Integer& b);

 private:
  friend class Rational;
  long word_ = 0;  // FLINT's fmpz
};

int compare(const Integer& a, const Integer& b);
// The least common multiple, non-negative; zero when either is zero.
Integer lcm(const Integer& a, const Integer& b);

}  // namespace isochor
