// Which parameters of a trimmed patch are kept.
//
// A parameter pair is inside when a ray from it towards +u crosses the loops an odd number of
// times. Every pair gets a definite answer, also on the loops themselves (each segment owns its
// lower end), so neighbouring cells never disagree about a shared corner.
#pragma once

#include <vector>

#include "isochor/bspline/patch_model.h"

namespace isochor::internal {

class TrimTest {
 public:
  // An empty region keeps everything.
  TrimTest(const TrimRegion& trim, const UvBox& domain);

  bool keeps_all() const { return segments_.empty(); }
  // Pairs on the border of the domain are judged just inside it: loops run along the border.
  bool inside(double u, double v) const;
  // Does a loop pass through the inside of the box? Loops along its sides do not count.
  // Cost: the number of segments at the same height.
  bool crosses(const UvBox& box) const;

 private:
  struct Segment {
    Uv a, b;
  };
  int row_of(double v) const;

  UvBox domain_;
  double u_margin_ = 0.0, v_margin_ = 0.0;
  std::vector<Segment> segments_;
  std::vector<std::vector<int>> rows_;  // segments by height
};

}  // namespace isochor::internal
