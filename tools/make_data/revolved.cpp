// Bodies of revolution as kernels write them when they convert them: rational, with circles of four
// arcs, smooth only because their poles lie as they do.
#include <cmath>

#include "make_data/model_text.h"
#include "make_data/shapes.h"

namespace make_data {
namespace {

using isochor::KnotVector;
using isochor::Surface;
using isochor::Vec3;

// A pole of a rational plane curve: place times weight, weight.
struct Pole {
  double x, y, w;
};

struct Curve {
  KnotVector knots;
  std::vector<Pole> poles;
};

// The unit circle in four quadratic arcs.
Curve circle() {
  const double corner = std::sqrt(0.5);
  return {KnotVector(2, {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4}),
          {{1, 0, 1},
           {corner, corner, corner},
           {0, 1, 1},
           {-corner, corner, corner},
           {-1, 0, 1},
           {-corner, -corner, corner},
           {0, -1, 1},
           {corner, -corner, corner},
           {1, 0, 1}}};
}

// Bezier arcs of degree 2 as arcs of degree 3.
Curve elevated(const Curve& arcs) {
  Curve cubic{arcs.knots, {}};
  std::vector<double> knots;
  for (double knot : arcs.knots.breaks()) knots.insert(knots.end(), 3, knot);
  knots.insert(knots.begin(), knots.front());
  knots.push_back(knots.back());
  cubic.knots = KnotVector(3, knots);
  const auto mixed = [](const Pole& near, const Pole& far) {
    return Pole{(near.x + 2 * far.x) / 3, (near.y + 2 * far.y) / 3, (near.w + 2 * far.w) / 3};
  };
  for (size_t i = 0; i + 2 < arcs.poles.size(); i += 2) {
    cubic.poles.push_back(arcs.poles[i]);
    cubic.poles.push_back(mixed(arcs.poles[i], arcs.poles[i + 1]));
    cubic.poles.push_back(mixed(arcs.poles[i + 2], arcs.poles[i + 1]));
  }
  cubic.poles.push_back(arcs.poles.back());
  return cubic;
}

// From one point to another, cubic, in equal spans.
Curve straight(const Vec3& from, const Vec3& to, int spans) {
  Curve line{KnotVector::uniform(3, spans), {}};
  for (int i = 0; i < line.knots.size(); ++i) {
    const Vec3 at = from + line.knots.greville(i) * (to - from);
    line.poles.push_back({at.x(), at.y(), 1});
  }
  return line;
}

// `profile` (radius, height) turned around the z axis; u runs around, v along the profile.
Surface revolved(const Curve& around, const Curve& profile) {
  std::vector<Vec3> poles;
  std::vector<double> weights;
  for (const Pole& turn : around.poles) {
    for (const Pole& at : profile.poles) {
      const double radius = at.x / at.w;
      poles.emplace_back(radius * (turn.x / turn.w), radius * (turn.y / turn.w), at.y / at.w);
      for (double& value : poles.back()) value += 0.0;  // no negative zeros
      weights.push_back(turn.w * at.w);
    }
  }
  return {around.knots, profile.knots, poles, weights};
}

}  // namespace

std::string cylinder_json() {
  const Vec3 bottom(0, 0, 0), bottom_rim(1, 0, 0), top_rim(1, 4, 0), top(0, 4, 0);
  return model_text({{"bottom", revolved(circle(), straight(bottom, bottom_rim, 2))},
                     {"wall", revolved(circle(), straight(bottom_rim, top_rim, 5))},
                     {"top", revolved(circle(), straight(top_rim, top, 2))}});
}

std::string torus_json() {
  Curve ring = elevated(circle());
  for (Pole& pole : ring.poles) pole.x += 3 * pole.w;
  return model_text({{"ring", revolved(elevated(circle()), ring)}});
}

std::string spindle_json() {
  const double corner = std::sqrt(0.5);
  // A nose of 2 and a tail of 6, a quarter of an ellipse each: speeds differ by 3 where they meet.
  const Curve profile{
      KnotVector(2, {0, 0, 0, 1, 1, 2, 2, 2}),
      {{0, 0, 1}, {corner, 0, corner}, {1, 2, 1}, {corner, 8 * corner, corner}, {0, 8, 1}}};
  return model_text({{"skin", revolved(circle(), profile)}});
}

}  // namespace make_data
