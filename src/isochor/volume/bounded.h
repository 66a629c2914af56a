// A number and how far it may be from what it stands for.
#pragma once

namespace isochor {

struct Bounded {
  double value = 0.0;
  double bound = 0.0;
};

}  // namespace isochor
