#include "isochor/step/self_intersections.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <numeric>
#include <set>

#include "isochor/base/tolerance.h"
#include "isochor/step/cell_pairs.h"
#include "isochor/step/child_progress.h"
#include "isochor/step/crossing_point.h"
#include "isochor/step/face_fold.h"

namespace isochor::internal {
namespace {

constexpr long kMostTests = 20000;
constexpr long kMostTestsInAll = 10000000;
constexpr size_t kMostBytesInAll = size_t{256} << 20;  // of cells kept from one pair to the next
constexpr long kFirstTry = 400;   // tests before common points are looked for, a few
constexpr size_t kFewStarts = 6;  // of iterations then, and at the end
constexpr size_t kManyStarts = 32;
constexpr double kDepthTolerances = 4.0;
constexpr int kPolylineSteps = 96;
constexpr size_t kListedPairs = 20;

enum class Answer { kApart, kCrossing, kUndecided };

// Two faces at work.
class PairSearch {
 public:
  PairSearch(FaceCells& a, FaceCells& b, const Shared& shared, double limit, double diagonal)
      : a_(a), b_(b), shared_(shared), limit_(limit), diagonal_(diagonal) {
    strip_ = shared.empty() ? 0.0 : kSharedStrip * std::min(a.root().size(), b.root().size());
  }

  Answer run(long most) {
    open_.emplace_back(0, 0);
    while (!open_.empty() && tests_ < most) {
      const auto [a, b] = open_.front();
      open_.pop_front();
      ++tests_;
      compare(a, b);
      if (tests_ == kFirstTry && try_points(kFewStarts)) return Answer::kCrossing;
    }
    if (open_.empty() && stuck_.empty()) return Answer::kApart;
    return try_points(kManyStarts) ? Answer::kCrossing : Answer::kUndecided;
  }
  long tests() const { return tests_; }
  const CrossingPoint& found() const { return *found_; }

 private:
  void compare(int ka, int kb) {
    const Cell& a = a_.cell(ka);
    const Cell& b = b_.cell(kb);
    if (a.outside || b.outside || !boxes_meet(a, b)) return;
    if (near_shared(a, b, shared_, strip_)) return;
    if (a.children < 0 && parted(a, b, normal_of(a_, a))) return;
    if (b.children < 0 && parted(a, b, normal_of(b_, b))) return;
    const double size_a = a.size(), size_b = b.size();
    const bool divide_a = size_a >= size_b;
    const double least = limit_ + strip_ / 8.0;
    const int child = std::max(size_a, size_b) < least ? -1
                      : divide_a                       ? a_.divide(ka)
                                                       : b_.divide(kb);
    if (child < 0) {
      stuck_.emplace_back(ka, kb);
      return;
    }
    for (int side = 0; side < 2; ++side) {
      open_.emplace_back(divide_a ? child + side : ka, divide_a ? kb : child + side);
    }
  }

  bool try_points(size_t starts) {
    std::vector<std::pair<int, int>> cells(stuck_.begin(), stuck_.end());
    cells.insert(cells.end(), open_.begin(), open_.end());
    for (size_t k = 0; k < std::min(starts, cells.size()); ++k) {
      const auto& [a, b] = cells[(2 * k + 1) * cells.size() / (2 * std::min(starts, cells.size()))];
      const auto point =
          crossing_near(a_, middle_of(a_.cell(a)), b_, middle_of(b_.cell(b)), limit_, diagonal_);
      if (!point || distance_to(shared_, point->at) <= 2.0 * limit_) continue;
      found_ = point;
      return true;
    }
    return false;
  }

  FaceCells& a_;
  FaceCells& b_;
  const Shared& shared_;
  double limit_, diagonal_, strip_;
  long tests_ = 0;
  std::deque<std::pair<int, int>> open_;
  std::vector<std::pair<int, int>> stuck_;
  std::optional<CrossingPoint> found_;
};

class ShapeSearch {
 public:
  ShapeSearch(const BrepTable& table, const std::vector<EdgeFacts>& edges) : table_(table) {
    for (const FaceRecord& face : table.faces) cells_.emplace_back(face, table.diagonal);
    collect_shared();
    collect_bodies();
    limits_.assign(table.faces.size(), 0.0);
    for (size_t f = 0; f < table.faces.size(); ++f) {
      limits_[f] = BRep_Tool::Tolerance(table.faces[f].face);
    }
    for (const EdgeFacts& edge : edges) {
      for (int f : edge.faces) {
        double& limit = limits_[static_cast<size_t>(f)];
        limit = std::max({limit, edge.tolerance, edge.max_gap});
      }
    }
  }

  CrossingsAccount run() {
    const long count = static_cast<long>(table_.faces.size());
    account_.pairs = count * (count - 1) / 2;
    const std::vector<std::pair<int, int>> candidates = meeting_boxes();
    account_.apart = account_.pairs - static_cast<long>(candidates.size());
    long done = 0;
    for (const auto& [a, b] : candidates) {
      tell_progress(static_cast<double>(done++) / static_cast<double>(candidates.size()),
                    "looking for self-intersections");
      compare(a, b);
      size_t bytes = 0;
      for (const FaceCells& face : cells_) bytes += face.bytes();
      if (bytes <= kMostBytesInAll) continue;
      for (FaceCells& face : cells_) face.forget();
    }
    for (FaceCells& face : cells_) face.forget();
    account_.faces = count;
    for (int f = 0; f < count; ++f) compare_with_itself(f);
    return std::move(account_);
  }

 private:
  // Pairs whose boxes meet, or are not known.
  std::vector<std::pair<int, int>> meeting_boxes() const {
    std::vector<int> order(cells_.size());
    std::iota(order.begin(), order.end(), 0);
    const auto begin = [&](int f) {
      const FaceCells& face = cells_[static_cast<size_t>(f)];
      return face.proven() && face.known() ? face.root().low.x()
                                           : -std::numeric_limits<double>::infinity();
    };
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return begin(a) < begin(b); });
    std::vector<std::pair<int, int>> pairs;
    for (size_t i = 0; i < order.size(); ++i) {
      const FaceCells& a = cells_[static_cast<size_t>(order[i])];
      const bool unknown_a = !a.known() || !a.proven();
      for (size_t j = i + 1; j < order.size(); ++j) {
        const FaceCells& b = cells_[static_cast<size_t>(order[j])];
        const bool unknown = unknown_a || !b.known() || !b.proven();
        if (!unknown && b.root().low.x() > a.root().high.x()) break;
        if (unknown || boxes_meet(a.root(), b.root()))
          pairs.push_back(std::minmax(order[i], order[j]));
      }
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  }

  void compare(int a, int b) {
    FaceCells& face_a = cells_[static_cast<size_t>(a)];
    FaceCells& face_b = cells_[static_cast<size_t>(b)];
    Answer answer = Answer::kUndecided;
    const Shared shared = shared_by(a, b);
    if (face_a.known() && face_b.known() && tests_ < kMostTestsInAll) {
      const double limit = std::max(kDepthTolerances * std::max(limits_[static_cast<size_t>(a)],
                                                                limits_[static_cast<size_t>(b)]),
                                    kCoincident * table_.diagonal);
      PairSearch search(face_a, face_b, shared, limit, table_.diagonal);
      answer = search.run(kMostTests);
      tests_ += search.tests();
      if (answer == Answer::kApart && !(face_a.proven() && face_b.proven())) {
        answer = Answer::kUndecided;
      }
      if (answer == Answer::kCrossing) {
        const CrossingPoint& point = search.found();
        account_.found.push_back({a, b, point.at, point.depth, limit, one_body(a, b)});
      }
    }
    account_.crossing += answer == Answer::kCrossing ? 1 : 0;
    account_.apart += answer == Answer::kApart && shared.empty() ? 1 : 0;
    account_.neighbours += answer == Answer::kApart && !shared.empty() ? 1 : 0;
    if (answer != Answer::kUndecided) return;
    ++account_.undecided;
    if (account_.undecided_pairs.size() < kListedPairs) account_.undecided_pairs.emplace_back(a, b);
  }

  void compare_with_itself(int f) {
    FaceCells& face = cells_[static_cast<size_t>(f)];
    const Shared shared = own_seams(f);
    const double limit =
        std::max(kDepthTolerances * limits_[static_cast<size_t>(f)], kCoincident * table_.diagonal);
    const double strip = face.known() ? kSharedStrip * face.root().size() : 0.0;
    FoldSearch search;
    if (tests_ < kMostTestsInAll) {
      search = search_fold(face, shared, strip, limit, table_.diagonal, kMostTests);
    }
    tests_ += search.tests;
    face.forget();
    account_.faces_free += search.answer == FoldAnswer::kFree ? 1 : 0;
    account_.faces_undecided += search.answer == FoldAnswer::kUndecided ? 1 : 0;
    if (search.answer != FoldAnswer::kCrossing) return;
    ++account_.faces_crossing;
    account_.found.push_back({f, f, search.found->at, search.found->depth, limit, true});
  }

  // Edges that the face uses twice, and the points of its collapsed sides.
  Shared own_seams(int f) const {
    Shared shared;
    for (size_t e = 0; e < table_.edges.size(); ++e) {
      const EdgeRecord& record = table_.edges[e];
      const auto uses = std::count_if(record.sites.begin(), record.sites.end(),
                                      [&](const EdgeSite& site) { return site.face == f; });
      if (uses > 1 && !lines_[e].empty()) shared.push_back(&lines_[e]);
      if (uses == 0 || !BRep_Tool::Degenerated(record.edge)) continue;
      for (TopExp_Explorer it(record.edge, TopAbs_VERTEX); it.More(); it.Next()) {
        shared.push_back(&points_.at(vertices_.FindIndex(it.Current())));
      }
    }
    return shared;
  }

  void collect_shared() {
    lines_.reserve(table_.edges.size());
    of_face_.resize(table_.faces.size());
    std::map<int, std::vector<Vec3>> vertices;
    std::vector<std::set<int>> vertices_of_face(table_.faces.size());
    for (const EdgeRecord& record : table_.edges) {
      lines_.push_back(polyline(record.edge));
      for (const EdgeSite& site : record.sites) {
        const auto face = static_cast<size_t>(site.face);
        if (!lines_.back().empty()) of_face_[face].insert(&lines_.back());
        for (TopExp_Explorer it(record.edge, TopAbs_VERTEX); it.More(); it.Next()) {
          const int number = vertices_.Add(it.Current());
          const gp_Pnt p = BRep_Tool::Pnt(TopoDS::Vertex(it.Current()));
          vertices[number] = {Vec3(p.X(), p.Y(), p.Z())};
          vertices_of_face[face].insert(number);
        }
      }
    }
    points_ = std::move(vertices);
    for (size_t f = 0; f < vertices_of_face.size(); ++f) {
      for (int number : vertices_of_face[f]) of_face_[f].insert(&points_[number]);
    }
  }

  static std::vector<Vec3> polyline(const TopoDS_Edge& edge) {
    std::vector<Vec3> line;
    if (BRep_Tool::Degenerated(edge) || !BRep_Tool::IsGeometric(edge)) return line;
    const BRepAdaptor_Curve curve(edge);
    if (!curve.Is3DCurve()) return line;
    const double first = curve.FirstParameter(), last = curve.LastParameter();
    for (int k = 0; k <= kPolylineSteps; ++k) {
      const gp_Pnt p = curve.Value(first + (last - first) * k / kPolylineSteps);
      line.emplace_back(p.X(), p.Y(), p.Z());
    }
    return line;
  }

  Shared shared_by(int a, int b) const {
    const auto& of_a = of_face_[static_cast<size_t>(a)];
    Shared shared;
    for (const auto* line : of_face_[static_cast<size_t>(b)]) {
      if (of_a.count(line) > 0) shared.push_back(line);
    }
    return shared;
  }

  void collect_bodies() {
    bodies_.resize(table_.faces.size());
    TopTools_IndexedMapOfShape faces;
    for (const FaceRecord& face : table_.faces) faces.Add(face.face);
    int number = 0;
    for (TopExp_Explorer solid(table_.shape, TopAbs_SOLID); solid.More(); solid.Next(), ++number) {
      for (TopExp_Explorer it(solid.Current(), TopAbs_FACE); it.More(); it.Next()) {
        const int face = faces.FindIndex(it.Current());
        if (face > 0) bodies_[static_cast<size_t>(face) - 1].insert(number);
      }
    }
  }

  // Faces that belong to no solid count as one body with any other.
  bool one_body(int a, int b) const {
    const auto& of_a = bodies_[static_cast<size_t>(a)];
    const auto& of_b = bodies_[static_cast<size_t>(b)];
    return of_a.empty() || of_b.empty() ||
           std::any_of(of_a.begin(), of_a.end(), [&](int k) { return of_b.count(k) > 0; });
  }

  const BrepTable& table_;
  std::vector<FaceCells> cells_;
  std::vector<double> limits_;
  std::vector<std::vector<Vec3>> lines_;  // of edges
  TopTools_IndexedMapOfShape vertices_;
  std::map<int, std::vector<Vec3>> points_;  // of vertices
  std::vector<std::set<const std::vector<Vec3>*>> of_face_;
  std::vector<std::set<int>> bodies_;  // the solids that use a face
  long tests_ = 0;
  CrossingsAccount account_;
};

}  // namespace

CrossingsAccount self_intersections(const BrepTable& table, const std::vector<EdgeFacts>& edges) {
  return ShapeSearch(table, edges).run();
}

}  // namespace isochor::internal
