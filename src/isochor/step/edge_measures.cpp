#include "isochor/step/edge_measures.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRep_Tool.hxx>
#include <GCPnts_AbscissaPoint.hxx>
#include <algorithm>
#include <array>
#include <cmath>

#include "isochor/base/tolerance.h"
#include "isochor/bspline/smoothness.h"

namespace isochor::internal {
namespace {

constexpr int kSamples = 24;

// A face at one point of its edge.
struct Sheet {
  gp_Pnt point;
  gp_Vec normal;  // outward, unit; zero where the parametrisation is singular
  gp_Vec du, dv, duu, dvv, duv;
};

Sheet sheet_at(const FaceRecord& face, const EdgeUse& use, double t) {
  Sheet sheet;
  const gp_Pnt2d at = use.curve->Value(t);
  face.surface.geometry->D2(at.X(), at.Y(), sheet.point, sheet.du, sheet.dv, sheet.duu, sheet.dvv,
                            sheet.duv);
  gp_Vec normal = sheet.du.Crossed(sheet.dv);
  const double size = normal.Magnitude();
  // Near a pole one derivative vanishes: its direction is rounding noise.
  if (size <= kCoincident * sheet.du.Magnitude() * sheet.dv.Magnitude() || size == 0.0) {
    return sheet;
  }
  sheet.normal = normal / (face.reversed() ? -size : size);
  return sheet;
}

// The normal curvature of a sheet in the unit tangent direction d.
double curvature(const Sheet& s, const gp_Vec& d) {
  const double e = s.du.Dot(s.du);
  const double f = s.du.Dot(s.dv);
  const double g = s.dv.Dot(s.dv);
  const double det = e * g - f * f;
  const double a = (d.Dot(s.du) * g - d.Dot(s.dv) * f) / det;
  const double b = (d.Dot(s.dv) * e - d.Dot(s.du) * f) / det;
  return s.normal.Dot(s.duu * (a * a) + s.duv * (2.0 * a * b) + s.dvv * (b * b));
}

// Where the edge's own parameter t is on its curve on a surface.
double pcurve_parameter(const EdgeUse& use, double s) {
  return use.first + (use.last - use.first) * s;
}

double largest_gap(const BrepTable& table, const EdgeRecord& record,
                   const BRepAdaptor_Curve& curve) {
  double gap = 0.0;
  const double first = curve.FirstParameter();
  const double last = curve.LastParameter();
  std::array<gp_Pnt, kSamples + 1> points;
  for (int k = 0; k <= kSamples; ++k) {
    points[static_cast<size_t>(k)] =
        curve.Value(first + (last - first) * (static_cast<double>(k) / kSamples));
  }
  for (const EdgeSite& site : record.sites) {
    const EdgeUse& use = table.use(site);
    const auto& surface = table.faces[static_cast<size_t>(site.face)].surface.geometry;
    if (use.curve.IsNull() || surface.IsNull()) continue;
    for (int k = 0; k <= kSamples; ++k) {
      const double s = static_cast<double>(k) / kSamples;
      const gp_Pnt2d at = use.curve->Value(pcurve_parameter(use, s));
      gap = std::max(gap, surface->Value(at.X(), at.Y()).Distance(points[static_cast<size_t>(k)]));
    }
  }
  return gap;
}

void measure_smoothness(const BrepTable& table, const EdgeRecord& record,
                        const BRepAdaptor_Curve& curve, EdgeFacts& facts) {
  const EdgeUse& a = table.use(record.sites[0]);
  const EdgeUse& b = table.use(record.sites[1]);
  const FaceRecord& face_a = table.faces[static_cast<size_t>(record.sites[0].face)];
  const FaceRecord& face_b = table.faces[static_cast<size_t>(record.sites[1].face)];
  if (a.curve.IsNull() || b.curve.IsNull()) return;
  double jump = 0.0;
  int measured = 0;
  for (int k = 0; k < kSamples; ++k) {
    const double s = (k + 0.5) / kSamples;
    const Sheet sa = sheet_at(face_a, a, pcurve_parameter(a, s));
    const Sheet sb = sheet_at(face_b, b, pcurve_parameter(b, s));
    gp_Pnt point;
    gp_Vec tangent;
    curve.D1(curve.FirstParameter() + (curve.LastParameter() - curve.FirstParameter()) * s, point,
             tangent);
    if (sa.normal.Magnitude() == 0.0 || sb.normal.Magnitude() == 0.0 ||
        tangent.Magnitude() == 0.0) {
      continue;
    }
    tangent.Normalize();
    facts.max_angle_rad =
        std::max(facts.max_angle_rad,
                 std::atan2(sa.normal.Crossed(sb.normal).Magnitude(), sa.normal.Dot(sb.normal)));
    jump = std::max(jump, std::abs(curvature(sa, sa.normal.Crossed(tangent)) -
                                   curvature(sb, sb.normal.Crossed(tangent))));
    ++measured;
  }
  if (measured > 0) {
    facts.smoothness = classify_smoothness(facts.max_angle_rad, jump, table.diagonal);
  }
}

}  // namespace

EdgeFacts measure_edge(const BrepTable& table, const EdgeRecord& record) {
  EdgeFacts facts;
  for (const EdgeSite& site : record.sites) facts.faces.push_back(site.face);
  facts.degenerated = BRep_Tool::Degenerated(record.edge);
  facts.tolerance = BRep_Tool::Tolerance(record.edge);
  if (facts.degenerated || !BRep_Tool::IsGeometric(record.edge)) return facts;
  const BRepAdaptor_Curve curve(record.edge);
  if (!curve.Is3DCurve()) return facts;
  facts.length = GCPnts_AbscissaPoint::Length(curve);
  constexpr int kSteps = 32;
  for (int k = 0; k <= kSteps; ++k) {
    const double s = static_cast<double>(k) / kSteps;
    const gp_Pnt p = curve.Value((1.0 - s) * curve.FirstParameter() + s * curve.LastParameter());
    facts.points.emplace_back(p.X(), p.Y(), p.Z());
  }
  facts.max_gap = largest_gap(table, record, curve);
  if (record.sites.size() == 2) measure_smoothness(table, record, curve, facts);
  return facts;
}

}  // namespace isochor::internal
