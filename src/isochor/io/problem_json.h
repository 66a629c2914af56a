// ECLES problems and solutions as JSON (CONTRACT, "ECLES problem and solution").
//
// Numbers are exact. A string ("3/2", "0.1", "1e-3") and an integer below 2^64 mean what is
// written; a JSON number with a point or an exponent means the double nearest to it, as everywhere
// in JSON, so that 0.5 is 1/2 but 0.1 is 3602879701896397/36028797018963968: who means 1/10 writes
// "0.1". A notice tells when that makes a difference.
#pragma once

#include <string>
#include <vector>

#include "isochor/ecles/problem.h"
#include "isochor/io/value.h"

namespace isochor {

// A problem and what its reader should know about how it was read.
struct ProblemFile {
  Problem problem;
  std::vector<std::string> notices;
};

// `file` is only used in errors. Throws InputError naming the place in the file and the value:
// whatever Problem::validate refuses, unknown parameters, unknown keys, keys that occur twice,
// numbers that together need more than 128 MB. Time linear in the text.
ProblemFile parse_problem(const std::string& text, const std::string& file);

// The text of a problem, numbers as exact strings: parse_problem(format_problem(p)) is p.
std::string format_problem(const Problem& problem);

// The solution as in CONTRACT; `notices` are passed on.
Value solution_value(const Problem& problem, const Solution& solution,
                     const std::vector<std::string>& notices = {});

}  // namespace isochor
