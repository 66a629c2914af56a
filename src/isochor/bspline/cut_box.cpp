#include "isochor/bspline/cut_box.h"

#include "isochor/base/error.h"
#include "isochor/bspline/common_basis.h"
#include "isochor/bspline/smoothness.h"

namespace isochor {
namespace {

Surface cut(const Surface& surface, Direction direction, double from, double to) {
  const KnotVector& knots = knots_of(surface, direction);
  ISOCHOR_REQUIRE(knots.begin() <= from && from < to && to <= knots.end(), from, to);
  if (from == knots.begin() && to == knots.end()) return surface;
  const int d = knots.degree();
  std::vector<double> kept(static_cast<size_t>(d) + 1, from);
  for (double t : knots.interior()) {
    if (from < t && t < to) kept.push_back(t);
  }
  kept.insert(kept.end(), static_cast<size_t>(d) + 1, to);
  // A basis in common with itself, on a part.
  const CommonSide part{knots, knots, {from, to}, false};
  const CommonBasis basis(part, part);
  const KnotVector cut_knots(d, kept);
  ISOCHOR_REQUIRE(basis.size() == cut_knots.size(), basis.size(), cut_knots.size());
  return refined_along(surface, direction, basis.map(0), cut_knots);
}

}  // namespace

Surface cut_box(const Surface& surface, const UvBox& box) {
  return cut(cut(surface, Direction::kU, box.u_min, box.u_max), Direction::kV, box.v_min,
             box.v_max);
}

}  // namespace isochor
