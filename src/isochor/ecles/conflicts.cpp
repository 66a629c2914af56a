#include "isochor/ecles/conflicts.h"

#include <map>

#include "isochor/base/error.h"

namespace isochor {

std::vector<Rational> given_multipliers(const ConstraintMatrix& matrix, const Circuit& circuit) {
  std::vector<Rational> result;
  for (size_t k = 0; k < circuit.rows.size(); ++k) {
    result.push_back(Rational(circuit.multipliers[k]) * matrix.scale(circuit.rows[k]));
  }
  return result;
}

Rational residual(const ConstraintMatrix& matrix, const Circuit& circuit,
                  const std::vector<Rational>& right_side, const std::vector<Rational>& values) {
  ISOCHOR_REQUIRE(right_side.size() == static_cast<size_t>(matrix.rows()), right_side.size());
  ISOCHOR_REQUIRE(values.size() == static_cast<size_t>(matrix.parameters()), values.size());
  const std::vector<Rational> multipliers = given_multipliers(matrix, circuit);
  Rational result;
  std::map<int, Integer> sums;  // y^T R, zero on derived parameters
  for (size_t k = 0; k < circuit.rows.size(); ++k) {
    result += multipliers[k] * right_side[static_cast<size_t>(circuit.rows[k])];
    for (const ConstraintTerm& term : matrix.row(circuit.rows[k])) {
      sums[term.parameter].add_product(term.coefficient, circuit.multipliers[k]);
    }
  }
  for (const auto& [parameter, sum] : sums) {
    if (!sum.is_zero()) result -= Rational(sum) * values[static_cast<size_t>(parameter)];
  }
  return result;
}

std::vector<Conflict> conflicts(const ConstraintMatrix& matrix, const Analysis& analysis,
                                const std::vector<std::vector<Rational>>& right_sides,
                                const std::vector<std::vector<Rational>>& values) {
  ISOCHOR_REQUIRE(right_sides.size() == values.size(), right_sides.size(), values.size());
  std::vector<Conflict> result;
  for (size_t component = 0; component < right_sides.size(); ++component) {
    for (size_t k = 0; k < analysis.circuits.size(); ++k) {
      Rational rest =
          residual(matrix, analysis.circuits[k], right_sides[component], values[component]);
      if (rest.is_zero()) continue;
      result.push_back({static_cast<int>(k), static_cast<int>(component), std::move(rest)});
    }
  }
  return result;
}

}  // namespace isochor
