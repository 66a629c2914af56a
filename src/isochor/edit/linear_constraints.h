// Linear constraints on a chosen set of unknowns, made orthonormal once, used many times.
//
// Symbols: a *slot* s is one unknown t_s: coefficient c(s) moves by t_s * direction(s) / sqrt(m_c),
// m_c the metric weight, so that |t|^2 is the metric. A constraint is a CoefficientRow and a
// right-hand side per axis: three scalar equations.
//
// The equations are orthonormalised in order of input (Gram-Schmidt, twice): an equation that
// depends on earlier ones is redundant when its right-hand side agrees and conflicting when not.
// Dependence is decided in floating point with kDependentPivot; near ties are possible, exact
// verdicts are the exact engine's task. Right-hand sides are displacements: what is left of them
// counts as rounding when it is at most `negligible`, a length.
#pragma once

#include <string>
#include <vector>

#include "isochor/edit/displacement_space.h"

namespace isochor {

struct Slots {
  std::vector<int> coefficient;
  std::vector<Vec3> direction;
  size_t size() const { return coefficient.size(); }
};

// One unknown per unlocked axis of every selected coefficient; `axes` masks the axes.
Slots axis_slots(const DisplacementSpace& space, const std::vector<char>& selected, unsigned axes);
// One unknown per selected coefficient that may move along `direction`.
Slots direction_slots(const DisplacementSpace& space, const std::vector<char>& selected,
                      const Vec3& direction);

struct LinearConstraint {
  std::string name;  // as users wrote it: "move[0]", "hold[1]"
  CoefficientRow row;
  Vec3 value = Vec3::Zero();
  unsigned axes = 7;  // which of the three equations are asked for
};

class ConstraintSystem {
 public:
  // With `homogeneous` the right-hand sides are taken as zero. Cost O(#slots * #equations^2).
  ConstraintSystem(const DisplacementSpace& space, Slots slots,
                   const std::vector<LinearConstraint>& constraints, bool homogeneous,
                   double negligible = 0.0);

  const Slots& slots() const { return slots_; }
  int rows() const { return rows_; }
  int rank() const { return static_cast<int>(basis_.size()); }
  const std::vector<std::string>& redundant() const { return redundant_; }
  // Names of constraints that contradict each other, a minimal-looking set; empty: consistent.
  const std::vector<std::string>& conflicting() const { return conflicting_; }
  // Constraints that ask for something that no slot can do.
  const std::vector<std::string>& unreachable() const { return unreachable_; }

  // The shortest t that satisfies all (independent) equations.
  std::vector<double> particular() const;
  // t minus its part in the row space: the nearest vector that changes no constraint value.
  void project(std::vector<double>& t) const;

  // From unknowns to coefficients (adds to delta) and, transposed, from gradients to unknowns.
  void add_to(const std::vector<double>& t, double scale, std::vector<Vec3>& delta) const;
  std::vector<double> pull_back(const std::vector<Vec3>& coefficient_gradient) const;

 private:
  struct Equation {
    size_t constraint;  // index of input
    std::vector<double> values;
    double rhs;
    double natural_size;  // norm of the row before slots were restricted: that of its largest axis
  };
  void add_equation(const std::vector<LinearConstraint>& constraints, Equation equation);

  const DisplacementSpace* space_;
  Slots slots_;
  double negligible_;
  std::vector<double> scale_;               // 1 / sqrt(m) by slot
  std::vector<std::vector<double>> basis_;  // orthonormal rows
  std::vector<double> basis_rhs_;
  std::vector<std::vector<double>> recipe_;  // basis row as a combination of input equations
  std::vector<size_t> equation_constraint_;  // input equation -> constraint
  int rows_ = 0;
  std::vector<std::string> redundant_, conflicting_, unreachable_;
};

}  // namespace isochor
