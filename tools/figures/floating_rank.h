// Which C1 constraints of a triangulated quintic spline floating point takes for redundant: the
// thesis' figure 2.3, on a mesh of our own.
#pragma once

#include <string>

#include "figures/plot.h"

namespace figures {

struct FloatingRank {
  Plot ranks;           // found by each method, against how far the vertex is from singular
  std::string picture;  // SVG: the constraints that floating point keeps, and that are independent
  std::string summary;  // what the picture shows, in a sentence
};
FloatingRank compare_floating_rank();

}  // namespace figures
