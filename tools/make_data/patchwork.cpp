#include <algorithm>
#include <map>
#include <tuple>

#include "make_data/shapes.h"
#include "make_data/step_text.h"

namespace make_data {

using isochor::Side;

namespace {

// A flat face of the unit cube, or a part of one: parameters are coordinates; u x v points out.
struct Piece {
  const char* name;
  int u_axis, v_axis, normal_axis;
  double level;  // of the normal coordinate
  KnotVector u, v;
};

KnotVector spans(int count, double begin = 0.0, double end = 1.0) {
  return KnotVector::uniform(3, count, begin, end);
}

// Seven faces in different bases; front and back meet both halves of the top along one side.
std::vector<Piece> pieces() {
  return {{"top left", 0, 1, 2, 1.0, spans(4, 0.0, 0.5), spans(6)},
          {"top right", 0, 1, 2, 1.0, spans(6, 0.5, 1.0), spans(4)},
          {"bottom", 1, 0, 2, 0.0, spans(6), spans(8)},
          {"front", 0, 2, 1, 0.0, spans(8), spans(6)},
          {"back", 2, 0, 1, 1.0, spans(6), spans(8)},
          {"left", 2, 1, 0, 0.0, spans(6), spans(6)},
          {"right", 1, 2, 0, 1.0, spans(6), spans(6)}};
}

Surface surface_of(const Piece& piece) {
  std::vector<Vec3> poles;
  for (int i = 0; i < piece.u.size(); ++i) {
    for (int j = 0; j < piece.v.size(); ++j) {
      Vec3 pole;
      pole[piece.u_axis] = piece.u.greville(i);
      pole[piece.v_axis] = piece.v.greville(j);
      pole[piece.normal_axis] = piece.level;
      poles.push_back(pole);
    }
  }
  return {piece.u, piece.v, poles};
}

// A vertex by its coordinates, in halves.
using Corner = std::tuple<int, int, int>;
Corner corner(const Vec3& p) {
  return {static_cast<int>(2.0 * p.x()), static_cast<int>(2.0 * p.y()),
          static_cast<int>(2.0 * p.z())};
}

// The edges along a side, in the direction of its parameter: two where the side runs through the
// middle of the top, also between the two halves of the top.
std::vector<Curve> edges_along(const Surface& surface, Side side) {
  const bool along_u = !is_u_side(side);
  const KnotVector& knots = along_u ? surface.u_knots() : surface.v_knots();
  const KnotVector& across = along_u ? surface.v_knots() : surface.u_knots();
  const double at = is_begin_side(side) ? across.begin() : across.end();
  const Curve whole = side_curve(surface, side);
  const Vec3 middle = 0.5 * (whole.poles.front() + whole.poles.back());
  const bool divided = middle.x() == 0.5 && middle.z() == 1.0;
  if (!divided) return {whole};
  const auto part = [&](double from, double to) {
    return along_u ? iso_v_curve(surface, at, from, to) : iso_u_curve(surface, at, from, to);
  };
  return {part(knots.begin(), 0.5), part(0.5, knots.end())};
}

Pcurve pcurve_along(int id, const Surface& surface, Side side) {
  const KnotVector& across = is_u_side(side) ? surface.u_knots() : surface.v_knots();
  const double at = is_begin_side(side) ? across.begin() : across.end();
  return is_u_side(side) ? straight_pcurve(id, {at, 0.0}, {0.0, 1.0})
                         : straight_pcurve(id, {0.0, at}, {1.0, 0.0});
}

}  // namespace

std::string patchwork_step() {
  StepText step("patchwork", "Unit cube of seven patches in different bases", "METRE");
  struct Edge {
    Curve curve;
    std::vector<Pcurve> pcurves;
    int id = 0;
  };
  std::vector<Surface> surfaces;
  std::vector<int> ids;
  std::map<std::pair<Corner, Corner>, Edge> edges;  // every edge runs along a rising coordinate
  std::map<Corner, int> vertices;
  const auto key = [](const Curve& curve) {
    return std::make_pair(corner(curve.poles.front()), corner(curve.poles.back()));
  };
  const std::vector<Piece> faces = pieces();
  for (const Piece& piece : faces) {
    surfaces.push_back(surface_of(piece));
    ids.push_back(step.surface(surfaces.back()));
    for (Side side : isochor::kSides) {
      for (const Curve& curve : edges_along(surfaces.back(), side)) {
        for (const Vec3& end : {curve.poles.front(), curve.poles.back()}) {
          if (vertices.count(corner(end)) == 0) vertices[corner(end)] = step.vertex(end);
        }
        Edge& edge = edges.emplace(key(curve), Edge{curve, {}}).first->second;
        edge.pcurves.push_back(pcurve_along(ids.back(), surfaces.back(), side));
      }
    }
  }
  for (auto& [ends, edge] : edges) {
    edge.id = step.edge(vertices[ends.first], vertices[ends.second], edge.curve, edge.pcurves);
  }
  const Rgb colour{0.62, 0.72, 0.85};
  for (size_t f = 0; f < faces.size(); ++f) {
    std::vector<Use> loop;
    for (const auto& [side, forward] : {std::pair(Side::kVBegin, true),
                                        {Side::kUEnd, true},
                                        {Side::kVEnd, false},
                                        {Side::kUBegin, false}}) {
      std::vector<Curve> along = edges_along(surfaces[f], side);
      if (!forward) std::reverse(along.begin(), along.end());
      for (const Curve& curve : along) loop.push_back({edges.at(key(curve)).id, forward});
    }
    step.face(faces[f].name, ids[f], {loop}, colour);
  }
  return step.text();
}

}  // namespace make_data
