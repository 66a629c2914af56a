// The volume of polynomial models and its gradient by tensors on differences of poles: no Gauss
// points at run time, O(d^2) operations a pole.
//
// Symbols: patch S = sum p_ij B_i(u) B_j(v) with poles p; a_ij = iint B_i B_j (S_u x S_v) du dv is
// the vector area weighted by one basis product. On a closed model the gradient of the volume with
// respect to a point is the signed sum of a_ij over the places where patches use it; on an open one
// integrals along the rim come on top (rim.h). The volume is the sum of heights times third
// components. The tensors are those of tau_tensor.h; the derivation is in docs/volume.md, "Tensors
// on differences", the loops in contraction_stages.h.
//
// Laws (tests of those names in tests/volume/contraction_test.cpp):
//  (1) second method: equal to VolumeForm's quadrature, the published tensors and ExactVolume up to
//      rounding; the error of the gradient grows like the number of poles a side, not like its
//      square as with theta tensors
//  (2) translation:   on closed models, moving all points by the same vector changes no bit of
//  value
//      and gradient where the sums of coordinates are exact
//  (3) threads:       their number changes no bit; instruction sets differ by rounding
//  (4) locality:      a part of the gradient has the bits that the whole gradient has there
//  (5) columns:       one column alone has the bits it has among three
#pragma once

#include <vector>

#include "isochor/base/instruction_set.h"
#include "isochor/base/vec3.h"
#include "isochor/bspline/patch_model.h"
#include "isochor/volume/bounded.h"
#include "isochor/volume/contraction_kernel.h"
#include "isochor/volume/rim.h"
#include "isochor/volume/tau_tensor.h"

namespace isochor {

struct ValueAndGradient {
  double value = 0.0;
  std::vector<Vec3> gradient;
};

// Rows [begin, end) of something.
struct IndexRange {
  int begin = 0;
  int end = 0;
  int count() const { return end - begin; }
};

class VolumeContraction {
 public:
  // Throws PreconditionError when a patch has weights that are not all equal.
  explicit VolumeContraction(const PatchModel& model, InstructionSet set = best_instruction_set());

  // The integral of (z - height) dx dy over all patches and its derivatives, one row per point of
  // the model's table. On closed models the height makes no difference and is not used. Cost per
  // pole of equal degrees d: 6 (3 d^2 + d) + 12 d (2d + 1) fused multiply-adds. `result` is
  // overwritten; passing the same one again saves the allocation.
  void value_and_gradient(const std::vector<Vec3>& points, double height, int threads,
                          ValueAndGradient& result) const;
  ValueAndGradient value_and_gradient(const std::vector<Vec3>& points, double height = 0.0,
                                      int threads = 1) const;

  // The value alone, or the column of one axis (0 to 2): a little over half the cost.
  double value(const std::vector<Vec3>& points, double height = 0.0, int threads = 1) const;
  std::vector<double> gradient_column(const std::vector<Vec3>& points, int axis,
                                      double height = 0.0, int threads = 1) const;

  // The value with a bound of its rounding error: counted step by step (docs/volume.md,
  // "Rounding"), so hundreds of times what happens. VolumeForm::bounded_value is sharper.
  Bounded bounded_value(const std::vector<Vec3>& points, double height = 0.0) const;

  // Adds row_of[i]'s row of the gradient for each point with row_of[i] >= 0. Cost: that of the
  // smallest rectangle of each patch that holds its points among them.
  void add_gradient(const std::vector<Vec3>& points, const std::vector<int>& row_of, double height,
                    std::vector<Vec3>& rows) const;

  // No side of a patch is left without a partner that cancels it.
  bool closed() const { return rim_elements_.empty(); }
  InstructionSet instruction_set() const { return set_; }

 private:
  struct PatchTensors {
    TauTensor u, v;
    std::vector<double> u_rows;  // per row k: 2d x (2d + 1), sign tau^u_ikj, i = k-d+b, j = k-d+a
    std::vector<int> points;     // #u x #v
    std::vector<int> target;     // the same; the point if only this place uses it, else ~slot
  };
  // A rectangle of one patch's poles, the unit of work: small enough for the caches.
  struct Task {
    int patch = 0;
    IndexRange rows, columns;
  };
  // Gives every entry to `sink` and returns the sum of what it makes of them.
  template <internal::Columns kColumns, typename Sink>
  double contract(const Task& task, int axis, const std::vector<Vec3>& points,
                  const Sink& sink) const;
  void add_patch(const Patch& patch);
  void find_targets(size_t point_count);
  double origin(const std::vector<Vec3>& points, double height) const;
  void add_rim(const std::vector<Vec3>& points, double height, std::vector<Vec3>& rows) const;

  InstructionSet set_;
  size_t point_count_ = 0;
  std::vector<Patch> model_;  // the patches as they came
  std::vector<PatchTensors> patches_;
  std::vector<Task> tasks_;
  std::vector<int> shared_points_;  // per slot: the point
  bool unused_points_ = false;      // some points belong to no patch
  internal::Rim rim_;
  std::vector<internal::RimElement> rim_elements_;
};

}  // namespace isochor
