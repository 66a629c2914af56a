// The lines of an airliner-like body: every section is an ellipse.
//
// At the arc length s of the side view's mean line, measured from the nose, the section lies at
// x(s), is centred at z(s), and has the half-axes w(s) across and h(s) up. At the nose x' = 0 and
// w, h grow linearly: the body is round there and its tangent plane is x = 0.
#pragma once

#include <vector>

#include "make_data/spline_tools.h"

namespace make_data {

class FuselageLines {
 public:
  FuselageLines();

  double length() const { return arc_.back(); }  // of the mean line
  double arc_at(double x) const;                 // the arc length at a station

  // The line as a function of t in [0, t_end], where the arc length is s0 + t * step.
  Profile x(double s0, double step, double t_end) const;
  Profile z(double s0, double step, double t_end) const;
  Profile w(double s0, double step, double t_end) const;
  Profile h(double s0, double step, double t_end) const;

 private:
  using Line = double (*)(double station);
  double station(double s) const;
  // Slopes at the ends come from the chain rule; `nose_slope` is the one at s = 0.
  Profile profile(Line line, double nose_slope, double s0, double step, double t_end) const;

  std::vector<double> stations_;  // finely sampled x, dense at the nose
  std::vector<double> arc_;       // arc length at the samples
};

}  // namespace make_data
