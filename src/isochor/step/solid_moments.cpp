#include "isochor/step/solid_moments.h"

#include <BRepBndLib.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <limits>

#include "isochor/base/tolerance.h"
#include "isochor/step/contour.h"

namespace isochor::internal {
namespace {

// Adds one face, in units of the kind's length.
void add_face(const TopoDS_Face& face, double distance, const MomentKind& kind, MomentArray& value,
              MomentArray& bound) {
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  const std::vector<FaceLoop> loops = face_loops(face);
  const TrimKind trim = classify_sides(surface, loops, distance).kind;
  const auto region = integrate_region(surface, loops, trim, kind);
  const double sign = face.Orientation() == TopAbs_REVERSED ? -1.0 : 1.0;
  const double unknown = region.closed ? 0.0 : std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < kMomentCount; ++k) {
    value[k] += sign * static_cast<double>(region.sums.value[k]);
    bound[k] += static_cast<double>(region.errors.value[k]) +
                4.0 * kUnitRoundoff * region.sums.noise[k] + unknown;
  }
}

}  // namespace

MomentIntegrals shape_moments(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  if (box.IsVoid()) return {};
  const gp_XYZ middle = 0.5 * box.CornerMin().XYZ() + 0.5 * box.CornerMax().XYZ();
  return shape_moments(shape, Vec3(middle.X(), middle.Y(), middle.Z()));
}

MomentIntegrals shape_moments(const TopoDS_Shape& shape, const Vec3& origin) {
  MomentIntegrals result;
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  if (box.IsVoid()) return result;
  const gp_XYZ low = box.CornerMin().XYZ();
  const gp_XYZ high = box.CornerMax().XYZ();
  const double diagonal = (high - low).Modulus();
  result.origin = origin;
  // A power of two: no rounding when lengths are scaled.
  const MomentKind kind{result.origin, std::exp2(std::ilogb(0.5 * diagonal))};
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    add_face(TopoDS::Face(it.Current()), kSideDistance * diagonal, kind, result.value,
             result.bound);
  }
  for (size_t k = 0; k < kMomentCount; ++k) {
    const int power = k == 0 ? 0 : k < 4 ? 1 : 2;
    const double factor = std::pow(kind.length, power + 1) / (power + 3);
    result.value[k] *= factor;
    result.bound[k] = result.bound[k] * factor + 3.0 * kUnitRoundoff * std::abs(result.value[k]);
  }
  return result;
}

}  // namespace isochor::internal
