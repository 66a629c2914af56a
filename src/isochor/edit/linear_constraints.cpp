#include "isochor/edit/linear_constraints.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "isochor/base/tolerance.h"

namespace isochor {
namespace {

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

void add_unique(std::vector<std::string>& names, const std::string& name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

}  // namespace

Slots axis_slots(const DisplacementSpace& space, const std::vector<char>& selected, unsigned axes) {
  Slots slots;
  for (int c = 0; c < space.size(); ++c) {
    if (!selected[static_cast<size_t>(c)]) continue;
    for (int a = 0; a < 3; ++a) {
      if (!(axes >> a & 1u) || (space.locked_axes(c) >> a & 1u)) continue;
      slots.coefficient.push_back(c);
      slots.direction.push_back(Vec3::Unit(a));
    }
  }
  return slots;
}

Slots direction_slots(const DisplacementSpace& space, const std::vector<char>& selected,
                      const Vec3& direction) {
  const Vec3 unit = direction.normalized();
  Slots slots;
  for (int c = 0; c < space.size(); ++c) {
    if (!selected[static_cast<size_t>(c)]) continue;
    bool possible = true;
    for (int a = 0; a < 3; ++a) {
      possible = possible && !((space.locked_axes(c) >> a & 1u) && unit[a] != 0.0);
    }
    if (!possible) continue;
    slots.coefficient.push_back(c);
    slots.direction.push_back(unit);
  }
  return slots;
}

ConstraintSystem::ConstraintSystem(const DisplacementSpace& space, Slots slots,
                                   const std::vector<LinearConstraint>& constraints,
                                   bool homogeneous, double negligible)
    : space_(&space), slots_(std::move(slots)), negligible_(negligible) {
  scale_.reserve(slots_.size());
  for (int c : slots_.coefficient) scale_.push_back(1.0 / std::sqrt(space.weight(c)));
  std::vector<Vec3> dense(static_cast<size_t>(space.size()), Vec3::Zero());
  for (size_t k = 0; k < constraints.size(); ++k) {
    const CoefficientRow& row = constraints[k].row;
    for (size_t i = 0; i < row.coefficient.size(); ++i) {
      dense[static_cast<size_t>(row.coefficient[i])] += row.value[i];
    }
    // Mirrored halves of a row cancel across the plane up to rounding: that axis is measured by
    // the others, so that its rounding is not taken for an equation.
    Vec3 squares = Vec3::Zero();
    for (const Vec3& value : row.value) squares += value.cwiseAbs2();
    const double natural_size = std::sqrt(squares.maxCoeff());
    for (int a = 0; a < 3; ++a) {
      if (!(constraints[k].axes >> a & 1u)) continue;
      Equation equation{k, std::vector<double>(slots_.size()),
                        homogeneous ? 0.0 : constraints[k].value[a], natural_size};
      for (size_t s = 0; s < slots_.size(); ++s) {
        equation.values[s] = dense[static_cast<size_t>(slots_.coefficient[s])][a] *
                             slots_.direction[s][a] * scale_[s];
      }
      add_equation(constraints, std::move(equation));
    }
    for (int c : row.coefficient) dense[static_cast<size_t>(c)] = Vec3::Zero();
  }
}

void ConstraintSystem::add_equation(const std::vector<LinearConstraint>& constraints,
                                    Equation equation) {
  const std::string& name = constraints[equation.constraint].name;
  ++rows_;
  const double size = std::sqrt(dot(equation.values, equation.values));
  if (!(size > equation.natural_size * std::sqrt(kDependentPivot))) {
    if (std::abs(equation.rhs) > negligible_) add_unique(unreachable_, name);
    return;
  }
  const double inverse = 1.0 / size;
  for (double& value : equation.values) value *= inverse;
  double rhs = equation.rhs * inverse;
  double rhs_size = std::abs(rhs);
  std::vector<double> recipe(equation_constraint_.size() + 1, 0.0);
  recipe.back() = inverse;
  for (int pass = 0; pass < 2; ++pass) {
    for (size_t b = 0; b < basis_.size(); ++b) {
      const double share = dot(equation.values, basis_[b]);
      for (size_t s = 0; s < equation.values.size(); ++s) {
        equation.values[s] -= share * basis_[b][s];
      }
      rhs -= share * basis_rhs_[b];
      rhs_size = std::max(rhs_size, std::abs(share * basis_rhs_[b]));
      for (size_t e = 0; e < recipe_[b].size(); ++e) recipe[e] -= share * recipe_[b][e];
    }
  }
  equation_constraint_.push_back(equation.constraint);
  const double left = dot(equation.values, equation.values);
  if (left > kDependentPivot) {
    const double normalise = 1.0 / std::sqrt(left);
    for (double& value : equation.values) value *= normalise;
    for (double& value : recipe) value *= normalise;
    basis_.push_back(std::move(equation.values));
    basis_rhs_.push_back(rhs * normalise);
    recipe_.push_back(std::move(recipe));
    return;
  }
  // Dependent. The same threshold decides whether the right-hand sides agree.
  const double agree = std::max(std::sqrt(kDependentPivot) * rhs_size, negligible_ * inverse);
  if (std::abs(rhs) <= agree) {
    add_unique(redundant_, name);
    return;
  }
  for (size_t e = 0; e < recipe.size(); ++e) {
    if (std::abs(recipe[e]) > std::sqrt(kDependentPivot) * inverse) {
      add_unique(conflicting_, constraints[equation_constraint_[e]].name);
    }
  }
}

std::vector<double> ConstraintSystem::particular() const {
  std::vector<double> t(slots_.size(), 0.0);
  for (size_t b = 0; b < basis_.size(); ++b) {
    for (size_t s = 0; s < t.size(); ++s) t[s] += basis_rhs_[b] * basis_[b][s];
  }
  return t;
}

void ConstraintSystem::project(std::vector<double>& t) const {
  for (int pass = 0; pass < 2; ++pass) {
    for (const std::vector<double>& row : basis_) {
      const double share = dot(t, row);
      for (size_t s = 0; s < t.size(); ++s) t[s] -= share * row[s];
    }
  }
}

void ConstraintSystem::add_to(const std::vector<double>& t, double scale,
                              std::vector<Vec3>& delta) const {
  for (size_t s = 0; s < t.size(); ++s) {
    delta[static_cast<size_t>(slots_.coefficient[s])] +=
        (scale * t[s] * scale_[s]) * slots_.direction[s];
  }
}

std::vector<double> ConstraintSystem::pull_back(const std::vector<Vec3>& gradient) const {
  std::vector<double> t(slots_.size());
  for (size_t s = 0; s < t.size(); ++s) {
    t[s] =
        gradient[static_cast<size_t>(slots_.coefficient[s])].dot(slots_.direction[s]) * scale_[s];
  }
  return t;
}

}  // namespace isochor
