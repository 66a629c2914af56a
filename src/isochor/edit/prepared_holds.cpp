// The holds of a PreparedEdit: what a user or a closing plane keeps in place.
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/bspline/continuity.h"
#include "isochor/edit/mirrored_model.h"
#include "isochor/edit/names.h"
#include "isochor/edit/prepared_edit.h"

namespace isochor {
namespace {

// A row as its values and coefficients, to find equal ones.
using CoefficientSet = std::vector<std::pair<int, double>>;

// The form n . (row), exactly for the doubles of n.
CoefficientRow along(CoefficientRow row, const Vec3& normal) {
  for (size_t k = 0; k < row.coefficient.size(); ++k) {
    for (int a = 0; a < 3; ++a) {
      Rational& value = row.exact[k][static_cast<size_t>(a)];
      value *= Rational(normal[a]);
      row.value[k][a] = value.to_double();
    }
  }
  return row;
}

}  // namespace

void PreparedEdit::resolve_holds() {
  for (size_t k = 0; k < edit_.holds.size(); ++k) {
    const Hold& hold = edit_.holds[k];
    const std::string name = "hold[" + std::to_string(k) + "]";
    switch (hold.kind) {
      case Hold::Kind::kPlace:
        holds_.push_back(resolve(hold.place, name));
        hold_names_.push_back(name);
        break;
      case Hold::Kind::kNormal:
        hold_normal(hold.place, name + ".normal");
        break;
      case Hold::Kind::kEdge:
        lock_edge(hold, name + ".edge");
        break;
      case Hold::Kind::kPlane:
        hold_plane(hold, name + ".plane");
        break;
      case Hold::Kind::kSymmetry:
        break;  // the space has it
    }
  }
}

void PreparedEdit::lock_edge(const Hold& hold, const std::string& name) {
  const int a = find_patch(rest_, hold.edge[0]);
  const int b = find_patch(rest_, hold.edge[1]);
  std::vector<int> points;
  for (const Join& join : rest_.joins) {
    const bool same =
        (join.a.patch == a && join.b.patch == b) || (join.a.patch == b && join.b.patch == a);
    if (!same) continue;
    for (const SideRef& side : {join.a, join.b}) {
      const Patch& patch = rest_.patches[static_cast<size_t>(side.patch)];
      const KnotVector& across = is_u_side(side.side) ? patch.u_knots : patch.v_knots;
      const int rows = boundary_rows(across, is_begin_side(side.side), 0);
      for (int depth = 0; depth < rows; ++depth) {
        for (const auto& [i, j] : side_indices(patch, side.side, depth)) {
          points.push_back(patch.point(i, j));
        }
      }
    }
  }
  if (points.empty()) {
    throw InputError("", name,
                     "\"" + hold.edge[0] + "\" and \"" + hold.edge[1] +
                         "\" share no edge along which both can move");
  }
  space_.lock_points(points, name + internal::kKeepsTheEdge);
}

// The normal n stays when the tangents' displacements have no part along it: n . delta_u = 0 and
// n . delta_v = 0, since n . S_u = n . S_v = 0 already. Linear, and exact for any displacement.
void PreparedEdit::hold_normal(const Place& place, const std::string& name) {
  const ResolvedPlace at = resolve(place, name);
  const Vec3 normal = rest_.surface(at.patch).normal(at.uv.u, at.uv.v);
  if (normal == Vec3::Zero()) {
    throw InputError("", name, at.text + " has no normal: the surface is singular there");
  }
  for (SurfaceForm form : {SurfaceForm::kAlongU, SurfaceForm::kAlongV}) {
    normals_.push_back({name, along(space_.surface_row(rest_, at.patch, at.uv, form), normal),
                        Vec3::Zero(), 7, true});
  }
}

void PreparedEdit::hold_plane(const Hold& hold, const std::string& name) {
  const Vec3 normal = hold.plane_normal.normalized();
  std::set<CoefficientSet> seen;  // tied points have one row
  bool any = false;
  for (size_t i = 0; i < rest_.points.size(); ++i) {
    const double off = normal.dot(rest_.points[i] - hold.plane_point);
    if (!(std::abs(off) <= kCoincident * size_)) continue;
    CoefficientRow row = space_.point_row(static_cast<int>(i));
    if (row.coefficient.empty()) continue;  // a point that no patch uses
    any = true;
    CoefficientSet key;
    for (size_t k = 0; k < row.coefficient.size(); ++k) {
      key.emplace_back(row.coefficient[k], row.value[k].x());
    }
    if (!seen.insert(std::move(key)).second) continue;
    kept_.push_back({name, along(std::move(row), normal), Vec3::Zero(), 7, true});
  }
  if (!any) throw InputError("", name, "no control point of the model lies in this plane");
}

// Points of free sides in the plane stay in it: the closed volume keeps its meaning. Along a
// coordinate axis that is one equation of that axis, which the method "axis" can take too.
void PreparedEdit::hold_closing_plane(const ClosingPlane& plane) {
  const std::string name = "close " + text_of(plane);
  int axis = -1;
  for (int a = 0; a < 3; ++a) axis = plane.normal == Vec3::Unit(a) ? a : axis;
  std::set<CoefficientSet> seen;
  for (const SideRef& ref : free_sides(rest_)) {
    const Patch& patch = rest_.patches[static_cast<size_t>(ref.patch)];
    const KnotVector& across = is_u_side(ref.side) ? patch.u_knots : patch.v_knots;
    std::vector<std::pair<int, int>> indices;
    bool in_plane = true;
    for (int depth = 0; depth < boundary_rows(across, is_begin_side(ref.side), 0); ++depth) {
      for (const auto& at : side_indices(patch, ref.side, depth)) {
        const auto id = static_cast<size_t>(patch.point(at.first, at.second));
        const double off = plane.normal.dot(rest_.points[id]) - plane.offset;
        if (depth == 0) in_plane = in_plane && std::abs(off) <= kCoincident * size_;
        indices.push_back(at);
      }
    }
    if (!in_plane) continue;
    for (const auto& [i, j] : indices) {
      CoefficientRow row = space_.point_row(patch.point(i, j));
      CoefficientSet key;
      for (size_t k = 0; k < row.coefficient.size(); ++k) {
        key.emplace_back(row.coefficient[k], row.value[k][std::max(axis, 0)]);
      }
      if (!seen.insert(std::move(key)).second) continue;
      if (axis >= 0) {
        kept_.push_back({name, std::move(row), Vec3::Zero(), 1u << axis, false});
      } else {
        kept_.push_back({name, along(std::move(row), plane.normal), Vec3::Zero(), 7, true});
      }
    }
  }
}

}  // namespace isochor
