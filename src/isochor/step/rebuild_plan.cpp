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
#include "isochor/step/displacement.h"
#include "isochor/step/occt_surface.h"

namespace isochor::internal {
namespace {

// Two faces that move a common vertex must agree to this part of its distance from the origin.
constexpr double kSameMove = 1e-11;

class Planner {
 public:
  explicit Planner(const TopoDS_Shape& part) {
    TopExp::MapShapes(part, TopAbs_FACE, faces_);
    TopExp::MapShapesAndAncestors(part, TopAbs_EDGE, TopAbs_FACE, neighbours_);
  }

  RebuildPlan run(const std::vector<FaceChange>& changes) {
    for (const auto& change : changes) changed_.Add(change.face);
    for (const auto& change : changes) {
      if (plan_.refusal.empty()) add(change);
    }
    return std::move(plan_);
  }

 private:
  void refuse(const std::string& handle, const std::string& reason) {
    if (plan_.refusal.empty()) plan_.refusal = handle + ": " + reason;
  }

  void add(const FaceChange& change) {
    const auto spline = plain_bspline(change.face);
    if (spline.IsNull() && !change.before) {
      return refuse(change.handle, "is not a B-spline face");
    }
    TopLoc_Location location;
    BRep_Tool::Surface(change.face, location);
    const Surface before = change.before ? *change.before : from_occt(*spline);
    try {
      const Displacement displacement(change.face, before, change.surface);
      plan_.surfaces.push_back({change.face, to_occt(change.surface), change.handle,
                                spline.IsNull(), before, change.surface});
      for (TopExp_Explorer it(change.face, TopAbs_EDGE); it.More(); it.Next()) {
        add_edge(change, displacement, TopoDS::Edge(it.Current()), location);
      }
    } catch (const InputError& e) {
      refuse(change.handle, e.reason());
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
      if (!run) return refuse(change.handle, "moves an edge that is trimmed out of it");
      moved_edges_.Add(edge);
      plan_.curves.push_back({forward, displacement.new_curve(edge, *run), location});
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
    if (plan_.points[static_cast<size_t>(known) - 1].point.Distance(moved) > kSameMove * scale) {
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
  RebuildPlan plan_;
};

}  // namespace

RebuildPlan plan_rebuild(const TopoDS_Shape& part, const std::vector<FaceChange>& changes) {
  return Planner(part).run(changes);
}

}  // namespace isochor::internal
