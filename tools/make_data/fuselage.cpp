#include <cmath>

#include "make_data/fuselage_lines.h"
#include "make_data/shapes.h"
#include "make_data/step_text.h"

namespace make_data {

using isochor::Side;

namespace {

constexpr int kAlong = 56, kAround = 32;  // knot spans; parameters count them
constexpr double kReciprocalGrid = 1e7;   // poles are rounded to a tenth of a micrometre
constexpr Rgb kSkin{0.80, 0.82, 0.85}, kGlass{0.08, 0.13, 0.32}, kCap{0.45, 0.47, 0.50};

// A rounded rectangle of parameters around (u, v). No knot lies inside one of its corners.
struct Window {
  std::string name;
  double u, v;
  double half_u, half_v, corner_u, corner_v;
};

// The crown is v = 16, port is below it.
std::vector<Window> all_windows() {
  std::vector<Window> windows;
  for (bool left : {true, false}) {
    const std::string side = left ? "left " : "right ";
    const double outward = left ? -1.0 : 1.0;
    for (int k = 1; k <= 2; ++k) {
      windows.push_back({"windscreen " + side + std::to_string(k), 5.0 + 0.25 * (k - 1),
                         16.0 + outward * (2.05 * k - 1.0), 0.68, 0.85, 0.3, 0.35});
    }
    for (int k = 1; k <= 10; ++k) {
      windows.push_back({"window " + side + std::to_string(k), 13.5 + 2.0 * k, 16.0 + outward * 7.0,
                         0.36, 0.66, 0.24, 0.35});
    }
  }
  return windows;
}

// Poles of the closed curve through the ellipse points at the 32 knots, clamped at the belly.
struct Section {
  std::vector<double> y, z;  // of the unit circle
};

Section unit_section() {
  const double pi = std::acos(-1.0);
  const double scale = 3.0 / (2.0 + std::cos(2.0 * pi / kAround));
  // Uniform coefficients c_k at the angles of the knots, mirrored exactly.
  const auto y_at = [&](int k) {
    const int m = (k + 2 * kAround) % kAround;
    if (m % (kAround / 2) == 0) return 0.0;
    const double value = scale * std::sin(2.0 * pi * std::min(m, kAround - m) / kAround);
    return m < kAround / 2 ? -value : value;  // first to port
  };
  const auto z_at = [&](int k) {
    const int m = (k + 2 * kAround) % kAround;
    return -scale * std::cos(2.0 * pi * std::min(m, kAround - m) / kAround);
  };
  const auto clamped = [](const auto& c) {
    std::vector<double> poles{(c(-1) + 4.0 * c(0) + c(1)) / 6.0, (2.0 * c(0) + c(1)) / 3.0};
    for (int k = 1; k < kAround; ++k) poles.push_back(c(k));
    poles.push_back((2.0 * c(0) + c(-1)) / 3.0);
    poles.push_back(poles.front());
    return poles;
  };
  return {clamped(y_at), clamped(z_at)};
}

Surface skin_surface() {
  const FuselageLines lines;
  const KnotVector u = KnotVector::uniform(3, kAlong, 0.0, kAlong);
  const KnotVector v = KnotVector::uniform(3, kAround, 0.0, kAround);
  const double step = lines.length() / kAlong;
  const auto x = complete_spline(u, lines.x(0.0, step, kAlong));
  const auto z = complete_spline(u, lines.z(0.0, step, kAlong));
  const auto w = complete_spline(u, lines.w(0.0, step, kAlong));
  const auto h = complete_spline(u, lines.h(0.0, step, kAlong));
  const Section section = unit_section();
  const auto rounded = [](double value) { return round_to_reciprocal(value, kReciprocalGrid); };
  std::vector<Vec3> poles;
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      const double across = i == 0 ? 0.0 : w[i], up = i == 0 ? 0.0 : h[i];
      poles.emplace_back(rounded(x[i]), rounded(across * section.y[j]),
                         rounded(z[i] + up * section.z[j]));
    }
  }
  return {u, v, poles};
}

// The eight edges of a rounded window, counter-clockwise in the parameter plane.
std::vector<int> window_edges(StepText& step, const Surface& skin, int surface,
                              const Window& window) {
  // The outline's corner points and the Bezier points between them; the first edge is the lower
  // straight side.
  const double a = window.half_u, b = window.half_v;
  const double ca = a - window.corner_u, cb = b - window.corner_v;
  const std::array<Uv, 8> ends{
      {{-ca, -b}, {ca, -b}, {a, -cb}, {a, cb}, {ca, b}, {-ca, b}, {-a, cb}, {-a, -cb}}};
  const std::array<Uv, 4> corners{{{a, -b}, {a, b}, {-a, b}, {-a, -b}}};
  const auto at = [&](Uv local) { return Uv{window.u + local.u, window.v + local.v}; };
  std::array<int, 8> vertices;
  for (int k = 0; k < 8; ++k) {
    vertices[k] = step.vertex(skin.point(at(ends[k]).u, at(ends[k]).v));
  }
  std::vector<int> edges;
  const KnotVector parabola = KnotVector::clamped(2, {0.0, 1.0});
  for (int k = 0; k < 8; ++k) {
    const int next = (k + 1) % 8;
    const Uv from = at(ends[k]), to = at(ends[next]);
    if (k % 2 == 1) {
      const Uv middle = at(corners[k / 2]);
      edges.push_back(step.edge(vertices[k], vertices[next], corner_curve(skin, from, middle, to),
                                {spline_pcurve(surface, parabola, {from, middle, to})}));
      continue;
    }
    // Straight sides keep the skin's parameter, so two of the four run backwards.
    const bool along_u = k % 4 == 0, forward = k < 4;
    const Uv low = forward ? from : to, high = forward ? to : from;
    const Curve curve =
        along_u ? iso_v_curve(skin, low.v, low.u, high.u) : iso_u_curve(skin, low.u, low.v, high.v);
    edges.push_back(step.edge(forward ? vertices[k] : vertices[next],
                              forward ? vertices[next] : vertices[k], curve,
                              {along_u ? straight_pcurve(surface, {0.0, low.v}, {1.0, 0.0})
                                       : straight_pcurve(surface, {low.u, 0.0}, {0.0, 1.0})}));
  }
  return edges;
}

}  // namespace

std::string fuselage_step() {
  const Surface skin = skin_surface();
  StepText step("fuselage", "Fuselage with windows: one bicubic skin", "METRE");
  const int surface = step.surface(skin, false, true);
  const Vec3 aft_origin(skin.pole(skin.u_size() - 1, 0).x(), 0.0, 0.0);
  const int cap = step.plane(aft_origin, Vec3::UnitX(), Vec3::UnitY());  // parameters (y, z)

  const int nose = step.vertex(skin.pole(0, 0));
  const int aft = step.vertex(skin.pole(skin.u_size() - 1, 0));
  const int seam = step.edge(nose, aft, side_curve(skin, Side::kVBegin),
                             {straight_pcurve(surface, {0.0, 0.0}, {1.0, 0.0}),
                              straight_pcurve(surface, {0.0, kAround}, {1.0, 0.0})},
                             true);
  const Curve rim_curve = side_curve(skin, Side::kUEnd);
  std::vector<Uv> rim_on_cap;
  for (const Vec3& pole : rim_curve.poles) rim_on_cap.push_back({pole.y(), pole.z()});
  const int rim = step.edge(aft, aft, rim_curve,
                            {straight_pcurve(surface, {kAlong, 0.0}, {0.0, 1.0}),
                             spline_pcurve(cap, rim_curve.knots, rim_on_cap)});

  std::vector<std::vector<Use>> skin_loops{{{seam, true}, {rim, true}, {seam, false}}};
  std::vector<std::vector<Use>> outlines;
  const std::vector<Window> windows = all_windows();
  for (const Window& window : windows) {
    const std::vector<int> edges = window_edges(step, skin, surface, window);
    std::vector<Use> outline, hole;
    for (int e = 0; e < 8; ++e) outline.push_back({edges[e], e % 2 == 1 || e < 4});
    for (auto use = outline.rbegin(); use != outline.rend(); ++use) {
      hole.push_back({use->edge, !use->forward});
    }
    outlines.push_back(outline);
    skin_loops.push_back(hole);
  }
  step.face("skin", surface, skin_loops, kSkin);
  for (size_t k = 0; k < windows.size(); ++k) {
    step.face(windows[k].name, surface, {outlines[k]}, kGlass);
  }
  step.face("aft cap", cap, {{{rim, false}}}, kCap);
  return step.text();
}

}  // namespace make_data
