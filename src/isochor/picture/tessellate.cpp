#include "isochor/picture/tessellate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/picture/cell_counts.h"

namespace isochor {
namespace {

using internal::GridLine;
using internal::GridVertex;
using internal::TrimTest;

UvBox domain_of(const Patch& patch) {
  return {patch.u_knots.begin(), patch.u_knots.end(), patch.v_knots.begin(), patch.v_knots.end()};
}

double extent_of(const Surface& surface) {
  Box box;
  for (const Vec3& p : surface.poles()) box.add(p);
  return box.diagonal();
}

// Evaluates the vertices of one patch; knows how to get a normal where S_u x S_v vanishes.
class VertexEvaluator {
 public:
  VertexEvaluator(const Surface& surface, double sign)
      : surface_(surface),
        sign_(sign),
        u_range_(surface.u_knots().end() - surface.u_knots().begin()),
        v_range_(surface.v_knots().end() - surface.v_knots().begin()) {
    const double extent = extent_of(surface);
    singular_ = kSingularNormal * extent * extent;
  }

  void evaluate(const GridVertex& at, Vec3* position, Vec3* normal) const {
    const SurfaceDerivatives here =
        surface_.derivatives(at.u.at, at.v.at, 1, at.u.limit, at.v.limit);
    *position = here.s;
    if (unit_normal(here, normal)) return;
    // A collapsed side: the limit from inside, found by stepping off it across, then along.
    const double u_middle = surface_.u_knots().begin() + 0.5 * u_range_;
    const double v_middle = surface_.v_knots().begin() + 0.5 * v_range_;
    for (double step : {1e-4, 1e-3, 1e-2}) {
      const double u = at.u.at + (at.u.at < u_middle ? step : -step) * u_range_;
      const double v = at.v.at + (at.v.at < v_middle ? step : -step) * v_range_;
      const bool v_first = here.su.norm() * u_range_ < here.sv.norm() * v_range_;
      const std::pair<double, double> tries[3] = {
          v_first ? std::pair(at.u.at, v) : std::pair(u, at.v.at),
          v_first ? std::pair(u, at.v.at) : std::pair(at.u.at, v), std::pair(u, v)};
      for (const auto& [tu, tv] : tries) {
        if (unit_normal(surface_.derivatives(tu, tv, 1), normal)) return;
      }
    }
    *normal = Vec3::Zero();  // complete_normals takes it from the triangles
  }

 private:
  bool unit_normal(const SurfaceDerivatives& at, Vec3* normal) const {
    const Vec3 cross = at.su.cross(at.sv);
    const double length = cross.norm();
    if (!(length * u_range_ * v_range_ > singular_)) return false;
    *normal = cross * (sign_ / length);
    return true;
  }

  const Surface& surface_;
  const double sign_, u_range_, v_range_;
  double singular_ = 0.0;
};

Mesh evaluate_grid(const internal::PatchGrid& grid, const Surface& surface, bool reversed) {
  Mesh mesh;
  mesh.positions.resize(grid.vertices.size());
  mesh.normals.resize(grid.vertices.size());
  const VertexEvaluator evaluator(surface, reversed ? -1.0 : 1.0);
  for (size_t i = 0; i < grid.vertices.size(); ++i) {
    evaluator.evaluate(grid.vertices[i], &mesh.positions[i], &mesh.normals[i]);
  }
  mesh.triangles = grid.triangles;
  if (reversed) {
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
  complete_normals(mesh);
  return mesh;
}

bool smooth_side(const PatchModel& model, const SideRef& side) {
  for (const Join& join : model.joins) {
    if (join.a == side || join.b == side) return join.smoothness >= Smoothness::kAlmost;
  }
  for (const LockedSide& locked : model.locked_sides) {
    if (locked.side == side) return locked.smoothness >= Smoothness::kAlmost;
  }
  return false;
}

bool has_length(const std::vector<Vec3>& line, double least) {
  double length = 0.0;
  for (size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();
  return length > least;
}

// A closed polyline in the parameters as a curve in space, with points where it leaves a cell's
// width.
std::vector<Vec3> loop_curve(const Surface& surface, const std::vector<Uv>& loop, double u_step,
                             double v_step) {
  std::vector<Vec3> curve;
  for (size_t i = 0; i < loop.size(); ++i) {
    const Uv& a = loop[i];
    const Uv& b = loop[(i + 1) % loop.size()];
    const double reach = std::max(std::abs(b.u - a.u) / u_step, std::abs(b.v - a.v) / v_step);
    const int pieces = std::clamp(static_cast<int>(std::ceil(reach)), 1, 4096);
    for (int k = 0; k < pieces; ++k) {
      const double f = static_cast<double>(k) / pieces;
      curve.push_back(surface.point(a.u + f * (b.u - a.u), a.v + f * (b.v - a.v)));
    }
  }
  if (!curve.empty()) curve.push_back(curve.front());
  return curve;
}

}  // namespace

void TessellationOptions::validate() const {
  ISOCHOR_REQUIRE(1 <= min_cells && min_cells <= max_cells, min_cells, max_cells);
  ISOCHOR_REQUIRE(max_cells <= 4096, max_cells);
  ISOCHOR_REQUIRE(chord > 0.0, chord);
  ISOCHOR_REQUIRE(0 <= trim_levels && trim_levels <= 8, trim_levels);
  ISOCHOR_REQUIRE(max_triangles >= 1.0, max_triangles);
}

Tessellator::Tessellator(PatchModel model, const TessellationOptions& options,
                         const std::vector<std::vector<Vec3>>& other_points)
    : model_(std::move(model)) {
  options.validate();
  std::vector<const std::vector<Vec3>*> shapes = {&model_.points};
  for (const auto& points : other_points) {
    ISOCHOR_REQUIRE(points.size() == model_.points.size(), points.size(), model_.points.size());
    shapes.push_back(&points);
  }
  const std::vector<internal::CellCounts> counts = internal::choose_cells(model_, shapes, options);
  for (size_t q = 0; q < model_.patches.size(); ++q) {
    const Patch& patch = model_.patches[q];
    u_lines_.push_back(internal::grid_lines(patch.u_knots, counts[q].u));
    v_lines_.push_back(internal::grid_lines(patch.v_knots, counts[q].v));
    trims_.emplace_back(patch.trim, domain_of(patch));
    grids_.push_back(
        internal::make_patch_grid(u_lines_[q], v_lines_[q], trims_[q], options.trim_levels));
  }
}

std::vector<Surface> Tessellator::surfaces_at(const std::vector<Vec3>& points) const {
  ISOCHOR_REQUIRE(points.size() == model_.points.size(), points.size(), model_.points.size());
  std::vector<Surface> surfaces;
  surfaces.reserve(model_.patches.size());
  for (size_t q = 0; q < model_.patches.size(); ++q) {
    surfaces.push_back(model_.surface(static_cast<int>(q), points));
  }
  return surfaces;
}

void Tessellator::require_corresponding(const std::vector<Surface>& surfaces) const {
  ISOCHOR_REQUIRE(surfaces.size() == grids_.size(), surfaces.size(), grids_.size());
  for (size_t q = 0; q < grids_.size(); ++q) {
    const UvBox own = domain_of(model_.patches[q]);
    const KnotVector& u = surfaces[q].u_knots();
    const KnotVector& v = surfaces[q].v_knots();
    ISOCHOR_REQUIRE(u.begin() == own.u_min && u.end() == own.u_max, q, u.begin(), u.end());
    ISOCHOR_REQUIRE(v.begin() == own.v_min && v.end() == own.v_max, q, v.begin(), v.end());
  }
}

Mesh Tessellator::mesh(const std::vector<Vec3>& points) const { return mesh(surfaces_at(points)); }

Mesh Tessellator::mesh(const std::vector<Surface>& surfaces) const {
  require_corresponding(surfaces);
  Mesh whole;
  for (size_t q = 0; q < grids_.size(); ++q) {
    append(whole, evaluate_grid(grids_[q], surfaces[q], model_.patches[q].reversed),
           static_cast<int>(q));
  }
  return whole;
}

std::vector<Vec3> Tessellator::iso_curve(const Surface& surface, size_t patch, bool along_v,
                                         double at) const {
  std::vector<Vec3> curve;
  double last = std::numeric_limits<double>::quiet_NaN();
  for (const GridLine& line : along_v ? v_lines_[patch] : u_lines_[patch]) {
    if (std::exchange(last, line.at) == line.at) continue;  // a crease, there twice
    curve.push_back(along_v ? surface.point(at, line.at) : surface.point(line.at, at));
  }
  return curve;
}

std::vector<LineSet> Tessellator::borders(const std::vector<Vec3>& points) const {
  return borders(surfaces_at(points));
}

std::vector<LineSet> Tessellator::borders(const std::vector<Surface>& surfaces) const {
  require_corresponding(surfaces);
  std::vector<LineSet> lines(2);
  lines[1].colour = {0.47, 0.50, 0.54};
  lines[1].width = 0.8;
  const double least = kCoincident * diagonal(model_);
  for (size_t q = 0; q < model_.patches.size(); ++q) {
    const Patch& patch = model_.patches[q];
    const Surface& surface = surfaces[q];
    const UvBox box = domain_of(patch);
    if (!trims_[q].keeps_all()) {
      const double u_step = (box.u_max - box.u_min) / static_cast<double>(u_lines_[q].size());
      const double v_step = (box.v_max - box.v_min) / static_cast<double>(v_lines_[q].size());
      for (const auto& loop : patch.trim.loops) {
        lines[0].add(loop_curve(surface, loop, u_step, v_step));
      }
      continue;
    }
    for (Side side : kSides) {
      const bool begin = is_begin_side(side);
      const double at =
          is_u_side(side) ? (begin ? box.u_min : box.u_max) : (begin ? box.v_min : box.v_max);
      const std::vector<Vec3> curve = iso_curve(surface, q, is_u_side(side), at);
      const bool smooth = smooth_side(model_, {static_cast<int>(q), side});
      if (has_length(curve, least)) lines[smooth ? 1 : 0].add(curve);
    }
  }
  return lines;
}

LineSet Tessellator::knot_lines(const std::vector<Vec3>& points, int max_lines) const {
  ISOCHOR_REQUIRE(max_lines >= 1, max_lines);
  LineSet lines;
  lines.colour = {0.25, 0.28, 0.33};
  lines.width = 0.6;
  lines.opacity = 0.4;
  for (size_t q = 0; q < model_.patches.size(); ++q) {
    const Patch& patch = model_.patches[q];
    const Surface surface = model_.surface(static_cast<int>(q), points);
    for (bool along_v : {true, false}) {
      const std::vector<double> breaks = (along_v ? patch.u_knots : patch.v_knots).breaks();
      const auto spans = static_cast<int>(breaks.size()) - 1;
      const int stride = (spans + max_lines) / (max_lines + 1);
      for (int k = stride; k < spans; k += stride) {
        const double at = breaks[static_cast<size_t>(k)];
        std::vector<Vec3> run;
        for (const GridLine& line : along_v ? v_lines_[q] : u_lines_[q]) {
          const Uv uv = along_v ? Uv{at, line.at} : Uv{line.at, at};
          if (trims_[q].inside(uv.u, uv.v)) {
            run.push_back(surface.point(uv.u, uv.v));
          } else {
            lines.add(run);
            run.clear();
          }
        }
        lines.add(run);
      }
    }
  }
  return lines;
}

Mesh tessellate(const PatchModel& model, const TessellationOptions& options) {
  return Tessellator(model, options).mesh();
}

LineSet control_net(const PatchModel& model, const std::vector<Vec3>& points) {
  ISOCHOR_REQUIRE(points.size() == model.points.size(), points.size(), model.points.size());
  LineSet net;
  net.colour = {0.78, 0.45, 0.12};
  net.width = 0.8;
  for (const Patch& patch : model.patches) {
    const auto first = static_cast<int>(net.points.size());
    for (int id : patch.points) net.points.push_back(points[static_cast<size_t>(id)]);
    const int nv = patch.v_size();
    for (int i = 0; i < patch.u_size(); ++i) {
      for (int j = 0; j < nv; ++j) {
        const int here = first + i * nv + j;
        if (j + 1 < nv) net.segments.push_back({here, here + 1});
        if (i + 1 < patch.u_size()) net.segments.push_back({here, here + nv});
      }
    }
  }
  return net;
}

}  // namespace isochor
