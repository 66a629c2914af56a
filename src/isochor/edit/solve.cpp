#include "isochor/edit/solve.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/edit/nearest_root.h"

namespace isochor {
namespace {

constexpr int kMostIterations = 200;

double norm(const std::vector<double>& t) {
  return std::sqrt(std::inner_product(t.begin(), t.end(), t.begin(), 0.0));
}

std::string list(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

// Exact when that is short; reports have all digits.
std::string short_text(const Rational& value) {
  constexpr size_t kReadable = 12;
  std::string text = value.to_string();
  if (text.size() <= kReadable) return text;
  std::ostringstream rounded;
  rounded << value.to_double();
  return rounded.str();
}

// "move[0] and hold[1] contradict each other within the extent: 1 x move[0] - 1 x hold[1] reads
// 0 = 0.1".
std::string sentence(const NamedConflict& conflict) {
  constexpr size_t kMostTerms = 6;
  std::vector<std::string> names;
  std::string sum;
  for (size_t k = 0; k < conflict.constraints.size(); ++k) {
    const std::string& name = conflict.constraints[k];
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    if (k == kMostTerms) sum += " + ...";
    if (k >= kMostTerms) continue;
    const Rational& multiplier = conflict.multipliers[k];
    sum += k == 0 ? "" : multiplier.sign() < 0 ? " - " : " + ";
    sum += short_text(multiplier.abs()) + " x " + name;
  }
  const std::string what = names.size() == 1 ? names.front() + " contradicts itself"
                                             : list(names) + " contradict each other";
  std::ostringstream text;
  text << what << " within the extent: " << sum << " reads 0 = " << conflict.residual;
  return text.str();
}

std::string print(double value) {  // std::to_string would print a change of 1e-18 as zero
  std::ostringstream text;
  text << value;
  return text.str();
}

// What does not depend on right-hand sides: constraint systems by the axes that they solve for.
struct Prepared {
  Support support;
  std::map<unsigned, ConstraintSystem> positions, corrections;
};

Support support_of(const SolveProblem& problem) {
  std::vector<char> moving = problem.extent;
  for (size_t c = 0; c < moving.size(); ++c) moving[c] = moving[c] || problem.sink[c];
  return problem.volume->support_of(problem.space->moved_points(moving));
}

// All state of one solve.
class Solver {
 public:
  Solver(const SolveProblem& problem, Prepared& prepared)
      : problem_(problem), space_(*problem.space), prepared_(prepared), support_(prepared.support) {
    result_.delta.assign(static_cast<size_t>(space_.size()), Vec3::Zero());
  }

  SolveResult run() {
    switch (problem_.method) {
      case Method::kIsotropic:
        isotropic();
        break;
      case Method::kAxis:
        by_axis();
        break;
      case Method::kTaylor:
        taylor();
        break;
    }
    if (result_.outcome == Outcome::kDone) {
      result_.achieved_change =
          problem_.volume->change(*problem_.points, points_at(result_.delta), support_);
      result_.energy = energy(result_.delta);
      result_.kept_residual = kept_residual();
      check_size();
    }
    return std::move(result_);
  }

 private:
  std::vector<Vec3> points_at(const std::vector<Vec3>& delta) const {
    std::vector<Vec3> points = space_.expand(delta);
    for (size_t i = 0; i < points.size(); ++i) points[i] += (*problem_.points)[i];
    return points;
  }

  double change_at(const std::vector<Vec3>& delta) const {
    return problem_.volume->change(*problem_.points, points_at(delta), support_);
  }

  // The gradient with respect to the coefficients at p + F delta.
  std::vector<Vec3> gradient_at(const std::vector<Vec3>& delta) const {
    const std::vector<Vec3> rows = problem_.volume->gradient(points_at(delta), support_);
    std::vector<Vec3> full(static_cast<size_t>(space_.point_count()), Vec3::Zero());
    for (size_t k = 0; k < support_.points.size(); ++k) {
      full[static_cast<size_t>(support_.points[k])] = rows[k];
    }
    return space_.gather(full);
  }

  double energy(const std::vector<Vec3>& delta) const {
    double sum = 0.0;
    for (int c = 0; c < space_.size(); ++c) {
      sum += 0.5 * space_.weight(c) * delta[static_cast<size_t>(c)].squaredNorm();
    }
    return sum;
  }

  void stop(Outcome outcome, std::string reason, std::vector<std::string> culprits = {}) {
    result_.outcome = outcome;
    result_.reason = std::move(reason);
    result_.culprits = std::move(culprits);
  }

  // Summed equations are refused beforehand where axes are solved one by one. Kept rows need no
  // such copy: equations of axes without unknowns are left out.
  static std::vector<LinearConstraint> restricted(std::vector<LinearConstraint> constraints,
                                                  unsigned axes) {
    for (LinearConstraint& constraint : constraints) constraint.axes &= axes;
    return constraints;
  }

  const ConstraintSystem& positional_system(unsigned axes) {
    auto found = prepared_.positions.find(axes);
    if (found == prepared_.positions.end()) {
      ConstraintSystem system(space_, axis_slots(space_, problem_.extent, axes),
                              restricted(problem_.constraints, axes), false,
                              kReached * problem_.size, problem_.kept);
      return prepared_.positions.emplace(axes, std::move(system)).first->second;
    }
    std::vector<Vec3> values;
    for (const LinearConstraint& constraint : problem_.constraints) {
      values.push_back(constraint.value);
    }
    found->second.ask(values);
    return found->second;
  }

  // Corrections solve the same equations with right-hand sides of zero: often on the same unknowns.
  const ConstraintSystem& correction_system(unsigned axes) {
    const bool directed = problem_.sink_direction.squaredNorm() > 0.0;
    if (!directed && problem_.sink == problem_.extent) return prepared_.positions.at(axes);
    const auto found = prepared_.corrections.find(axes);
    if (found != prepared_.corrections.end()) return found->second;
    Slots slots = directed ? direction_slots(space_, problem_.sink, problem_.sink_direction)
                           : axis_slots(space_, problem_.sink, axes);
    ConstraintSystem system(space_, std::move(slots), restricted(problem_.constraints, axes), true,
                            0.0, problem_.kept);
    return prepared_.corrections.emplace(axes, std::move(system)).first->second;
  }

  // Of the displacement as it comes out, in doubles.
  double kept_residual() const {
    double largest = 0.0;
    for (const LinearConstraint& kept : problem_.kept) {
      Vec3 sum = Vec3::Zero();
      Vec3 squares = Vec3::Zero();
      for (size_t k = 0; k < kept.row.coefficient.size(); ++k) {
        const Vec3& d = result_.delta[static_cast<size_t>(kept.row.coefficient[k])];
        sum += kept.row.value[k].cwiseProduct(d);
        squares += kept.row.value[k].cwiseAbs2();
      }
      if (kept.summed) {
        largest = std::max(largest, std::abs(sum.sum()) / std::sqrt(squares.sum()));
        continue;
      }
      for (int a = 0; a < 3; ++a) {
        if (squares[a] > 0.0) {
          largest = std::max(largest, std::abs(sum[a]) / std::sqrt(squares[a]));
        }
      }
    }
    return largest;
  }

  // Adds the counts of a system to the result; false when the positions alone are impossible.
  bool accept(const ConstraintSystem& system) {
    result_.rows += system.rows();
    result_.rank += system.rank();
    result_.freedom_left += static_cast<int>(system.slots().size()) - system.rank();
    for (const std::string& name : system.redundant()) {
      auto& all = result_.redundant;
      if (std::find(all.begin(), all.end(), name) == all.end()) all.push_back(name);
    }
    if (!system.unreachable().empty()) {
      stop(Outcome::kInfeasible,
           "no free coefficient of the extent moves what " + list(system.unreachable()) +
               " asks for: enlarge the extent, refine, or choose another place",
           system.unreachable());
      return false;
    }
    if (!system.conflicting().empty()) {
      result_.conflicts = system.conflicts();
      stop(Outcome::kConflicting, sentence(system.conflicts().front()), system.conflicting());
      return false;
    }
    if (!system.unresolved().empty()) {
      stop(Outcome::kUndecided,
           "within this extent " + list(system.unresolved()) +
               " can only be met by displacements beyond what doubles resolve: enlarge the extent",
           system.unresolved());
      return false;
    }
    return true;
  }

  std::vector<std::string> constraint_names() const {
    std::vector<std::string> names;
    for (const LinearConstraint& constraint : problem_.constraints)
      names.push_back(constraint.name);
    return names;
  }

  // The size of the gradient on the coefficients of a system, whatever axes its unknowns may use:
  // what a gradient must be compared with before its rounding is taken for a direction.
  static double size_on(const ConstraintSystem& system, const std::vector<Vec3>& full) {
    double sum = 0.0;
    for (int c : system.slots().coefficient) sum += full[static_cast<size_t>(c)].squaredNorm();
    return std::sqrt(sum);
  }

  // The volume cannot be corrected: says which of the published degenerate cases it is.
  void stop_without_direction(const std::vector<double>& gradient, double gradient_scale,
                              double missing, bool proven, const std::string& where) {
    std::vector<std::string> culprits = constraint_names();
    culprits.emplace_back("volume");
    std::string text = "the volume is off by " + print(missing) + " and ";
    if (norm(gradient) <= kVanishing * gradient_scale) {
      text += "no free coefficient changes it" + where + " (the gradient vanishes on the extent)";
    } else {
      text += "every change of it" + where +
              " would also move a constrained point (gradient and constraints are dependent on "
              "the extent)";
    }
    stop(proven ? Outcome::kInfeasible : Outcome::kUndecided,
         text + ": enlarge the extent or choose another sink", culprits);
  }

  bool close_enough(double missing) const {
    return std::abs(missing) <= kVolumeKept * problem_.volume_scale;
  }

  // A change larger than the model is no answer a designer could want.
  void check_size() {
    double largest = 0.0;
    for (const Vec3& d : result_.delta) largest = std::max(largest, d.norm());
    double asked = 0.0;
    for (const LinearConstraint& c : problem_.constraints) asked = std::max(asked, c.value.norm());
    if (largest <= problem_.size + 10.0 * asked) return;
    const std::string goal = problem_.volume_free ? "reaching what is asked" : "keeping the volume";
    stop(Outcome::kUndecided,
         goal + " within this extent would move control points by " + print(largest) +
             ", more than the size of the model: enlarge the extent",
         problem_.volume_free ? constraint_names() : std::vector<std::string>{"volume"});
  }

  // The smoothest displacement that meets the positions; false when none does.
  bool meet_positions() {
    const ConstraintSystem& positions = positional_system(7);
    if (!accept(positions)) return false;
    positions.add_to(positions.particular(), 1.0, result_.delta);
    result_.positional_energy = energy(result_.delta);
    return true;
  }

  void isotropic() {
    if (!meet_positions() || problem_.volume_free) return;
    const ConstraintSystem& correction = correction_system(7);
    const std::vector<Vec3> positional = result_.delta;
    const double missing = problem_.change - change_at(positional);
    std::vector<double> direction;
    for (int k = 0; k < kMostIterations; ++k) {
      const std::vector<Vec3> full = gradient_at(result_.delta);
      const std::vector<double> gradient = correction.pull_back(full);
      std::vector<double> next = gradient;
      correction.project(next);
      const double length = norm(next);
      const double scale = size_on(correction, full);
      if (!(length > kVanishing * scale)) {
        if (k == 0 && close_enough(missing)) return;
        const bool proven = correction.slots().size() == static_cast<size_t>(correction.rank());
        return stop_without_direction(gradient, scale, missing, proven, "");
      }
      for (double& value : next) value /= length;
      if (!direction.empty()) {
        result_.stationarity = turn(direction, next);
        if (result_.stationarity <= kStationary) break;
      }
      direction = std::move(next);
      result_.iterations = k + 1;
      if (!step_along(correction, positional, direction)) return;
    }
  }

  // The sine of the angle between two unit vectors, up to sign.
  static double turn(const std::vector<double>& a, const std::vector<double>& b) {
    const double along = std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
    double across = 0.0;
    for (size_t s = 0; s < a.size(); ++s) {
      const double difference = b[s] - along * a[s];
      across += difference * difference;
    }
    return std::sqrt(across);
  }

  // delta = positional + s * direction with the exact volume; false when there is no such s.
  bool step_along(const ConstraintSystem& correction, const std::vector<Vec3>& positional,
                  const std::vector<double>& direction) {
    std::vector<Vec3> unit(positional.size(), Vec3::Zero());
    correction.add_to(direction, 1.0, unit);
    const std::vector<Vec3> base = points_at(positional);
    const LineCubic cubic = problem_.volume->line_cubic(base, space_.expand(unit), support_);
    const double missing = problem_.change - change_at(positional);
    double s = nearest_root(cubic, missing);
    if (!std::isfinite(s)) {
      stop(Outcome::kUndecided,
           "no step along the volume gradient restores the volume: enlarge the extent", {"volume"});
      return false;
    }
    // The points are rounded to doubles: correct s once or twice for what that costs.
    for (int pass = 0; pass < 2; ++pass) {
      result_.delta = positional;
      correction.add_to(direction, s, result_.delta);
      const double slope = cubic.slope(s);
      if (pass == 1 || slope == 0.0) break;
      s += (problem_.change - change_at(result_.delta)) / slope;
    }
    return true;
  }

  void by_axis() {
    double positional_energy = 0.0;
    for (size_t turn_of = 0; turn_of < 3; ++turn_of) {
      const int axis = problem_.axis_order[turn_of];
      const unsigned bit = 1u << axis;
      const ConstraintSystem& positions = positional_system(bit);
      if (!accept(positions)) return;
      const std::vector<Vec3> before = result_.delta;
      positions.add_to(positions.particular(), 1.0, result_.delta);
      positional_energy += energy(result_.delta) - energy(before);
      if (problem_.volume_free) continue;
      const double wanted = turn_of == 2 ? problem_.change : 0.0;
      if (!correct_axis(axis, wanted)) return;
    }
    result_.positional_energy = positional_energy;
  }

  // Makes the change of volume `wanted` by the one axis; the volume is affine in it.
  bool correct_axis(int axis, double wanted) {
    const ConstraintSystem& correction = correction_system(1u << axis);
    const std::vector<Vec3> full = gradient_at(result_.delta);
    const std::vector<double> gradient = correction.pull_back(full);
    std::vector<double> direction = gradient;
    correction.project(direction);
    const double missing = wanted - change_at(result_.delta);
    const double scale = size_on(correction, full);
    const double length = norm(direction);
    if (!(length > kVanishing * scale)) {
      if (close_enough(missing)) return true;
      const std::string where = std::string(" along ") + static_cast<char>('x' + axis);
      stop_without_direction(gradient, scale, missing, true, where);
      return false;
    }
    const std::vector<Vec3> start = result_.delta;
    double s = missing / (length * length);
    for (int pass = 0; pass < 2; ++pass) {
      result_.delta = start;
      correction.add_to(direction, s, result_.delta);
      if (pass == 0) s += (wanted - change_at(result_.delta)) / (length * length);
    }
    return true;
  }

  void taylor() {
    if (!meet_positions() || problem_.volume_free) return;
    const ConstraintSystem& correction = correction_system(7);
    const std::vector<Vec3> none(result_.delta.size(), Vec3::Zero());
    const std::vector<Vec3> full = gradient_at(none);
    const std::vector<double> gradient = correction.pull_back(full);
    std::vector<double> direction = gradient;
    correction.project(direction);
    double first_order = 0.0;
    for (size_t c = 0; c < full.size(); ++c) first_order += full[c].dot(result_.delta[c]);
    const double missing = problem_.change - first_order;
    const double length = norm(direction);
    const double scale = size_on(correction, full);
    if (!(length > kVanishing * scale)) {
      if (close_enough(missing)) return;
      return stop_without_direction(gradient, scale, missing, true, "");
    }
    correction.add_to(direction, missing / (length * length), result_.delta);
  }

  const SolveProblem& problem_;
  const DisplacementSpace& space_;
  Prepared& prepared_;
  const Support& support_;
  SolveResult result_;
};

}  // namespace

struct EditSolver::State {
  SolveProblem problem;
  Prepared prepared;
};

EditSolver::EditSolver(SolveProblem problem)
    : state_(std::make_unique<State>(State{std::move(problem), {}})) {
  const SolveProblem& given = state_->problem;
  ISOCHOR_REQUIRE(given.space != nullptr && given.volume != nullptr && given.points != nullptr);
  const auto count = static_cast<size_t>(given.space->size());
  ISOCHOR_REQUIRE(given.extent.size() == count && given.sink.size() == count, count);
  std::array<int, 3> axes = given.axis_order;
  std::sort(axes.begin(), axes.end());
  ISOCHOR_REQUIRE((axes == std::array<int, 3>{0, 1, 2}), axes[0], axes[1], axes[2]);
  state_->prepared.support = support_of(given);
}

EditSolver::~EditSolver() = default;
EditSolver::EditSolver(EditSolver&&) noexcept = default;
EditSolver& EditSolver::operator=(EditSolver&&) noexcept = default;

SolveResult EditSolver::solve(const std::vector<Vec3>& values, double change, double volume_scale) {
  SolveProblem& problem = state_->problem;
  ISOCHOR_REQUIRE(values.size() == problem.constraints.size(), values.size());
  for (size_t k = 0; k < values.size(); ++k) problem.constraints[k].value = values[k];
  problem.change = change;
  problem.volume_scale = volume_scale;
  return Solver(problem, state_->prepared).run();
}

SolveResult solve(const SolveProblem& problem) {
  std::vector<Vec3> values;
  for (const LinearConstraint& constraint : problem.constraints) values.push_back(constraint.value);
  return EditSolver(problem).solve(values, problem.change, problem.volume_scale);
}

}  // namespace isochor
