// A surface cut into patches that continue each other.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "isochor/bspline/joins.h"
#include "isochor/bspline/refinement.h"

namespace isochor::testing {

// A surface as two patches, "fore" and "aft", cut at a u knot by inserting it until it
// interpolates; the cut shares its points. Joins are found and measured.
inline PatchModel cut_in_two(const Surface& surface, double at) {
  const int d = surface.u_knots().degree();
  const int extra = d - surface.u_knots().multiplicity(at);
  const Surface cut = refine(
      surface, with_knots(surface.u_knots(), std::vector<double>(static_cast<size_t>(extra), at)),
      surface.v_knots());
  const auto& knots = cut.u_knots().knots();
  const auto first = std::lower_bound(knots.begin(), knots.end(), at);
  const int row = static_cast<int>(first - knots.begin()) - 1;
  std::vector<double> low(knots.begin(), first + d);
  low.push_back(at);
  std::vector<double> high(first, knots.end());
  high.insert(high.begin(), at);
  PatchModel model;
  model.points = cut.poles();
  const int nv = cut.v_size();
  const auto add = [&](const char* name, int from, int to, const std::vector<double>& u) {
    Patch patch{name,
                "face:" + std::to_string(model.patches.size() + 1),
                KnotVector(d, u),
                cut.v_knots(),
                {},
                {},
                false,
                {},
                {}};
    for (int i = from; i < to; ++i) {
      for (int j = 0; j < nv; ++j) {
        patch.points.push_back(i * nv + j);
        if (cut.rational()) patch.weights.push_back(cut.weights()[cut.index(i, j)]);
      }
    }
    model.patches.push_back(patch);
  };
  add("fore", 0, row + 1, low);
  add("aft", row, cut.u_size(), high);
  model.joins = find_joins(model);
  return model;
}

}  // namespace isochor::testing
