#include "isochor/step/gaps.h"

#include <BRep_Tool.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_Surface.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>

namespace isochor::internal {
namespace {

// Samples per edge: enough per knot span to see any wave of a cubic, bounded for huge curves.
constexpr int kLeastSamples = 32;
constexpr int kSamplesPerSpan = 6;
constexpr int kMostSamples = 512;

struct SpaceCurve {
  Handle(Geom_Curve) curve;
  double first = 0.0, last = 0.0;
  explicit SpaceCurve(const TopoDS_Edge& edge) { curve = BRep_Tool::Curve(edge, first, last); }
  gp_Pnt at(double fraction) const { return curve->Value(first + fraction * (last - first)); }
};

// The curve of an edge on a face.
struct FaceCurve {
  Handle(Geom2d_Curve) curve;
  Handle(Geom_Surface) surface;
  double first = 0.0, last = 0.0;
  FaceCurve(const TopoDS_Edge& edge, const TopoDS_Face& face) {
    curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
    surface = BRep_Tool::Surface(face);
  }
  bool known() const { return !curve.IsNull() && !surface.IsNull(); }
  gp_Pnt at(double fraction) const {
    const gp_Pnt2d uv = curve->Value(first + fraction * (last - first));
    return surface->Value(uv.X(), uv.Y());
  }
};

int spans_of(const Handle(Geom_Surface) & surface) {
  const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface);
  return spline.IsNull() ? 1 : std::max(spline->NbUKnots(), spline->NbVKnots());
}

int sample_count(const SpaceCurve& space, const FaceCurve& on_face) {
  int spans = spans_of(on_face.surface);
  const auto spline = Handle(Geom_BSplineCurve)::DownCast(space.curve);
  if (!spline.IsNull()) spans = std::max(spans, spline->NbKnots());
  const auto flat = Handle(Geom2d_BSplineCurve)::DownCast(on_face.curve);
  if (!flat.IsNull()) spans = std::max(spans, flat->NbKnots());
  return std::clamp(kSamplesPerSpan * spans, kLeastSamples, kMostSamples);
}

// Both vertices of the edge in the direction of its curve; they may be null.
struct Ends {
  TopoDS_Vertex first, last;
  explicit Ends(const TopoDS_Edge& edge) {
    const auto forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
    TopExp::Vertices(forward, first, last);
  }
};

double distance(const TopoDS_Vertex& vertex, const gp_Pnt& point) {
  return vertex.IsNull() ? 0.0 : BRep_Tool::Pnt(vertex).Distance(point);
}

}  // namespace

double edge_gap(const TopoDS_Edge& edge, const TopoDS_Face& face) {
  const SpaceCurve space(edge);
  const FaceCurve on_face(edge, face);
  if (!on_face.known()) return 0.0;
  const Ends ends(edge);
  const int samples = sample_count(space, on_face);
  double largest = 0.0;
  for (int k = 0; k <= samples; ++k) {
    const double fraction = static_cast<double>(k) / samples;
    const gp_Pnt point = on_face.at(fraction);
    largest = std::max(largest, space.curve.IsNull() ? distance(ends.first, point)
                                                     : space.at(fraction).Distance(point));
  }
  return largest;
}

Gaps measure_gaps(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape edges, vertices;
  TopExp::MapShapes(shape, TopAbs_EDGE, edges);
  TopExp::MapShapes(shape, TopAbs_VERTEX, vertices);
  Gaps gaps;
  gaps.edges.assign(static_cast<size_t>(edges.Extent()), 0.0);
  gaps.vertices.assign(static_cast<size_t>(vertices.Extent()), 0.0);
  const auto vertex_gap = [&](const TopoDS_Vertex& vertex, const gp_Pnt& point) {
    if (vertex.IsNull()) return;
    double& gap = gaps.vertices[static_cast<size_t>(vertices.FindIndex(vertex)) - 1];
    gap = std::max(gap, distance(vertex, point));
  };
  for (int k = 1; k <= edges.Extent(); ++k) {
    const auto& edge = TopoDS::Edge(edges(k));
    const SpaceCurve space(edge);
    if (space.curve.IsNull()) continue;
    const Ends ends(edge);
    vertex_gap(ends.first, space.at(0.0));
    vertex_gap(ends.last, space.at(1.0));
  }
  for (TopExp_Explorer f(shape, TopAbs_FACE); f.More(); f.Next()) {
    const auto& face = TopoDS::Face(f.Current());
    for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next()) {
      const auto& edge = TopoDS::Edge(e.Current());
      double& gap = gaps.edges[static_cast<size_t>(edges.FindIndex(edge)) - 1];
      gap = std::max(gap, edge_gap(edge, face));
      const FaceCurve on_face(edge, face);
      if (!on_face.known()) continue;
      const Ends ends(edge);
      vertex_gap(ends.first, on_face.at(0.0));
      vertex_gap(ends.last, on_face.at(1.0));
    }
  }
  return gaps;
}

}  // namespace isochor::internal
