// One polynomial patch as bare arrays, the common ground of the baselines.
//
// Symbols: patch S = sum p_ij B_i(u) B_j(v) with #u x #v poles, u-major; a_ij = iint B_i B_j
// (S_u x S_v) du dv. On a closed model the rows of the volume's gradient are the sums of a_ij over
// the places where a point is used.
#pragma once

#include <array>
#include <vector>

#include "isochor/bspline/patch_model.h"

namespace isochor::bench {

// x, y and z of a grid, apart, u-major.
using Columns = std::array<std::vector<double>, 3>;

struct PatchGrid {
  KnotVector u, v;
  Columns poles;

  int rows() const { return u.size(); }
  int columns() const { return v.size(); }
  size_t count() const { return poles[0].size(); }
};

PatchGrid patch_grid(const PatchModel& model, int patch);

// Fetches the poles of a patch from the model's table; `poles` gets its size on first use.
void gather_poles(const PatchModel& model, int patch, Columns& poles);
// Adds the areas of a patch to the rows of its points.
void add_rows(const Patch& patch, const Columns& areas, std::vector<Vec3>& rows);
// One row per point of the model: the areas of one patch summed over the places of each point.
std::vector<Vec3> point_rows(const PatchModel& model, int patch, const Columns& areas);

// What a baseline does: all three columns of a_ij (or of another gradient with the same sums over
// a closed model) and the volume sum z a_z.
class GradientMethod {
 public:
  virtual ~GradientMethod() = default;
  // Overwrites `areas`; returns the volume.
  virtual double run(const PatchGrid& grid, Columns& areas) const = 0;
};

// A torus of wavy tube as one periodic patch of `side` x `side` poles with equal degrees: closed,
// smooth, and as large as one likes.
PatchModel wavy_torus(int degree, int side);

// Six patches of `side` x `side` poles around a smoothly bent cube, without gaps; with `ripples`
// waves along each edge, as large as a hundredth of it, when there are any.
PatchModel bent_cube(int degree, int side, int ripples = 0);

}  // namespace isochor::bench
