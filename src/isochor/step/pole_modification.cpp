#include "isochor/step/pole_modification.h"

#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <algorithm>

namespace isochor::internal {

PoleModification::PoleModification(const RebuildPlan& plan) {
  for (const auto& change : plan.surfaces) surfaces_.Bind(change.face, change.surface);
  for (const auto& change : plan.curves) curves_.Bind(change.edge, change);
  for (const auto& change : plan.points) points_.Bind(change.vertex, change);
}

Standard_Boolean PoleModification::NewSurface(const TopoDS_Face& face,
                                              Handle(Geom_Surface) & surface,
                                              TopLoc_Location& location, Standard_Real& tolerance,
                                              Standard_Boolean& reverse_wires,
                                              Standard_Boolean& reverse_face) {
  reverse_wires = reverse_face = Standard_False;
  if (!surfaces_.Find(face, surface)) return Standard_False;
  BRep_Tool::Surface(face, location);
  tolerance = BRep_Tool::Tolerance(face);
  return Standard_True;
}

Standard_Boolean PoleModification::NewCurve(const TopoDS_Edge& edge, Handle(Geom_Curve) & curve,
                                            TopLoc_Location& location, Standard_Real& tolerance) {
  const internal::NewCurve* change = curves_.Seek(edge);
  if (change == nullptr) return Standard_False;
  curve = change->curve;
  location = change->location;
  tolerance = std::max(BRep_Tool::Tolerance(edge), change->tolerance);
  return Standard_True;
}

Standard_Boolean PoleModification::NewPoint(const TopoDS_Vertex& vertex, gp_Pnt& point,
                                            Standard_Real& tolerance) {
  const internal::NewPoint* change = points_.Seek(vertex);
  if (change == nullptr) return Standard_False;
  point = change->point;
  tolerance = std::max(BRep_Tool::Tolerance(vertex), change->tolerance);
  return Standard_True;
}

Standard_Boolean PoleModification::NewCurve2d(const TopoDS_Edge& edge, const TopoDS_Face& face,
                                              const TopoDS_Edge& /*new_edge*/,
                                              const TopoDS_Face& /*new_face*/,
                                              Handle(Geom2d_Curve) & curve,
                                              Standard_Real& tolerance) {
  const bool new_surface = surfaces_.IsBound(face);
  if (!new_surface && !curves_.IsBound(edge)) return Standard_False;
  // Of a seam, the orientation of the edge says which of its two curves is meant. Planes store no
  // curves; once converted they need those that were computed.
  double first = 0.0, last = 0.0;
  Standard_Boolean stored = Standard_False;
  curve = BRep_Tool::CurveOnSurface(edge, face, first, last, &stored);
  tolerance = BRep_Tool::Tolerance(edge);
  if (const internal::NewCurve* change = curves_.Seek(edge)) {
    tolerance = std::max(tolerance, change->tolerance);
  }
  return !curve.IsNull() && (stored || new_surface);
}

Standard_Boolean PoleModification::NewParameter(const TopoDS_Vertex&, const TopoDS_Edge&,
                                                Standard_Real&, Standard_Real&) {
  return Standard_False;
}

GeomAbs_Shape PoleModification::Continuity(const TopoDS_Edge& edge, const TopoDS_Face& face_1,
                                           const TopoDS_Face& face_2, const TopoDS_Edge&,
                                           const TopoDS_Face&, const TopoDS_Face&) {
  return BRep_Tool::Continuity(edge, face_1, face_2);
}

}  // namespace isochor::internal
