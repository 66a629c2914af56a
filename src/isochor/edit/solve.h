// The solve: the smallest displacement that meets the linear constraints and the volume.
//
//   minimise 1/2 delta' M delta  subject to  A delta = b,  V(p + F delta) - V(p) = change.
//
// Methods (M is the diagonal metric of the coefficients):
//  isotropic  the positional solution plus a correction along the metric gradient of the volume;
//             the step is the root nearest zero of the exact cubic V(s), and the gradient is taken
//             again at the result until its direction is stationary: then the first-order
//             conditions of the problem above hold. Does not depend on the frame.
//  axis       x, then y, then z (or another order), each with the other two held: the volume is
//             affine in each, so each step is closed form (Sauvage et al. 2008, eq. 15 and 16 are
//             its cases of one and two rows). The whole change is made by the last axis.
//  taylor     volume to first order only [HSB05]: the volume is *not* kept.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "isochor/base/outcome.h"
#include "isochor/edit/linear_constraints.h"
#include "isochor/volume/volume_form.h"

namespace isochor {

struct SolveProblem {
  const DisplacementSpace* space = nullptr;
  const VolumeForm* volume = nullptr;
  const std::vector<Vec3>* points = nullptr;  // p
  std::vector<char> extent;                   // coefficients that may move
  std::vector<char> sink;                     // coefficients that may take the volume correction
  Vec3 sink_direction = Vec3::Zero();         // nonzero: the correction only goes along it
  std::vector<LinearConstraint> constraints;  // asked for
  std::vector<LinearConstraint> kept;         // equations of the skin: homogeneous, always there
  bool volume_free = false;
  double change = 0.0;        // wanted V(after) - V(before)
  double volume_scale = 1.0;  // |V|: the change is met within kVolumeKept times this
  double size = 1.0;          // diagonal: a correction longer than this is not one
  Method method = Method::kIsotropic;
  std::array<int, 3> axis_order = {0, 1, 2};
};

struct SolveResult {
  Outcome outcome = Outcome::kDone;
  std::string reason;                    // in words, when not done
  std::vector<std::string> culprits;     // constraints to blame, as users wrote them
  std::vector<NamedConflict> conflicts;  // when conflicting: each with its proof
  std::vector<std::string> redundant;
  double kept_residual = 0.0;  // largest of the kept rows at delta, rows of length 1; a length
  int rows = 0, rank = 0, freedom_left = 0;
  std::vector<Vec3> delta;         // by coefficient
  double achieved_change = 0.0;    // V(after) - V(before)
  double positional_energy = 0.0;  // 1/2 delta' M delta for the moves alone
  double energy = 0.0;             // and with the volume correction
  int iterations = 0;
  double stationarity = 0.0;  // sine of the angle between the last two directions
};

// Solves one problem for many right-hand sides: verdicts and factorisations do not depend on them.
class EditSolver {
 public:
  // What the problem points to must outlive the solver. PreconditionError for sizes that do not
  // fit.
  explicit EditSolver(SolveProblem problem);
  ~EditSolver();
  EditSolver(EditSolver&&) noexcept;
  EditSolver& operator=(EditSolver&&) noexcept;

  // values[k] is the right-hand side of constraint k; change and scale as in SolveProblem.
  SolveResult solve(const std::vector<Vec3>& values, double change, double volume_scale);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// The same once, for the values of the problem.
SolveResult solve(const SolveProblem& problem);

}  // namespace isochor
