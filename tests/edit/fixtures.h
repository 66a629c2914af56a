// What the tests of the edit layer share: prepared models, usual edits, small vector algebra.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"
#include "isochor/edit/displacement_space.h"
#include "isochor/edit/edit_script.h"
#include "support/models.h"

namespace isochor::testing {

// A model with its joins and locks, as the readers deliver it.
inline PatchModel prepared(PatchModel model) {
  model.joins = find_joins(model);
  derive_locks(model);
  return model;
}

// The cube of figures 3 to 6 of Sauvage et al. 2008.
inline PatchModel paper_cube() { return prepared(make_cube_model(3, 12)); }

// The same cube as the paper's, small enough for dense oracles.
inline PatchModel small_cube(int degree = 2, int spans = 4) {
  return prepared(make_cube_model(degree, spans));
}

// A bent cube without any symmetry.
inline PatchModel bent_cube(std::uint32_t seed, double weight_ratio = 1.0, double bend = 0.05) {
  RandomModelOptions options;
  options.bend = bend;
  options.weight_ratio = weight_ratio;
  return prepared(random_closed_model(seed, options));
}

// The cube from -1/2 to 1/2: symmetric in all three planes.
inline PatchModel centred_cube(int degree, int spans) {
  PatchModel model = make_cube_model(degree, spans);
  translate(model, Vec3::Constant(-0.5));
  return prepared(model);
}

inline Scale every(int k) {
  Scale scale;
  scale.kind = k == 1 ? Scale::Kind::kFinest : Scale::Kind::kEvery;
  scale.every = k;
  return scale;
}

// Positions only, at a scale: the usual space of these tests.
inline DisplacementSpace::Options at_scale(int k) { return {every(k), Continuity::kC0, {}}; }

inline DisplacementSpace::Options mirrored(int axis, int k = 1) {
  return {every(k), Continuity::kC0, {axis}};
}

inline Move move_by(const std::string& patch, Uv uv, const Vec3& vector) {
  Move move;
  move.place.patch = patch;
  move.place.uv = uv;
  move.vector = vector;
  return move;
}

inline Move move_pole_by(const std::string& patch, int i, int j, const Vec3& vector) {
  Move move = move_by(patch, {}, vector);
  move.place.kind = Place::Kind::kCoefficient;
  move.place.i = i;
  move.place.j = j;
  return move;
}

inline Hold hold_at(const std::string& patch, Uv uv) {
  Hold hold;
  hold.place.patch = patch;
  hold.place.uv = uv;
  return hold;
}

inline Hold hold_edge(const std::string& a, const std::string& b) {
  Hold hold;
  hold.kind = Hold::Kind::kEdge;
  hold.edge = {a, b};
  return hold;
}

inline Hold hold_symmetry(int axis) {
  Hold hold;
  hold.kind = Hold::Kind::kSymmetry;
  hold.axis = axis;
  return hold;
}

inline Extent whole_extent() {
  Extent extent;
  extent.kind = Extent::Kind::kAll;
  return extent;
}

inline Extent ball(double radius) {
  Extent extent;
  extent.kind = Extent::Kind::kRadius;
  extent.radius = radius;
  return extent;
}

inline Extent faces(const std::vector<std::string>& names) {
  Extent extent;
  extent.kind = Extent::Kind::kFaces;
  extent.faces = names;
  return extent;
}

inline Extent poles(const std::string& patch, const std::vector<std::pair<int, int>>& indices) {
  Extent extent;
  extent.kind = Extent::Kind::kPoles;
  extent.poles[patch] = indices;
  return extent;
}

// One move, positions only, everything else by default.
inline Edit edit_of(const Move& move, const Extent& extent) {
  Edit edit;
  edit.moves = {move};
  edit.extent = extent;
  edit.continuity = Continuity::kC0;
  return edit;
}

// Figure 4 of Sauvage et al. 2008: point (0.7, 0.8) of the top, displacement (0.2, 0.2, 0.9).
inline Edit figure4(Method method = Method::kIsotropic) {
  Edit edit = edit_of(move_by("top", {0.7, 0.8}, Vec3(0.2, 0.2, 0.9)), ball(0.5));
  edit.name = "figure 4";
  edit.method = method;
  return edit;
}

inline std::vector<Vec3> random_vectors(std::uint32_t seed, size_t count) {
  std::mt19937 random(seed);
  std::normal_distribution<double> value;
  std::vector<Vec3> vectors(count);
  for (Vec3& v : vectors) {
    for (int a = 0; a < 3; ++a) v[a] = value(random);
  }
  return vectors;
}

inline double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

// The largest distance between points of the same index.
inline double distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double largest = 0.0;
  for (size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

// The value of a row on coefficients.
inline Vec3 value_of(const CoefficientRow& row, const std::vector<Vec3>& delta) {
  Vec3 sum = Vec3::Zero();
  for (size_t k = 0; k < row.coefficient.size(); ++k) {
    sum += row.value[k].cwiseProduct(delta[static_cast<size_t>(row.coefficient[k])]);
  }
  return sum;
}

}  // namespace isochor::testing
