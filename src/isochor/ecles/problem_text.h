// What a solution says, in sentences for people.
#pragma once

#include <string>

#include "isochor/ecles/problem.h"

namespace isochor {

// "3" in one dimension, "(3, 1/2)" in more.
std::string text_of(const RationalPoint& point);

// One of
//   "join and offset contradict each other: 1 x join - 2 x offset reads 0 = 3"
//   "join does not allow the new p1: 1 x join reads 1 p1 = 1, but it is 4"
//   "join binds p1: 1 x join reads 1 p1 = 1 whatever the derived parameters are"
//   "a, b and total say the same more than once ...: 1 x a + 1 x b - 1 x total reads 0 = 0"
// for a combination that contradicts, without and with anchors left, and for one that does not. Of
// long sums only the beginning is written out.
std::string sentence(const Problem& problem, const Combination& combination);

// The outcome in one line.
std::string headline(const Problem& problem, const Solution& solution);

}  // namespace isochor
