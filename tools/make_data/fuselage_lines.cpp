#include "make_data/fuselage_lines.h"

#include <algorithm>
#include <cmath>

namespace make_data {

namespace {

constexpr double kNoseLength = 5.6, kTailBegin = 17.5, kLength = 28.0;
constexpr double kHalfHeight = 1.9, kHalfWidth = 1.8;
constexpr double kCapHalfHeight = 0.46, kCapHalfWidth = 0.4;
constexpr double kNoseExponent = 2.3;  // above 2: no jump in curvature where the cabin begins
// The exponent is above that of the nose and the droop below half the half-height: so the keel line
// falls all the way from the tip to the cabin.
constexpr double kNoseDroop = 0.66, kDroopExponent = 2.6;
constexpr double kCrownShare = 0.86;  // how much of the tail's taper is taken from below
constexpr double kBlendShare = 0.5;   // part of the tail over which its slope builds up

// 0 at the tip, 1 from the cabin on.
double nose(double x) {
  if (x >= kNoseLength) return 1.0;
  return std::sqrt(1.0 - std::pow(1.0 - x / kNoseLength, kNoseExponent));
}

// 0 up to the tail, 1 at the cap: the integral of a slope that rises smoothly and then stays.
double tail(double x) {
  const double t = std::max(0.0, (x - kTailBegin) / (kLength - kTailBegin));
  const double q = std::min(t / kBlendShare, 1.0);
  const double blend = kBlendShare * (q * q * q - 0.5 * q * q * q * q);
  return (blend + std::max(0.0, t - kBlendShare)) / (1.0 - 0.5 * kBlendShare);
}

double half_height(double x) {
  return kHalfHeight * nose(x) - (kHalfHeight - kCapHalfHeight) * tail(x);
}
double half_width(double x) {
  return kHalfWidth * nose(x) - (kHalfWidth - kCapHalfWidth) * tail(x);
}
double centre(double x) {
  return -kNoseDroop * std::pow(std::max(0.0, 1.0 - x / kNoseLength), kDroopExponent) +
         kCrownShare * (kHalfHeight - kCapHalfHeight) * tail(x);
}
double itself(double x) { return x; }

double slope(double (*line)(double), double x) {
  const double step = 1e-4;  // of the order of the cube root of epsilon times the length
  return (line(x + step) - line(x - step)) / (2.0 * step);
}

}  // namespace

FuselageLines::FuselageLines() {
  const int samples = 20000;
  double arc = 0.0, previous = 0.0;
  for (int part = 0; part < 2; ++part) {
    for (int k = part; k <= samples; ++k) {
      const double t = static_cast<double>(k) / samples;
      const double x = part == 0 ? kNoseLength * t * t : kNoseLength + (kLength - kNoseLength) * t;
      if (k > 0) arc += std::hypot(x - previous, half_height(x) - half_height(previous));
      previous = x;
      stations_.push_back(x);
      arc_.push_back(arc);
    }
  }
}

double FuselageLines::arc_at(double x) const {
  const size_t k = static_cast<size_t>(std::upper_bound(stations_.begin(), stations_.end() - 1, x) -
                                       stations_.begin());
  const double t = (x - stations_[k - 1]) / (stations_[k] - stations_[k - 1]);
  return arc_[k - 1] + t * (arc_[k] - arc_[k - 1]);
}

double FuselageLines::station(double s) const {
  const size_t k =
      static_cast<size_t>(std::upper_bound(arc_.begin(), arc_.end() - 1, s) - arc_.begin());
  const double t = std::clamp((s - arc_[k - 1]) / (arc_[k] - arc_[k - 1]), 0.0, 1.0);
  return stations_[k - 1] + t * (stations_[k] - stations_[k - 1]);
}

Profile FuselageLines::profile(Line line, double nose_slope, double s0, double step,
                               double t_end) const {
  const auto slope_at = [&](double s) {
    if (s <= 0.0) return nose_slope * step;
    const double x = std::min(station(s), kLength - 1e-3);  // the tail ends in a straight cone
    return slope(line, x) / std::hypot(1.0, slope(half_height, x)) * step;
  };
  return {[this, line, s0, step](double t) { return line(station(s0 + t * step)); }, slope_at(s0),
          slope_at(s0 + t_end * step)};
}

Profile FuselageLines::x(double s0, double step, double t_end) const {
  return profile(itself, 0.0, s0, step, t_end);
}
Profile FuselageLines::z(double s0, double step, double t_end) const {
  return profile(centre, 0.0, s0, step, t_end);
}
Profile FuselageLines::w(double s0, double step, double t_end) const {
  return profile(half_width, kHalfWidth / kHalfHeight, s0, step, t_end);
}
Profile FuselageLines::h(double s0, double step, double t_end) const {
  return profile(half_height, 1.0, s0, step, t_end);
}

}  // namespace make_data
