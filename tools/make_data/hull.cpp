#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "make_data/shapes.h"
#include "make_data/step_text.h"

namespace make_data {

using isochor::Side;

namespace {

constexpr int kAlong = 24, kUp = 12;     // knot spans; u runs forward, v from the keel to the deck
constexpr double kGrid = 1.0 / 16384.0;  // dyadic: the deck edges lie in the deck plane exactly
constexpr double kKeelLength = 35.0, kDeckLength = 40.0;
constexpr double kDeckHeight = 4.5, kDeckRise = 1.0 / 32.0;  // z = height + rise * x
constexpr double kHalfBeam = 4.2;
constexpr Rgb kPort{0.72, 0.16, 0.14}, kStarboard{0.72, 0.16, 0.14}, kDeck{0.80, 0.66, 0.46},
    kTransom{0.35, 0.10, 0.10};

double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * t * (10.0 + t * (6.0 * t - 15.0));
}

// 0 at 0 with slope near 0, then rising with slope near 1: a corner at `at`, rounded over `width`.
double ramp(double t, double at, double width) {
  const auto soft = [width](double x) { return 0.5 * (x + std::sqrt(x * x + width * width)); };
  return soft(t - at) - soft(-at);
}

// All lines below take fractions: `along` from the transom (0) to the bow (1), `up` from the keel
// (0) to the deck (1).
double keel_height(double along) {
  return 1.5 * (1.0 - smooth_step(along / 0.5)) +
         0.5 * std::pow(std::max(0.0, along - 0.75) / 0.25, 3);
}

double deck_half_breadth(double along) {
  const double forward = std::max(0.0, (along - 0.4) / 0.6), aft = std::max(0.0, 0.4 - along) / 0.4;
  return kHalfBeam * (1.0 - std::pow(forward, 2.6)) * (1.0 - 0.24 * std::pow(aft, 2.2));
}

// A section as fractions of half-breadth and of height over the keel.
struct SectionPoint {
  double out, up;
};

// Round bilge: out along the floor, around the bilge, up the side.
SectionPoint midship(double up) {
  const double out = (up - ramp(up, 0.5, 0.16)) / (1.0 - ramp(1.0, 0.5, 0.16));
  const double rise = ramp(up, 0.42, 0.16) / ramp(1.0, 0.42, 0.16);
  return {0.93 * out + 0.07 * up, 0.80 * rise + 0.14 * out + 0.06 * up};
}

// Sharp below, flared above.
SectionPoint bow(double up) { return {0.25 * up + 0.75 * std::pow(up, 1.9), up}; }

Vec3 pole_at(double along, double up) {
  const double sharp = smooth_step((along - 0.05) / 1.05);
  const SectionPoint m = midship(up), b = bow(up);
  const double out = (1.0 - sharp) * m.out + sharp * b.out;
  const double height = (1.0 - sharp) * m.up + sharp * b.up;
  const double stem = 0.35 * up + 0.65 * up * up;  // concave below, raked above
  const double x = along * (kKeelLength + (kDeckLength - kKeelLength) * stem);
  const double keel = keel_height(along), deck = kDeckHeight + kDeckRise * x;
  return {x, deck_half_breadth(along) * out, keel + (deck - keel) * height};
}

// The starboard side: with u forward and v up its normal points out.
Surface starboard_surface() {
  const KnotVector u = KnotVector::uniform(3, kAlong, 0.0, kAlong);
  const KnotVector v = KnotVector::uniform(3, kUp, 0.0, kUp);
  std::vector<Vec3> poles;
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      const Vec3 p = pole_at(u.greville(i) / kAlong, v.greville(j) / kUp);
      const bool centre = j == 0 || i == u.size() - 1, deck = j == v.size() - 1;
      const double x = round_to_step(p.x(), kGrid);
      poles.emplace_back(x, centre ? 0.0 : -round_to_step(p.y(), kGrid),
                         deck ? kDeckHeight + kDeckRise * x : round_to_step(p.z(), kGrid));
    }
  }
  return {u, v, poles};
}

Surface mirrored(const Surface& surface) {
  std::vector<Vec3> poles = surface.poles();
  for (Vec3& pole : poles) pole.y() = 0.0 - pole.y();
  return {surface.u_knots(), surface.v_knots(), poles};
}

// The pcurve of an iso curve of a skin, and of a skin's side on a plane whose parameters `map`
// gives.
Pcurve along_v(int surface, double u) { return straight_pcurve(surface, {u, 0.0}, {0.0, 1.0}); }
Pcurve along_u(int surface, double v) { return straight_pcurve(surface, {0.0, v}, {1.0, 0.0}); }
template <typename Map>
Pcurve pcurve_on(int plane, const Curve& curve, const Map& map) {
  std::vector<Uv> poles;
  for (const Vec3& pole : curve.poles) poles.push_back(map(pole));
  return spline_pcurve(plane, curve.knots, poles);
}

}  // namespace

std::string hull_step() {
  const Surface starboard = starboard_surface(), port = mirrored(starboard);
  StepText step("hull", "Ship hull with a planar deck and a transom", "METRE");
  const int s = step.surface(starboard), p = step.surface(port);
  const int transom = step.plane(Vec3::Zero(), -Vec3::UnitX(), -Vec3::UnitY());  // (-y, z)
  const Vec3 deck_x = Vec3(1.0, 0.0, kDeckRise).normalized();
  const Vec3 deck_origin(0.0, 0.0, kDeckHeight);
  const int deck = step.plane(deck_origin, deck_x.cross(Vec3::UnitY()), deck_x);

  const int last_u = starboard.u_size() - 1, last_v = starboard.v_size() - 1;
  const int heel = step.vertex(starboard.pole(0, 0)), foot = step.vertex(starboard.pole(last_u, 0));
  const int head = step.vertex(starboard.pole(last_u, last_v));
  const int corner_s = step.vertex(starboard.pole(0, last_v));
  const int corner_p = step.vertex(port.pole(0, last_v));

  const auto on_transom = [](const Vec3& q) { return Uv{0.0 - q.y(), q.z()}; };
  const auto on_deck = [&](const Vec3& q) { return Uv{(q - deck_origin).dot(deck_x), q.y()}; };
  const int keel = step.edge(heel, foot, side_curve(starboard, Side::kVBegin),
                             {along_u(s, 0.0), along_u(p, 0.0)});
  const int stem = step.edge(foot, head, side_curve(starboard, Side::kUEnd),
                             {along_v(s, kAlong), along_v(p, kAlong)});
  const auto side_edges = [&](const Surface& skin, int id, int corner) {
    const Curve stern = side_curve(skin, Side::kUBegin), sheer = side_curve(skin, Side::kVEnd);
    return std::array<int, 2>{
        step.edge(heel, corner, stern, {along_v(id, 0.0), pcurve_on(transom, stern, on_transom)}),
        step.edge(corner, head, sheer, {along_u(id, kUp), pcurve_on(deck, sheer, on_deck)})};
  };
  const auto [stern_s, sheer_s] = side_edges(starboard, s, corner_s);
  const auto [stern_p, sheer_p] = side_edges(port, p, corner_p);
  const Vec3 from = starboard.pole(0, last_v), to = port.pole(0, last_v);
  const int taffrail = step.straight_edge(corner_s, corner_p, from, to,
                                          {straight_pcurve(transom, on_transom(from), {-1.0, 0.0}),
                                           straight_pcurve(deck, on_deck(from), {0.0, 1.0})});

  step.face("starboard", s, {{{keel, true}, {stem, true}, {sheer_s, false}, {stern_s, false}}},
            kStarboard);
  step.face("port", p, {{{stern_p, true}, {sheer_p, true}, {stem, false}, {keel, false}}}, kPort,
            true);
  step.face("transom", transom, {{{stern_s, true}, {taffrail, true}, {stern_p, false}}}, kTransom);
  step.face("deck", deck, {{{sheer_s, true}, {sheer_p, false}, {taffrail, false}}}, kDeck);
  return step.text();
}

std::string half_hull_step() {
  const Surface skin = starboard_surface();
  StepText step("half hull", "Starboard skin of a ship hull, open at its flat ends", "METRE");
  step.leave_open();
  const int id = step.surface(skin);
  const int last_u = skin.u_size() - 1, last_v = skin.v_size() - 1;
  const int heel = step.vertex(skin.pole(0, 0)), foot = step.vertex(skin.pole(last_u, 0));
  const int head = step.vertex(skin.pole(last_u, last_v)),
            stern = step.vertex(skin.pole(0, last_v));
  const auto side = [&](int from, int to, Side which, const Pcurve& pcurve) {
    return step.edge(from, to, side_curve(skin, which), {pcurve});
  };
  step.face("starboard", id,
            {{{side(heel, foot, Side::kVBegin, along_u(id, 0.0)), true},
              {side(foot, head, Side::kUEnd, along_v(id, kAlong)), true},
              {side(stern, head, Side::kVEnd, along_u(id, kUp)), false},
              {side(heel, stern, Side::kUBegin, along_v(id, 0.0)), false}}},
            kStarboard);
  return step.text();
}

}  // namespace make_data
