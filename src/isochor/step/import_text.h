// The shapes that the text of a STEP file states, entity by entity. Internal to `step`; no
// OpenCASCADE.
//
// Faces are those that a shape representation leads to: ADVANCED_FACE and FACE_SURFACE, and the
// surfaces that geometric sets list. One that only a colour or nothing refers to is unused.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "isochor/step/import_account.h"
#include "isochor/step/part21.h"

namespace isochor::internal {

struct StatedFace {
  std::uint64_t number = 0;
  size_t place = 0;  // among the instances of the file
  std::string text;  // "#123 (line 45, ADVANCED_FACE)"
};

struct StatedShapes {
  bool readable = true;  // false: only `broken` and a rough number of faces are known
  int entities = 0;
  ShapeCounts counts;
  std::vector<StatedFace> faces;    // in file order
  std::vector<std::string> unused;  // faces no shape leads to
  // References that lead nowhere, points whose coordinates are no numbers, and what else breaks the
  // rules; the first of many, and how many more.
  std::vector<std::string> broken;
};

StatedShapes stated_shapes(const Part21File& file);

// The same of a file; text that cannot be read at all is broken, with the reason, and
// its faces are counted by their keywords.
StatedShapes stated_shapes(const std::string& path);

}  // namespace isochor::internal
