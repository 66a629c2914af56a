#include "isochor/exact/rational.h"

#include <flint/flint.h>
#include <flint/fmpq.h>
#include <flint/fmpz.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "isochor/base/error.h"

namespace isochor {
namespace {

static_assert(sizeof(fmpq) == 2 * sizeof(long), "Rational holds FLINT's handle in two longs");

constexpr int kMantissaBits = std::numeric_limits<double>::digits;  // 53
constexpr long kSmallestExponent =
    std::numeric_limits<double>::min_exponent - kMantissaBits;  // -1074
constexpr long kLargestDecimalExponent = 9999;

template <typename Words>
fmpq* handle(Words& words) {
  return reinterpret_cast<fmpq*>(&words);
}
template <typename Words>
const fmpq* handle(const Words& words) {
  return reinterpret_cast<const fmpq*>(&words);
}

[[noreturn]] void reject(std::string_view text, const std::string& reason) {
  throw InputError("", "number \"" + std::string(text.substr(0, 60)) + "\"", reason);
}

// The digits at the front of `rest`, which is advanced past them.
std::string_view take_digits(std::string_view& rest) {
  const auto end =
      std::find_if_not(rest.begin(), rest.end(), [](char c) { return '0' <= c && c <= '9'; });
  const std::string_view digits = rest.substr(0, static_cast<size_t>(end - rest.begin()));
  rest.remove_prefix(digits.size());
  return digits;
}

// True, and advanced, when `rest` begins with one of `choices`; `sign` tells which.
bool take_sign(std::string_view& rest) {
  if (rest.empty() || (rest.front() != '-' && rest.front() != '+')) return false;
  const bool negative = rest.front() == '-';
  rest.remove_prefix(1);
  return negative;
}

long take_exponent(std::string_view& rest, std::string_view text) {
  if (rest.empty() || (rest.front() != 'e' && rest.front() != 'E')) return 0;
  rest.remove_prefix(1);
  const bool negative = take_sign(rest);
  const std::string_view digits = take_digits(rest);
  if (digits.empty()) reject(text, "the exponent has no digits");
  long exponent = 0;
  for (char c : digits) {
    exponent = 10 * exponent + (c - '0');
    if (exponent > kLargestDecimalExponent) {
      reject(text, "the exponent is beyond " + std::to_string(kLargestDecimalExponent));
    }
  }
  return negative ? -exponent : exponent;
}

}  // namespace

Rational::Rational(long value) { fmpz_set_si(&words_.numerator, value); }
Rational::Rational(const Integer& value) { fmpz_set(&words_.numerator, &value.word_); }

Rational::Rational(double value) {
  ISOCHOR_REQUIRE(std::isfinite(value), value);
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  fmpz_set_si(&words_.numerator, static_cast<long>(std::ldexp(mantissa, kMantissaBits)));
  *this = scaled_by_power_of_two(exponent - kMantissaBits);
}

Rational::Rational(const Integer& numerator, const Integer& denominator) {
  ISOCHOR_REQUIRE(!denominator.is_zero(), numerator.to_string());
  fmpq_set_fmpz_frac(handle(words_), &numerator.word_, &denominator.word_);
}

Rational::Rational(const Rational& other) { fmpq_set(handle(words_), handle(other.words_)); }
Rational::Rational(Rational&& other) noexcept : words_(std::exchange(other.words_, Words())) {}
Rational& Rational::operator=(const Rational& other) {
  fmpq_set(handle(words_), handle(other.words_));
  return *this;
}
Rational& Rational::operator=(Rational&& other) noexcept {
  std::swap(words_, other.words_);
  return *this;
}
Rational::~Rational() { fmpq_clear(handle(words_)); }

Rational Rational::parse(std::string_view text) {
  std::string_view rest = text;
  if (rest.empty()) reject(text, "the text is empty");
  const bool negative = take_sign(rest);
  const std::string_view whole = take_digits(rest);
  std::string digits(whole);
  Integer denominator(1);
  long exponent = 0;
  if (!rest.empty() && rest.front() == '/') {
    rest.remove_prefix(1);
    const std::string below(take_digits(rest));
    if (whole.empty() || below.empty()) reject(text, "a fraction needs digits on both sides");
    fmpz_set_str(&denominator.word_, below.c_str(), 10);
    if (denominator.is_zero()) reject(text, "the denominator is zero");
  } else {
    if (!rest.empty() && rest.front() == '.') {
      rest.remove_prefix(1);
      const std::string_view fraction = take_digits(rest);
      digits += fraction;
      exponent = -static_cast<long>(fraction.size());
    }
    if (digits.empty()) reject(text, "there are no digits");
    exponent += take_exponent(rest, text);
  }
  if (!rest.empty()) reject(text, std::string("unexpected character '") + rest.front() + "'");

  Integer numerator;
  fmpz_set_str(&numerator.word_, digits.c_str(), 10);
  if (negative) numerator = -numerator;
  Integer power;
  fmpz_set_ui(&power.word_, 10);
  fmpz_pow_ui(&power.word_, &power.word_, static_cast<ulong>(std::labs(exponent)));
  (exponent < 0 ? denominator : numerator) *= power;
  return Rational(numerator, denominator);
}

std::optional<Rational> Rational::reconstruct(const Integer& residue, const Integer& modulus) {
  ISOCHOR_REQUIRE(residue.sign() >= 0 && residue < modulus && Integer(2) < modulus,
                  residue.to_string(), modulus.to_string());
  Rational result;
  if (fmpq_reconstruct_fmpz(handle(result.words_), &residue.word_, &modulus.word_) == 0) {
    return std::nullopt;
  }
  return result;
}

Rational& Rational::operator+=(const Rational& b) {
  fmpq_add(handle(words_), handle(words_), handle(b.words_));
  return *this;
}
Rational& Rational::operator-=(const Rational& b) {
  fmpq_sub(handle(words_), handle(words_), handle(b.words_));
  return *this;
}
Rational& Rational::operator*=(const Rational& b) {
  fmpq_mul(handle(words_), handle(words_), handle(b.words_));
  return *this;
}
Rational& Rational::operator/=(const Rational& b) {
  ISOCHOR_REQUIRE(!b.is_zero(), to_string());
  fmpq_div(handle(words_), handle(words_), handle(b.words_));
  return *this;
}
Rational Rational::operator-() const {
  Rational result;
  fmpq_neg(handle(result.words_), handle(words_));
  return result;
}

Rational Rational::scaled_by_power_of_two(long exponent) const {
  Rational result;
  const auto size = static_cast<ulong>(std::labs(exponent));
  if (exponent < 0) {
    fmpq_div_2exp(handle(result.words_), handle(words_), size);
  } else {
    fmpq_mul_2exp(handle(result.words_), handle(words_), size);
  }
  return result;
}

int Rational::sign() const { return fmpq_sgn(handle(words_)); }

Integer Rational::numerator() const {
  Integer result;
  fmpz_set(&result.word_, &words_.numerator);
  return result;
}
Integer Rational::denominator() const {
  Integer result;
  fmpz_set(&result.word_, &words_.denominator);
  return result;
}

std::string Rational::to_string() const {
  const std::unique_ptr<char, void (*)(void*)> text(fmpq_get_str(nullptr, 10, handle(words_)),
                                                    flint_free);
  return text.get();
}

double Rational::to_double() const {
  if (is_zero()) return 0.0;
  const fmpz* const top_word = fmpq_numref(handle(words_));
  const fmpz* const bottom_word = fmpq_denref(handle(words_));
  if (fmpz_bits(top_word) <= kMantissaBits && fmpz_bits(bottom_word) <= kMantissaBits) {
    // Both are doubles, and the processor rounds a quotient once.
    return static_cast<double>(fmpz_get_si(top_word)) /
           static_cast<double>(fmpz_get_si(bottom_word));
  }
  // |value| = quotient 2^-scale, with more than enough bits and a sticky last one.
  Integer above = numerator().sign() < 0 ? -numerator() : numerator();
  Integer below = denominator();
  const long scale =
      kMantissaBits + 13 - (static_cast<long>(above.bits()) - static_cast<long>(below.bits()));
  if (scale >= 0) {
    above = above.shifted(static_cast<ulong>(scale));
  } else {
    below = below.shifted(static_cast<ulong>(-scale));
  }
  Integer quotient;
  Integer remainder;
  fmpz_fdiv_qr(&quotient.word_, &remainder.word_, &above.word_, &below.word_);
  if (!remainder.is_zero() && fmpz_is_even(&quotient.word_)) quotient += 1;

  // The last place the result can have; subnormals have fewer bits.
  const long top = static_cast<long>(quotient.bits()) - 1 - scale;
  const long last = std::max(top - (kMantissaBits - 1), kSmallestExponent);
  const long dropped = last + scale;  // at least 13: scale leaves 66 or 67 bits
  Integer mantissa;
  fmpz_fdiv_q_2exp(&mantissa.word_, &quotient.word_, static_cast<ulong>(dropped));
  Integer rest = quotient - mantissa.shifted(static_cast<ulong>(dropped));
  const int order = compare(rest.shifted(1), Integer(1).shifted(static_cast<ulong>(dropped)));
  if (order > 0 || (order == 0 && fmpz_is_odd(&mantissa.word_))) mantissa += 1;
  if (last > std::numeric_limits<double>::max_exponent) {
    return sign() * std::numeric_limits<double>::infinity();
  }
  return sign() *
         std::ldexp(static_cast<double>(fmpz_get_si(&mantissa.word_)), static_cast<int>(last));
}

Enclosure Rational::enclosure() const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double nearest = to_double();
  int order = 0;  // sign of nearest - value
  if (std::isinf(nearest)) {
    order = nearest > 0.0 ? 1 : -1;
  } else {
    order = compare(Rational(nearest), *this);
  }
  if (order < 0) return {nearest, std::nextafter(nearest, kInfinity)};
  if (order > 0) return {std::nextafter(nearest, -kInfinity), nearest};
  return {nearest, nearest};
}

int compare(const Rational& a, const Rational& b) {
  const int order = fmpq_cmp(handle(a.words_), handle(b.words_));
  return order < 0 ? -1 : (order > 0 ? 1 : 0);
}

}  // namespace isochor
