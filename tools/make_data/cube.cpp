#include <map>

#include "make_data/model_text.h"
#include "make_data/shapes.h"
#include "make_data/step_text.h"

namespace make_data {

using isochor::Side;

namespace {

constexpr int kSpans = 12;

// A face: where its parameters run; u x v points out of the cube.
struct CubeFace {
  const char* name;
  int u_axis, v_axis, normal_axis;
  double level;  // of the normal coordinate
};
constexpr std::array<CubeFace, 6> kFaces{{{"top", 0, 1, 2, 1.0},
                                          {"bottom", 1, 0, 2, 0.0},
                                          {"front", 0, 2, 1, 0.0},
                                          {"back", 2, 0, 1, 1.0},
                                          {"left", 2, 1, 0, 0.0},
                                          {"right", 1, 2, 0, 1.0}}};

Surface face_surface(const CubeFace& face) {
  const KnotVector knots = KnotVector::uniform(3, kSpans);
  std::vector<Vec3> poles;
  for (int i = 0; i < knots.size(); ++i) {
    for (int j = 0; j < knots.size(); ++j) {
      Vec3 pole;
      pole[face.u_axis] = knots.greville(i);
      pole[face.v_axis] = knots.greville(j);
      pole[face.normal_axis] = face.level;
      poles.push_back(pole);
    }
  }
  return {knots, knots, poles};
}

// Straight pcurve of a side, along the side's own parameter.
Pcurve side_pcurve(int surface, Side side) {
  const double at = is_begin_side(side) ? 0.0 : 1.0;
  return is_u_side(side) ? straight_pcurve(surface, {at, 0.0}, {0.0, 1.0})
                         : straight_pcurve(surface, {0.0, at}, {1.0, 0.0});
}

}  // namespace

std::string cube_step() {
  StepText step("cube", "Unit cube of six bicubic patches", "METRE");
  std::vector<Surface> surfaces;
  std::vector<int> ids;
  for (const CubeFace& face : kFaces) {
    surfaces.push_back(face_surface(face));
    ids.push_back(step.surface(surfaces.back()));
  }
  struct HalfEdge {
    Curve curve;
    Pcurve pcurve;
  };
  // Every edge runs along a rising coordinate, on both faces.
  std::map<std::pair<int, int>, std::vector<HalfEdge>> halves;  // by the two end vertices
  std::map<int, int> vertices;                                  // by corner number
  const auto corner = [](const Vec3& p) {
    return static_cast<int>(p.x() + 2.0 * p.y() + 4.0 * p.z());
  };
  const auto ends = [&](const Curve& curve) {
    return std::make_pair(corner(curve.poles.front()), corner(curve.poles.back()));
  };
  for (int number = 0; number < 8; ++number) {
    vertices[number] = step.vertex(Vec3(number % 2, number / 2 % 2, number / 4));
  }
  for (size_t f = 0; f < kFaces.size(); ++f) {
    for (Side side : isochor::kSides) {
      const Curve curve = side_curve(surfaces[f], side);
      halves[ends(curve)].push_back({curve, side_pcurve(ids[f], side)});
    }
  }
  std::map<std::pair<int, int>, int> edges;
  for (const auto& [key, pair] : halves) {
    edges[key] = step.edge(vertices[key.first], vertices[key.second], pair[0].curve,
                           {pair[0].pcurve, pair[1].pcurve});
  }
  const Rgb colour{0.62, 0.72, 0.85};
  for (size_t f = 0; f < kFaces.size(); ++f) {
    const auto edge = [&](Side side) { return edges[ends(side_curve(surfaces[f], side))]; };
    step.face(kFaces[f].name, ids[f],
              {{{edge(Side::kVBegin), true},
                {edge(Side::kUEnd), true},
                {edge(Side::kVEnd), false},
                {edge(Side::kUBegin), false}}},
              colour);
  }
  return step.text();
}

std::string cube_json() {
  NamedSurfaces surfaces;
  for (const CubeFace& face : kFaces) surfaces.emplace_back(face.name, face_surface(face));
  return model_text(surfaces);
}

}  // namespace make_data
