// Meshes and lines of a PatchModel, for pictures and mesh files.
//
// The cut into triangles is made once, in the parameters, and then evaluated for any position of
// the points: meshes before and after an edit have the same vertices in the same order.
//
// Laws:
//  (1) every vertex lies on its patch; the distance of a patch from its triangles is about
//      `chord` * diagonal at most, where the bounds on cells allow it;
//  (2) normals are unit vectors and point outwards by Patch::reversed, also at collapsed sides;
//  (3) sides that match along a join get the same vertices, up to rounding;
//  (4) only what Patch::trim keeps is covered; the error of its area falls with `trim_levels`.
#pragma once

#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/io/mesh.h"
#include "isochor/picture/patch_grid.h"

namespace isochor {

struct TessellationOptions {
  int min_cells = 2;      // to a knot span, in each direction; 1 where a patch has over 64 spans
  int max_cells = 64;     // to a knot span, in each direction
  double chord = 1.5e-4;  // wanted distance between surface and triangles, over the diagonal
  int trim_levels = 4;    // a cell that a trim crosses is halved so often
  double max_triangles = 1.2e6;  // cells are made larger to stay below, but no larger than a span

  // Throws PreconditionError naming the field.
  void validate() const;
};

class Tessellator {
 public:
  // Cells are made small enough for the model's points and for each of `other_points`.
  // Cost: O(spans) evaluations of second derivatives.
  explicit Tessellator(PatchModel model, const TessellationOptions& options = {},
                       const std::vector<std::vector<Vec3>>& other_points = {});

  // One vertex normal each; groups are patch indices. Cost: one evaluation a vertex.
  Mesh mesh() const { return mesh(model_.points); }
  Mesh mesh(const std::vector<Vec3>& points) const;
  // The same cut on other surfaces with the same parameter rectangles (a refined model, a model
  // read from another file). Throws PreconditionError when their number or a domain differs.
  Mesh mesh(const std::vector<Surface>& surfaces) const;

  // Patch borders and trimming loops: [0] sharp ones, [1] those that are smooth or almost smooth
  // joins, drawn lighter.
  std::vector<LineSet> borders() const { return borders(model_.points); }
  std::vector<LineSet> borders(const std::vector<Vec3>& points) const;
  std::vector<LineSet> borders(const std::vector<Surface>& surfaces) const;
  // Knot lines, at most `max_lines` in each direction of a patch, where the trim keeps them.
  LineSet knot_lines(const std::vector<Vec3>& points, int max_lines = 12) const;

 private:
  std::vector<Surface> surfaces_at(const std::vector<Vec3>& points) const;
  void require_corresponding(const std::vector<Surface>& surfaces) const;
  std::vector<Vec3> iso_curve(const Surface& surface, size_t patch, bool along_v, double at) const;

  PatchModel model_;
  std::vector<std::vector<internal::GridLine>> u_lines_, v_lines_;
  std::vector<internal::TrimTest> trims_;
  std::vector<internal::PatchGrid> grids_;
};

// The one-off form of Tessellator.
Mesh tessellate(const PatchModel& model, const TessellationOptions& options = {});

// The control polygons of all patches, at the given points.
LineSet control_net(const PatchModel& model, const std::vector<Vec3>& points);

}  // namespace isochor
