// Edits for the tests: poles at one place of a shape move together, in all faces that have them.
#pragma once

#include <BRep_Tool.hxx>
#include <vector>

#include "isochor/step/document.h"
#include "isochor/step/occt_surface.h"
#include "isochor/step/solid_model.h"

namespace isochor::shapes {

// Moves every pole within 1e-9 of `place` by `move`. Faces without such a pole are left out.
inline std::vector<EditedFace> pull(const internal::Document& document, const Vec3& place,
                                    const Vec3& move) {
  std::vector<EditedFace> edits;
  for (int f = 0; f < document.face_count(); ++f) {
    const auto spline = internal::plain_bspline(document.face(f));
    if (spline.IsNull()) continue;
    TopLoc_Location location;
    BRep_Tool::Surface(document.face(f), location);
    spline->Transform(location.Transformation());
    const Surface old = internal::from_occt(*spline);
    std::vector<Vec3> poles = old.poles();
    bool moved = false;
    for (Vec3& p : poles) {
      if ((p - place).norm() > 1e-9) continue;
      p += move;
      moved = true;
    }
    if (!moved) continue;
    edits.push_back({f, Surface(old.u_knots(), old.v_knots(), poles, old.weights())});
  }
  return edits;
}

// Pole (i, j) of a face, in the document's coordinates.
inline Vec3 pole_of(const internal::Document& document, int face, int i, int j) {
  TopLoc_Location location;
  BRep_Tool::Surface(document.face(face), location);
  const auto spline = internal::plain_bspline(document.face(face));
  const gp_Pnt p = spline->Pole(i + 1, j + 1).Transformed(location.Transformation());
  return {p.X(), p.Y(), p.Z()};
}

}  // namespace isochor::shapes
