#include "isochor/volume/closing.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <sstream>

#include "isochor/base/tolerance.h"

namespace isochor {
namespace {

constexpr size_t kListedEdges = 6;

std::string print(double value, int digits) {
  std::ostringstream text;
  text.precision(digits);
  text << value;
  return text.str();
}

double distance(const OpenEdge& edge, const ClosingPlane& plane) {
  double farthest = 0.0;
  for (const Vec3& p : edge.points) {
    farthest = std::max(farthest, std::abs(plane.normal.dot(p) - plane.offset));
  }
  return farthest;
}

// The number with fewest digits within the tolerance.
double shortened(double value, double tolerance) {
  if (std::abs(value) <= tolerance) return 0.0;
  constexpr int kMostDigits = 17;
  for (int digits = 1; digits < kMostDigits; ++digits) {
    const double shorter = std::stod(print(value, digits));
    if (std::abs(shorter - value) <= tolerance / 2) return shorter;
  }
  return value;
}

// The coordinate planes that hold an edge.
std::vector<ClosingPlane> coordinate_planes(const OpenEdge& edge, double tolerance) {
  std::vector<ClosingPlane> planes;
  for (int axis = 0; axis < 3; ++axis) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const Vec3& p : edge.points) {
      low = std::min(low, p[axis]);
      high = std::max(high, p[axis]);
    }
    if (!(high - low <= tolerance)) continue;
    planes.push_back({Vec3::Unit(axis), shortened(0.5 * (low + high), tolerance), false});
  }
  return planes;
}

// The plane through an edge that is no straight line.
std::optional<ClosingPlane> own_plane(const OpenEdge& edge, double tolerance) {
  if (edge.points.size() < 3) return std::nullopt;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : edge.points) middle += p / static_cast<double>(edge.points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vec3& p : edge.points) spread += (p - middle) * (p - middle).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  const double second =
      std::sqrt(solver.eigenvalues()[1] / static_cast<double>(edge.points.size()));
  if (!(second > tolerance)) return std::nullopt;
  Vec3 normal = solver.eigenvectors().col(0);
  int largest = 0;
  normal.cwiseAbs().maxCoeff(&largest);
  if (normal[largest] < 0.0) normal = -normal;
  for (int a = 0; a < 3; ++a) {  // rounding, where the plane is parallel to an axis
    if (std::abs(normal[a]) <= kSameLength) normal[a] = 0.0;
  }
  normal.normalize();
  const ClosingPlane plane{normal, normal.dot(middle), false};
  if (distance(edge, plane) > tolerance) return std::nullopt;
  return plane;
}

// The plane that holds most of the edges still open, among the candidates.
std::optional<OpenPlanes::Group> fullest(const std::vector<ClosingPlane>& candidates,
                                         const std::vector<OpenEdge>& edges,
                                         const std::vector<char>& open, double tolerance) {
  std::optional<OpenPlanes::Group> best;
  for (const ClosingPlane& plane : candidates) {
    int count = 0;
    for (size_t e = 0; e < edges.size(); ++e) {
      count += open[e] && distance(edges[e], plane) <= tolerance ? 1 : 0;
    }
    if (count > 0 && (!best || count > best->edges)) best = OpenPlanes::Group{plane, count};
  }
  return best;
}

std::string option_of(const ClosingPlane& plane) {
  for (int a = 0; a < 3; ++a) {
    if (plane.normal == Vec3::Unit(a)) {
      return "--close " + std::string(1, static_cast<char>('x' + a)) + "=" +
             print(plane.offset, 17);
    }
  }
  return "--close \"" + print(plane.normal.x(), 17) + "," + print(plane.normal.y(), 17) + "," +
         print(plane.normal.z(), 17) + "," + print(plane.offset, 17) + "\"";
}

}  // namespace

std::vector<OpenEdge> open_edges(const PatchModel& model, const Closure& closure) {
  std::vector<OpenEdge> edges;
  for (const SideRef& ref : closure.open) {
    OpenEdge edge;
    edge.label = label_of(model, ref);
    const Surface surface = model.surface(ref.patch);
    const bool u_side = is_u_side(ref.side);
    const KnotVector& along = u_side ? surface.v_knots() : surface.u_knots();
    const KnotVector& across = u_side ? surface.u_knots() : surface.v_knots();
    const double fixed = is_begin_side(ref.side) ? across.begin() : across.end();
    const auto add = [&](double t) {
      edge.points.push_back(u_side ? surface.point(fixed, t) : surface.point(t, fixed));
    };
    for (int span : along.spans()) {
      const int steps = along.degree() + 1;
      for (int k = 0; k < steps; ++k) {
        add(along[span] + (along[span + 1] - along[span]) * k / steps);
      }
    }
    add(along.end());
    edges.push_back(std::move(edge));
  }
  return edges;
}

ClosingCheck check_closing(const std::vector<OpenEdge>& edges,
                           const std::vector<ClosingPlane>& planes, double tolerance) {
  ClosingCheck check;
  std::vector<std::string> faults;
  for (const OpenEdge& edge : edges) {
    double nearest = std::numeric_limits<double>::infinity();
    const ClosingPlane* plane = nullptr;
    for (const ClosingPlane& candidate : planes) {
      const double off = distance(edge, candidate);
      if (off < nearest) {
        nearest = off;
        plane = &candidate;
      }
    }
    if (nearest <= tolerance) {
      check.farthest = std::max(check.farthest, nearest);
    } else if (plane != nullptr) {
      faults.push_back(edge.label + " leaves the plane " + text_of(*plane) + " by " +
                       print(nearest, 3));
    } else {
      faults.push_back(edge.label + " is open");
    }
  }
  check.closed = faults.empty();
  for (size_t k = 0; k < std::min(faults.size(), kListedEdges); ++k) {
    check.why_open += (k == 0 ? "" : "; ") + faults[k];
  }
  if (faults.size() > kListedEdges) {
    check.why_open += "; and " + std::to_string(faults.size() - kListedEdges) + " more";
  }
  return check;
}

OpenPlanes planes_of(const std::vector<OpenEdge>& edges, double tolerance) {
  std::vector<ClosingPlane> coordinate, own;
  const auto add = [](std::vector<ClosingPlane>& planes, const ClosingPlane& plane) {
    const bool known = std::any_of(planes.begin(), planes.end(),
                                   [&](const auto& other) { return same_plane(plane, other); });
    if (!known) planes.push_back(plane);
  };
  for (const OpenEdge& edge : edges) {
    const std::vector<ClosingPlane> found = coordinate_planes(edge, tolerance);
    for (const ClosingPlane& plane : found) add(coordinate, plane);
    if (const auto plane = own_plane(edge, tolerance); plane && found.empty()) add(own, *plane);
  }
  OpenPlanes result;
  std::vector<char> open(edges.size(), 1);
  for (const auto* candidates : {&coordinate, &own}) {
    while (const auto group = fullest(*candidates, edges, open, tolerance)) {
      result.groups.push_back(*group);
      for (size_t e = 0; e < edges.size(); ++e) {
        if (distance(edges[e], group->plane) <= tolerance) open[e] = 0;
      }
    }
  }
  for (size_t e = 0; e < edges.size(); ++e) {
    if (open[e]) result.left_over.push_back(edges[e].label);
  }
  return result;
}

std::string opening_text(const std::vector<OpenEdge>& edges, double tolerance) {
  if (edges.empty()) return "";
  const OpenPlanes found = planes_of(edges, tolerance);
  std::string text =
      "open along " + std::to_string(edges.size()) + (edges.size() == 1 ? " edge" : " edges");
  std::string options;
  // More planes than a body has flat ends say nothing.
  constexpr size_t kMostPlanes = 4;
  if (found.groups.empty() || found.groups.size() > kMostPlanes) {
    return text + ", which lie in no plane or in many: no plane closes it";
  }
  std::vector<ClosingPlane> planes;
  for (const auto& group : found.groups) {
    planes.push_back(group.plane);
    options += (options.empty() ? "" : " ") + option_of(group.plane);
  }
  if (found.groups.size() == 1 && found.left_over.empty()) {
    text += (edges.size() == 1 ? " in the plane " : ", all in the plane ") + text_of(planes[0]);
  } else {
    for (size_t k = 0; k < found.groups.size(); ++k) {
      text += (k == 0 ? ": " : ", ") + std::to_string(found.groups[k].edges) + " in the plane " +
              text_of(planes[k]);
    }
  }
  if (!found.left_over.empty()) {
    return text + ", " + std::to_string(found.left_over.size()) + " in no plane (" +
           found.left_over.front() + "): no plane closes those";
  }
  if (!field_without_flux(planes)) return text + ": too many directions to be closed by planes";
  return text + ": " + options + (planes.size() == 1 ? " closes it" : " close it");
}

}  // namespace isochor
