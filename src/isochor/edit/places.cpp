#include "isochor/edit/places.h"

#include <algorithm>
#include <sstream>

#include "isochor/base/error.h"
#include "isochor/bspline/closest_point.h"
#include "isochor/bspline/joins.h"
#include "isochor/bspline/trims.h"
#include "isochor/edit/names.h"

namespace isochor {
namespace {

Uv parameters_of(const Patch& patch, const Place& place, const std::string& where) {
  const KnotVector& u = patch.u_knots;
  const KnotVector& v = patch.v_knots;
  Uv uv = place.uv;
  if (place.normalised) {
    const bool inside = 0.0 <= uv.u && uv.u <= 1.0 && 0.0 <= uv.v && uv.v <= 1.0;
    if (!inside) throw InputError("", where, "uv01 " + text_of(uv) + " is outside [0, 1] x [0, 1]");
    uv = {u.begin() + uv.u * (u.end() - u.begin()), v.begin() + uv.v * (v.end() - v.begin())};
    uv = {std::min(uv.u, u.end()), std::min(uv.v, v.end())};
  } else if (!(u.begin() <= uv.u && uv.u <= u.end() && v.begin() <= uv.v && uv.v <= v.end())) {
    std::ostringstream text;
    text << "uv " << text_of(uv) << " is outside the domain [" << u.begin() << ", " << u.end()
         << "] x [" << v.begin() << ", " << v.end() << "] of " << label_of(patch);
    throw InputError("", where, text.str());
  }
  if (!inside_trim(patch.trim, uv.u, uv.v)) {
    throw InputError(
        "", where,
        "uv " + text_of(uv) + " lies in a part of " + label_of(patch) + " that is trimmed away");
  }
  return uv;
}

}  // namespace

SurfacePlace surface_place(const PatchModel& model, const Place& place, const std::string& where) {
  ISOCHOR_REQUIRE(place.kind != Place::Kind::kCoefficient, where);
  if (place.kind == Place::Kind::kSurface) {
    const int patch = find_patch(model, place.patch);
    return {patch, parameters_of(model.patches[static_cast<size_t>(patch)], place, where)};
  }
  const ClosestPoint found = closest_point(model, place.near);
  if (found.patch < 0) throw InputError("", where, "the model has no surface to be near to");
  return {found.patch, found.uv};
}

std::string text_of(const Uv& uv) {
  std::ostringstream text;
  text.precision(6);
  text << "(" << uv.u << ", " << uv.v << ")";
  return text.str();
}

}  // namespace isochor
