#include "isochor/step/brep_table.h"

#include <BRepBndLib.hxx>
#include <Bnd_Box.hxx>
#include <TopoDS.hxx>
#include <map>

#include "isochor/base/tolerance.h"

namespace isochor::internal {

std::string BrepTable::label(int face) const {
  return "face:" + std::to_string(face + 1) + " (" + faces[static_cast<size_t>(face)].surface.kind +
         ")";
}

void collect_edges(BrepTable& table) {
  table.edges.clear();
  TopTools_IndexedMapOfShape known;
  for (size_t f = 0; f < table.faces.size(); ++f) {
    const auto& loops = table.faces[f].loops;
    for (size_t l = 0; l < loops.size(); ++l) {
      for (size_t k = 0; k < loops[l].uses.size(); ++k) {
        const TopoDS_Edge& edge = loops[l].uses[k].edge;
        const auto index = static_cast<size_t>(known.Add(edge)) - 1;
        if (index == table.edges.size()) table.edges.push_back({edge, {}});
        table.edges[index].sites.push_back(
            {static_cast<int>(f), static_cast<int>(l), static_cast<int>(k)});
      }
    }
  }
}

namespace {

void refuse_shared(FaceRecord& record, int places, const PartNames& part_names) {
  if (places == 1) return;
  record.shared = "it belongs to " + used_part(record.face, places, part_names);
  record.surface.surface.reset();
  std::string& refusal = record.surface.refusal;
  refusal = record.surface.bspline ? record.shared : refusal + "; " + record.shared;
}

}  // namespace

BrepTable brep_table(const TopoDS_Shape& shape, const TopTools_IndexedMapOfShape& faces,
                     const PartNames& part_names, const FileSurfaces& stated) {
  BrepTable table;
  table.shape = shape;
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  if (!box.IsVoid() && !box.IsOpen()) {
    table.z0 = 0.5 * (box.CornerMin().Z() + box.CornerMax().Z());
    table.diagonal = box.CornerMin().Distance(box.CornerMax());
  }
  std::map<const void*, int> places;
  for (int k = 1; k <= faces.Extent(); ++k) ++places[faces(k).TShape().get()];
  table.faces.reserve(static_cast<size_t>(faces.Extent()));
  for (int k = 1; k <= faces.Extent(); ++k) {
    FaceRecord record;
    record.face = TopoDS::Face(faces(k));
    const auto own = stated.find(k - 1);
    record.surface = face_surface(record.face, own == stated.end() ? nullptr : &own->second);
    record.loops = face_loops(record.face);
    refuse_shared(record, places[record.face.TShape().get()], part_names);
    if (!record.surface.geometry.IsNull()) {
      const double distance = kSideDistance * table.diagonal;
      record.trim = record.surface.surface
                        ? classify_trim(record.surface.geometry, record.loops, distance)
                        : classify_sides(record.surface.geometry, record.loops, distance);
    }
    table.faces.push_back(std::move(record));
  }
  collect_edges(table);
  return table;
}

}  // namespace isochor::internal
