#include "isochor/step/rebuild_plan.h"

#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListIteratorOfListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>
#include <cmath>
#include <gp_Trsf.hxx>

#include "isochor/base/error.h"
#include "isochor/step/checks.h"
#include "isochor/step/displacement.h"
#include "isochor/step/occt_surface.h"

namespace isochor::internal {
namespace {

// Two faces that move a common vertex must agree to this part of its distance from the origin.
constexpr double kSameMove = 1e-11;

// The share of a trim's tolerance that its new curve may use.
constexpr double kShareOfCurve = 0.1;
// Readers measure gaps at other places: a stored tolerance exceeds the measured gap by this factor.
constexpr double kToleranceOverGap = 1.5;

class Planner {
 public:
  Planner(const TopoDS_Shape& part, double trim_tolerance) : trim_tolerance_(trim_tolerance) {
    TopExp::MapShapes(part, TopAbs_FACE, faces_);
    TopExp::MapShapesAndAncestors(part, TopAbs_EDGE, TopAbs_FACE, neighbours_);
  }

  RebuildPlan run(const std::vector<FaceChange>& changes) {
    for (const auto& change : changes) changed_.Add(change.face);
    displacements_.resize(changes.size());
    for (size_t k = 0; k < changes.size(); ++k) {
      if (plan_.refusal.empty()) add(changes[k], displacements_[k]);
    }
    for (size_t k = 0; k < changes.size(); ++k) {
      if (plan_.refusal.empty()) add_edges(changes[k], *displacements_[k]);
    }
    return std::move(plan_);
  }

 private:
  void refuse(const std::string& handle, const std::string& reason) {
    if (plan_.refusal.empty()) plan_.refusal = handle + ": " + reason;
  }

  void add(const FaceChange& change, std::optional<Displacement>& displacement) {
    const auto spline = plain_bspline(change.face);
    if (spline.IsNull() && !change.before) {
      return refuse(change.handle, "is not a B-spline face");
    }
    const Surface before = change.before ? *change.before : from_occt(*spline);
    try {
      displacement.emplace(change.face, before, change.surface);
      plan_.surfaces.push_back({change.face, to_occt(change.surface), change.handle,
                                spline.IsNull(), before, change.surface});
    } catch (const InputError& e) {
      refuse(change.handle, e.reason());
    }
  }

  void add_edges(const FaceChange& change, const Displacement& displacement) {
    TopLoc_Location location;
    BRep_Tool::Surface(change.face, location);
    for (TopExp_Explorer it(change.face, TopAbs_EDGE); it.More(); it.Next()) {
      add_edge(change, displacement, TopoDS::Edge(it.Current()), location);
    }
  }

  void add_edge(const FaceChange& change, const Displacement& displacement, const TopoDS_Edge& edge,
                const TopLoc_Location& location) {
    const auto forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
    TopoDS_Vertex first, last;
    TopExp::Vertices(forward, first, last);
    add_vertex(change, first, displacement.at_end(edge, 0), location);
    add_vertex(change, last, displacement.at_end(edge, 1), location);
    if (BRep_Tool::Degenerated(edge) || displacement.along(edge) == 0.0) return;
    const std::string other = unedited_neighbour(edge);
    if (!other.empty()) {
      return refuse(change.handle,
                    "moves the edge it shares with " + other + ", which is not edited");
    }
    if (!moved_edges_.Contains(edge)) {
      const auto run = displacement.iso_run(edge);
      if (trim_tolerance_ > 0.0 && is_trim(edge)) return add_trim(change, forward, location);
      if (!run) return refuse(change.handle, "moves an edge that is trimmed out of it");
      moved_edges_.Add(edge);
      plan_.curves.push_back({forward, displacement.new_curve(edge, *run), location});
    }
  }

  // The changed faces at an edge: index among the changes.
  std::vector<size_t> changes_at(const TopoDS_Edge& edge) const {
    std::vector<size_t> found;
    for (TopTools_ListIteratorOfListOfShape it(neighbours_.FindFromKey(edge)); it.More();
         it.Next()) {
      const int index = changed_.FindIndex(it.Value());
      if (index > 0) found.push_back(static_cast<size_t>(index) - 1);
    }
    return found;
  }

  // A trimming curve of one of its faces.
  bool is_trim(const TopoDS_Edge& edge) const {
    for (size_t k : changes_at(edge)) {
      if (!displacements_[k]->iso_run(edge)) return true;
    }
    return false;
  }

  // An edge that its faces move although it is a trimming curve of one of them.
  void add_trim(const FaceChange& change, const TopoDS_Edge& edge,
                const TopLoc_Location& location) {
    const std::vector<size_t> faces = changes_at(edge);
    const auto mean = [&](double fraction) {
      Vec3 sum = Vec3::Zero();
      for (size_t k : faces) sum += displacements_[k]->at(edge, fraction);
      return Vec3(sum / static_cast<double>(faces.size()));
    };
    const Handle(Geom_Curve) curve =
        displaced_curve(edge, location, mean, kShareOfCurve * trim_tolerance_);
    if (curve.IsNull()) {
      return refuse(change.handle, "moves a trimming edge for which no curve was found");
    }
    double gap = 0.0;
    for (size_t k : faces) gap = std::max(gap, displacements_[k]->gap_to(edge, *curve));
    const double old = BRep_Tool::Tolerance(edge);
    if (gap > std::max(old, trim_tolerance_)) {
      return refuse(change.handle, "moves a trimming edge, and the faces there would part by " +
                                       number_text(gap) + ", more than " +
                                       number_text(trim_tolerance_));
    }
    moved_edges_.Add(edge);
    const double tolerance =
        std::max(old, std::min(kToleranceOverGap * gap, std::max(gap, trim_tolerance_)));
    plan_.curves.push_back({edge, curve, location, tolerance});
    TopoDS_Vertex ends[2];
    TopExp::Vertices(edge, ends[0], ends[1]);
    for (const TopoDS_Vertex& end : ends) {
      const int known = end.IsNull() ? 0 : moved_vertices_.FindIndex(end);
      if (known == 0) continue;
      double& own = plan_.points[static_cast<size_t>(known) - 1].tolerance;
      own = std::max(own, tolerance);
    }
  }

  void add_vertex(const FaceChange& change, const TopoDS_Vertex& vertex, const Vec3& displacement,
                  const TopLoc_Location& location) {
    if (vertex.IsNull() || displacement == Vec3::Zero()) return;
    gp_Vec move(displacement.x(), displacement.y(), displacement.z());
    if (!location.IsIdentity()) move.Transform(location.Transformation());
    const gp_Pnt old = BRep_Tool::Pnt(vertex);
    const gp_Pnt moved = old.Translated(move);
    const int known = moved_vertices_.FindIndex(vertex);
    if (known == 0) {
      moved_vertices_.Add(vertex);
      plan_.points.push_back({vertex, moved});
      return;
    }
    const double scale = std::max(old.Distance(gp_Pnt()), move.Magnitude());
    const double allowed = std::max(kSameMove * scale, trim_tolerance_);
    if (plan_.points[static_cast<size_t>(known) - 1].point.Distance(moved) > allowed) {
      refuse(change.handle, "moves a corner differently from its neighbour");
    }
  }

  // "face:7" when an unchanged face uses the edge.
  std::string unedited_neighbour(const TopoDS_Edge& edge) const {
    for (TopTools_ListIteratorOfListOfShape it(neighbours_.FindFromKey(edge)); it.More();
         it.Next()) {
      if (!changed_.Contains(it.Value())) {
        return "face:" + std::to_string(faces_.FindIndex(it.Value()));
      }
    }
    return "";
  }

  TopTools_IndexedMapOfShape faces_, changed_, moved_edges_, moved_vertices_;
  TopTools_IndexedDataMapOfShapeListOfShape neighbours_;
  std::vector<std::optional<Displacement>> displacements_;  // by change
  double trim_tolerance_ = 0.0;
  RebuildPlan plan_;
};

}  // namespace

RebuildPlan plan_rebuild(const TopoDS_Shape& part, const std::vector<FaceChange>& changes,
                         double trim_tolerance) {
  return Planner(part, trim_tolerance).run(changes);
}

}  // namespace isochor::internal
