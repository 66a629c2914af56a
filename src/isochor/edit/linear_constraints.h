// Linear constraints on a chosen set of unknowns: judged exactly once, solved many times.
//
// Symbols: a *slot* s is one unknown t_s: coefficient c(s) moves by t_s * direction(s) / sqrt(m_c),
// m_c the metric weight, so that |t|^2 is the metric. A constraint is a CoefficientRow with a
// right-hand side per axis (three scalar equations), or one equation that sums over the axes. The
// *asked* constraints are the user's; the *kept* ones hold the skin together (homogeneous rows of
// continuity.h's relations) and come first.
//
// Which equations are independent, redundant or contradictory is decided by ecles on the rational
// rows: it does not depend on the pose, on rounding, or on the order of the asked constraints.
// Right-hand sides are displacements of computed positions: what a contradiction amounts to counts
// as rounding while it is at most `negligible`, a length, per unit of its multipliers. The numbers
// are then computed in doubles on the independent equations: the kept ones through a sparse
// factorisation, the asked ones orthonormalised against them.
//
// Laws:
//  (1) particular is the shortest solution; project is the orthogonal projection on the null space;
//  (2) a conflict's constraints contradict each other, any proper subset does not, and its
//      multipliers times its equations read 0 = residual;
//  (3) redundant equations are ignored: leaving them out changes no result.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "isochor/ecles/conflicts.h"
#include "isochor/edit/displacement_space.h"
#include "isochor/edit/named_conflict.h"

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
  unsigned axes = 7;    // which of the three equations are asked for
  bool summed = false;  // one equation, the sum over the axes; its right-hand side is value.x()
};

class ConstraintSystem {
 public:
  // With `homogeneous` the right-hand sides are taken as zero. `kept` rows are homogeneous always.
  // Cost: that of ecles' analysis, plus O(#slots * #asked equations^2).
  ConstraintSystem(const DisplacementSpace& space, Slots slots,
                   const std::vector<LinearConstraint>& asked, bool homogeneous,
                   double negligible = 0.0, const std::vector<LinearConstraint>& kept = {});
  ~ConstraintSystem();
  ConstraintSystem(ConstraintSystem&&) noexcept;
  ConstraintSystem& operator=(ConstraintSystem&&) noexcept;

  // New right-hand sides, one per asked constraint. Cost O(#asked equations * #slots).
  void ask(const std::vector<Vec3>& values);

  const Slots& slots() const { return slots_; }
  // Asked equations and the kept ones that involve a slot; how many of them are independent.
  int rows() const { return rows_; }
  int rank() const { return analysis_.rank(); }
  // Names of asked constraints of which some equation follows from others that agree with it.
  const std::vector<std::string>& redundant() const { return redundant_; }
  // The names in conflicts(), each once; empty: consistent.
  const std::vector<std::string>& conflicting() const { return conflicting_; }
  const std::vector<NamedConflict>& conflicts() const { return conflicts_; }
  // Constraints that ask for something that no slot can do.
  const std::vector<std::string>& unreachable() const { return unreachable_; }
  // Asked constraints that are independent, but by less than doubles can resolve.
  const std::vector<std::string>& unresolved() const { return unresolved_; }

  // The shortest t that satisfies all (independent) equations.
  std::vector<double> particular() const;
  // t minus its part in the row space: the nearest vector that changes no constraint value.
  void project(std::vector<double>& t) const;

  // From unknowns to coefficients (adds to delta) and, transposed, from gradients to unknowns.
  void add_to(const std::vector<double>& t, double scale, std::vector<Vec3>& delta) const;
  std::vector<double> pull_back(const std::vector<Vec3>& coefficient_gradient) const;

 private:
  struct Equation {
    int constraint = 0;  // index of input; kept ones are counted after the asked ones
    int axis = 0;        // of the right-hand side
    int row = -1;        // of the matrix; -1: it involves no slot
  };
  // A row of the matrix on the scaled unknowns, of length 1, and the factor from the right-hand
  // side as given.
  struct UnitRow {
    std::vector<std::pair<int, double>> terms;
    double scale = 1.0;
  };
  struct KeptRows;
  UnitRow unit_row(int row) const;
  void build(const std::vector<LinearConstraint>& asked, const std::vector<LinearConstraint>& kept);
  std::vector<int> precedence(size_t first_asked) const;
  void orthonormalise();
  void add_basis_row(int row);
  void project_kept(std::vector<double>& t) const;
  void explain(const Circuit& circuit, double residual);
  double value_of(const Equation& equation) const;
  bool is_asked(const Equation& equation) const {
    return static_cast<size_t>(equation.constraint) < asked_names_.size();
  }

  const DisplacementSpace* space_;
  Slots slots_;
  bool homogeneous_;
  double negligible_;
  std::vector<double> scale_;  // 1 / sqrt(m) by slot
  std::vector<std::string> asked_names_, kept_names_;
  std::vector<Vec3> values_;  // by asked constraint
  std::vector<Equation> equations_;
  std::vector<int> equation_of_row_;
  std::unique_ptr<ConstraintMatrix> matrix_;
  Analysis analysis_;
  std::unique_ptr<KeptRows> kept_rows_;
  // Independent asked equations: unit rows, orthonormal rows, and these as combinations of those.
  std::vector<int> basis_equation_;
  std::vector<std::vector<double>> unit_rows_, basis_, recipe_;
  std::vector<double> unit_scale_;
  int rows_ = 0;
  std::vector<std::string> redundant_, conflicting_, unreachable_, unresolved_;
  std::vector<NamedConflict> conflicts_;
};

}  // namespace isochor
