// An edit of parameters under linear constraints, as data, and its exact solution.
//
// Symbols (Rodrigues 2017, chapters 2 and 5): parameters p are points of dimension d; constraints
// R p = q; the anchors A take new values; the derived parameters D take what the constraints ask
// for, as near to their hints h as their weights w say; the others, F, keep their values. A
// constraint is relevant when it has a nonzero coefficient on an anchor or a derived parameter.
//
// Laws (tests of those names in tests/ecles/problem_test.cpp):
//  (1) exact:       solved values fulfil every relevant constraint, anchors have their values, F
//  stays (2) nearest:     sum over D of w |p - h|^2 is the least; so the four methods give equal
//  values (3) culprits:    a conflict is a combination of constraints in which D cancels and
//  something
//                   nonzero is left; every proper part of it could be fulfilled
//  (4) order:       the result does not depend on the order of parameters and constraints, because
//                   names decide which of several dependent constraints counts as the extra one
//  (5) proven:      every verdict has been verified by proof.h before it is returned
// Not a law: that irrelevant constraints hold afterwards. They hold when they held before.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "isochor/ecles/constraint_matrix.h"
#include "isochor/exact/rational.h"

namespace isochor {

// One number a dimension.
using RationalPoint = std::vector<Rational>;

struct Problem {
  // Weak: solve for these values. Strong: only when every value of the anchors could be served.
  enum class Require { kWeak, kStrong };
  // Fast: local blocks. The others are the dense algorithm of the thesis with its three ways to
  // simplify, for comparison: values are the same.
  enum class Method { kFast, kGcd, kTurner, kPlain };

  struct Parameter {
    std::string name;
    RationalPoint value;
  };
  struct Constraint {
    std::string name;
    RationalTerms terms;  // of parameter indices
    RationalPoint equals;
  };
  struct Anchor {
    int parameter = 0;
    RationalPoint value;
  };
  struct Derived {
    int parameter = 0;
    RationalPoint hint;
    Rational weight = 1;
  };

  int dimension = 1;
  std::vector<Parameter> parameters;
  std::vector<Constraint> constraints;
  std::vector<Anchor> anchors;
  std::vector<Derived> derived;
  Require require = Require::kWeak;
  Method method = Method::kFast;

  // Throws InputError without file, the entity as in a problem file ("derived.p3.weight"): an empty
  // list of parameters or constraints, neither anchors nor derived parameters, empty or repeated
  // names, points of another dimension, constraints without a nonzero coefficient, weights that are
  // not positive, a parameter chosen twice. PreconditionError when an index is out of range.
  void validate() const;
};

const char* name_of(Problem::Require require);
const char* name_of(Problem::Method method);

// Constraints added up with multipliers so that no derived parameter is left.
struct Combination {
  // Constraints by name; coprime integers, the first positive.
  std::vector<std::pair<int, Rational>> multipliers;
  // What is left of the anchors: their coefficients in the sum.
  RationalTerms anchors;
  // The sum of the right sides minus that of the left sides, at the new values of the anchors: zero
  // unless the constraints contradict each other. One number a dimension.
  RationalPoint residual;

  bool contradicts() const;
};

// A relevant constraint that others imply, and how: itself among those.
struct Redundancy {
  int constraint = 0;
  Combination because;
};

// A constraint that the values at the start do not fulfil.
struct Violation {
  int constraint = 0;
  bool relevant = false;   // if not, nothing is done about it
  RationalPoint residual;  // right side minus left side
};

struct Solution {
  // Refused: it has a solution, which a limit of the method keeps it from giving.
  enum class Outcome { kSolved, kNotWeaklySolvable, kNotStronglySolvable, kRefused };

  Outcome outcome = Outcome::kSolved;
  std::string reason;  // of a refusal, with the limit
  // Of every parameter, in the order of the problem; empty unless solved.
  std::vector<RationalPoint> values;
  int rank = 0;               // of the relevant constraints on the derived parameters
  int freedom_left = 0;       // derived parameters minus rank
  std::vector<int> relevant;  // constraints, ascending
  // In the order of the names of the constraint that is extra.
  std::vector<Redundancy> redundant;      // harmless
  std::vector<Combination> conflicts;     // why it was not solved: minimal sets
  std::vector<Combination> obstructions;  // what binds the anchors; empty when strongly solvable
  bool strongly_solvable = true;
  std::vector<Violation> violated_before;
  bool proofs_verified = false;
};

const char* name_of(Solution::Outcome outcome);

// Throws InputError as `Problem::validate` does.
Solution solve(const Problem& problem);

}  // namespace isochor
