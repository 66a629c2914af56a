// Face by face: is a file that was read back what was meant? Internal to `step`.
#pragma once

#include <string>
#include <vector>

#include "isochor/step/document.h"
#include "isochor/step/rebuild.h"

namespace isochor::internal {

struct FaceComparison {
  int bspline_untouched = 0;
  int identical = 0;           // of these, the same bits
  int edited_exact = 0;        // edited faces with exactly the poles, knots and weights meant
  double analytic_ulps = 0.0;  // largest distance of an analytic face from where it was
  std::vector<std::string> notices;
  std::string objection;  // in words; empty when every face is what was meant
};

// `before`: the input; `after`: read back; `edited`: what was to be changed. Units in the last
// place are those of the largest coordinate of the shape.
FaceComparison compare_faces(const Document& before, const Document& after,
                             const std::vector<EditedFace>& edited);

}  // namespace isochor::internal
