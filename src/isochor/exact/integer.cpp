#include "isochor/exact/integer.h"

#include <flint/flint.h>
#include <flint/fmpz.h>

#include <limits>
#include <memory>
#include <type_traits>

#include "isochor/base/error.h"

namespace isochor {
namespace {

static_assert(std::is_same_v<fmpz, long>, "Integer holds FLINT's handle in one long");

}  // namespace

Integer::Integer(long value) { fmpz_set_si(&word_, value); }
Integer::Integer(const Integer& other) { fmpz_set(&word_, &other.word_); }
Integer& Integer::operator=(const Integer& other) {
  fmpz_set(&word_, &other.word_);
  return *this;
}
Integer::~Integer() { fmpz_clear(&word_); }

Integer& Integer::operator+=(const Integer& b) {
  fmpz_add(&word_, &word_, &b.word_);
  return *this;
}
Integer& Integer::operator-=(const Integer& b) {
  fmpz_sub(&word_, &word_, &b.word_);
  return *this;
}
Integer& Integer::operator*=(const Integer& b) {
  fmpz_mul(&word_, &word_, &b.word_);
  return *this;
}
Integer Integer::operator-() const {
  Integer result;
  fmpz_neg(&result.word_, &word_);
  return result;
}

void Integer::add_product(const Integer& a, const Integer& b) {
  fmpz_addmul(&word_, &a.word_, &b.word_);
}
void Integer::add_product(const Integer& a, long b) { fmpz_addmul_si(&word_, &a.word_, b); }
void Integer::subtract_product(const Integer& a, const Integer& b) {
  fmpz_submul(&word_, &a.word_, &b.word_);
}

Integer Integer::shifted(unsigned long exponent) const {
  Integer result;
  fmpz_mul_2exp(&result.word_, &word_, exponent);
  return result;
}

Integer Integer::divided_exactly(const Integer& b) const {
  ISOCHOR_REQUIRE(!b.is_zero());
  Integer result;
  fmpz_divexact(&result.word_, &word_, &b.word_);
  return result;
}

void Integer::divide_exactly(const Integer& b) {
  ISOCHOR_REQUIRE(!b.is_zero());
  fmpz_divexact(&word_, &word_, &b.word_);
}

Integer Integer::divided_floor(const Integer& b) const {
  ISOCHOR_REQUIRE(!b.is_zero());
  Integer result;
  fmpz_fdiv_q(&result.word_, &word_, &b.word_);
  return result;
}

Integer Integer::divided_nearest(const Integer& b) const {
  Integer twice = *this + *this;
  twice += b;
  return twice.divided_floor(b + b);
}

bool Integer::is_multiple_of(const Integer& b) const {
  return b.is_zero() ? is_zero() : fmpz_divisible(&word_, &b.word_) != 0;
}

unsigned long Integer::modulo(unsigned long modulus) const {
  ISOCHOR_REQUIRE(modulus != 0);
  return fmpz_fdiv_ui(&word_, modulus);
}

std::optional<long> Integer::to_long() const {
  if (!fmpz_fits_si(&word_)) return std::nullopt;
  return fmpz_get_si(&word_);
}

double Integer::to_double() const {
  constexpr unsigned long kLargestExponent = std::numeric_limits<double>::max_exponent;
  if (bits() > kLargestExponent) {
    return sign() * std::numeric_limits<double>::infinity();
  }
  return fmpz_get_d(&word_);
}

int Integer::sign() const { return fmpz_sgn(&word_); }
unsigned long Integer::bits() const { return fmpz_bits(&word_); }

std::string Integer::to_string() const {
  const std::unique_ptr<char, void (*)(void*)> text(fmpz_get_str(nullptr, 10, &word_), flint_free);
  return text.get();
}

int compare(const Integer& a, const Integer& b) {
  const int order = fmpz_cmp(&a.word_, &b.word_);
  return order < 0 ? -1 : (order > 0 ? 1 : 0);
}

int compare_magnitudes(const Integer& a, const Integer& b) {
  const int order = fmpz_cmpabs(&a.word_, &b.word_);
  return order < 0 ? -1 : (order > 0 ? 1 : 0);
}

Integer lcm(const Integer& a, const Integer& b) {
  Integer result;
  fmpz_lcm(&result.word_, &a.word_, &b.word_);
  return result;
}

Integer gcd(const Integer& a, const Integer& b) {
  Integer result;
  fmpz_gcd(&result.word_, &a.word_, &b.word_);
  return result;
}

}  // namespace isochor
