#include "isochor/step/flux.h"

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

double FaceIntegrals::bound_about_zero(double z0) const {
  return bound + std::abs(z0) * projected_bound;
}

FaceIntegrals integrate_face(const Handle(Geom_Surface) & surface,
                             const std::vector<FaceLoop>& loops, TrimKind kind, bool reversed,
                             double z0, const FluxField& field) {
  const auto region = integrate_region(surface, loops, kind, FluxKind{z0, field});
  const FluxSums& sums = region.sums;
  const double sign = reversed ? -1.0 : 1.0;
  FaceIntegrals result;
  result.flux = sign * static_cast<double>(sums.flux);
  result.projected = sign * static_cast<double>(sums.projected);
  result.area = static_cast<double>(sums.area);
  const double unknown = region.closed ? 0.0 : std::numeric_limits<double>::infinity();
  result.bound = static_cast<double>(region.errors.flux) +
                 4.0 * kUnitRoundoff * static_cast<double>(sums.noise) + unknown;
  result.projected_bound = static_cast<double>(region.errors.projected) +
                           4.0 * kUnitRoundoff * static_cast<double>(sums.projected_noise) +
                           unknown;
  return result;
}

FaceIntegrals integrate_face(const TopoDS_Face& face, double z0, double distance,
                             const FluxField& field) {
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  const std::vector<FaceLoop> loops = face_loops(face);
  const TrimKind kind = classify_sides(surface, loops, distance).kind;
  return integrate_face(surface, loops, kind, face.Orientation() == TopAbs_REVERSED, z0, field);
}

ShapeIntegrals integrate_shape(const TopoDS_Shape& shape, const std::optional<FluxField>& field) {
  ShapeIntegrals result;
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  double diagonal = 0.0;
  if (!box.IsVoid()) {
    if (!field) result.z0 = 0.5 * (box.CornerMin().Z() + box.CornerMax().Z());
    diagonal = box.CornerMin().Distance(box.CornerMax());
  }
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    result.faces.push_back(integrate_face(TopoDS::Face(it.Current()), result.z0,
                                          kSideDistance * diagonal, field.value_or(FluxField{})));
    result.volume += result.faces.back().flux;
    result.bound += result.faces.back().bound;
    result.area += result.faces.back().area;
  }
  return result;
}

}  // namespace isochor::internal
