// How many Gauss points a patch with weights needs.
#pragma once

#include <memory>
#include <vector>

#include "isochor/volume/element_fields.h"

namespace isochor::internal {

// No patch gets more points per span than this, unless its degree alone asks for more.
inline constexpr int kMaxRationalGaussPoints = 40;

// Tables shared by all patches with the same knots and rule.
class TableCache {
 public:
  std::shared_ptr<const SpanTable> get(const KnotVector& knots, int gauss_points);

 private:
  std::vector<std::shared_ptr<const SpanTable>> tables_;
};

// The next finer rule: at least two points more, about a quarter more.
int finer_rule(int gauss_points);

// Raises the rules of both directions of a patch with weights, from what its degrees ask for, until
// going from a rule to the next finer one changes the volume integrals by no more than rounding.
//
// The test shape has pseudo-random poles (the same for everybody), because the shape of the moment
// may be special: a flat disk in its own plane has no volume under any rule. So the choice depends
// on knots and weights alone, which edits do not change. Convergence is geometric at a rate that
// the weights determine.
void choose_rules(PatchForm& patch, TableCache& tables);

}  // namespace isochor::internal
