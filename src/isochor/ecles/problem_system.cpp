#include "isochor/ecles/problem_system.h"

#include <algorithm>

#include "isochor/base/error.h"
#include "isochor/ecles/least_change.h"
#include "isochor/ecles/reference.h"

namespace isochor::internal {
namespace {

constexpr int kMostMegabytes = 128;
constexpr int kMostBits = 65'536;
constexpr int kMostEliminated = 1500;
constexpr size_t kMostDense = 100'000;
constexpr int kMostPlainRows = 16;

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

}  // namespace

ProblemSystem system_of(const Problem& problem) {
  ProblemSystem system{
      ConstraintMatrix(static_cast<int>(problem.parameters.size()), rows_of(problem)),
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

namespace {

std::vector<Rational> weights_of(const Problem& problem) {
  std::vector<Rational> weights;
  for (const auto& each : problem.derived) weights.push_back(each.weight);
  return weights;
}

DerivedValues nearest_values(const Problem& problem, const ProblemSystem& system,
                             const Analysis& analysis) {
  const LeastChange least(system.matrix, system.selection.derived, analysis.independent,
                          weights_of(problem));
  const LeastChange::Digits digits = least.most_digits();
  if (digits.longest > kMostBits) {
    return {{},
            "constraints that hang together may give values of " +
                std::to_string(static_cast<long>(std::min(digits.longest, 1e15))) +
                " binary digits; the limit is " + std::to_string(kMostBits)};
  }
  const double megabytes = digits.together * problem.dimension / 8e6;
  if (megabytes > kMostMegabytes) {
    return {{},
            "the exact values of " + std::to_string(problem.derived.size()) +
                " derived parameters that hang together may need " +
                std::to_string(static_cast<long>(std::min(megabytes, 1e15))) +
                " MB; the limit is " + std::to_string(kMostMegabytes) + " MB"};
  }
  DerivedValues result;
  for (size_t c = 0; c < system.values.size(); ++c) {
    std::vector<Rational> wanted = system.values[c];
    for (const auto& each : problem.derived) {
      wanted[static_cast<size_t>(each.parameter)] = each.hint[c];
    }
    auto solved = least.solve_within(kMostEliminated, system.right_sides[c], wanted);
    if (!solved) {
      return {{},
              "more than " + std::to_string(kMostEliminated) +
                  " constraints that hang together are too badly conditioned to be solved "
                  "from doubles, and too many to be solved densely"};
    }
    result.values.push_back(std::move(*solved));
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

// Why the dense algorithm should not be tried.
std::string too_large_for(Problem::Method method, const Analysis& analysis, size_t derived) {
  const size_t coefficients = analysis.relevance.rows.size() * derived;
  const std::string name = std::string("the method \"") + name_of(method) + "\"";
  const std::string advice = "; \"fast\" gives the same values";
  if (coefficients > kMostDense) {
    return name + " is dense: it would fill " + std::to_string(coefficients) +
           " coefficients, the limit is " + std::to_string(kMostDense) + advice;
  }
  if (method == Problem::Method::kPlain && analysis.rank() > kMostPlainRows) {
    return name + " doubles the length of its numbers with each of " +
           std::to_string(analysis.rank()) + " independent constraints, the limit is " +
           std::to_string(kMostPlainRows) + advice;
  }
  return "";
}

// The same by the algorithm of the thesis, whose verdicts must be the same too.
DerivedValues thesis_values(const Problem& problem, const ProblemSystem& system,
                            const Analysis& analysis) {
  const std::string refused = too_large_for(problem.method, analysis, problem.derived.size());
  if (!refused.empty()) return {{}, refused};
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
  DerivedValues result{{system.values.size(), std::vector<Rational>()}, ""};
  for (int c = 0; c < d; ++c) {
    for (int k = 0; k < update->derived.rows(); ++k) {
      result.values[static_cast<size_t>(c)].push_back(update->derived.at(k, c));
    }
  }
  return result;
}

}  // namespace

DerivedValues derived_values(const Problem& problem, const ProblemSystem& system,
                             const Analysis& analysis) {
  return problem.method == Problem::Method::kFast ? nearest_values(problem, system, analysis)
                                                  : thesis_values(problem, system, analysis);
}

}  // namespace isochor::internal
