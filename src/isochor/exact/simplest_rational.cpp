#include "isochor/exact/simplest_rational.h"

#include <utility>
#include <vector>

#include "isochor/base/error.h"

namespace isochor {

Rational simplest_between(const Rational& low, const Rational& high) {
  ISOCHOR_REQUIRE(low <= high, low.to_string(), high.to_string());
  if (low.sign() <= 0 && high.sign() >= 0) return {};
  if (high.sign() < 0) return -simplest_between(-high, -low);
  // Both ends share the partial quotients until one whole number lies between them.
  std::vector<Rational> quotients;
  Rational below = low;
  Rational above = high;
  for (;;) {
    const Rational floor(below.numerator().divided_floor(below.denominator()));
    const Rational ceiling = floor == below ? floor : floor + Rational(1);
    if (ceiling <= above) {
      quotients.push_back(ceiling);
      break;
    }
    quotients.push_back(floor);
    const Rational next_below = Rational(1) / (above - floor);
    above = Rational(1) / (below - floor);
    below = next_below;
  }
  Rational value = std::move(quotients.back());
  for (auto quotient = quotients.rbegin() + 1; quotient != quotients.rend(); ++quotient) {
    value = *quotient + Rational(1) / value;
  }
  return value;
}

}  // namespace isochor
