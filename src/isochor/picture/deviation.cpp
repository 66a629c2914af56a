#include "isochor/picture/deviation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "isochor/base/error.h"

namespace isochor {
namespace {

constexpr int kLeafSize = 6;
// Two nearest points count as equally near within this part of the squared distance.
constexpr double kTie = 1e-9;

Vec3 nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double length2 = along.squaredNorm();
  const double s = length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return a + s * along;
}

Vec3 nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double n2 = normal.squaredNorm();
  if (n2 > 0.0) {
    const Vec3 foot = p - normal * ((p - a).dot(normal) / n2);
    if (normal.dot((b - a).cross(foot - a)) >= 0.0 && normal.dot((c - b).cross(foot - b)) >= 0.0 &&
        normal.dot((a - c).cross(foot - c)) >= 0.0) {
      return foot;
    }
  }
  Vec3 best = nearest_on_segment(p, a, b);
  for (const Vec3& other : {nearest_on_segment(p, b, c), nearest_on_segment(p, c, a)}) {
    if ((other - p).squaredNorm() < (best - p).squaredNorm()) best = other;
  }
  return best;
}

double distance2_to_box(const Vec3& p, const Box& box) {
  return (box.low - p).cwiseMax(p - box.high).cwiseMax(0.0).squaredNorm();
}

// The triangles of a mesh in a tree of boxes.
class NearestTriangle {
 public:
  explicit NearestTriangle(const Mesh& mesh) : mesh_(mesh), order_(mesh.triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    build(0, static_cast<int>(order_.size()));
  }

  double signed_distance(const Vec3& p) const {
    Best best;
    search(0, p, best);
    return best.side < 0.0 ? -std::sqrt(best.distance2) : std::sqrt(best.distance2);
  }

 private:
  struct Node {
    Box box;
    int first = 0, count = 0;  // triangles, when a leaf
    int right = 0;             // the left child follows its parent
  };
  struct Best {
    double distance2 = 1e308;
    double side = 0.0;  // cosine between the way to the point and the outward normal
  };

  const Vec3& corner(int triangle, size_t k) const {
    return mesh_.positions[static_cast<size_t>(mesh_.triangles[static_cast<size_t>(triangle)][k])];
  }
  Vec3 centroid(int t) const { return (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3.0; }

  int build(int first, int last) {
    const auto own = static_cast<int>(nodes_.size());
    nodes_.emplace_back();
    Box box, centres;
    for (int k = first; k < last; ++k) {
      const int t = order_[static_cast<size_t>(k)];
      for (size_t c = 0; c < 3; ++c) box.add(corner(t, c));
      centres.add(centroid(t));
    }
    nodes_[static_cast<size_t>(own)].box = box;
    if (last - first <= kLeafSize) {
      nodes_[static_cast<size_t>(own)].first = first;
      nodes_[static_cast<size_t>(own)].count = last - first;
      return own;
    }
    int axis = 0;
    (centres.high - centres.low).maxCoeff(&axis);
    const int middle = first + (last - first) / 2;
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                     [&](int a, int b) {
                       const double ca = centroid(a)[axis], cb = centroid(b)[axis];
                       return ca != cb ? ca < cb : a < b;
                     });
    build(first, middle);
    const int right = build(middle, last);
    nodes_[static_cast<size_t>(own)].right = right;
    return own;
  }

  void search(int index, const Vec3& p, Best& best) const {
    const Node& node = nodes_[static_cast<size_t>(index)];
    if (distance2_to_box(p, node.box) > best.distance2 * (1.0 + kTie)) return;
    if (node.count > 0) {
      for (int k = node.first; k < node.first + node.count; ++k) {
        try_triangle(order_[static_cast<size_t>(k)], p, best);
      }
      return;
    }
    const int left = index + 1;
    const bool left_first = distance2_to_box(p, nodes_[static_cast<size_t>(left)].box) <=
                            distance2_to_box(p, nodes_[static_cast<size_t>(node.right)].box);
    search(left_first ? left : node.right, p, best);
    search(left_first ? node.right : left, p, best);
  }

  // At an edge or a corner several triangles are equally near; the one that faces the point most
  // squarely knows on which side it lies.
  void try_triangle(int t, const Vec3& p, Best& best) const {
    const Vec3& a = corner(t, 0);
    const Vec3 way = p - nearest_on_triangle(p, a, corner(t, 1), corner(t, 2));
    const double distance2 = way.squaredNorm();
    if (distance2 > best.distance2 * (1.0 + kTie)) return;
    const Vec3 normal = (corner(t, 1) - a).cross(corner(t, 2) - a);
    const double scale = normal.norm() * std::sqrt(distance2);
    const double side = scale > 0.0 ? normal.dot(way) / scale : 0.0;
    const bool nearer = distance2 < best.distance2 * (1.0 - kTie);
    if (nearer || std::abs(side) > std::abs(best.side)) best.side = side;
    best.distance2 = std::min(best.distance2, distance2);
  }

  const Mesh& mesh_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

}  // namespace

std::vector<double> signed_deviation(const Mesh& mesh, const Mesh& reference) {
  require_usable(mesh);
  require_usable(reference);
  ISOCHOR_REQUIRE(!reference.empty());
  const NearestTriangle nearest(reference);
  std::vector<double> distances;
  distances.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions) distances.push_back(nearest.signed_distance(p));
  return distances;
}

}  // namespace isochor
