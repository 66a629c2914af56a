#include "isochor/step/surgical_plan.h"

#include <BRep_Tool.hxx>
#include <Geom_BSplineCurve.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>

#include "isochor/base/error.h"
#include "isochor/step/entity_index.h"

namespace isochor::internal {
namespace {

Vec3 vector_of(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }

SplineValue curve_value(const Handle(Geom_Curve) & curve) {
  const auto spline = Handle(Geom_BSplineCurve)::DownCast(curve);
  ISOCHOR_REQUIRE(!spline.IsNull() && !spline->IsPeriodic());
  std::vector<double> knots;
  for (int k = 1; k <= spline->NbKnots(); ++k) {
    knots.insert(knots.end(), static_cast<size_t>(spline->Multiplicity(k)), spline->Knot(k));
  }
  SplineValue value;
  const std::string defect = KnotVector::defect(spline->Degree(), knots);
  if (!defect.empty()) throw InputError("", "", "a new edge curve: " + defect);
  value.knots.emplace_back(spline->Degree(), std::move(knots));
  for (int k = 1; k <= spline->NbPoles(); ++k) {
    value.poles.push_back(vector_of(spline->Pole(k)));
    if (spline->IsRational()) value.weights.push_back(spline->Weight(k));
  }
  return value;
}

// Points of a shape as its entity states them: before placements inside the part.
gp_Pnt own_place(const gp_Pnt& point, const TopoDS_Shape& shape) {
  if (shape.Location().IsIdentity()) return point;
  return point.Transformed(shape.Location().Transformation().Inverted());
}

MovedCurve moved_curve(const NewCurve& change, const EntityIndex& index) {
  MovedCurve moved;
  moved.edge = index.number(change.edge);
  moved.curve = curve_value(change.curve);
  const auto edge = TopoDS::Edge(change.edge);
  TopoDS_Vertex ends[2];
  TopExp::Vertices(edge, ends[0], ends[1]);
  for (size_t k = 0; k < 2; ++k) {
    if (ends[k].IsNull()) continue;
    moved.ends[k] = vector_of(own_place(BRep_Tool::Pnt(ends[k]), ends[k]));
    moved.near = std::max(moved.near, BRep_Tool::Tolerance(ends[k]));
  }
  return moved;
}

MovedPoint moved_point(const NewPoint& change, const EntityIndex& index) {
  MovedPoint moved;
  moved.vertex = index.number(change.vertex);
  const auto vertex = TopoDS::Vertex(change.vertex);
  moved.before = vector_of(own_place(BRep_Tool::Pnt(vertex), vertex));
  moved.after = vector_of(own_place(change.point, vertex));
  moved.near = BRep_Tool::Tolerance(vertex);
  return moved;
}

}  // namespace

SurgicalEdit surgical_edit(const Document& document, const std::vector<RebuildPlan>& plans) {
  const EntityIndex index(document);
  SurgicalEdit edit;
  for (const auto& plan : plans) {
    for (const auto& change : plan.surfaces) {
      edit.surfaces.push_back({change.handle, index.number(change.face), change.converted,
                               change.before, change.after});
      for (TopExp_Explorer it(change.face, TopAbs_EDGE); it.More(); it.Next()) {
        edit.known_edges.insert(index.number(it.Current()));
      }
      for (TopExp_Explorer it(change.face, TopAbs_VERTEX); it.More(); it.Next()) {
        edit.known_vertices.insert(index.number(it.Current()));
      }
    }
    for (const auto& change : plan.curves) edit.curves.push_back(moved_curve(change, index));
    for (const auto& change : plan.points) edit.points.push_back(moved_point(change, index));
  }
  return edit;
}

}  // namespace isochor::internal
