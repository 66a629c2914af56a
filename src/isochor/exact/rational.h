// Rational numbers, exact.
//
// A value type over FLINT's fmpq, always in lowest terms with a positive denominator.
//
// Laws (tests of those names in tests/exact/rational_test.cpp):
//  (1) field:        + - * / are exact and obey the field's laws
//  (2) dyadic:       Rational(x).to_double() == x for every finite double x
//  (3) nearest:      to_double() is the double nearest to the value, ties to even
//  (4) enclosure:    low <= value <= high, and low == high exactly when the value is a double
//  (5) text:         parse(to_string()) gives the number back
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "isochor/exact/integer.h"

namespace isochor {

// Two doubles around an exact value; adjacent, or equal.
struct Enclosure {
  double low = 0.0;
  double high = 0.0;
};

class Rational {
 public:
  Rational() = default;
  Rational(long value);  // NOLINT: an integer literal is a Rational
  Rational(int value) : Rational(static_cast<long>(value)) {}  // NOLINT: the same
  Rational(const Integer& value);  // NOLINT: every integer is a Rational
  // The exact value of a double. PreconditionError when it is not finite.
  explicit Rational(double value);
  // numerator / denominator, reduced. PreconditionError when the denominator is zero.
  Rational(const Integer& numerator, const Integer& denominator);
  Rational(const Rational& other);
  Rational(Rational&& other) noexcept;
  Rational& operator=(const Rational& other);
  Rational& operator=(Rational&& other) noexcept;
  ~Rational();

  // "3", "-3/2", "0.1", "1e-3", "+2.5E+7": exactly that number. No spaces, no hexadecimal, decimal
  // exponents between -9999 and 9999. Throws InputError (entity: the text) with the reason.
  static Rational parse(std::string_view text);
  // The fraction n / d with n == d residue modulo m and |n|, d <= sqrt((m - 1) / 2), which is
  // unique; nothing when there is none. residue in [0, m), m > 2.
  static std::optional<Rational> reconstruct(const Integer& residue, const Integer& modulus);

  Rational& operator+=(const Rational& b);
  Rational& operator-=(const Rational& b);
  Rational& operator*=(const Rational& b);
  Rational& operator/=(const Rational& b);  // PreconditionError when b is zero
  friend Rational operator+(Rational a, const Rational& b) { return std::move(a += b); }
  friend Rational operator-(Rational a, const Rational& b) { return std::move(a -= b); }
  friend Rational operator*(Rational a, const Rational& b) { return std::move(a *= b); }
  friend Rational operator/(Rational a, const Rational& b) { return std::move(a /= b); }
  Rational operator-() const;
  Rational abs() const { return sign() < 0 ? -*this : *this; }
  // *this 2^exponent, exponent of either sign.
  Rational scaled_by_power_of_two(long exponent) const;

  int sign() const;  // -1, 0, 1
  bool is_zero() const { return sign() == 0; }
  Integer numerator() const;
  Integer denominator() const;

  // "3" or "-3/2".
  std::string to_string() const;
  // The nearest double, ties to even; infinite beyond the range of double, gradual below it.
  double to_double() const;
  Enclosure enclosure() const;

  friend int compare(const Rational& a, const Rational& b);  // sign of a - b
  friend bool operator==(const Rational& a, const Rational& b) { return compare(a, b) == 0; }
  friend bool operator!=(const Rational& a, const Rational& b) { return compare(a, b) != 0; }
  friend bool operator<(const Rational& a, const Rational& b) { return compare(a, b) < 0; }
  friend bool operator>(const Rational& a, const Rational& b) { return compare(a, b) > 0; }
  friend bool operator<=(const Rational& a, const Rational& b) { return compare(a, b) <= 0; }
  friend bool operator>=(const Rational& a, const Rational& b) { return compare(a, b) >= 0; }

 private:
  // FLINT's fmpq: numerator and denominator, each an fmpz.
  struct Words {
    long numerator = 0;
    long denominator = 1;
  };
  Words words_;
};

int compare(const Rational& a, const Rational& b);

}  // namespace isochor
