#include "isochor/edit/linear_constraints.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"

namespace isochor {
namespace {

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

void add_unique(std::vector<std::string>& names, const std::string& name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

// Which slots a coefficient has; the slot's share of axis a is direction[a].
std::vector<std::vector<int>> slots_by_coefficient(const Slots& slots, int coefficients) {
  std::vector<std::vector<int>> by_coefficient(static_cast<size_t>(coefficients));
  for (size_t s = 0; s < slots.size(); ++s) {
    by_coefficient[static_cast<size_t>(slots.coefficient[s])].push_back(static_cast<int>(s));
  }
  return by_coefficient;
}

Rational exact_entry(const CoefficientRow& row, size_t k, int axis) {
  return row.exact.empty() ? Rational(row.value[k][axis]) : row.exact[k][static_cast<size_t>(axis)];
}

// The part of a row that axis `axis` of its coefficients contributes, on the slots.
void add_terms(const CoefficientRow& row, int axis, const Slots& slots,
               const std::vector<std::vector<int>>& slots_of, RationalTerms& terms) {
  for (size_t k = 0; k < row.coefficient.size(); ++k) {
    for (int s : slots_of[static_cast<size_t>(row.coefficient[k])]) {
      const double share = slots.direction[static_cast<size_t>(s)][axis];
      if (share == 0.0) continue;
      Rational value = exact_entry(row, k, axis);
      if (share != 1.0) value *= Rational(share);
      if (!value.is_zero()) terms.emplace_back(s, std::move(value));
    }
  }
}

// -1, 0 or 1 for two rows of a matrix, term by term.
int compare_rows(const ConstraintMatrix& matrix, int a, int b) {
  const ArrayView<ConstraintTerm> first = matrix.row(a);
  const ArrayView<ConstraintTerm> second = matrix.row(b);
  if (first.size() != second.size()) return first.size() < second.size() ? -1 : 1;
  for (size_t k = 0; k < first.size(); ++k) {
    if (first[k].parameter != second[k].parameter) {
      return first[k].parameter < second[k].parameter ? -1 : 1;
    }
    const int order = compare(first[k].coefficient, second[k].coefficient);
    if (order != 0) return order;
  }
  return 0;
}

}  // namespace

// Independent kept rows as unit rows, and the factorisation of their Gram matrix.
struct ConstraintSystem::KeptRows {
  Eigen::SparseMatrix<double, Eigen::RowMajor> rows;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> gram;
};

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
                                   const std::vector<LinearConstraint>& asked, bool homogeneous,
                                   double negligible, const std::vector<LinearConstraint>& kept)
    : space_(&space), slots_(std::move(slots)), homogeneous_(homogeneous), negligible_(negligible) {
  scale_.reserve(slots_.size());
  for (int c : slots_.coefficient) scale_.push_back(1.0 / std::sqrt(space.weight(c)));
  build(asked, kept);
  orthonormalise();
  std::vector<Vec3> values;
  for (const LinearConstraint& constraint : asked) values.push_back(constraint.value);
  ask(values);
}

ConstraintSystem::~ConstraintSystem() = default;
ConstraintSystem::ConstraintSystem(ConstraintSystem&&) noexcept = default;
ConstraintSystem& ConstraintSystem::operator=(ConstraintSystem&&) noexcept = default;

void ConstraintSystem::build(const std::vector<LinearConstraint>& asked,
                             const std::vector<LinearConstraint>& kept) {
  for (const LinearConstraint& constraint : asked) {
    asked_names_.push_back(constraint.name);
    values_.push_back(constraint.value);
  }
  for (const LinearConstraint& constraint : kept) kept_names_.push_back(constraint.name);
  const auto slots_of = slots_by_coefficient(slots_, space_->size());
  std::vector<RationalTerms> matrix_rows;
  const auto add = [&](const LinearConstraint& constraint, int index, int axis) {
    RationalTerms terms;
    for (int a = 0; a < 3; ++a) {
      if (constraint.summed ? (constraint.axes >> a & 1u) != 0 : a == axis) {
        add_terms(constraint.row, a, slots_, slots_of, terms);
      }
    }
    Equation equation{index, axis, -1};
    const bool kept_row = static_cast<size_t>(index) >= asked.size();
    if (kept_row && terms.empty()) return;
    if (!terms.empty()) {
      equation.row = static_cast<int>(matrix_rows.size());
      equation_of_row_.push_back(static_cast<int>(equations_.size()));
      matrix_rows.push_back(std::move(terms));
    }
    equations_.push_back(equation);
  };
  const auto add_all = [&](const std::vector<LinearConstraint>& constraints, size_t offset) {
    for (size_t k = 0; k < constraints.size(); ++k) {
      const int index = static_cast<int>(offset + k);
      if (constraints[k].summed) {
        add(constraints[k], index, 0);
        continue;
      }
      for (int axis = 0; axis < 3; ++axis) {
        if (constraints[k].axes >> axis & 1u) add(constraints[k], index, axis);
      }
    }
  };
  add_all(kept, asked.size());
  const size_t first_asked = matrix_rows.size();
  add_all(asked, 0);
  rows_ = static_cast<int>(equations_.size());

  const int parameters = static_cast<int>(slots_.size());
  matrix_ = std::make_unique<ConstraintMatrix>(parameters, matrix_rows);
  AnalysisOptions options;
  options.precedence = precedence(first_asked);
  Selection selection;
  selection.derived.resize(slots_.size());
  std::iota(selection.derived.begin(), selection.derived.end(), 0);
  analysis_ = analyse(*matrix_, selection, options);
}

// Kept rows come first. Asked constraints follow by what they say, then by what they ask for, and
// only equal ones by the order of input: so verdicts do not depend on it.
std::vector<int> ConstraintSystem::precedence(size_t first_asked) const {
  std::vector<std::vector<int>> rows_of(asked_names_.size());
  for (size_t row = first_asked; row < equation_of_row_.size(); ++row) {
    const Equation& equation = equations_[static_cast<size_t>(equation_of_row_[row])];
    rows_of[static_cast<size_t>(equation.constraint)].push_back(static_cast<int>(row));
  }
  const auto asked_value = [&](int row) {
    const auto e = static_cast<size_t>(equation_of_row_[static_cast<size_t>(row)]);
    return matrix_->scale(row) * Rational(value_of(equations_[e]));
  };
  const auto before = [&](int a, int b) {
    const std::vector<int>& first = rows_of[static_cast<size_t>(a)];
    const std::vector<int>& second = rows_of[static_cast<size_t>(b)];
    if (first.size() != second.size()) return first.size() < second.size();
    for (size_t k = 0; k < first.size(); ++k) {
      const int order = compare_rows(*matrix_, first[k], second[k]);
      if (order != 0) return order < 0;
    }
    for (size_t k = 0; k < first.size(); ++k) {
      const int order = compare(asked_value(first[k]), asked_value(second[k]));
      if (order != 0) return order < 0;
    }
    return false;
  };
  std::vector<int> constraints(asked_names_.size());
  std::iota(constraints.begin(), constraints.end(), 0);
  std::stable_sort(constraints.begin(), constraints.end(), before);
  std::vector<int> place(equation_of_row_.size());
  int next = 0;
  while (next < static_cast<int>(first_asked)) {
    place[static_cast<size_t>(next)] = next;
    ++next;
  }
  for (int constraint : constraints) {
    for (int row : rows_of[static_cast<size_t>(constraint)]) {
      place[static_cast<size_t>(row)] = next++;
    }
  }
  return place;
}

double ConstraintSystem::value_of(const Equation& equation) const {
  if (homogeneous_ || !is_asked(equation)) return 0.0;
  return values_[static_cast<size_t>(equation.constraint)][equation.axis];
}

// The integers of a row may be far beyond doubles: they are divided by the largest first.
ConstraintSystem::UnitRow ConstraintSystem::unit_row(int row) const {
  Integer largest;
  for (const ConstraintTerm& term : matrix_->row(row)) {
    largest = std::max(largest, term.coefficient.abs());
  }
  UnitRow unit;
  double squares = 0.0;
  for (const ConstraintTerm& term : matrix_->row(row)) {
    const double value = Rational(term.coefficient, largest).to_double() *
                         scale_[static_cast<size_t>(term.parameter)];
    unit.terms.emplace_back(term.parameter, value);
    squares += value * value;
  }
  const double normalise = 1.0 / std::sqrt(squares);
  for (auto& term : unit.terms) term.second *= normalise;
  unit.scale = normalise * (matrix_->scale(row) / Rational(largest)).to_double();
  return unit;
}

// Takes the independent rows as unit rows in the metric: the kept ones sparse, the asked ones dense
// and orthonormal to all before them.
void ConstraintSystem::orthonormalise() {
  std::vector<Eigen::Triplet<double>> triplets;
  std::vector<int> asked_rows;
  int kept = 0;
  for (int row : analysis_.independent) {
    const Equation& equation =
        equations_[static_cast<size_t>(equation_of_row_[static_cast<size_t>(row)])];
    if (is_asked(equation)) {
      asked_rows.push_back(row);
      continue;
    }
    for (const auto& [slot, value] : unit_row(row).terms) triplets.emplace_back(kept, slot, value);
    ++kept;
  }
  kept_rows_ = std::make_unique<KeptRows>();
  kept_rows_->rows.resize(kept, static_cast<long>(slots_.size()));
  kept_rows_->rows.setFromTriplets(triplets.begin(), triplets.end());
  if (kept > 0) {
    kept_rows_->gram.compute(kept_rows_->rows * kept_rows_->rows.transpose());
    const bool factored = kept_rows_->gram.info() == Eigen::Success;
    if (!factored) kept_rows_->rows.resize(0, static_cast<long>(slots_.size()));
    if (!factored || !(kept_rows_->gram.vectorD().minCoeff() > kDependentPivot)) {
      add_unique(unresolved_, "continuity");
    }
  }
  for (int row : asked_rows) add_basis_row(row);
}

// What is left of an asked row after all before it; nothing that doubles can use: unresolved.
void ConstraintSystem::add_basis_row(int row) {
  const int e = equation_of_row_[static_cast<size_t>(row)];
  const UnitRow unit = unit_row(row);
  std::vector<double> values(slots_.size(), 0.0);
  for (const auto& [slot, value] : unit.terms) values[static_cast<size_t>(slot)] = value;
  const std::vector<double> given = values;
  std::vector<double> recipe(basis_equation_.size() + 1, 0.0);
  recipe.back() = 1.0;
  for (int pass = 0; pass < 2; ++pass) {
    project_kept(values);
    for (size_t b = 0; b < basis_.size(); ++b) {
      const double share = dot(values, basis_[b]);
      for (size_t s = 0; s < values.size(); ++s) values[s] -= share * basis_[b][s];
      for (size_t k = 0; k < recipe_[b].size(); ++k) recipe[k] -= share * recipe_[b][k];
    }
  }
  const double left = dot(values, values);
  if (!(left > kDependentPivot)) {
    const Equation& equation = equations_[static_cast<size_t>(e)];
    add_unique(unresolved_, asked_names_[static_cast<size_t>(equation.constraint)]);
    return;
  }
  const double normalise = 1.0 / std::sqrt(left);
  for (double& value : values) value *= normalise;
  for (double& value : recipe) value *= normalise;
  basis_.push_back(std::move(values));
  recipe_.push_back(std::move(recipe));
  unit_rows_.push_back(given);
  unit_scale_.push_back(unit.scale);
  basis_equation_.push_back(e);
}

void ConstraintSystem::ask(const std::vector<Vec3>& values) {
  ISOCHOR_REQUIRE(values.size() == asked_names_.size(), values.size(), asked_names_.size());
  values_ = values;
  redundant_.clear();
  conflicting_.clear();
  conflicts_.clear();
  unreachable_.clear();
  for (const Equation& equation : equations_) {
    if (equation.row >= 0 || std::abs(value_of(equation)) <= negligible_) continue;
    add_unique(unreachable_, asked_names_[static_cast<size_t>(equation.constraint)]);
  }
  for (size_t k = 0; k < analysis_.circuits.size(); ++k) {
    const Circuit& circuit = analysis_.circuits[k];
    const std::vector<Rational> multipliers = given_multipliers(*matrix_, circuit);
    Rational residual;
    double size = 0.0;
    for (size_t i = 0; i < circuit.rows.size(); ++i) {
      const Equation& equation =
          equations_[static_cast<size_t>(equation_of_row_[static_cast<size_t>(circuit.rows[i])])];
      if (!is_asked(equation)) continue;
      residual += multipliers[i] * Rational(value_of(equation));
      size += std::abs(multipliers[i].to_double());
    }
    const Equation& dependent = equations_[static_cast<size_t>(
        equation_of_row_[static_cast<size_t>(analysis_.dependent[k])])];
    if (std::abs(residual.to_double()) > negligible_ * size) {
      explain(circuit, residual.to_double());
    } else if (is_asked(dependent)) {
      add_unique(redundant_, asked_names_[static_cast<size_t>(dependent.constraint)]);
    }
  }
}

void ConstraintSystem::explain(const Circuit& circuit, double residual) {
  NamedConflict conflict;
  const std::vector<Rational> multipliers = given_multipliers(*matrix_, circuit);
  // The asked equations first, so that the first multiplier, 1, is one of theirs.
  for (bool asked : {true, false}) {
    for (size_t i = 0; i < circuit.rows.size(); ++i) {
      const Equation& equation =
          equations_[static_cast<size_t>(equation_of_row_[static_cast<size_t>(circuit.rows[i])])];
      if (is_asked(equation) != asked) continue;
      const auto index = static_cast<size_t>(equation.constraint);
      conflict.constraints.push_back(asked ? asked_names_[index]
                                           : kept_names_[index - asked_names_.size()]);
      conflict.multipliers.push_back(multipliers[i]);
    }
  }
  const Rational first = conflict.multipliers.front();
  for (Rational& multiplier : conflict.multipliers) multiplier /= first;
  conflict.residual = residual / first.to_double();
  for (const std::string& name : conflict.constraints) add_unique(conflicting_, name);
  const bool known = std::any_of(conflicts_.begin(), conflicts_.end(), [&](const auto& other) {
    return other.constraints == conflict.constraints && other.multipliers == conflict.multipliers;
  });
  if (!known) conflicts_.push_back(std::move(conflict));
}

std::vector<double> ConstraintSystem::particular() const {
  std::vector<double> t(slots_.size(), 0.0);
  std::vector<double> wanted;
  for (size_t k = 0; k < basis_.size(); ++k) {
    wanted.push_back(value_of(equations_[static_cast<size_t>(basis_equation_[k])]) *
                     unit_scale_[k]);
  }
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<double> missing = wanted;
    if (pass > 0) {
      for (size_t k = 0; k < missing.size(); ++k) missing[k] -= dot(unit_rows_[k], t);
    }
    for (size_t b = 0; b < basis_.size(); ++b) {
      double share = 0.0;
      for (size_t k = 0; k < recipe_[b].size(); ++k) share += recipe_[b][k] * missing[k];
      for (size_t s = 0; s < t.size(); ++s) t[s] += share * basis_[b][s];
    }
    project_kept(t);
  }
  return t;
}

// The Gram matrix of unit rows is well conditioned unless rows nearly depend on each other; what
// one solve leaves, the second takes.
void ConstraintSystem::project_kept(std::vector<double>& t) const {
  if (kept_rows_->rows.rows() == 0) return;
  Eigen::Map<Eigen::VectorXd> vector(t.data(), static_cast<long>(t.size()));
  for (int pass = 0; pass < 2; ++pass) {
    const Eigen::VectorXd shares = kept_rows_->gram.solve(kept_rows_->rows * vector);
    vector -= kept_rows_->rows.transpose() * shares;
  }
}

void ConstraintSystem::project(std::vector<double>& t) const {
  for (int pass = 0; pass < 2; ++pass) {
    project_kept(t);
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
