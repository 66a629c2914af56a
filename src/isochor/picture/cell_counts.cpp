#include "isochor/picture/cell_counts.h"

#include <algorithm>
#include <cmath>

#include "isochor/picture/tessellate.h"

namespace isochor::internal {
namespace {

constexpr int kManySpans = 64;
constexpr int kMaxAcross =
    17;  // places at which a span's bend is looked at, in the other direction

// Evenly spread places over the domain, a little inside its ends.
std::vector<double> places(const KnotVector& knots, int count) {
  std::vector<double> at;
  for (int k = 0; k < count; ++k) {
    const double f = (k + 0.5) / count;
    at.push_back(knots.begin() + f * (knots.end() - knots.begin()));
  }
  return at;
}

// Raises `cells` to what the bend of `surface` along one direction asks for.
void raise_to_bend(const Surface& surface, bool along_u, double chord,
                   const TessellationOptions& options, std::vector<int>& cells) {
  const KnotVector& along = along_u ? surface.u_knots() : surface.v_knots();
  const KnotVector& across = along_u ? surface.v_knots() : surface.u_knots();
  const auto across_spans = static_cast<int>(across.spans().size());
  const std::vector<double> others =
      places(across, std::clamp(2 * across_spans + 1, 3, kMaxAcross));
  const std::vector<double> breaks = along.breaks();
  const int samples = 2 + along.degree() / 2;
  for (size_t k = 0; k + 1 < breaks.size(); ++k) {
    const double width = breaks[k + 1] - breaks[k];
    double bend = 0.0;
    for (int s = 0; s < samples; ++s) {
      const double t = breaks[k] + width * (s + 0.5) / samples;
      for (double other : others) {
        const auto d =
            along_u ? surface.derivatives(t, other, 2) : surface.derivatives(other, t, 2);
        bend = std::max(bend, (along_u ? d.suu : d.svv).norm());
      }
    }
    const double wanted = std::ceil(width * std::sqrt(bend / (8.0 * chord)));
    const double bounded = std::min(wanted, static_cast<double>(options.max_cells));
    if (bounded > cells[k]) cells[k] = static_cast<int>(bounded);
  }
}

std::vector<int>& cells_along(std::vector<CellCounts>& counts, const SideRef& side) {
  CellCounts& own = counts[static_cast<size_t>(side.patch)];
  return is_u_side(side.side) ? own.v : own.u;
}

// Gives facing spans the same (larger) number until nothing changes.
void equalise_joins(const PatchModel& model, std::vector<CellCounts>& counts) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (const Join& join : model.joins) {
      if (!join.matching) continue;
      std::vector<int>& a = cells_along(counts, join.a);
      std::vector<int>& b = cells_along(counts, join.b);
      if (a.size() != b.size()) continue;
      for (size_t k = 0; k < a.size(); ++k) {
        int& other = b[join.opposed ? b.size() - 1 - k : k];
        if (a[k] == other) continue;
        a[k] = other = std::max(a[k], other);
        changed = true;
      }
    }
  }
}

double triangle_count(const std::vector<CellCounts>& counts) {
  double sum = 0.0;
  for (const CellCounts& own : counts) {
    double u = 0.0, v = 0.0;
    for (int n : own.u) u += n;
    for (int n : own.v) v += n;
    sum += 2.0 * u * v;
  }
  return sum;
}

}  // namespace

std::vector<CellCounts> choose_cells(const PatchModel& model,
                                     const std::vector<const std::vector<Vec3>*>& shapes,
                                     const TessellationOptions& options) {
  std::vector<CellCounts> counts;
  const double size = diagonal(model);
  const double chord = options.chord * (size > 0.0 ? size : 1.0);
  for (size_t q = 0; q < model.patches.size(); ++q) {
    const Patch& patch = model.patches[q];
    const size_t nu = patch.u_knots.spans().size();
    const size_t nv = patch.v_knots.spans().size();
    CellCounts own;
    own.u.assign(nu, nu > kManySpans ? 1 : options.min_cells);
    own.v.assign(nv, nv > kManySpans ? 1 : options.min_cells);
    for (const std::vector<Vec3>* points : shapes) {
      const Surface surface = model.surface(static_cast<int>(q), *points);
      raise_to_bend(surface, true, chord, options, own.u);
      raise_to_bend(surface, false, chord, options, own.v);
    }
    counts.push_back(std::move(own));
  }
  equalise_joins(model, counts);
  const double total = triangle_count(counts);
  if (total > options.max_triangles) {
    const double factor = std::sqrt(options.max_triangles / total);
    const auto shrink = [factor](int& n) { n = std::max(1, static_cast<int>(n * factor)); };
    for (CellCounts& own : counts) {
      std::for_each(own.u.begin(), own.u.end(), shrink);
      std::for_each(own.v.begin(), own.v.end(), shrink);
    }
  }
  return counts;
}

}  // namespace isochor::internal
