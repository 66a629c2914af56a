// A shape's faces and edges in tables: what every later step of reading asks for.
//
// Faces keep the order of the document; edges are numbered by first use. Internal to the step layer
// (OpenCASCADE types).
#pragma once

#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "isochor/step/document.h"
#include "isochor/step/face_loops.h"
#include "isochor/step/face_patches.h"
#include "isochor/step/file_surface.h"
#include "isochor/step/solid_model.h"
#include "isochor/step/trim_region.h"

namespace isochor::internal {

struct FaceRecord {
  TopoDS_Face face;
  FaceSurface surface;
  std::vector<FaceLoop> loops;
  FaceTrim trim;       // of surface.geometry
  std::string shared;  // why its part, used several times, cannot be edited; else empty
  int patch = -1;      // index into PatchModel::patches
  bool reversed() const { return face.Orientation() == TopAbs_REVERSED; }
};

// Where an edge is used.
struct EdgeSite {
  int face = 0, loop = 0, use = 0;
};

struct EdgeRecord {
  TopoDS_Edge edge;
  std::vector<EdgeSite> sites;
};

struct BrepTable {
  TopoDS_Shape shape;
  double diagonal = 0.0;  // of the shape's box
  double z0 = 0.0;        // the middle of its box: where face fluxes are taken from
  std::vector<FaceRecord> faces;
  std::vector<EdgeRecord> edges;

  const EdgeUse& use(const EdgeSite& site) const {
    const FaceRecord& record = faces[static_cast<size_t>(site.face)];
    return record.loops[static_cast<size_t>(site.loop)].uses[static_cast<size_t>(site.use)];
  }
  // "face:5 (plane)"
  std::string label(int face) const;
};

// `faces`: the document's numbering. Patch numbers are left open. `part_names`: the parts of an
// assembly by the faces' TShapes, for messages. `stated`: surfaces that the reader changed, as the
// file states them.
BrepTable brep_table(const TopoDS_Shape& shape, const TopTools_IndexedMapOfShape& faces,
                     const PartNames& part_names = {}, const FileSurfaces& stated = {});

// Fills the tables' edges from the loops of its faces (part of brep_table; again after loops or
// surfaces of faces were replaced).
void collect_edges(BrepTable& table);

}  // namespace isochor::internal
