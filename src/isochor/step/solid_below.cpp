#include "isochor/step/solid_below.h"

#include <BRepBndLib.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <limits>

#include "isochor/base/tolerance.h"
#include "isochor/step/contour.h"
#include "isochor/step/solid_section.h"

namespace isochor::internal {
namespace {

// Roundings of a sum of a rule.
constexpr double kSumNoise = 64 * kUnitRoundoff;
// The shape may end below the plane although its box does not when only this part of the box is
// above.
constexpr double kLooseBox = 0.1;

// The true error is rarely more than the last difference of two rules, but it can be: where a kink
// lies, both may be wrong alike.
constexpr double kDoubt = 8.0;

struct Sums {
  std::array<double, 4> value{}, error{};
};

void add_face(const TopoDS_Face& face, const ShapeFrame& seen, const FrameField& field,
              Sums& sums) {
  const Handle(Geom_Surface) placed = BRep_Tool::Surface(face);
  const auto surface = Handle(Geom_Surface)::DownCast(placed->Transformed(seen.to_frame));
  SectionIntegrand integrand(surface, seen.noise, field);
  if (integrand.above() || integrand.coplanar()) return;
  const std::vector<FaceLoop> loops = face_loops(face);
  const TrimKind trim = classify_sides(placed, loops, kSideDistance * seen.diagonal).kind;
  const auto region = integrate_region(surface, loops, trim, integrand);
  const double sign = face.Orientation() == TopAbs_REVERSED ? -1.0 : 1.0;
  const double unknown = region.closed ? 0.0 : std::numeric_limits<double>::infinity();
  const double noise = kSumNoise * static_cast<double>(region.sums.noise);
  for (size_t k = 0; k < 4; ++k) {
    sums.value[k] += sign * static_cast<double>(region.sums.value[k]);
    sums.error[k] += kDoubt * static_cast<double>(region.errors.value[k]) +
                     noise * (k == 0 ? 1.0 : seen.diagonal) + unknown;
  }
}

Sums all_faces(const TopoDS_Shape& shape, const ShapeFrame& seen, const FrameField& field) {
  Sums sums;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    add_face(TopoDS::Face(it.Current()), seen, field, sums);
  }
  // Heights are known up to the noise: a rim of that width around the waterline, which is about
  // four diagonals long. Where the field vanishes there, this counts by its square.
  const double farthest = field.on_waterline ? seen.noise : seen.diagonal;
  const double rim =
      4.0 * seen.noise * seen.diagonal * field.slope.norm() * farthest * field.direction.norm();
  for (size_t k = 0; k < 4; ++k) sums.error[k] += rim * (k == 0 ? 1.0 : seen.diagonal);
  return sums;
}

FrameField lanes_for(const FluxField& field, const ShapeFrame& seen) {
  FrameField result = in_frame(field, seen.frame);
  result.lever = seen.diagonal;
  return result;
}

std::vector<ClosingPlane> caps_near(const TopoDS_Shape& shape, const ClosingPlane& plane,
                                    const std::vector<ClosingPlane>& closing) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  if (box.IsVoid()) return closing;
  const gp_Pnt low = box.CornerMin(), high = box.CornerMax();
  return caps_below(plane, closing, Vec3(low.X(), low.Y(), low.Z()),
                    Vec3(high.X(), high.Y(), high.Z()));
}

// Whether all of the shape is below although its box is not.
bool nothing_above(const TopoDS_Shape& shape, const ClosingPlane& plane,
                   const std::vector<ClosingPlane>& closing) {
  const ClosingPlane opposite{-plane.normal, -plane.offset, false};
  const std::optional<FluxField> field = field_below(opposite, closing);
  const auto seen = shape_frame(shape, opposite.normal, opposite.offset);
  if (!field || !seen) return false;
  const Sums above = all_faces(shape, *seen, lanes_for(*field, *seen));
  return std::abs(above.value[0]) <= above.error[0];
}

}  // namespace

PartBelow shape_below(const TopoDS_Shape& shape, const ClosingPlane& plane,
                      const std::vector<ClosingPlane>& closing) {
  PartBelow part;
  part.normal = plane.normal;
  part.height = plane.offset;
  part.centroid_bound = std::numeric_limits<double>::infinity();
  const std::vector<ClosingPlane> caps = caps_near(shape, plane, closing);
  const FluxField field = require_field_below(plane, caps);
  const std::optional<ShapeFrame> seen = shape_frame(shape, plane.normal, plane.offset);
  if (!seen || seen->low >= 0.0) return part;
  const Sums sums = all_faces(shape, *seen, lanes_for(field, *seen));
  part.volume = sums.value[0];
  part.bound = sums.error[0];
  // What is not different from zero within its bound lies in the plane, or above.
  if (std::abs(part.volume) <= part.bound) {
    if (std::isfinite(part.bound)) return part;
    part.side = PlaneSide::kCut;
    return part;
  }
  const bool perhaps = seen->high <= kLooseBox * (seen->high - seen->low);
  const bool everything = seen->high <= 0.0 || (perhaps && nothing_above(shape, plane, closing));
  part.side = everything ? PlaneSide::kEverything : PlaneSide::kCut;
  set_centroid(seen->frame.axes.transpose() * Vec3(sums.value[1], sums.value[2], sums.value[3]),
               Vec3(sums.error[1], sums.error[2], sums.error[3]), seen->frame.origin, part);
  return part;
}

}  // namespace isochor::internal
