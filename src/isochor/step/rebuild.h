// Puts edited surfaces into a shape: faces, edges and vertices follow, everything else stays.
// Internal to `step`.
//
// Laws:
//  (1) parameter curves, tolerances, orientation and topology stay as they were;
//  (2) faces keep their numbers, and labels their names and colours;
//  (3) the result is not trusted: callers measure it before it is written (see write_edited).
#pragma once

#include <string>
#include <vector>

#include "isochor/step/document.h"
#include "isochor/step/file_surface.h"
#include "isochor/step/rebuild_plan.h"
#include "isochor/step/solid_model.h"

namespace isochor::internal {

// Changes the document; `convert` as in ReadOptions. Returns why it cannot be done, in words, or
// nothing; then the document may be half changed and must be dropped. Throws PreconditionError when
// a face number is out of range. `plans`, when given, receives what was done to each part.
// `trim_tolerance`: as in write_edited.
[[nodiscard]] std::string rebuild(Document& document, const std::vector<EditedFace>& faces,
                                  const std::vector<int>& convert = {},
                                  std::vector<RebuildPlan>* plans = nullptr,
                                  double trim_tolerance = 0.0);

// `surface`, given in the document's coordinates, in those of the face's own surface. Poles that
// have not moved get the old pole itself, because transforming there and back would round. `stated`
// are the surfaces that the reader changed; `face` is number `k` of the document.
Surface local_surface(const Surface& surface, const TopoDS_Face& face, int k = -1,
                      const FileSurfaces& stated = {});

// One part only, without labels: for a plan that has no refusal.
TopoDS_Shape rebuild_part(const TopoDS_Shape& part, const RebuildPlan& plan);

}  // namespace isochor::internal
