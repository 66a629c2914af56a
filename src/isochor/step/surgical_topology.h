// The faces of an edit in the text of a STEP file: their surfaces, edges and vertices. Internal to
// `step`; no OpenCASCADE.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "isochor/step/part21.h"
#include "isochor/step/part21_references.h"

namespace isochor::internal {

// A face, or a surface that stands for one.
struct FaceText {
  const Part21Instance* face = nullptr;     // null: only a surface
  const Part21Instance* holder = nullptr;   // whose argument `reference` is: the face or a wrapper
  Part21Value reference;                    // to the surface; unused when there is no holder
  const Part21Instance* surface = nullptr;  // without wrappers that trim
};

struct EdgeText {
  const Part21Instance* edge = nullptr;    // EDGE_CURVE
  const Part21Instance* holder = nullptr;  // whose argument `reference` is: the edge or its
  Part21Value reference;                   // SURFACE_CURVE or SEAM_CURVE
  const Part21Instance* curve = nullptr;   // in space
  std::vector<const Part21Instance*> pcurves;
  const Part21Instance* ends[2] = {nullptr, nullptr};  // VERTEX_POINT
};

struct VertexText {
  const Part21Instance* vertex = nullptr;  // VERTEX_POINT
  Part21Value reference;                   // to the point
  const Part21Instance* point = nullptr;
};

// All throw InputError when an instance is not what the schema asks for.
FaceText face_text(const Part21File& file, std::uint64_t entity);

// The edges and vertices around faces, each once, by their numbers.
struct BoundaryText {
  std::map<std::uint64_t, EdgeText> edges;
  std::map<std::uint64_t, VertexText> vertices;
};
void add_boundary(const Part21File& file, const FaceText& face, BoundaryText& boundary);

// The faces that use an edge.
std::vector<const Part21Instance*> faces_around(const Part21File& file,
                                                const Part21References& references,
                                                const Part21Instance& edge);

}  // namespace isochor::internal
