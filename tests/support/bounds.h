// How far a computed number is from the exact one.
#pragma once

#include "isochor/exact/rational.h"
#include "isochor/volume/volume_form.h"

namespace isochor::testing {

inline double error_of(const Bounded& computed, const Rational& exact) {
  return (Rational(computed.value) - exact).abs().to_double();
}

}  // namespace isochor::testing
