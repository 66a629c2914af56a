// What an edit did to the smoothness of a skin: gaps, angles and curvatures before and after,
// measured.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/bspline/smoothness.h"

namespace isochor {

// All joins of a model after an edit.
struct JoinRecord {
  int count = 0;
  double max_gap = 0.0;
  double max_angle_rad = 0.0;
  double max_curvature_jump = 0.0;
  // The largest change of the angle that the edit made at a join that was protected.
  double angle_change_rad = 0.0;
};

// The largest changes over the places where the surface was smoother than its points have to be.
struct SkinChange {
  int joins = 0;       // smooth joins of patches that moved
  int knot_lines = 0;  // smooth knot lines that would allow a crease, of patches that moved
  int poles = 0;       // collapsed sides with a tangent plane
  double angle_rad = 0.0;
  // Of the jump of the normal curvature, 1 / length unit; where curvature was continuous and the
  // degrees have room to keep it so.
  double curvature = 0.0;
};

struct SkinMeasures {
  JoinRecord joins;
  SkinChange change;
};

// The rest shape of an edit, and how shapes that it is dragged to differ from it. The rest shape is
// measured once.
class SkinGauge {
 public:
  // Measures all joins. `rest` must outlive the gauge.
  explicit SkinGauge(const PatchModel& rest);

  // Of the model with other points: joins of the patches with moved[q], knot lines and collapsed
  // sides of those patches; all other joins count with what the rest shape has. Angles by atan2 of
  // cross and dot products at several points of each span. Cost O(#spans d^2) of those patches.
  SkinMeasures measure(const std::vector<Vec3>& points, const std::vector<bool>& moved);

 private:
  struct PatchSkin {
    std::vector<KnotLine> lines_u, lines_v;
    std::array<PoleSide, 4> sides;  // in the order of kSides
  };

  PatchSkin patch_skin(const Surface& surface) const;
  void compare_patch(int q, const std::vector<Vec3>& points, SkinChange& change);

  const PatchModel& rest_;
  double size_ = 0.0;
  std::vector<Join> joins_;                        // of the rest shape
  std::vector<std::optional<PatchSkin>> patches_;  // of the rest shape, where it was needed
};

}  // namespace isochor
