#include "isochor/step/shared_trim.h"

#include <algorithm>

#include "isochor/base/tolerance.h"

namespace isochor::internal {
namespace {

// Following refines the patches along the edge several times: each new span must be seen.
constexpr int kLeastPlaces = 256;
constexpr int kPlacesPerSpan = 8;
constexpr int kMostPlaces = 4096;

int place_count(const BrepTable& table, const std::array<EdgeSite, 2>& sites) {
  int spans = 0;
  for (const EdgeSite& site : sites) {
    const Surface& surface = *table.faces[static_cast<size_t>(site.face)].surface.surface;
    spans +=
        static_cast<int>(surface.u_knots().breaks().size() + surface.v_knots().breaks().size());
  }
  return std::clamp(kPlacesPerSpan * spans, kLeastPlaces, kMostPlaces);
}

// Parameter curves may leave the domain by a rounding, and go once around where it is closed.
double inside(double value, const KnotVector& knots) {
  const double length = knots.end() - knots.begin();
  if (value > knots.end() + kSideNoise * length) value -= length;
  if (value < knots.begin() - kSideNoise * length) value += length;
  return std::clamp(value, knots.begin(), knots.end());
}

}  // namespace

void trace_shared_trim(const BrepTable& table, const std::array<EdgeSite, 2>& sites,
                       SharedTrim& trim) {
  const int count = place_count(table, sites);
  for (size_t k = 0; k < 2; ++k) {
    const EdgeUse& use = table.use(sites[k]);
    if (use.curve.IsNull()) continue;
    const FaceRecord& face = table.faces[static_cast<size_t>(sites[k].face)];
    const Surface& surface = *face.surface.surface;
    for (int i = 0; i <= count; ++i) {
      const gp_Pnt2d at = use.curve->Value(use.first + (use.last - use.first) * i / count);
      trim.along[k].push_back(
          {inside(at.X(), surface.u_knots()), inside(at.Y(), surface.v_knots())});
    }
    const auto loop = static_cast<size_t>(sites[k].loop);
    if (loop < face.trim.boxes.size()) {
      trim.boxes[k] = face.trim.boxes[loop][static_cast<size_t>(sites[k].use)];
    }
  }
}

}  // namespace isochor::internal
