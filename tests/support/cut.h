// Patches cut into patches that continue each other.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "isochor/bspline/joins.h"
#include "isochor/bspline/model_refinement.h"
#include "isochor/bspline/refinement.h"
#include "support/models.h"
#include "support/splines.h"

namespace isochor::testing {

// Inserts knots until each of the values has full multiplicity: splines interpolate there.
inline KnotVector with_cuts(const KnotVector& knots, const std::vector<double>& cuts) {
  std::vector<double> inserted;
  for (double at : cuts) {
    const int missing = knots.degree() - knots.multiplicity(at);
    inserted.insert(inserted.end(), static_cast<size_t>(missing), at);
  }
  return with_knots(knots, inserted);
}

// The pole ranges [from, to] and knots of the pieces of a direction.
struct Piece {
  int from, to;
  KnotVector knots;
};
inline std::vector<Piece> pieces_of(const KnotVector& knots, const std::vector<double>& cuts) {
  const int d = knots.degree();
  std::vector<Piece> pieces;
  int from = 0;
  const auto add = [&](int to) {
    std::vector<double> own(knots.knots().begin() + from, knots.knots().begin() + to + d + 2);
    // A cut has d copies; each of the two pieces has one more at its end.
    if (from > 0) own.front() = own[1];
    if (to < knots.size() - 1) own.back() = own[own.size() - 2];
    pieces.push_back({from, to, KnotVector(d, own)});
    from = to;
  };
  for (double at : cuts) {
    const auto first = std::lower_bound(knots.knots().begin(), knots.knots().end(), at);
    add(static_cast<int>(first - knots.knots().begin()) - 1);
  }
  add(knots.size() - 1);
  return pieces;
}

// The first patch cut at u and v knots, u-major, as "face:1", "face:2", ...; pieces share the
// points of the cuts, and whatever the whole shared with itself. Joins are found and measured.
inline PatchModel cut_apart(const PatchModel& whole, const std::vector<double>& u_cuts,
                            const std::vector<double>& v_cuts) {
  const Patch& old = whole.patches[0];
  PatchModel refined = without_unused_points(
      refine(whole, 0, with_cuts(old.u_knots, u_cuts), with_cuts(old.v_knots, v_cuts)));
  const Patch patch = refined.patches[0];
  PatchModel model = refined;
  model.patches.clear();
  model.joins.clear();
  for (const Piece& u : pieces_of(patch.u_knots, u_cuts)) {
    for (const Piece& v : pieces_of(patch.v_knots, v_cuts)) {
      Patch piece = patch;
      piece.name.clear();
      piece.handle = "face:" + std::to_string(model.patches.size() + 1);
      piece.u_knots = u.knots;
      piece.v_knots = v.knots;
      piece.points.clear();
      piece.weights.clear();
      for (int i = u.from; i <= u.to; ++i) {
        for (int j = v.from; j <= v.to; ++j) {
          piece.points.push_back(patch.point(i, j));
          if (patch.weights.empty()) continue;
          piece.weights.push_back(patch.weights[static_cast<size_t>(i * patch.v_size() + j)]);
        }
      }
      model.patches.push_back(piece);
    }
  }
  model.joins = find_joins(model);
  return model;
}

// A surface as two patches, "fore" and "aft", cut at a u knot.
inline PatchModel cut_in_two(const Surface& surface, double at) {
  PatchModel model = cut_apart(make_separate_model({surface}), {at}, {});
  model.patches[0].name = "fore";
  model.patches[1].name = "aft";
  return model;
}

// The same patch over a longer domain.
inline void stretch(Patch& patch, Direction direction, double factor) {
  KnotVector& knots = direction == Direction::kU ? patch.u_knots : patch.v_knots;
  std::vector<double> values = knots.knots();
  for (double& t : values) t *= factor;
  knots = KnotVector(knots.degree(), values);
}

// The same patch run through differently: bit 0 of `how` reverses u, bit 1 reverses v, bit 2 swaps
// the two afterwards.
inline Patch reoriented(const Patch& patch, int how) {
  const auto mirrored = [](const KnotVector& knots) {
    std::vector<double> values;
    for (int k = static_cast<int>(knots.knots().size()) - 1; k >= 0; --k) {
      values.push_back(knots.begin() + knots.end() - knots[k]);
    }
    return KnotVector(knots.degree(), values);
  };
  const bool flip_u = (how & 1) != 0;
  const bool flip_v = (how & 2) != 0;
  const bool swap = (how & 4) != 0;
  Patch result = patch;
  if (flip_u) result.u_knots = mirrored(patch.u_knots);
  if (flip_v) result.v_knots = mirrored(patch.v_knots);
  if (swap) std::swap(result.u_knots, result.v_knots);
  for (int i = 0; i < patch.u_size(); ++i) {
    for (int j = 0; j < patch.v_size(); ++j) {
      const int from_i = flip_u ? patch.u_size() - 1 - i : i;
      const int from_j = flip_v ? patch.v_size() - 1 - j : j;
      const auto from = static_cast<size_t>(from_i * patch.v_size() + from_j);
      const auto to = static_cast<size_t>(swap ? j * patch.u_size() + i : i * patch.v_size() + j);
      result.points[to] = patch.points[from];
      if (!patch.weights.empty()) result.weights[to] = patch.weights[from];
    }
  }
  const bool turned_over = (flip_u != flip_v) != swap;
  result.reversed = patch.reversed != turned_over;
  return result;
}

// Bezier patches built to meet with these factors; the last row is random.
inline PatchModel curvature_pair(double lambda, double mu) {
  std::mt19937 random(8);
  const KnotVector knots = KnotVector::uniform(3, 1);
  const auto points = random_points(random, 32);
  PatchModel model =
      make_separate_model({Surface(knots, knots, {points.begin(), points.begin() + 16}),
                           Surface(knots, knots, {points.begin() + 16, points.end()})});
  for (size_t j = 0; j < 4; ++j) {
    const auto a = [&](size_t i) -> Vec3& { return model.points[4 * i + j]; };
    const auto b = [&](size_t i) -> Vec3& { return model.points[16 + 4 * i + j]; };
    for (size_t i = 0; i < 4; ++i) {
      const auto x = static_cast<double>(i);
      const auto y = static_cast<double>(j);
      a(i) = 0.2 * a(i) + Vec3(x, y, 0.0);
      b(i) = 0.2 * b(i) + Vec3(3.0 + x, y, 0.0);
    }
    b(0) = a(3);
    const Vec3 speed = a(3) - a(2);
    b(1) = b(0) + lambda * speed;
    b(2) = 2 * b(1) - b(0) + lambda * lambda * (a(3) - 2 * a(2) + a(1)) + mu * 0.5 * speed;
    model.ties.push_back({12 + static_cast<int>(j), 16 + static_cast<int>(j)});
  }
  model.joins = find_joins(model);
  return model;
}

}  // namespace isochor::testing
