// The simplest rational number of an interval.
#pragma once

#include "isochor/exact/rational.h"

namespace isochor {

// The number of [low, high] with the smallest denominator, and among those the one with the
// smallest absolute value: a walk down the Stern-Brocot tree by continued fractions.
// PreconditionError unless low <= high. Cost O(digits) divisions.
Rational simplest_between(const Rational& low, const Rational& high);

}  // namespace isochor
