// Edited geometry put into the text of a STEP file, line by line. Internal to `step`; no
// OpenCASCADE.
//
// Topology does not change, so an edit is new points, sometimes new curves and surfaces, and
// references that name them in place of the old. Where the basis stays and nobody else uses a
// surface or curve, the references to its moved poles are changed in place; else a new instance is
// appended and its users are re-pointed.
//
// Laws:
//  (1) every line of the file is in the result, except those in which references changed (and
//      stated volumes, areas and centroids);
//  (2) geometry of faces, edges and vertices that are not named in the edit does not change;
//  (3) poles, points and curves that have not moved keep their instances.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/bspline/surface.h"
#include "isochor/step/part21.h"
#include "isochor/step/part21_splines.h"
#include "isochor/step/surgical_properties.h"

namespace isochor::internal {

// All coordinates are those of the part, as the file states them. Entity numbers are 12 for #12,
// 0 when not known.
struct MovedSurface {
  std::string handle;        // for messages
  std::uint64_t entity = 0;  // the face, or the surface itself of a face that is only a surface
  bool converted = false;    // the file has another kind of surface
  Surface before, after;
};
struct MovedCurve {
  std::uint64_t edge = 0;
  SplineValue curve;
  std::array<Vec3, 2> ends;  // before the edit
  double near = 0.0;         // ends may be off by this
};
struct MovedPoint {
  std::uint64_t vertex = 0;
  Vec3 before, after;
  double near = 0.0;
};

struct SurgicalEdit {
  std::vector<MovedSurface> surfaces;
  std::vector<MovedCurve> curves;
  std::vector<MovedPoint> points;
  MeasureChange measures;  // of the whole file
  // Edges and vertices of the edited faces that are known to be what they are in the file; the
  // others are matched by place.
  std::set<std::uint64_t> known_edges, known_vertices;
};

struct SurgicalText {
  std::string refusal;  // why it cannot be done, in words; else empty
  std::string text;     // of the new file
  int lines_appended = 0, lines_repointed = 0;
  std::vector<std::string> notices;
};

// Throws InputError where the file breaks the grammar or a rule of the schema.
SurgicalText edit_text(const Part21File& file, const SurgicalEdit& edit);

}  // namespace isochor::internal
