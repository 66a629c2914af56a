#include "support/models.h"

#include <array>
#include <cmath>
#include <map>
#include <random>
#include <utility>

namespace isochor::testing {
namespace {

// Circle of radius 1 as a rational quadratic of four arcs: nine points (x, y, weight); the last
// repeats the first.
constexpr double kHalfRoot = 0.70710678118654752440;
constexpr std::array<std::array<double, 3>, 9> kCircle = {{{1, 0, 1},
                                                           {1, 1, kHalfRoot},
                                                           {0, 1, 1},
                                                           {-1, 1, kHalfRoot},
                                                           {-1, 0, 1},
                                                           {-1, -1, kHalfRoot},
                                                           {0, -1, 1},
                                                           {1, -1, kHalfRoot},
                                                           {1, 0, 1}}};

KnotVector arc_knots(int arcs) {
  std::vector<double> knots(3, 0.0);
  for (int arc = 1; arc < arcs; ++arc) knots.insert(knots.end(), 2, static_cast<double>(arc));
  knots.insert(knots.end(), 3, static_cast<double>(arcs));
  return KnotVector(2, knots);
}

Patch make_patch(const char* name, int number, KnotVector u, KnotVector v) {
  Patch patch{name, "face:" + std::to_string(number), std::move(u), std::move(v), {}, {}, false, {},
              {}};
  return patch;
}

// A face of the box: `fixed` axis at its end (or begin), u along `along_u`, v along `along_v`.
struct BoxFace {
  const char* name;
  int fixed;
  bool at_end;
  int along_u;
  int along_v;
};
constexpr std::array<BoxFace, 6> kBoxFaces = {{{"top", 2, true, 0, 1},
                                               {"bottom", 2, false, 1, 0},
                                               {"right", 0, true, 1, 2},
                                               {"left", 0, false, 2, 1},
                                               {"back", 1, true, 2, 0},
                                               {"front", 1, false, 0, 2}}};

}  // namespace

PatchModel make_box_model(const KnotVector& x, const KnotVector& y, const KnotVector& z) {
  const std::array<const KnotVector*, 3> knots = {&x, &y, &z};
  PatchModel model;
  std::map<std::array<int, 3>, int> lattice;
  const auto point_at = [&](const std::array<int, 3>& at) {
    const auto [entry, fresh] = lattice.emplace(at, static_cast<int>(model.points.size()));
    if (fresh) {
      model.points.emplace_back(x.greville(at[0]), y.greville(at[1]), z.greville(at[2]));
    }
    return entry->second;
  };
  for (const BoxFace& face : kBoxFaces) {
    const auto u = static_cast<size_t>(face.along_u);
    const auto v = static_cast<size_t>(face.along_v);
    const auto w = static_cast<size_t>(face.fixed);
    Patch patch =
        make_patch(face.name, static_cast<int>(model.patches.size()) + 1, *knots[u], *knots[v]);
    std::array<int, 3> at{};
    at[w] = face.at_end ? knots[w]->size() - 1 : 0;
    for (at[u] = 0; at[u] < patch.u_size(); ++at[u]) {
      for (at[v] = 0; at[v] < patch.v_size(); ++at[v]) patch.points.push_back(point_at(at));
    }
    model.patches.push_back(std::move(patch));
  }
  return model;
}

PatchModel make_cube_model(int degree, int spans) {
  const KnotVector knots = KnotVector::uniform(degree, spans);
  return make_box_model(knots, knots, knots);
}

KnotVector random_clamped_knots(std::uint32_t seed, int degree, int spans) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> length(0.1, 1.0);
  std::uniform_int_distribution<int> repeat(1, degree);
  std::vector<double> breaks(1, 0.0);
  for (int s = 0; s < spans; ++s) breaks.push_back(breaks.back() + length(random));
  const double total = breaks.back();
  std::vector<double> knots(static_cast<size_t>(degree) + 1, 0.0);
  for (int s = 1; s < spans; ++s) {
    knots.insert(knots.end(), static_cast<size_t>(repeat(random)),
                 breaks[static_cast<size_t>(s)] / total);
  }
  knots.insert(knots.end(), static_cast<size_t>(degree) + 1, 1.0);
  return KnotVector(degree, knots);
}

PatchModel random_closed_model(std::uint32_t seed, const RandomModelOptions& options) {
  std::mt19937 random(seed);
  std::array<std::uint32_t, 3> seeds{};
  for (auto& s : seeds) s = static_cast<std::uint32_t>(random());
  PatchModel model =
      make_box_model(random_clamped_knots(seeds[0], options.degrees[0], options.spans),
                     random_clamped_knots(seeds[1], options.degrees[1], options.spans),
                     random_clamped_knots(seeds[2], options.degrees[2], options.spans));
  std::uniform_real_distribution<double> shift(-options.bend, options.bend);
  for (Vec3& p : model.points) {
    for (int axis = 0; axis < 3; ++axis) p[axis] += shift(random);
  }
  if (options.weight_ratio != 1.0) {
    // One weight per point, so that neighbours share the boundary curves.
    std::uniform_real_distribution<double> weight(1.0, options.weight_ratio);
    std::vector<double> weights;
    for (size_t i = 0; i < model.points.size(); ++i) weights.push_back(weight(random));
    for (Patch& patch : model.patches) {
      for (int id : patch.points) patch.weights.push_back(weights[static_cast<size_t>(id)]);
    }
  }
  return model;
}

PatchModel random_open_patch(std::uint32_t seed, int degree_u, int degree_v, int spans,
                             bool unclamped) {
  std::mt19937 random(seed);
  const auto knots_for = [&](int degree) {
    if (!unclamped) {
      return random_clamped_knots(static_cast<std::uint32_t>(random()), degree, spans);
    }
    std::uniform_real_distribution<double> length(0.1, 1.0);
    std::vector<double> knots(1, -0.75);
    while (static_cast<int>(knots.size()) < spans + 2 * degree + 1) {
      knots.push_back(knots.back() + length(random));
    }
    return KnotVector(degree, knots);
  };
  PatchModel model;
  const KnotVector u = knots_for(degree_u);
  Patch patch = make_patch("sheet", 1, u, knots_for(degree_v));
  std::uniform_real_distribution<double> coordinate(0.0, 1.0);
  for (int k = 0; k < patch.u_size() * patch.v_size(); ++k) {
    const double x = coordinate(random);
    const double y = coordinate(random);
    model.points.emplace_back(x, y, coordinate(random));
    patch.points.push_back(k);
  }
  model.patches.push_back(std::move(patch));
  return model;
}

PatchModel make_periodic_torus(int degree_u, int degree_v, int rows, int columns,
                               double major_radius, double minor_radius) {
  const auto periodic = [](int degree, int count) {
    std::vector<double> knots;
    for (int k = -degree; k <= count + degree; ++k) knots.push_back(k);
    return KnotVector(degree, knots);
  };
  PatchModel model;
  Patch patch = make_patch("torus", 1, periodic(degree_u, rows), periodic(degree_v, columns));
  const double turn = 2.0 * std::acos(-1.0);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double around = turn * i / rows;
      const double across = turn * j / columns;
      const double r = major_radius + minor_radius * std::cos(across);
      model.points.emplace_back(r * std::cos(around), r * std::sin(around),
                                minor_radius * std::sin(across));
    }
  }
  for (int i = 0; i < rows + degree_u; ++i) {
    for (int j = 0; j < columns + degree_v; ++j) {
      patch.points.push_back((i % rows) * columns + j % columns);
    }
  }
  model.patches.push_back(std::move(patch));
  return model;
}

PatchModel make_sphere(double radius) {
  PatchModel model;
  Patch patch = make_patch("sphere", 1, arc_knots(4), arc_knots(2));
  // v runs from the south pole to the north pole: the half circle of (z, distance from the axis).
  for (size_t i = 0; i < 9; ++i) {
    for (size_t j = 0; j < 5; ++j) {
      const auto& meridian = kCircle[(j + 6) % 8];
      patch.weights.push_back(kCircle[i][2] * meridian[2]);
      const bool pole = j == 0 || j == 4;
      if (i == 8) {
        patch.points.push_back(patch.points[j]);
      } else if (pole && i > 0) {
        patch.points.push_back(patch.points[j]);
      } else {
        patch.points.push_back(static_cast<int>(model.points.size()));
        model.points.push_back(
            radius * Vec3(meridian[0] * kCircle[i][0], meridian[0] * kCircle[i][1], meridian[1]));
      }
    }
  }
  model.patches.push_back(std::move(patch));
  return model;
}

PatchModel make_cylinder(double radius, double height) {
  PatchModel model;
  const KnotVector along = KnotVector::uniform(1, 1);
  // Points 0-7 the lower circle, 8-15 the upper one, 16 and 17 the centres of the disks.
  for (int ring = 0; ring < 2; ++ring) {
    for (size_t i = 0; i < 8; ++i) {
      model.points.emplace_back(radius * kCircle[i][0], radius * kCircle[i][1], ring * height);
    }
  }
  model.points.emplace_back(0.0, 0.0, 0.0);
  model.points.emplace_back(0.0, 0.0, height);
  const auto ruled = [&](const char* name, int number, auto&& begin, auto&& end) {
    Patch patch = make_patch(name, number, arc_knots(4), along);
    for (int i = 0; i < 9; ++i) {
      patch.points.insert(patch.points.end(), {begin(i % 8), end(i % 8)});
      patch.weights.insert(patch.weights.end(), 2, kCircle[static_cast<size_t>(i)][2]);
    }
    model.patches.push_back(std::move(patch));
  };
  const auto lower = [](int i) { return i; };
  const auto upper = [](int i) { return 8 + i; };
  ruled("wall", 1, lower, upper);
  ruled(
      "bottom", 2, [](int) { return 16; }, lower);
  ruled("top", 3, upper, [](int) { return 17; });
  return model;
}

PatchModel make_separate_model(const std::vector<Surface>& surfaces) {
  PatchModel model;
  for (const Surface& surface : surfaces) {
    Patch patch{"",
                "face:" + std::to_string(model.patches.size() + 1),
                surface.u_knots(),
                surface.v_knots(),
                {},
                surface.weights(),
                false,
                {},
                {}};
    for (const Vec3& p : surface.poles()) {
      patch.points.push_back(static_cast<int>(model.points.size()));
      model.points.push_back(p);
    }
    model.patches.push_back(patch);
  }
  return model;
}

void translate(PatchModel& model, const Vec3& t) {
  for (Vec3& p : model.points) p += t;
}

void transform(PatchModel& model, const Eigen::Matrix3d& matrix) {
  for (Vec3& p : model.points) p = matrix * p;
}

}  // namespace isochor::testing
