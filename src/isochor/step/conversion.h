// Faces that are not B-spline, as B-spline surfaces with the same parameters.
//
// Only the surface changes: a face keeps its edges and their parameter curves, so the point at each
// (u, v) must stay where it is. Planes and extruded curves allow that exactly. Surfaces with
// circles do not: no B-spline runs along a circle with the angle as its parameter.
//
// Laws:
//  (1) |converted(u, v) - original(u, v)| <= kSameSurface * diagonal all over the face's box;
//  (2) the result is bicubic in the directions that were straight, so that edits are smooth.
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include <Geom_BSplineSurface.hxx>
#include <optional>
#include <string>

#include "isochor/step/brep_table.h"

namespace isochor::internal {

struct Conversion {
  Handle(Geom_BSplineSurface) surface;  // null: see `refusal`
  std::string refusal;                  // why not, in words
};

// `diagonal` of the shape. Faces that are B-spline already are refused.
Conversion convert_face(const FaceRecord& face, double diagonal);

// Turns these faces of the table (0-based) into B-spline faces. Returns why one cannot be, with its
// handle, or nothing. Throws PreconditionError when a number is out of range.
[[nodiscard]] std::string convert_faces(BrepTable& table, const std::vector<int>& faces);

// B-spline faces that use a box of their surface's parameters get the surface of that box alone
// (cut_box.h): their sides are natural then, and join like all others. The edges and parameter
// curves stay, because the parameters do.
void cut_iso_boxes(BrepTable& table);

// The same for the surface of a face that comes back from an edit: `whole` cut to the domain of
// `edited`; nothing when that is its own domain already, or not inside it.
std::optional<Surface> cut_like(const Surface& whole, const Surface& edited);

}  // namespace isochor::internal
