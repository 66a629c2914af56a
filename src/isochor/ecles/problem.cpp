#include "isochor/ecles/problem.h"

#include <algorithm>
#include <unordered_set>

#include "isochor/base/error.h"
#include "isochor/ecles/analysis.h"
#include "isochor/ecles/conflicts.h"
#include "isochor/ecles/problem_system.h"
#include "isochor/ecles/proof.h"

namespace isochor {
namespace {

[[noreturn]] void refuse(const std::string& entity, const std::string& reason) {
  throw InputError("", entity, reason);
}

std::string numbered(const char* list, size_t i) {
  return std::string(list) + "[" + std::to_string(i) + "]";
}

void require_dimension(const std::string& entity, const RationalPoint& point, int dimension) {
  if (point.size() == static_cast<size_t>(dimension)) return;
  refuse(entity, "expected " + std::to_string(dimension) + " numbers (the dimension), found " +
                     std::to_string(point.size()));
}

void require_new_name(const std::string& entity, const std::string& name,
                      std::unordered_set<std::string>& known) {
  if (name.empty()) refuse(entity, "the name is empty");
  if (!known.insert(name).second) refuse(entity, "the name \"" + name + "\" occurs twice");
}

void require_coefficients(const std::string& entity, const Problem::Constraint& constraint) {
  if (constraint.terms.empty()) {
    refuse(entity, "the constraint \"" + constraint.name + "\" has no terms");
  }
  if (std::all_of(constraint.terms.begin(), constraint.terms.end(),
                  [](const auto& term) { return term.second.is_zero(); })) {
    refuse(entity, "all coefficients of the constraint \"" + constraint.name + "\" are zero");
  }
}

// Right side minus left side of one constraint; value_of(parameter, component).
template <typename ValueOf>
RationalPoint residual_of(const Problem::Constraint& constraint, ValueOf value_of) {
  RationalPoint residual = constraint.equals;
  for (const auto& [parameter, coefficient] : constraint.terms) {
    for (size_t c = 0; c < residual.size(); ++c)
      residual[c] -= coefficient * value_of(parameter, c);
  }
  return residual;
}

bool is_zero(const RationalPoint& point) {
  return std::all_of(point.begin(), point.end(), [](const Rational& x) { return x.is_zero(); });
}

std::vector<Violation> violations(const Problem& problem, const std::vector<int>& relevant) {
  std::vector<Violation> result;
  for (size_t i = 0; i < problem.constraints.size(); ++i) {
    RationalPoint residual = residual_of(
        problem.constraints[i], [&](int j, size_t c) -> const auto& {
          return problem.parameters[static_cast<size_t>(j)].value[c];
        });
    if (is_zero(residual)) continue;
    const int row = static_cast<int>(i);
    result.push_back(
        {row, std::binary_search(relevant.begin(), relevant.end(), row), std::move(residual)});
  }
  return result;
}

// Divided by what makes the multipliers coprime integers, the first of them positive.
void normalise(Combination& combination) {
  Integer denominators(1), content;
  for (const auto& term : combination.multipliers) {
    denominators = lcm(denominators, term.second.denominator());
  }
  for (const auto& term : combination.multipliers) {
    content = gcd(content, (term.second * Rational(denominators)).numerator());
  }
  Rational factor(denominators, content);
  if (combination.multipliers.front().second.sign() < 0) factor = -factor;
  for (auto& term : combination.multipliers) term.second *= factor;
  for (auto& term : combination.anchors) term.second *= factor;
  for (Rational& number : combination.residual) number *= factor;
}

// A circuit in the words of the problem.
Combination combination_of(const internal::ProblemSystem& system,
                           const std::vector<bool>& is_anchor, const Circuit& circuit) {
  Combination result;
  const std::vector<Rational> given = given_multipliers(system.matrix, circuit);
  for (size_t k = 0; k < circuit.rows.size(); ++k) {
    result.multipliers.emplace_back(circuit.rows[k], given[k]);
    for (const ConstraintTerm& term : system.matrix.row(circuit.rows[k])) {
      if (!is_anchor[static_cast<size_t>(term.parameter)]) continue;
      result.anchors.emplace_back(term.parameter,
                                  Rational(circuit.multipliers[k] * term.coefficient));
    }
  }
  std::sort(result.multipliers.begin(), result.multipliers.end(),
            [&](const auto& a, const auto& b) {
              return system.precedence[static_cast<size_t>(a.first)] <
                     system.precedence[static_cast<size_t>(b.first)];
            });
  std::sort(result.anchors.begin(), result.anchors.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  RationalTerms sums;
  for (auto& term : result.anchors) {
    if (!sums.empty() && sums.back().first == term.first) {
      sums.back().second += term.second;
    } else {
      sums.push_back(std::move(term));
    }
  }
  sums.erase(std::remove_if(sums.begin(), sums.end(),
                            [](const auto& term) { return term.second.is_zero(); }),
             sums.end());
  result.anchors = std::move(sums);
  for (size_t c = 0; c < system.values.size(); ++c) {
    result.residual.push_back(
        residual(system.matrix, circuit, system.right_sides[c], system.values[c]));
  }
  normalise(result);
  return result;
}

// The verdict and everything that explains it, in the order of names.
void judge(const Problem& problem, const internal::ProblemSystem& system, const Analysis& analysis,
           Solution& solution) {
  solution.relevant = analysis.relevance.rows;
  solution.rank = analysis.rank();
  solution.freedom_left = analysis.freedom_left(system.selection);
  solution.strongly_solvable = analysis.strongly_solvable();
  std::vector<bool> is_anchor(problem.parameters.size());
  for (int j : system.selection.anchors) is_anchor[static_cast<size_t>(j)] = true;
  std::vector<size_t> order(analysis.circuits.size());
  for (size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return system.precedence[static_cast<size_t>(analysis.dependent[a])] <
           system.precedence[static_cast<size_t>(analysis.dependent[b])];
  });
  const bool strong = problem.require == Problem::Require::kStrong;
  for (size_t k : order) {
    const Combination combination = combination_of(system, is_anchor, analysis.circuits[k]);
    const bool binds = std::binary_search(analysis.obstructions.begin(),
                                          analysis.obstructions.end(), static_cast<int>(k));
    if (binds) solution.obstructions.push_back(combination);
    if (combination.contradicts() || (binds && strong)) {
      solution.conflicts.push_back(combination);
    } else {
      solution.redundant.push_back({analysis.dependent[k], combination});
    }
  }
  if (strong && !solution.strongly_solvable) {
    solution.outcome = Solution::Outcome::kNotStronglySolvable;
  } else if (!solution.conflicts.empty()) {
    solution.outcome = Solution::Outcome::kNotWeaklySolvable;
  }
}

// Verdicts leave this file only when the checker, which shares no code with those who found them,
// agrees.
void require_proofs(const internal::ProblemSystem& system, const Analysis& analysis) {
  ISOCHOR_REQUIRE(verify(analysis, system.matrix, system.selection), analysis.rank());
  for (const Conflict& conflict :
       conflicts(system.matrix, analysis, system.right_sides, system.values)) {
    const Circuit& circuit = analysis.circuits[static_cast<size_t>(conflict.circuit)];
    ISOCHOR_REQUIRE(verify_conflict(circuit, conflict, system.matrix, system.selection,
                                    system.right_sides, system.values),
                    conflict.circuit);
    ISOCHOR_REQUIRE(verify_minimal(circuit, system.matrix, system.selection.derived),
                    conflict.circuit);
  }
}

// Whether a constraint holds for one component of the values. Over a common denominator: adding
// long fractions one by one would spend its time reducing them.
bool holds(const internal::ProblemSystem& system, int row, size_t component,
           const std::vector<RationalPoint>& values) {
  Integer sum, common(1);
  for (const ConstraintTerm& term : system.matrix.row(row)) {
    const Rational& value = values[static_cast<size_t>(term.parameter)][component];
    const Integer denominator = value.denominator();
    if (denominator != common) {
      const Integer next = lcm(common, denominator);
      sum *= next.divided_exactly(common);
      common = next;
    }
    sum.add_product(term.coefficient * value.numerator(), common.divided_exactly(denominator));
  }
  return Rational(sum, common) ==
         system.right_sides[component][static_cast<size_t>(row)] * system.matrix.scale(row);
}

void put_values(const Problem& problem, const internal::ProblemSystem& system,
                const Analysis& analysis, Solution& solution) {
  const internal::DerivedValues derived = internal::derived_values(problem, system, analysis);
  if (!derived.refused.empty()) {
    solution.outcome = Solution::Outcome::kRefused;
    solution.reason = derived.refused;
    return;
  }
  for (const auto& parameter : problem.parameters) solution.values.push_back(parameter.value);
  for (const auto& anchor : problem.anchors) {
    solution.values[static_cast<size_t>(anchor.parameter)] = anchor.value;
  }
  for (size_t k = 0; k < problem.derived.size(); ++k) {
    for (size_t c = 0; c < derived.values.size(); ++c) {
      solution.values[static_cast<size_t>(problem.derived[k].parameter)][c] = derived.values[c][k];
    }
  }
  for (int i : solution.relevant) {
    for (size_t c = 0; c < derived.values.size(); ++c) {
      ISOCHOR_REQUIRE(holds(system, i, c, solution.values), i, c);
    }
  }
}

}  // namespace

void Problem::validate() const {
  ISOCHOR_REQUIRE(dimension >= 1, dimension);
  const auto in_range = [this](int j) {
    return 0 <= j && static_cast<size_t>(j) < parameters.size();
  };
  if (parameters.empty()) refuse("parameters", "the list is empty: there is nothing to edit");
  if (constraints.empty()) refuse("constraints", "the list is empty: there is nothing to keep");
  if (anchors.empty() && derived.empty()) {
    refuse("anchors", "there are neither anchors nor derived parameters: there is nothing to do");
  }
  std::unordered_set<std::string> names;
  for (size_t j = 0; j < parameters.size(); ++j) {
    const std::string entity = numbered("parameters", j);
    require_new_name(entity + ".name", parameters[j].name, names);
    require_dimension(entity + ".value", parameters[j].value, dimension);
  }
  names.clear();
  for (size_t i = 0; i < constraints.size(); ++i) {
    const std::string entity = numbered("constraints", i);
    require_new_name(entity + ".name", constraints[i].name, names);
    require_dimension(entity + ".equals", constraints[i].equals, dimension);
    require_coefficients(entity + ".terms", constraints[i]);
    for (const auto& term : constraints[i].terms) {
      ISOCHOR_REQUIRE(in_range(term.first), i, term.first);
    }
  }
  std::vector<bool> chosen(parameters.size());
  const auto choose = [&](const char* list, int j) {
    ISOCHOR_REQUIRE(in_range(j), list, j);
    const std::string entity = list + ("." + parameters[static_cast<size_t>(j)].name);
    if (chosen[static_cast<size_t>(j)]) {
      refuse(entity, "the parameter is already an anchor or derived; it can be only one of them");
    }
    chosen[static_cast<size_t>(j)] = true;
    return entity;
  };
  for (const Anchor& anchor : anchors) {
    require_dimension(choose("anchors", anchor.parameter), anchor.value, dimension);
  }
  for (const Derived& each : derived) {
    const std::string entity = choose("derived", each.parameter);
    require_dimension(entity + ".hint", each.hint, dimension);
    if (each.weight.sign() <= 0) {
      refuse(entity + ".weight", "a weight must be positive, found " + each.weight.to_string());
    }
  }
}

const char* name_of(Problem::Require require) {
  return require == Problem::Require::kWeak ? "weak" : "strong";
}

const char* name_of(Problem::Method method) {
  switch (method) {
    case Problem::Method::kFast:
      return "fast";
    case Problem::Method::kGcd:
      return "gcd";
    case Problem::Method::kTurner:
      return "turner";
    case Problem::Method::kPlain:
      return "plain";
  }
  return "";
}

const char* name_of(Solution::Outcome outcome) {
  switch (outcome) {
    case Solution::Outcome::kSolved:
      return "solved";
    case Solution::Outcome::kNotWeaklySolvable:
      return "not_weakly_solvable";
    case Solution::Outcome::kNotStronglySolvable:
      return "not_strongly_solvable";
    case Solution::Outcome::kRefused:
      return "refused";
  }
  return "";
}

bool Combination::contradicts() const { return !is_zero(residual); }

Solution solve(const Problem& problem) {
  problem.validate();
  const internal::ProblemSystem system = internal::system_of(problem);
  const Analysis analysis = analyse(system.matrix, system.selection, {system.precedence});
  require_proofs(system, analysis);
  Solution solution;
  solution.proofs_verified = true;
  judge(problem, system, analysis, solution);
  solution.violated_before = violations(problem, solution.relevant);
  if (solution.outcome == Solution::Outcome::kSolved) {
    put_values(problem, system, analysis, solution);
  }
  return solution;
}

}  // namespace isochor
