#include "isochor/step/solid_section.h"

#include <BRepBndLib.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <gp_Ax3.hxx>
#include <limits>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/step/contour.h"

namespace isochor::internal {
namespace {

// Roundings of a height, relative to the distance from the plane's origin; and of a sum of a rule.
constexpr double kHeightNoise = 128 * kUnitRoundoff;
constexpr double kSumNoise = 64 * kUnitRoundoff;

gp_Dir direction(const Vec3& v) { return gp_Dir(v.x(), v.y(), v.z()); }

// What all faces have below the plane, in the plane's frame.
struct Below {
  std::array<double, 3> value{}, error{};
  bool coplanar = false;
};

void add_face(const TopoDS_Face& face, const gp_Trsf& to_frame, double noise, double distance,
              Below& below) {
  const Handle(Geom_Surface) placed = BRep_Tool::Surface(face);
  const auto surface = Handle(Geom_Surface)::DownCast(placed->Transformed(to_frame));
  SectionIntegrand integrand(surface, noise);
  below.coplanar = below.coplanar || integrand.coplanar();
  if (integrand.above() || integrand.coplanar()) return;
  const std::vector<FaceLoop> loops = face_loops(face);
  const TrimKind trim = classify_sides(placed, loops, distance).kind;
  const auto region = integrate_region(surface, loops, trim, integrand);
  const double sign = face.Orientation() == TopAbs_REVERSED ? -1.0 : 1.0;
  const double unknown = region.closed ? 0.0 : std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < 3; ++k) {
    below.value[k] += sign * static_cast<double>(region.sums.value[k]);
    below.error[k] += static_cast<double>(region.errors.value[k]) +
                      kSumNoise * static_cast<double>(region.sums.noise) + unknown;
  }
}

}  // namespace

std::optional<ShapeFrame> shape_frame(const TopoDS_Shape& shape, const Vec3& normal,
                                      double height) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  if (box.IsVoid()) return std::nullopt;
  const gp_XYZ middle = 0.5 * box.CornerMin().XYZ() + 0.5 * box.CornerMax().XYZ();
  ShapeFrame result;
  result.diagonal = box.CornerMin().Distance(box.CornerMax());
  Vec3 origin(middle.X(), middle.Y(), middle.Z());
  origin += (height - normal.dot(origin)) * normal;
  const Vec3 across = normal.unitOrthogonal();
  result.frame.axes << across.transpose(), normal.cross(across).transpose(), normal.transpose();
  result.frame.origin = origin;
  result.to_frame.SetTransformation(
      gp_Ax3(gp_Pnt(origin.x(), origin.y(), origin.z()), direction(normal), direction(across)));
  result.noise = kHeightNoise * result.diagonal + 4 * kUnitRoundoff * origin.norm();
  const Bnd_Box seen = box.Transformed(result.to_frame);
  result.low = seen.CornerMin().Z();
  result.high = seen.CornerMax().Z();
  return result;
}

Section shape_section(const TopoDS_Shape& shape, const Vec3& normal, double height) {
  const double length = normal.norm();
  ISOCHOR_REQUIRE(length > 0.0 && std::isfinite(length) && std::isfinite(height), length, height);
  Section result;
  result.normal = normal / length;
  result.height = height / length;
  const std::optional<ShapeFrame> seen = shape_frame(shape, result.normal, result.height);
  if (!seen) return result;
  const double diagonal = seen->diagonal, noise = seen->noise;
  Below below;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    add_face(TopoDS::Face(it.Current()), seen->to_frame, noise, kSideDistance * diagonal, below);
  }
  result.coplanar = below.coplanar;
  result.area = -below.value[0] + 0.0;
  // Heights are known up to the noise: a rim of that width around the section, which is about four
  // diagonals long.
  result.bound = below.error[0] + 4.0 * noise * diagonal;
  result.centroid = seen->frame.origin;
  result.centroid_bound = std::numeric_limits<double>::infinity();
  const double least = std::abs(result.area) - result.bound;
  if (least > 0.0) {
    const double x = -below.value[1] / result.area, y = -below.value[2] / result.area;
    result.centroid += seen->frame.axes.transpose() * Vec3(x, y, 0.0);
    result.centroid_bound = (below.error[1] + below.error[2] + 4.0 * diagonal * noise * diagonal +
                             std::hypot(x, y) * result.bound) /
                                least +
                            8 * kUnitRoundoff * result.centroid.norm();
  }
  return result;
}

}  // namespace isochor::internal
