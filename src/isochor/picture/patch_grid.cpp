#include "isochor/picture/patch_grid.h"

#include <cstdint>
#include <unordered_map>

#include "isochor/base/error.h"

namespace isochor::internal {
namespace {

// Cuts one patch. Corners live on an integer lattice of 2^levels steps between grid lines.
class GridCutter {
 public:
  GridCutter(const std::vector<GridLine>& u_lines, const std::vector<GridLine>& v_lines,
             const TrimTest& trim, int levels)
      : u_lines_(u_lines), v_lines_(v_lines), trim_(trim), levels_(levels), step_(1LL << levels) {}

  PatchGrid run() {
    for (size_t i = 0; i + 1 < u_lines_.size(); ++i) {
      if (u_lines_[i].at == u_lines_[i + 1].at) continue;
      for (size_t j = 0; j + 1 < v_lines_.size(); ++j) {
        if (v_lines_[j].at == v_lines_[j + 1].at) continue;
        divide({static_cast<std::int64_t>(i) * step_, static_cast<std::int64_t>(j) * step_, step_});
      }
    }
    // Whole cells come last: by then all vertices that smaller neighbours put on their sides exist.
    for (const Cell& cell : whole_) add_whole(cell);
    return std::move(grid_);
  }

 private:
  struct Cell {
    std::int64_t u, v, size;
  };
  using Key = std::uint64_t;
  // kind: 0 a lattice corner, 1 (2) the cut on the finest edge that leaves it along u (v),
  // 3 the middle of a whole cell.
  static Key key(std::int64_t u, std::int64_t v, int kind) {
    return (static_cast<Key>(u) << 33) | (static_cast<Key>(v) << 2) | static_cast<Key>(kind);
  }

  static GridLine line_at(const std::vector<GridLine>& lines, std::int64_t position,
                          std::int64_t step) {
    const auto i = static_cast<size_t>(position / step);
    const std::int64_t rest = position % step;
    if (rest == 0) return lines[i];
    const double fraction = static_cast<double>(rest) / static_cast<double>(step);
    return {lines[i].at + fraction * (lines[i + 1].at - lines[i].at), Limit::kFromAbove};
  }
  GridVertex corner(std::int64_t u, std::int64_t v) const {
    return {line_at(u_lines_, u, step_), line_at(v_lines_, v, step_)};
  }

  int add(Key name, const GridVertex& vertex) {
    const auto [found, fresh] = known_.try_emplace(name, static_cast<int>(grid_.vertices.size()));
    if (fresh) grid_.vertices.push_back(vertex);
    return found->second;
  }
  int add_corner(std::int64_t u, std::int64_t v) { return add(key(u, v, 0), corner(u, v)); }

  void divide(const Cell& cell) {
    const GridVertex low = corner(cell.u, cell.v);
    const double u1 = line_at(u_lines_, cell.u + cell.size, step_).at;
    const double v1 = line_at(v_lines_, cell.v + cell.size, step_).at;
    if (!trim_.crosses({low.u.at, u1, low.v.at, v1})) {
      if (trim_.inside(0.5 * (low.u.at + u1), 0.5 * (low.v.at + v1))) keep(cell);
      return;
    }
    if (cell.size == 1) return cut(cell);
    const std::int64_t half = cell.size / 2;
    for (int k = 0; k < 4; ++k) divide({cell.u + (k & 1) * half, cell.v + (k >> 1) * half, half});
  }

  void keep(const Cell& cell) {
    whole_.push_back(cell);
    add_corner(cell.u, cell.v);
    add_corner(cell.u + cell.size, cell.v);
    add_corner(cell.u + cell.size, cell.v + cell.size);
    add_corner(cell.u, cell.v + cell.size);
  }

  // The place between an inside and an outside corner where the loop passes, by bisection.
  GridVertex boundary_between(GridVertex in, GridVertex out) const {
    const GridVertex start = in;
    for (int k = 0; k < 40; ++k) {
      const GridVertex middle = {{0.5 * (in.u.at + out.u.at), start.u.limit},
                                 {0.5 * (in.v.at + out.v.at), start.v.limit}};
      (trim_.inside(middle.u.at, middle.v.at) ? in : out) = middle;
    }
    return in;
  }

  // A finest cell that a loop crosses: the polygon of its inside corners and the cuts between.
  void cut(const Cell& c) {
    const std::int64_t us[4] = {c.u, c.u + 1, c.u + 1, c.u};
    const std::int64_t vs[4] = {c.v, c.v, c.v + 1, c.v + 1};
    GridVertex at[4];
    bool in[4];
    for (int k = 0; k < 4; ++k) {
      at[k] = corner(us[k], vs[k]);
      in[k] = trim_.inside(at[k].u.at, at[k].v.at);
    }
    std::vector<int> polygon;
    for (int k = 0; k < 4; ++k) {
      const int next = (k + 1) % 4;
      if (in[k]) polygon.push_back(add_corner(us[k], vs[k]));
      if (in[k] == in[next]) continue;
      const bool along_u = vs[k] == vs[next];
      const Key name = key(std::min(us[k], us[next]), std::min(vs[k], vs[next]), along_u ? 1 : 2);
      polygon.push_back(
          add(name, in[k] ? boundary_between(at[k], at[next]) : boundary_between(at[next], at[k])));
    }
    // Two opposite corners inside, the middle outside: two separate triangles.
    const double middle_u = 0.5 * (at[0].u.at + at[2].u.at);
    const double middle_v = 0.5 * (at[0].v.at + at[2].v.at);
    if (polygon.size() == 6 && !trim_.inside(middle_u, middle_v)) {
      if (in[0]) {
        fan({polygon[5], polygon[0], polygon[1]});
        fan({polygon[2], polygon[3], polygon[4]});
      } else {
        fan({polygon[0], polygon[1], polygon[2]});
        fan({polygon[3], polygon[4], polygon[5]});
      }
      return;
    }
    fan(polygon);
  }

  void fan(const std::vector<int>& polygon) {
    for (size_t k = 2; k < polygon.size(); ++k) {
      grid_.triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
    }
  }

  // The vertices on the way from one corner of a whole cell to the next, the last one left out.
  void walk(std::vector<int>& ring, std::int64_t u, std::int64_t v, int du, int dv,
            std::int64_t length) {
    for (std::int64_t k = 0; k < length; ++k) {
      const auto found = known_.find(key(u + k * du, v + k * dv, 0));
      if (found != known_.end()) ring.push_back(found->second);
    }
  }

  void add_whole(const Cell& c) {
    std::vector<int> ring;
    walk(ring, c.u, c.v, 1, 0, c.size);
    walk(ring, c.u + c.size, c.v, 0, 1, c.size);
    walk(ring, c.u + c.size, c.v + c.size, -1, 0, c.size);
    walk(ring, c.u, c.v + c.size, 0, -1, c.size);
    if (ring.size() == 4) return fan(ring);
    GridVertex middle = corner(c.u, c.v);
    middle.u.at = 0.5 * (middle.u.at + line_at(u_lines_, c.u + c.size, step_).at);
    middle.v.at = 0.5 * (middle.v.at + line_at(v_lines_, c.v + c.size, step_).at);
    const int centre = add(key(c.u, c.v, 3), middle);
    for (size_t k = 0; k < ring.size(); ++k) {
      grid_.triangles.push_back({centre, ring[k], ring[(k + 1) % ring.size()]});
    }
  }

  const std::vector<GridLine>& u_lines_;
  const std::vector<GridLine>& v_lines_;
  const TrimTest& trim_;
  const int levels_;
  const std::int64_t step_;
  PatchGrid grid_;
  std::vector<Cell> whole_;
  std::unordered_map<Key, int> known_;
};

}  // namespace

std::vector<GridLine> grid_lines(const KnotVector& knots, const std::vector<int>& cells) {
  const std::vector<double> breaks = knots.breaks();
  ISOCHOR_REQUIRE(cells.size() + 1 == breaks.size(), cells.size(), breaks.size());
  std::vector<GridLine> lines = {{breaks.front(), Limit::kFromAbove}};
  for (size_t k = 0; k < cells.size(); ++k) {
    for (int c = 1; c < cells[k]; ++c) {
      const double fraction = static_cast<double>(c) / cells[k];
      lines.push_back({breaks[k] + fraction * (breaks[k + 1] - breaks[k]), Limit::kFromAbove});
    }
    lines.push_back({breaks[k + 1], Limit::kFromBelow});
    const bool interior = k + 1 < cells.size();
    if (interior && knots.multiplicity(breaks[k + 1]) >= knots.degree()) {
      lines.push_back({breaks[k + 1], Limit::kFromAbove});
    }
  }
  return lines;
}

PatchGrid make_patch_grid(const std::vector<GridLine>& u_lines,
                          const std::vector<GridLine>& v_lines, const TrimTest& trim, int levels) {
  ISOCHOR_REQUIRE(0 <= levels && levels <= 8, levels);
  return GridCutter(u_lines, v_lines, trim, trim.keeps_all() ? 0 : levels).run();
}

}  // namespace isochor::internal
