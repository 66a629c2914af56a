// Arithmetic modulo a prime below 2^62, and the sequence of primes that eliminations try.
//
// Numbers are represented by 0 .. p-1. A factor used many times is prepared once (Shoup: with
// f' = floor(2^64 f / p), a f - floor(a f' / 2^64) p lies in [0, 2p)): then a product needs no
// division.
#pragma once

#include <cstdint>

#include "isochor/exact/integer.h"

namespace isochor::internal {

using Residue = std::uint64_t;
__extension__ using Wide = unsigned __int128;

class PrimeField {
 public:
  struct Factor {
    Residue value = 0;
    Residue quotient = 0;  // floor(2^64 value / p)
  };

  explicit PrimeField(unsigned long prime) : p_(prime) {}

  unsigned long prime() const { return p_; }
  Residue add(Residue a, Residue b) const { return reduced(a + b); }
  Residue subtract(Residue a, Residue b) const { return reduced(a + p_ - b); }
  Residue negative(Residue a) const { return a == 0 ? 0 : p_ - a; }
  Residue multiply(Residue a, Residue b) const {
    return static_cast<Residue>(static_cast<Wide>(a) * b % p_);
  }
  Factor factor(Residue value) const {
    return {value, static_cast<Residue>((static_cast<Wide>(value) << 64) / p_)};
  }
  Residue multiply(Residue a, const Factor& f) const {
    const auto high = static_cast<Residue>(static_cast<Wide>(a) * f.quotient >> 64);
    return reduced(a * f.value - high * p_);
  }
  // a != 0.
  Residue inverse(Residue a) const;
  Residue of(const Integer& value) const { return value.modulo(p_); }
  Residue of(long value) const;

 private:
  Residue reduced(Residue a) const { return a >= p_ ? a - p_ : a; }

  Residue p_;
};

// 2^61 - 1, then the primes below it, descending.
unsigned long elimination_prime(int index);

}  // namespace isochor::internal
