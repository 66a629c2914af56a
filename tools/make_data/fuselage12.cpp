#include <cmath>

#include "make_data/fuselage_lines.h"
#include "make_data/shapes.h"
#include "make_data/step_text.h"

namespace make_data {

using isochor::Side;

namespace {

constexpr int kQuarterSpans = 8;
constexpr double kGrid = 1.0 / 4096.0;  // dyadic: the smoothness relations below hold without error
constexpr double kNoseRatio = 0.75;     // length of a span of the nose over one of the cabin
constexpr std::array<int, 3> kSpans{10, 12, 9};
constexpr std::array<const char*, 3> kParts{"nose", "cabin", "tail"};
constexpr std::array<const char*, 4> kQuarters{"left", "top", "right", "bottom"};
constexpr Rgb kNoseColour{0.93, 0.94, 0.96}, kCabinColour{0.78, 0.83, 0.90},
    kTailColour{0.55, 0.66, 0.82}, kCap{0.45, 0.47, 0.50};

// Poles of one patch, before they become a surface.
struct Net {
  KnotVector u, v;
  std::vector<Vec3> poles;
  Vec3& at(int i, int j) { return poles[static_cast<size_t>(i) * v.size() + j]; }
};
using Nets = std::vector<std::vector<Net>>;  // [part][quarter]

// Quarter q runs from the angle (q - 1/2) 90 degrees, counted from port over the crown.
Net sampled_net(const FuselageLines& lines, double s0, double step, int spans, int quarter) {
  const KnotVector u = KnotVector::uniform(3, spans, 0.0, spans);
  const KnotVector v = KnotVector::uniform(3, kQuarterSpans, 0.0, kQuarterSpans);
  const auto x = complete_spline(u, lines.x(s0, step, spans));
  const auto z = complete_spline(u, lines.z(s0, step, spans));
  const auto w = complete_spline(u, lines.w(s0, step, spans));
  const auto h = complete_spline(u, lines.h(s0, step, spans));
  const double turn = std::acos(0.0) / kQuarterSpans, begin = (quarter - 0.5) * std::acos(0.0);
  const double end = begin + kQuarterSpans * turn;
  const auto across = complete_spline(v, {[=](double t) { return -std::cos(begin + t * turn); },
                                          std::sin(begin) * turn, std::sin(end) * turn});
  const auto up = complete_spline(v, {[=](double t) { return std::sin(begin + t * turn); },
                                      std::cos(begin) * turn, std::cos(end) * turn});
  Net net{u, v, {}};
  const bool tip = s0 == 0.0;
  for (int i = 0; i < u.size(); ++i) {
    const double wide = tip && i == 0 ? 0.0 : w[i], high = tip && i == 0 ? 0.0 : h[i];
    for (int j = 0; j < v.size(); ++j) {
      net.poles.emplace_back(round_to_step(x[i], kGrid), round_to_step(wide * across[j], kGrid),
                             round_to_step(z[i] + high * up[j], kGrid));
    }
  }
  return net;
}

// Around: equal spans, so a shared pole is the midpoint of its two neighbours across the join.
void smooth_around(std::vector<Net>& ring) {
  for (int q = 0; q < 4; ++q) {
    Net &a = ring[q], &b = ring[(q + 1) % 4];
    const int last = a.v.size() - 1;
    for (int i = 0; i < a.u.size(); ++i) {
      a.at(i, last) = b.at(i, 0) = 0.5 * (a.at(i, last - 1) + b.at(i, 1));
    }
  }
}

// Along: the row before the join continues the row behind it, `ratio` times as far.
void smooth_along(Net& front, Net& rear, double ratio) {
  const int last = front.u.size() - 1;
  for (int j = 0; j < front.v.size(); ++j) {
    front.at(last, j) = rear.at(0, j);
    front.at(last - 1, j) = rear.at(0, j) - ratio * (rear.at(1, j) - rear.at(0, j));
  }
}

Nets smooth_nets() {
  const FuselageLines lines;
  const double step =
      lines.length() / (kNoseRatio * kSpans[0] + kSpans[1] + kSpans[2]);  // of the cabin
  Nets nets(3);
  double s0 = 0.0;
  for (int part = 0; part < 3; ++part) {
    const double own_step = part == 0 ? kNoseRatio * step : step;
    for (int q = 0; q < 4; ++q) {
      nets[part].push_back(sampled_net(lines, s0, own_step, kSpans[part], q));
    }
    s0 += own_step * kSpans[part];
    smooth_around(nets[part]);
  }
  for (int q = 0; q < 4; ++q) {
    smooth_along(nets[0][q], nets[1][q], kNoseRatio);
    smooth_along(nets[1][q], nets[2][q], 1.0);
  }
  return nets;
}

// The entities of the twelve patches, of the corners and of the edges between them. Front p is the
// front of part p, front 3 is the aft end; line q lies between the quarters q - 1 and q.
struct Grid {
  std::array<std::array<int, 4>, 3> surfaces;    // [part][quarter]
  std::array<std::array<int, 4>, 4> corners;     // [front][line]; all of front 0 are the tip
  std::array<std::array<int, 4>, 3> lengthwise;  // [part][line]
  std::array<std::array<int, 4>, 4> rings;       // [front][quarter]; front 0 has none
};

Surface surface_of(const Net& net) { return {net.u, net.v, net.poles}; }

void add_corners(StepText& step, const Nets& nets, Grid& grid) {
  const int tip = step.vertex(nets[0][0].poles.front());
  for (int q = 0; q < 4; ++q) {
    grid.corners[0][q] = tip;
    for (int p = 0; p < 3; ++p) {
      const Net& net = nets[p][q];
      const size_t last_row = static_cast<size_t>(net.u.size() - 1) * net.v.size();
      grid.corners[p + 1][q] = step.vertex(net.poles[last_row]);
    }
  }
}

void add_edges(StepText& step, const Nets& nets, int cap, Grid& grid) {
  for (int p = 0; p < 3; ++p) {
    for (int q = 0; q < 4; ++q) {
      const Surface surface = surface_of(nets[p][q]);
      grid.lengthwise[p][q] = step.edge(
          grid.corners[p][q], grid.corners[p + 1][q], side_curve(surface, Side::kVBegin),
          {straight_pcurve(grid.surfaces[p][q], {0.0, 0.0}, {1.0, 0.0}),
           straight_pcurve(grid.surfaces[p][(q + 3) % 4], {0.0, kQuarterSpans}, {1.0, 0.0})});
      const Curve ring = side_curve(surface, Side::kUEnd);
      std::vector<Uv> on_cap;
      for (const Vec3& pole : ring.poles) on_cap.push_back({pole.y(), pole.z()});
      const double u_end = kSpans[p];
      grid.rings[p + 1][q] =
          step.edge(grid.corners[p + 1][q], grid.corners[p + 1][(q + 1) % 4], ring,
                    {straight_pcurve(grid.surfaces[p][q], {u_end, 0.0}, {0.0, 1.0}),
                     p < 2 ? straight_pcurve(grid.surfaces[p + 1][q], {0.0, 0.0}, {0.0, 1.0})
                           : spline_pcurve(cap, ring.knots, on_cap)});
    }
  }
}

}  // namespace

std::string fuselage12_step() {
  const Nets nets = smooth_nets();
  StepText step("fuselage12", "Fuselage of twelve tangent-continuous bicubic patches", "METRE");
  Grid grid;
  for (int p = 0; p < 3; ++p) {
    for (int q = 0; q < 4; ++q) grid.surfaces[p][q] = step.surface(surface_of(nets[p][q]));
  }
  const int cap = step.plane(Vec3(nets[2][0].poles.back().x(), 0.0, 0.0), Vec3::UnitX(),
                             Vec3::UnitY());  // parameters (y, z)
  add_corners(step, nets, grid);
  add_edges(step, nets, cap, grid);

  const std::array<Rgb, 3> colours{kNoseColour, kCabinColour, kTailColour};
  for (int p = 0; p < 3; ++p) {
    for (int q = 0; q < 4; ++q) {
      std::vector<Use> loop{{grid.lengthwise[p][q], true},
                            {grid.rings[p + 1][q], true},
                            {grid.lengthwise[p][(q + 1) % 4], false}};
      if (p > 0) loop.push_back({grid.rings[p][q], false});
      step.face(std::string(kParts[p]) + " " + kQuarters[q], grid.surfaces[p][q], {loop},
                colours[p]);
    }
  }
  std::vector<Use> rim;
  for (int q = 3; q >= 0; --q) rim.push_back({grid.rings[3][q], false});
  step.face("aft cap", cap, {rim}, kCap);
  return step.text();
}

}  // namespace make_data
