#include <array>
#include <vector>

#include "make_data/shapes.h"
#include "make_data/step_text.h"

namespace make_data {

using isochor::Side;

namespace {

// A polynomial: the terms coefficient * x^a * y^b. All coefficients are dyadic.
struct Term {
  int a, b;
  double coefficient;
};
using Polynomial = std::vector<Term>;

// The skin is the graph of `kSkin`. The canopy is higher by 2 (p^2 - y^2) with p = (4 - x^2) / 8,
// so the two meet in the parabolas y = +-p(x), which end at x = +-2.
const Polynomial kSkin = {{0, 0, 1.0}, {2, 0, -1.0 / 128.0}, {0, 2, -0.25}};
const Polynomial kCanopy = {{0, 0, 1.5}, {2, 0, -33.0 / 128.0}, {4, 0, 1.0 / 32.0}, {0, 2, -2.25}};
constexpr double kHalfLength = 4.0, kHalfWidth = 1.5, kFloor = -1.0, kTip = 2.0;
constexpr Rgb kSkinColour{0.62, 0.72, 0.85}, kCanopyColour{0.95, 0.76, 0.35},
    kSideColour{0.45, 0.52, 0.62};

// The spline coefficient of x^power: its polar form at the inner knots of function i.
double monomial(const KnotVector& knots, int i, int power) {
  const int degree = knots.degree();
  std::vector<double> sums(static_cast<size_t>(degree) + 1, 0.0);  // elementary symmetric
  sums[0] = 1.0;
  for (int k = 1; k <= degree; ++k) {
    for (int order = k; order >= 1; --order) {
      sums[static_cast<size_t>(order)] += sums[static_cast<size_t>(order) - 1] * knots[i + k];
    }
  }
  double subsets = 1.0;
  for (int k = 0; k < power; ++k) subsets = subsets * (degree - k) / (k + 1);
  return sums[static_cast<size_t>(power)] / subsets;
}

// The graph of a polynomial: parameters are x and y.
Surface graph(const Polynomial& height, const KnotVector& u, const KnotVector& v) {
  std::vector<Vec3> poles;
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      double z = 0.0;
      for (const Term& term : height) {
        z += term.coefficient * monomial(u, i, term.a) * monomial(v, j, term.b);
      }
      poles.emplace_back(u.greville(i), v.greville(j), z);
    }
  }
  return {u, v, poles};
}

// The curve over y = sign * p(x) on both surfaces, of degree 4 in x.
Curve rim(double sign) {
  const KnotVector knots = KnotVector::uniform(4, 1, -kTip, kTip);
  Curve curve{knots, {}};
  for (int i = 0; i < knots.size(); ++i) {
    const double square = monomial(knots, i, 2);
    curve.poles.emplace_back(knots.greville(i), sign * (0.5 - square / 8.0),
                             15.0 / 16.0 + 3.0 * square / 128.0 - monomial(knots, i, 4) / 256.0);
  }
  return curve;
}

Pcurve rim_pcurve(int surface, double sign) {
  return spline_pcurve(surface, KnotVector::uniform(2, 1, -kTip, kTip),
                       {{-kTip, 0.0}, {0.0, sign}, {kTip, 0.0}});
}

// The mast: a wall over a closed curve of four parabolas in the skin's parameter plane, with the
// corners of a square as control points, and a cover parallel to the skin.
constexpr double kMastX = -3.0, kMastHalf = 0.25, kMastHeight = 0.75;
constexpr int kArcs = 4;

Uv corner_of_mast(int k) {
  const std::array<Uv, 4> corners = {{{kMastX + kMastHalf, -kMastHalf},
                                      {kMastX + kMastHalf, kMastHalf},
                                      {kMastX - kMastHalf, kMastHalf},
                                      {kMastX - kMastHalf, -kMastHalf}}};
  return corners[static_cast<size_t>(k % kArcs)];
}

Uv middle(const Uv& a, const Uv& b) { return {0.5 * (a.u + b.u), 0.5 * (a.v + b.v)}; }

Pcurve mast_pcurve(int surface) {
  const Uv start = middle(corner_of_mast(0), corner_of_mast(1));
  return spline_pcurve(
      surface, KnotVector(2, {0, 0, 0, 1, 2, 3, 4, 4, 4}),
      {start, corner_of_mast(1), corner_of_mast(2), corner_of_mast(3), corner_of_mast(4), start});
}

// The Bezier coefficients of degree 4 of a parabola, and of its square.
using Parabola = std::array<double, 3>;
std::array<double, 5> raised(const Parabola& b) {
  return {b[0], (b[0] + b[1]) / 2, (b[0] + 4 * b[1] + b[2]) / 6, (b[1] + b[2]) / 2, b[2]};
}
std::array<double, 5> squared(const Parabola& b) {
  return {b[0] * b[0], b[0] * b[1], (b[0] * b[2] + 2 * b[1] * b[1]) / 3, b[1] * b[2], b[2] * b[2]};
}

// The curve on the skin: four Bezier arcs of degree 4.
Curve mast_foot() {
  Curve curve{KnotVector(4, {0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 4}),
              {}};
  for (int k = 0; k < kArcs; ++k) {
    const Uv from = middle(corner_of_mast(k), corner_of_mast(k + 1)), via = corner_of_mast(k + 1);
    const Uv to = middle(via, corner_of_mast(k + 2));
    const Parabola u{from.u, via.u, to.u}, v{from.v, via.v, to.v};
    const auto x = raised(u), y = raised(v), xx = squared(u), yy = squared(v);
    for (size_t i = k == 0 ? 0 : 1; i < 5; ++i) {
      curve.poles.emplace_back(x[i], y[i], 1.0 - xx[i] / 128.0 - yy[i] / 4.0);
    }
  }
  return curve;
}

Surface mast_wall() {
  const Curve foot = mast_foot();
  const KnotVector up = KnotVector::uniform(3, 6);
  std::vector<Vec3> poles;
  for (const Vec3& p : foot.poles) {
    for (int j = 0; j < up.size(); ++j) {
      poles.emplace_back(p.x(), p.y(), p.z() + kMastHeight * up.greville(j));
    }
  }
  return {foot.knots, up, poles};
}

Surface mast_cover() {
  Polynomial height = kSkin;
  height.front().coefficient += kMastHeight;
  return graph(height, KnotVector::uniform(3, 6, kMastX - 0.375, kMastX + 0.375),
               KnotVector::uniform(3, 6, -0.375, 0.375));
}

// One of the four planar sides, seen from outside: from one corner of the skin to the next.
struct Wall {
  const char* name;
  Vec3 normal;
  Side side;     // of the skin
  bool forward;  // the skin's side runs from the wall's left to its right
};

}  // namespace

std::string canopy_step() {
  StepText step("canopy", "Block with a curved skin, a canopy and a mast", "METRE");
  const Surface skin = graph(kSkin, KnotVector::uniform(3, 32, -kHalfLength, kHalfLength),
                             KnotVector::uniform(3, 24, -kHalfWidth, kHalfWidth));
  const Surface canopy = graph(kCanopy, KnotVector::uniform(4, 9, -2.25, 2.25),
                               KnotVector::uniform(3, 6, -0.75, 0.75));
  const int skin_id = step.surface(skin), canopy_id = step.surface(canopy);
  const Surface mast = mast_wall(), cover = mast_cover();
  const int mast_id = step.surface(mast, true), cover_id = step.surface(cover);

  const std::array<Wall, 4> walls = {{{"port", -Vec3::UnitY(), Side::kVBegin, true},
                                      {"aft", Vec3::UnitX(), Side::kUEnd, true},
                                      {"starboard", Vec3::UnitY(), Side::kVEnd, false},
                                      {"fore", -Vec3::UnitX(), Side::kUBegin, false}}};
  // Corners counter-clockwise, seen from above; wall k is between corners k and k + 1.
  std::array<Vec3, 4> top, bottom;
  std::array<int, 4> top_id, bottom_id, upright;
  const int last_u = skin.u_size() - 1, last_v = skin.v_size() - 1;
  top = {skin.pole(0, 0), skin.pole(last_u, 0), skin.pole(last_u, last_v), skin.pole(0, last_v)};
  for (size_t k = 0; k < 4; ++k) {
    bottom[k] = Vec3(top[k].x(), top[k].y(), kFloor);
    top_id[k] = step.vertex(top[k]);
    bottom_id[k] = step.vertex(bottom[k]);
  }
  const int floor = step.plane(Vec3(0.0, 0.0, kFloor), -Vec3::UnitZ(), Vec3::UnitX());
  const auto on_floor = [](const Vec3& p) { return Uv{p.x(), 0.0 - p.y()}; };
  std::array<int, 4> plane;
  std::array<Vec3, 4> right;  // along the walls, seen from outside
  for (size_t k = 0; k < 4; ++k) {
    right[k] = Vec3::UnitZ().cross(walls[k].normal);
    plane[k] = step.plane(bottom[k], walls[k].normal, right[k]);
  }
  const auto on_wall = [&](size_t k, const Vec3& p) {
    return Uv{(p - bottom[k]).dot(right[k]), p.z() - kFloor};
  };
  for (size_t k = 0; k < 4; ++k) {
    const size_t before = (k + 3) % 4;
    upright[k] = step.straight_edge(
        bottom_id[k], top_id[k], bottom[k], top[k],
        {straight_pcurve(plane[k], on_wall(k, bottom[k]), {0.0, 1.0}),
         straight_pcurve(plane[before], on_wall(before, bottom[k]), {0.0, 1.0})});
  }
  std::vector<Use> outline, floor_loop;
  std::array<int, 4> sill, foot;
  for (size_t k = 0; k < 4; ++k) {
    const size_t next = (k + 1) % 4;
    const Curve curve = side_curve(skin, walls[k].side);
    std::vector<Uv> poles;
    for (const Vec3& pole : curve.poles) poles.push_back(on_wall(k, pole));
    const bool along_u = !is_u_side(walls[k].side);
    const double at = is_begin_side(walls[k].side) ? -1.0 : 1.0;
    const Pcurve on_skin = along_u ? straight_pcurve(skin_id, {0.0, at * kHalfWidth}, {1.0, 0.0})
                                   : straight_pcurve(skin_id, {at * kHalfLength, 0.0}, {0.0, 1.0});
    const size_t from = walls[k].forward ? k : next, to = walls[k].forward ? next : k;
    sill[k] = step.edge(top_id[from], top_id[to], curve,
                        {on_skin, spline_pcurve(plane[k], curve.knots, poles)});
    const Vec3 direction = right[k];
    foot[k] = step.straight_edge(
        bottom_id[k], bottom_id[next], bottom[k], bottom[next],
        {straight_pcurve(plane[k], on_wall(k, bottom[k]), {1.0, 0.0}),
         straight_pcurve(floor, on_floor(bottom[k]), {direction.x(), 0.0 - direction.y()})});
    outline.push_back({sill[k], walls[k].forward});
  }
  for (size_t k = 4; k-- > 0;) floor_loop.push_back({foot[k], false});

  const Curve upper_curve = rim(1.0), lower_curve = rim(-1.0);
  const int fore_tip = step.vertex(upper_curve.poles.front());
  const int aft_tip = step.vertex(upper_curve.poles.back());
  const auto rim_edge = [&](const Curve& curve, double sign) {
    return step.edge(fore_tip, aft_tip, curve,
                     {rim_pcurve(skin_id, sign), rim_pcurve(canopy_id, sign)});
  };
  const int upper = rim_edge(upper_curve, 1.0), lower = rim_edge(lower_curve, -1.0);
  const Curve foot_curve = side_curve(mast, Side::kVBegin);
  const Curve rim_curve = side_curve(mast, Side::kVEnd);
  const int mast_low = step.vertex(foot_curve.poles.front());
  const int mast_high = step.vertex(rim_curve.poles.front());
  const int mast_base = step.edge(mast_low, mast_low, foot_curve,
                                  {mast_pcurve(skin_id), straight_pcurve(mast_id, {0, 0}, {1, 0})});
  const int mast_top = step.edge(mast_high, mast_high, rim_curve,
                                 {straight_pcurve(mast_id, {0, 1}, {1, 0}), mast_pcurve(cover_id)});
  const int mast_seam = step.edge(
      mast_low, mast_high, side_curve(mast, Side::kUBegin),
      {straight_pcurve(mast_id, {kArcs, 0}, {0, 1}), straight_pcurve(mast_id, {0, 0}, {0, 1})},
      true);
  step.face("skin", skin_id, {outline, {{upper, true}, {lower, false}}, {{mast_base, false}}},
            kSkinColour);
  step.face("canopy", canopy_id, {{{lower, true}, {upper, false}}}, kCanopyColour);
  for (size_t k = 0; k < 4; ++k) {
    const size_t next = (k + 1) % 4;
    step.face(walls[k].name, plane[k],
              {{{foot[k], true},
                {upright[next], true},
                {sill[k], !walls[k].forward},
                {upright[k], false}}},
              kSideColour);
  }
  step.face("mast", mast_id,
            {{{mast_base, true}, {mast_seam, true}, {mast_top, false}, {mast_seam, false}}},
            kSideColour);
  step.face("mast cover", cover_id, {{{mast_top, true}}}, kSideColour);
  step.face("floor", floor, {floor_loop}, kSideColour);
  return step.text();
}

}  // namespace make_data
