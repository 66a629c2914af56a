// The surface of a face as Isochor edits it.
//
// Laws:
//  (1) poles, weights and knots of surfaces that are not periodic are the file's own bits;
//  (2) periodic surfaces are opened at their origin: same points at the same parameters, unclamped
//      knots, and their last pole rows repeat the first ones (a wrap, see bspline/joins.h);
//  (3) wrappers that only restrict the parameters are looked through: the whole basis surface is
//      the patch, the restriction is the face's trim.
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include <Geom_Surface.hxx>
#include <TopoDS_Face.hxx>
#include <optional>
#include <string>

#include "isochor/bspline/surface.h"

namespace isochor::internal {

struct FaceSurface {
  std::string kind;  // "B-spline 3x3", "rational B-spline 2x2", "plane", "cylinder", ...
  bool bspline = false;
  bool rational = false;
  Handle(Geom_Surface) geometry;   // without wrappers; opened when periodic; in the shape's frame
  std::optional<Surface> surface;  // when the face can be a patch
  std::string refusal;             // when not: why, in words
};

// Whether the face stands where it is stored, or turned and shifted only.
bool moved_rigidly(const TopoDS_Face& face);

// `stated`: the surface as the file states it, in its own coordinates, where a reader made another
// of it (see file_surface.h); else null.
FaceSurface face_surface(const TopoDS_Face& face, const Surface* stated = nullptr);

// The same for a surface alone. `geometry` is left null when `surface` is.
FaceSurface describe_surface(const Handle(Geom_Surface) & surface);

}  // namespace isochor::internal
