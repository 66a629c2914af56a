// How many binary digits the thesis' factorings need: its figures 7.1 to 7.10.
#pragma once

#include <string>
#include <vector>

#include "figures/plot.h"

namespace figures {

struct NamedPlot {
  std::string name;  // of the files, without ending
  Plot plot;
};

// Each point is the largest entry met in `matrices` random ones; the same numbers on every run.
std::vector<NamedPlot> bit_growth_plots(int matrices);

}  // namespace figures
