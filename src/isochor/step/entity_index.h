// Which entities of a STEP file became which faces, edges and vertices. Internal to `step`.
//
// OpenCASCADE records what each entity became; that is searched once and kept by TShape, because a
// part may stand in several places of an assembly.
#pragma once

#include <Standard_Transient.hxx>
#include <TopoDS_Shape.hxx>
#include <cstdint>
#include <unordered_map>

#include "isochor/step/document.h"

namespace isochor::internal {

class EntityIndex {
 public:
  // Empty unless the document was read from a STEP file. O(entities).
  explicit EntityIndex(const Document& document);

  // The face (FACE_SURFACE, ADVANCED_FACE or a surface that stands alone), edge (EDGE_CURVE) or
  // vertex (VERTEX_POINT) that became this shape, whatever its place and orientation; null when not
  // known.
  Handle(Standard_Transient) entity(const TopoDS_Shape& shape) const;
  // Its number in the file, 12 for #12; 0 when not known.
  std::uint64_t number(const TopoDS_Shape& shape) const;

 private:
  struct Entry {
    Handle(Standard_Transient) entity;
    std::uint64_t number = 0;
  };
  std::unordered_map<const void*, Entry> by_shape_;
};

}  // namespace isochor::internal
