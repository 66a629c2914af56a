#include "isochor/ecles/prime_field.h"

#include <initializer_list>

namespace isochor::internal {
namespace {

Residue power(const PrimeField& field, Residue base, Residue exponent) {
  Residue result = 1;
  for (; exponent != 0; exponent >>= 1) {
    if ((exponent & 1) != 0) result = field.multiply(result, base);
    base = field.multiply(base, base);
  }
  return result;
}

// Miller and Rabin's test; these bases decide every odd number of 64 bits (Sorenson, Webster 2015).
bool is_prime(Residue n) {
  const PrimeField field(n);
  Residue odd = n - 1;
  int twos = 0;
  for (; odd % 2 == 0; odd /= 2) ++twos;
  for (const Residue base : {2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37}) {
    Residue value = power(field, base, odd);
    bool passed = value == 1 || value == n - 1;
    for (int i = 1; i < twos && !passed; ++i) {
      value = field.multiply(value, value);
      passed = value == n - 1;
    }
    if (!passed) return false;
  }
  return true;
}

}  // namespace

Residue PrimeField::inverse(Residue a) const {
  // Euclid: each remainder is its coefficient times a, modulo p.
  std::int64_t before = 0, coefficient = 1;
  Residue larger = p_, smaller = a;
  while (smaller > 1) {
    const Residue quotient = larger / smaller;
    const Residue rest = larger - quotient * smaller;
    const std::int64_t next = before - static_cast<std::int64_t>(quotient) * coefficient;
    before = coefficient;
    coefficient = next;
    larger = smaller;
    smaller = rest;
  }
  return coefficient < 0 ? p_ - static_cast<Residue>(-coefficient)
                         : static_cast<Residue>(coefficient);
}

Residue PrimeField::of(long value) const {
  const Residue magnitude =
      (value < 0 ? 0 - static_cast<Residue>(value) : static_cast<Residue>(value));
  const Residue rest = magnitude < p_ ? magnitude : magnitude % p_;
  return value < 0 ? negative(rest) : rest;
}

unsigned long elimination_prime(int index) {
  Residue prime = (Residue{1} << 61) - 1;
  for (; index > 0; --index) {
    do {
      prime -= 2;
    } while (!is_prime(prime));
  }
  return prime;
}

}  // namespace isochor::internal
