#include "isochor/step/face_loops.h"

#include <BRepTools_WireExplorer.hxx>
#include <BRep_Tool.hxx>
#include <TopAbs_ShapeEnum.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Wire.hxx>

namespace isochor::internal {
namespace {

EdgeUse use_of(const TopoDS_Edge& edge, const TopoDS_Face& forward) {
  EdgeUse use;
  use.edge = edge;
  use.reversed = edge.Orientation() == TopAbs_REVERSED;
  use.degenerated = BRep_Tool::Degenerated(edge);
  use.tolerance = BRep_Tool::Tolerance(edge);
  use.curve = BRep_Tool::CurveOnSurface(edge, forward, use.first, use.last);
  return use;
}

bool on_boundary(const TopoDS_Shape& edge) {
  return edge.ShapeType() == TopAbs_EDGE &&
         (edge.Orientation() == TopAbs_FORWARD || edge.Orientation() == TopAbs_REVERSED);
}

FaceLoop loop_of(const TopoDS_Wire& wire, const TopoDS_Face& forward) {
  FaceLoop loop;
  size_t count = 0;
  for (TopoDS_Iterator it(wire); it.More(); it.Next()) count += on_boundary(it.Value()) ? 1 : 0;
  for (BRepTools_WireExplorer it(wire, forward); it.More(); it.Next()) {
    if (on_boundary(it.Current())) loop.uses.push_back(use_of(it.Current(), forward));
  }
  if (loop.uses.size() == count) return loop;
  // The explorer stops where a wire is not one connected chain; every edge counts all the same.
  loop.uses.clear();
  loop.ordered = false;
  for (TopoDS_Iterator it(wire); it.More(); it.Next()) {
    if (on_boundary(it.Value())) loop.uses.push_back(use_of(TopoDS::Edge(it.Value()), forward));
  }
  return loop;
}

}  // namespace

std::vector<FaceLoop> face_loops(const TopoDS_Face& face) {
  const TopoDS_Face forward = TopoDS::Face(face.Oriented(TopAbs_FORWARD));
  std::vector<FaceLoop> loops;
  for (TopoDS_Iterator it(forward); it.More(); it.Next()) {
    if (it.Value().ShapeType() != TopAbs_WIRE) continue;
    FaceLoop loop = loop_of(TopoDS::Wire(it.Value()), forward);
    if (!loop.uses.empty()) loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace isochor::internal
