#include "isochor/step/face_fold.h"

#include <GeomAdaptor_Surface.hxx>
#include <algorithm>
#include <cmath>
#include <deque>
#include <map>

#include "isochor/base/tolerance.h"

namespace isochor::internal {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kTurnSlack = 1e-6;  // of a full turn, by which parameters may pass it
constexpr long kFirstTry = 400;
constexpr size_t kStarts = 32;

// Directions within `half` of `axis`; half >= pi / 2: any.
struct Cone {
  Vec3 axis = Vec3::Zero();
  double half = kPi;
};
struct Cones {
  Cone u, v;
};

double angle(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

Vec3 unit(const Vec3& v) {
  const double size = v.norm();
  return size > 0.0 ? Vec3(v / size) : Vec3(Vec3::Zero());
}

// With X = w (P - c) for a point c, S_u w / p = sum B (dX_i - (S - c) dw_i) over the differences of
// neighbours: each term lies in a ball about dX_i with the radius |S - c| |dw_i|.
Cone cone_along_u(const BezierCell& cell, double noise) {
  Vec3 centre = Vec3::Zero();
  for (const Vec4& p : cell.at) centre += p.head<3>() / p.w() / static_cast<double>(cell.at.size());
  double reach = 0.0, heaviest = 0.0;
  for (const Vec4& p : cell.at) {
    reach = std::max(reach, (p.head<3>() / p.w() - centre).norm());
    heaviest = std::max(heaviest, p.w());
  }
  std::vector<std::pair<Vec3, double>> balls;
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < cell.u_degree; ++i) {
    for (int j = 0; j <= cell.v_degree; ++j) {
      const Vec4 d = cell(i + 1, j) - cell(i, j);
      balls.emplace_back(d.head<3>() - centre * d.w(),
                         reach * std::abs(d.w()) + 2.0 * noise * heaviest);
      sum += balls.back().first;
    }
  }
  Cone cone{unit(sum), 0.0};
  for (const auto& [d, radius] : balls) {
    const double size = d.norm();
    if (!(radius < size)) return {};
    cone.half = std::max(cone.half, angle(cone.axis, d) + std::asin(radius / size));
  }
  return cone.axis == Vec3::Zero() ? Cone{} : cone;
}

Cone merged(const std::vector<Cone>& cones) {
  Vec3 sum = Vec3::Zero();
  for (const Cone& cone : cones) sum += cone.axis;
  Cone all{unit(sum), 0.0};
  if (all.axis == Vec3::Zero()) return {};
  for (const Cone& cone : cones) {
    all.half = std::max(all.half, angle(all.axis, cone.axis) + cone.half);
  }
  return all;
}

UvBox around(const UvBox& a, const UvBox& b) {
  return {std::min(a.u_min, b.u_min), std::max(a.u_max, b.u_max), std::min(a.v_min, b.v_min),
          std::max(a.v_max, b.v_max)};
}

bool overlap(const UvBox& a, const UvBox& b) {
  return a.u_min < b.u_max && b.u_min < a.u_max && a.v_min < b.v_max && b.v_min < a.v_max;
}

bool touch(const UvBox& a, const UvBox& b) {
  return a.u_min <= b.u_max && b.u_min <= a.u_max && a.v_min <= b.v_max && b.v_min <= a.v_max;
}

// Surfaces that take no point twice but at seams and poles, by their formulas.
bool injective_by_kind(const FaceCells& face) {
  const GeomAdaptor_Surface surface(face.surface());
  const UvBox& box = face.bounds();
  const double turn = 2.0 * kPi * (1.0 + kTurnSlack);
  if (surface.GetType() == GeomAbs_Plane) return true;
  if (box.u_max - box.u_min > turn) return false;
  switch (surface.GetType()) {
    case GeomAbs_Cylinder:
      return true;
    case GeomAbs_Cone: {
      const double slope = std::sin(surface.Cone().SemiAngle()), r = surface.Cone().RefRadius();
      return (r + box.v_min * slope) * (r + box.v_max * slope) >= 0.0;
    }
    case GeomAbs_Sphere:
      return box.v_max - box.v_min <= kPi * (1.0 + kTurnSlack);
    case GeomAbs_Torus:
      return box.v_max - box.v_min <= turn &&
             surface.Torus().MajorRadius() > surface.Torus().MinorRadius();
    default:
      return false;
  }
}

class Search {
 public:
  Search(FaceCells& face, const Shared& shared, double strip, double limit, double diagonal)
      : face_(face), shared_(shared), strip_(strip), limit_(limit), diagonal_(diagonal) {}

  FoldSearch run(long most) {
    FoldSearch result;
    open_.emplace_back(0, 0);
    while (!open_.empty() && result.tests < most) {
      const auto [a, b] = open_.front();
      open_.pop_front();
      ++result.tests;
      a == b ? compare_with_itself(a) : compare(a, b);
      if (result.tests == kFirstTry && try_points(result)) return result;
    }
    if (open_.empty() && stuck_.empty()) {
      result.answer = FoldAnswer::kFree;
    } else {
      try_points(result);
    }
    return result;
  }

 private:
  void compare_with_itself(int k) {
    const Cell& cell = face_.cell(k);
    if (cell.outside || near_shared(cell, cell, shared_, strip_)) return;
    if (injective(cell.uv)) return;
    const int child = cell.size() < limit_ ? -1 : face_.divide(k);
    if (child < 0) {
      stuck_.emplace_back(k, k);
      return;
    }
    open_.emplace_back(child, child);
    open_.emplace_back(child + 1, child + 1);
    open_.emplace_back(child, child + 1);
  }

  void compare(int ka, int kb) {
    const Cell& a = face_.cell(ka);
    const Cell& b = face_.cell(kb);
    if (a.outside || b.outside || !boxes_meet(a, b)) return;
    if (near_shared(a, b, shared_, strip_)) return;
    if (touch(a.uv, b.uv) && injective(around(a.uv, b.uv))) return;
    if (a.children < 0 && parted(a, b, normal_of(face_, a))) return;
    if (b.children < 0 && parted(a, b, normal_of(face_, b))) return;
    const bool divide_a = a.size() >= b.size();
    const double larger = std::max(a.size(), b.size());
    const int child = larger < limit_ ? -1 : face_.divide(divide_a ? ka : kb);
    if (child < 0) {
      stuck_.emplace_back(ka, kb);
      return;
    }
    for (int side = 0; side < 2; ++side) {
      open_.emplace_back(divide_a ? child + side : ka, divide_a ? kb : child + side);
    }
  }

  // Law (1) over a rectangle, from the cones of the cells that cover it.
  bool injective(const UvBox& box) {
    std::vector<Cone> u, v;
    if (!collect(0, box, u, v)) return false;
    const Cone cu = merged(u), cv = merged(v);
    if (!(cu.half < 0.5 * kPi && cv.half < 0.5 * kPi)) return false;
    const double between = angle(cu.axis, cv.axis);
    return std::min(between, kPi - between) > cu.half + cv.half + kSingular;
  }

  // False when a cone is no cone.
  bool collect(int k, const UvBox& box, std::vector<Cone>& u, std::vector<Cone>& v) {
    const Cell& cell = face_.cell(k);
    if (!overlap(cell.uv, box)) return true;
    if (cell.children >= 0) {
      return collect(cell.children, box, u, v) && collect(cell.children + 1, box, u, v);
    }
    const auto [it, added] = cones_.try_emplace(k);
    if (added) {
      it->second = {cone_along_u(cell.bezier, cell.radius),
                    cone_along_u(cell.bezier.transposed(), cell.radius)};
    }
    const Cones& cones = it->second;
    if (!(cones.u.half < 0.5 * kPi && cones.v.half < 0.5 * kPi)) return false;
    u.push_back(cones.u);
    v.push_back(cones.v);
    return true;
  }

  bool try_points(FoldSearch& result) {
    std::vector<std::pair<int, int>> cells(stuck_.begin(), stuck_.end());
    cells.insert(cells.end(), open_.begin(), open_.end());
    cells.erase(std::remove_if(cells.begin(), cells.end(),
                               [](const auto& pair) { return pair.first == pair.second; }),
                cells.end());
    const size_t starts = std::min(kStarts, cells.size());
    for (size_t k = 0; k < starts; ++k) {
      const auto& [a, b] = cells[(2 * k + 1) * cells.size() / (2 * starts)];
      const auto point = crossing_near(face_, middle_of(face_.cell(a)), face_,
                                       middle_of(face_.cell(b)), limit_, diagonal_);
      if (!point || distance_to(shared_, point->at) <= 2.0 * limit_) continue;
      result.found = point;
      result.answer = FoldAnswer::kCrossing;
      return true;
    }
    return false;
  }

  FaceCells& face_;
  const Shared& shared_;
  double strip_, limit_, diagonal_;
  std::deque<std::pair<int, int>> open_;
  std::vector<std::pair<int, int>> stuck_;
  std::map<int, Cones> cones_;
};

}  // namespace

FoldSearch search_fold(FaceCells& face, const Shared& shared, double strip, double limit,
                       double diagonal, long most) {
  if (!face.known() || !face.proven()) return {};
  const Cell* leaf = &face.root();
  while (leaf->children >= 0) leaf = &face.cell(leaf->children);
  if (leaf->bezier.at.empty()) {
    FoldSearch result;
    if (injective_by_kind(face)) result.answer = FoldAnswer::kFree;
    return result;
  }
  return Search(face, shared, strip, limit, diagonal).run(most);
}

}  // namespace isochor::internal
