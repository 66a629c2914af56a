// OpenCASCADE's way to replace geometry and keep topology, driven by a RebuildPlan. Internal.
//
// Each override is needed; without it OpenCASCADE either keeps an old curve (and the shape is not
// valid) or drops the parameter curves and recomputes them within a tolerance.
#pragma once

#include <BRepTools_Modification.hxx>
#include <NCollection_DataMap.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>

#include "isochor/step/rebuild_plan.h"

namespace isochor::internal {

class PoleModification : public BRepTools_Modification {
 public:
  explicit PoleModification(const RebuildPlan& plan);

  Standard_Boolean NewSurface(const TopoDS_Face& face, Handle(Geom_Surface) & surface,
                              TopLoc_Location& location, Standard_Real& tolerance,
                              Standard_Boolean& reverse_wires,
                              Standard_Boolean& reverse_face) override;
  Standard_Boolean NewCurve(const TopoDS_Edge& edge, Handle(Geom_Curve) & curve,
                            TopLoc_Location& location, Standard_Real& tolerance) override;
  Standard_Boolean NewPoint(const TopoDS_Vertex& vertex, gp_Pnt& point,
                            Standard_Real& tolerance) override;
  Standard_Boolean NewCurve2d(const TopoDS_Edge& edge, const TopoDS_Face& face,
                              const TopoDS_Edge& new_edge, const TopoDS_Face& new_face,
                              Handle(Geom2d_Curve) & curve, Standard_Real& tolerance) override;
  Standard_Boolean NewParameter(const TopoDS_Vertex& vertex, const TopoDS_Edge& edge,
                                Standard_Real& parameter, Standard_Real& tolerance) override;
  GeomAbs_Shape Continuity(const TopoDS_Edge& edge, const TopoDS_Face& face_1,
                           const TopoDS_Face& face_2, const TopoDS_Edge& new_edge,
                           const TopoDS_Face& new_face_1, const TopoDS_Face& new_face_2) override;

 private:
  NCollection_DataMap<TopoDS_Shape, Handle(Geom_Surface), TopTools_ShapeMapHasher> surfaces_;
  NCollection_DataMap<TopoDS_Shape, internal::NewCurve, TopTools_ShapeMapHasher> curves_;
  NCollection_DataMap<TopoDS_Shape, internal::NewPoint, TopTools_ShapeMapHasher> points_;
};

}  // namespace isochor::internal
