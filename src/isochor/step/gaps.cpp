#include "isochor/step/gaps.h"

#include <BRep_Tool.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom2d_Line.hxx>
#include <GeomAdaptor_Curve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_Surface.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>

namespace isochor::internal {
namespace {

// Samples per edge: enough per knot span to see any wave of a cubic, bounded for huge curves.
constexpr int kLeastSamples = 32;
constexpr int kSamplesPerSpan = 6;
constexpr int kMostSamples = 512;

// Adaptors remember the span they were last asked for.
struct SpaceCurve {
  Handle(Geom_Curve) curve;
  double first = 0.0, last = 0.0;
  GeomAdaptor_Curve values;

  explicit SpaceCurve(const TopoDS_Edge& edge) {
    curve = BRep_Tool::Curve(edge, first, last);
    if (known()) values.Load(curve);
  }
  bool known() const { return !curve.IsNull(); }
  gp_Pnt at(double fraction) const { return values.Value(first + fraction * (last - first)); }
  int spans() const {
    const auto spline = Handle(Geom_BSplineCurve)::DownCast(curve);
    return spline.IsNull() ? 1 : spline->NbKnots();
  }
};

bool same_numbers(const Geom_BSplineCurve& a, const Geom_BSplineCurve& b) {
  if (a.Degree() != b.Degree() || a.NbPoles() != b.NbPoles() || a.NbKnots() != b.NbKnots()) {
    return false;
  }
  if (a.IsPeriodic() || b.IsPeriodic() || a.IsRational() || b.IsRational()) return false;
  for (int k = 1; k <= a.NbKnots(); ++k) {
    if (a.Knot(k) != b.Knot(k) || a.Multiplicity(k) != b.Multiplicity(k)) return false;
  }
  for (int k = 1; k <= a.NbPoles(); ++k) {
    const gp_Pnt p = a.Pole(k), q = b.Pole(k);
    if (p.X() != q.X() || p.Y() != q.Y() || p.Z() != q.Z()) return false;
  }
  return true;
}

// The curve of an edge on a face.
class FaceCurve {
 public:
  FaceCurve(const TopoDS_Edge& edge, const TopoDS_Face& face) {
    curve_ = BRep_Tool::CurveOnSurface(edge, face, first_, last_);
    surface_ = BRep_Tool::Surface(face);
    if (!known()) return;
    values_.Load(curve_);
    follow_parameter_line();
  }
  bool known() const { return !curve_.IsNull() && !surface_.IsNull(); }
  gp_Pnt at(double fraction) const {
    const gp_Pnt2d uv = values_.Value(first_ + fraction * (last_ - first_));
    if (runs_ == Runs::kAnyhow) return surface_->Value(uv.X(), uv.Y());
    return line_.Value(runs_ == Runs::kAlongU ? uv.X() : uv.Y());
  }
  // Proves that the composed curve is that of the edge, by numbers and at equal parameters: then
  // there is no gap.
  bool is(const SpaceCurve& space) const {
    if (runs_ == Runs::kAnyhow || space.first != first_ || space.last != last_) return false;
    const auto line = Handle(Geom2d_Line)::DownCast(curve_);
    const bool along_u = runs_ == Runs::kAlongU;
    const double origin = along_u ? line->Location().X() : line->Location().Y();
    const double speed = along_u ? line->Direction().X() : line->Direction().Y();
    const auto own = Handle(Geom_BSplineCurve)::DownCast(space.curve);
    return origin == 0.0 && speed == 1.0 && !own.IsNull() && same_numbers(*own, *line_.BSpline());
  }
  // Of the composed curve: knots of a direction in which it does not run are not met.
  int spans() const {
    if (runs_ != Runs::kAnyhow) return line_.NbKnots();
    const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface_);
    const auto flat = Handle(Geom2d_BSplineCurve)::DownCast(curve_);
    return std::max(spline.IsNull() ? 1 : std::max(spline->NbUKnots(), spline->NbVKnots()),
                    flat.IsNull() ? 1 : flat->NbKnots());
  }

 private:
  enum class Runs { kAnyhow, kAlongU, kAlongV };

  // A straight line along one parameter stays on one curve of the surface, which is cheaper.
  void follow_parameter_line() {
    const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface_);
    const auto line = Handle(Geom2d_Line)::DownCast(curve_);
    if (spline.IsNull() || line.IsNull()) return;
    if (line->Direction().X() == 0.0) {
      runs_ = Runs::kAlongV;
      line_.Load(spline->UIso(line->Location().X()));
    } else if (line->Direction().Y() == 0.0) {
      runs_ = Runs::kAlongU;
      line_.Load(spline->VIso(line->Location().Y()));
    }
  }

  Handle(Geom2d_Curve) curve_;
  Handle(Geom_Surface) surface_;
  double first_ = 0.0, last_ = 0.0;
  Geom2dAdaptor_Curve values_;
  Runs runs_ = Runs::kAnyhow;
  GeomAdaptor_Curve line_;  // of the surface, when the curve runs along a parameter
};

int sample_count(const SpaceCurve& space, const FaceCurve& on_face) {
  return std::clamp(kSamplesPerSpan * std::max(space.spans(), on_face.spans()), kLeastSamples,
                    kMostSamples);
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

double gap_between(const SpaceCurve& space, const FaceCurve& on_face, const Ends& ends) {
  if (space.known() && on_face.is(space)) return 0.0;
  const int samples = sample_count(space, on_face);
  double largest = 0.0;
  for (int k = 0; k <= samples; ++k) {
    const double fraction = static_cast<double>(k) / samples;
    const gp_Pnt point = on_face.at(fraction);
    largest = std::max(
        largest, space.known() ? space.at(fraction).Distance(point) : distance(ends.first, point));
  }
  return largest;
}

}  // namespace

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
    if (!space.known()) continue;
    const Ends ends(edge);
    vertex_gap(ends.first, space.at(0.0));
    vertex_gap(ends.last, space.at(1.0));
  }
  for (TopExp_Explorer f(shape, TopAbs_FACE); f.More(); f.Next()) {
    const auto& face = TopoDS::Face(f.Current());
    for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next()) {
      const auto& edge = TopoDS::Edge(e.Current());
      double& gap = gaps.edges[static_cast<size_t>(edges.FindIndex(edge)) - 1];
      const FaceCurve on_face(edge, face);
      if (!on_face.known()) continue;
      const Ends ends(edge);
      gap = std::max(gap, gap_between(SpaceCurve(edge), on_face, ends));
      vertex_gap(ends.first, on_face.at(0.0));
      vertex_gap(ends.last, on_face.at(1.0));
    }
  }
  return gaps;
}

}  // namespace isochor::internal
