// Chained edits whose constraints hold exactly for ever, in numbers of 64 bits.
//
// Exact rational updates grow by thousands of digits in a few hundred edits. Here every parameter
// is an integer multiple of one unit, 1 / (denominator 2^bits), and an edit moves the derived
// parameters to the integer solution of the constraints that lies next to the least-squares
// optimum: first the optimum in doubles (LeastChange), then, block by block, rounding inside the
// lattice of integer solutions (lattice_blocks.h). Whatever the doubles say, only exact solutions
// can come out, so residuals never change, and the numbers never grow longer.
//
// Symbols (Rodrigues 2017, ch. 5): A anchors, D derived, F fixed; z the anchors' moves.
//
// Laws (tests/ecles/grid_editor_test.cpp):
//  (1) exact:    residual(c, i) of every row never changes
//  (2) bound:    |value - least-squares optimum for the anchors used| <= GridUpdate::distance, and
//                <= GridUpdate::bound, which is known before the edit but for the doubles' slack
//  (3) base:     update() starts from the state at initialize(): the last call alone counts
//  (4) refusal:  an update that is not done changes nothing and says why
// Where the grid has no solution for the anchors' targets the policy decides: snap to a near
// admissible move and report the deviation, or refuse and name the rows and the divisor.
// Limits: numbers beyond 64 bits are refused by value. Blocks that no lattice suits (GridOptions)
// are solved in rationals, exactly, but their digits then do grow.
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "isochor/ecles/analysis.h"
#include "isochor/ecles/constraint_matrix.h"
#include "isochor/ecles/relevant.h"
#include "isochor/exact/rational.h"

namespace isochor {

namespace internal {
class LatticeCache;
}

enum class AnchorPolicy { kSnap, kRequireExact };

struct GridOptions {
  std::vector<Rational> weights;  // in the order of Selection::derived; empty for all equal
  AnchorPolicy policy = AnchorPolicy::kSnap;
  // Blocks with more columns are divided; what stays larger, or may round by more than
  // largest_rounding (model units), is solved in rationals.
  int largest_block = 64;
  double largest_rounding = std::numeric_limits<double>::infinity();
};

// What initialize() found. Lengths in model units.
struct GridPlan {
  int blocks = 0;           // lattices
  int free_parameters = 0;  // derived, in no row: rounded alone
  std::vector<int> loose;   // derived parameters to be solved in rationals
  bool restricted = false;  // a component too large was divided; some grid solutions are not seen
  double bound = 0.0;       // largest distance of rounding from the optimum; infinite where a loose
                            // block hangs on rounded parameters
};

// Multipliers y of stored rows: y^T R_ED has integer entries (`restricted`: on the multiples that
// the division of a large component allows), y^T R_EA z = value has not.
struct GridObstacle {
  int component = 0;
  std::vector<int> rows;
  std::vector<Rational> multipliers;
  Rational value;
  bool restricted = false;
};

struct GridUpdate {
  enum class Outcome {
    kDone,
    kAnchorOffGrid,   // kRequireExact: a target is no multiple of the unit
    kNoGridSolution,  // kRequireExact: the derived parameters cannot follow on the grid
    kNotSolvable,     // a relevant row cannot follow at all: not strongly solvable
    kTooLarge,        // a number leaves 64 bits, or an anchor moves by more than 2^53 units
  };
  Outcome outcome = Outcome::kDone;
  std::string reason;                          // for people; empty when done
  GridObstacle obstacle;                       // of kNoGridSolution
  std::vector<std::vector<Rational>> anchors;  // by component, in the order of A: values used
  double deviation = 0.0;                      // largest |anchor used - target|
  double distance = 0.0;  // largest |derived - optimum|, from above, a posteriori
  double bound = 0.0;     // the same, a priori: the plan's bound plus the slack of the doubles
};

// Copies share the lattices met so far: edit them on one thread.
class GridEditor {
 public:
  // values[component][parameter]: exact multiples of 1 / (denominator 2^bits) within 64 bits,
  // InputError otherwise. They need not satisfy anything: residuals stay what they are.
  GridEditor(ConstraintMatrix matrix, const Integer& denominator, unsigned bits,
             const std::vector<std::vector<Rational>>& values);

  const ConstraintMatrix& matrix() const { return matrix_; }
  const Rational& unit() const { return unit_; }
  int components() const { return static_cast<int>(numbers_.size()); }
  // value == (number + rest) unit; rest is zero but for parameters that were loose once.
  long number(int component, int parameter) const;
  Rational rest(int component, int parameter) const;
  Rational value(int component, int parameter) const;
  // Of the stored row (scale times the given one): its value. Exact.
  Rational row_value(int component, int row) const;

  // The current state becomes the base of updates. `analysis` is that of the same matrix and
  // selection. PreconditionError for weights of the wrong number or sign.
  GridPlan initialize(const Selection& selection, const Analysis& analysis,
                      const GridOptions& options = {});
  // targets[component][k] for A, hints[component][k] for D, in model units. Hints must be finite.
  // PreconditionError for the wrong shape or before initialize().
  GridUpdate update(const std::vector<std::vector<Rational>>& targets,
                    const std::vector<std::vector<double>>& hints);
  // Back to the base.
  void cancel();

 private:
  struct Job;
  struct Move;
  Rational exact_number(int component, int parameter) const;
  bool move_anchors(const std::vector<Rational>& targets, Move& move, GridUpdate& report) const;
  bool move_derived(const std::vector<double>& hints, Move& move, GridUpdate& report);
  void move_loose(const std::vector<double>& hints, Move& move) const;
  bool check(const Move& move, GridUpdate& report) const;
  void apply(const Move& move);

  ConstraintMatrix matrix_;
  Rational unit_;
  std::vector<std::vector<long>> numbers_;
  std::vector<std::map<int, Rational>> rests_;
  std::vector<double> zero_rows_, increments_;  // zero between updates
  std::shared_ptr<internal::LatticeCache> cache_;
  std::shared_ptr<Job> job_;
};

}  // namespace isochor
