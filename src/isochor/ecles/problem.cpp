#include "isochor/ecles/problem.h"

#include <algorithm>
#include <unordered_set>

#include "isochor/base/error.h"
#include "isochor/ecles/analysis.h"
#include "isochor/ecles/conflicts.h"
#include "isochor/ecles/least_change.h"
#include "isochor/ecles/proof.h"
#include "isochor/ecles/reference.h"

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

// The parameters and the constraints of a problem, prepared for the analysis.
struct System {
  ConstraintMatrix matrix;
  Selection selection;
  std::vector<int> precedence;                     // by name
  std::vector<std::vector<Rational>> right_sides;  // component by component, as given
  std::vector<std::vector<Rational>> values;       // likewise; anchors new, the others as they are
};

std::vector<RationalTerms> rows_of(const Problem& problem) {
  std::vector<RationalTerms> rows;
  rows.reserve(problem.constraints.size());
  for (const auto& constraint : problem.constraints) rows.push_back(constraint.terms);
  return rows;
}

// The place of each constraint among all, sorted by name: a property that survives any reordering.
std::vector<int> places_by_name(const std::vector<Problem::Constraint>& constraints) {
  std::vector<int> order(constraints.size()), places(constraints.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return constraints[static_cast<size_t>(a)].name < constraints[static_cast<size_t>(b)].name;
  });
  for (size_t k = 0; k < order.size(); ++k) {
    places[static_cast<size_t>(order[k])] = static_cast<int>(k);
  }
  return places;
}

System system_of(const Problem& problem) {
  System system{ConstraintMatrix(static_cast<int>(problem.parameters.size()), rows_of(problem)),
                {},
                places_by_name(problem.constraints),
                {},
                {}};
  for (const auto& anchor : problem.anchors) system.selection.anchors.push_back(anchor.parameter);
  for (const auto& each : problem.derived) system.selection.derived.push_back(each.parameter);
  for (size_t c = 0; c < static_cast<size_t>(problem.dimension); ++c) {
    auto& right_side = system.right_sides.emplace_back();
    for (const auto& constraint : problem.constraints) right_side.push_back(constraint.equals[c]);
    auto& values = system.values.emplace_back();
    for (const auto& parameter : problem.parameters) values.push_back(parameter.value[c]);
    for (const auto& anchor : problem.anchors) {
      values[static_cast<size_t>(anchor.parameter)] = anchor.value[c];
    }
  }
  return system;
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
Combination combination_of(const System& system, const std::vector<bool>& is_anchor,
                           const Circuit& circuit) {
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
void judge(const Problem& problem, const System& system, const Analysis& analysis,
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
void require_proofs(const System& system, const Analysis& analysis) {
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

std::vector<Rational> weights_of(const Problem& problem) {
  std::vector<Rational> weights;
  for (const auto& each : problem.derived) weights.push_back(each.weight);
  return weights;
}

using ByComponent = std::vector<std::vector<Rational>>;  // each: one value a derived parameter

ByComponent nearest_values(const Problem& problem, const System& system, const Analysis& analysis) {
  const LeastChange least(system.matrix, system.selection.derived, analysis.independent,
                          weights_of(problem));
  ByComponent result;
  for (size_t c = 0; c < system.values.size(); ++c) {
    std::vector<Rational> wanted = system.values[c];
    for (const auto& each : problem.derived) {
      wanted[static_cast<size_t>(each.parameter)] = each.hint[c];
    }
    result.push_back(least.solve(system.right_sides[c], wanted));
  }
  return result;
}

// One row for each item of a list: `point_of` says which point of it.
template <typename List, typename PointOf>
RationalMatrix points_of(const List& list, int dimension, PointOf point_of) {
  RationalMatrix result(static_cast<int>(list.size()), dimension);
  for (size_t i = 0; i < list.size(); ++i) {
    for (int c = 0; c < dimension; ++c) {
      result.set(static_cast<int>(i), c, point_of(list[i])[static_cast<size_t>(c)]);
    }
  }
  return result;
}

Simplification simplification_of(Problem::Method method) {
  ISOCHOR_REQUIRE(method != Problem::Method::kFast, name_of(method));
  if (method == Problem::Method::kGcd) return Simplification::kGcd;
  return method == Problem::Method::kTurner ? Simplification::kTurner : Simplification::kNone;
}

// The same by the algorithm of the thesis, whose verdicts must be the same too.
ByComponent thesis_values(const Problem& problem, const System& system, const Analysis& analysis) {
  const int d = problem.dimension;
  const auto value = [](const auto& item) -> const RationalPoint& { return item.value; };
  const ReferenceEditor editor(
      system.matrix,
      points_of(problem.constraints, d,
                [](const auto& item) -> const RationalPoint& { return item.equals; }),
      points_of(problem.parameters, d, value), system.selection, simplification_of(problem.method));
  const auto update =
      editor.update(points_of(problem.anchors, d, value),
                    points_of(problem.derived, d,
                              [](const auto& item) -> const RationalPoint& { return item.hint; }),
                    weights_of(problem));
  ISOCHOR_REQUIRE(update && editor.rank() == analysis.rank() &&
                      editor.strongly_solvable() == analysis.strongly_solvable(),
                  editor.rank(), analysis.rank());
  ByComponent result(system.values.size());
  for (int c = 0; c < d; ++c) {
    for (int k = 0; k < update->derived.rows(); ++k) {
      result[static_cast<size_t>(c)].push_back(update->derived.at(k, c));
    }
  }
  return result;
}

void put_values(const Problem& problem, const System& system, const Analysis& analysis,
                Solution& solution) {
  for (const auto& parameter : problem.parameters) solution.values.push_back(parameter.value);
  for (const auto& anchor : problem.anchors) {
    solution.values[static_cast<size_t>(anchor.parameter)] = anchor.value;
  }
  const ByComponent derived = problem.method == Problem::Method::kFast
                                  ? nearest_values(problem, system, analysis)
                                  : thesis_values(problem, system, analysis);
  for (size_t k = 0; k < problem.derived.size(); ++k) {
    for (size_t c = 0; c < derived.size(); ++c) {
      solution.values[static_cast<size_t>(problem.derived[k].parameter)][c] = derived[c][k];
    }
  }
  for (int i : solution.relevant) {
    const auto& constraint = problem.constraints[static_cast<size_t>(i)];
    ISOCHOR_REQUIRE(is_zero(residual_of(
                        constraint,
                        [&](int j, size_t c) -> const auto& {
                          return solution.values[static_cast<size_t>(j)][c];
                        })),
                    constraint.name);
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
  }
  return "";
}

bool Combination::contradicts() const { return !is_zero(residual); }

Solution solve(const Problem& problem) {
  problem.validate();
  const System system = system_of(problem);
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
