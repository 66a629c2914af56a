#include "model_picture.h"

#include <algorithm>

#include "busy_line.h"
#include "isochor/base/error.h"
#include "isochor/io/file.h"
#include "isochor/io/image.h"
#include "isochor/picture/edit_picture.h"
#include "isochor/picture/tessellate.h"
#include "terminal.h"
#ifdef ISOCHOR_WITH_OCCT
#include "isochor/step/solid_mesh.h"
#endif

namespace isochor::app {
namespace {

// Adds the faces that are no patches, which no edit moves.
void add_other_faces(const LoadedModel& model, const Common& common, BusyLine& busy, Mesh& mesh,
                     std::vector<LineSet>& lines) {
#ifdef ISOCHOR_WITH_OCCT
  if (!model.solid) return;
  SolidMeshOptions options;
  options.limits = read_options(common, busy).limits;
  options.watch = busy.watch();
  const SolidMesh solid = mesh_solid(model.path, options);
  const auto is_patch = [&](int face) {
    return model.solid->faces[static_cast<size_t>(face)].patch >= 0;
  };
  for (const FaceMesh& face : solid.faces) {
    if (is_patch(face.face)) continue;
    append(mesh, {face.positions, face.normals, {}, face.triangles, {}}, face.face);
  }
  LineSet edges;
  for (const EdgeLine& edge : solid.edges) {  // those of patches are drawn with the patches
    const std::vector<int>& faces = model.solid->edges[static_cast<size_t>(edge.edge)].faces;
    if (std::none_of(faces.begin(), faces.end(), is_patch)) edges.add(edge.points);
  }
  if (!edges.empty()) lines.push_back(std::move(edges));
#else
  (void)model;
  (void)common;
  (void)busy;
  (void)mesh;
  (void)lines;
#endif
}

std::vector<Surface> surfaces_of(const PatchModel& model) {
  std::vector<Surface> surfaces;
  for (size_t q = 0; q < model.patches.size(); ++q)
    surfaces.push_back(model.surface(static_cast<int>(q)));
  return surfaces;
}

}  // namespace

ModelMesh mesh_of(const LoadedModel& model, const Common& common) {
  BusyLine busy(common, "cutting " + model.path + " into triangles");
  ModelMesh result;
  if (!model.patches.patches.empty()) {
    const Tessellator tessellator(model.patches);
    result.mesh = tessellator.mesh();
    result.lines = tessellator.borders();
  }
  add_other_faces(model, common, busy, result.mesh, result.lines);
  return result;
}

void require_picture(const std::string& path) {
  if (extension_of(path) != "png") {
    throw InputError(path, "", "pictures are written as PNG; choose a name that ends in .png");
  }
  require_writable(path);
}

Image draw_edit(const LoadedModel& before, const EditSession& session,
                const std::vector<Certificate>& certificates, const Common& common) {
  BusyLine busy(common, "drawing the edit");
  // Cut on the edited shape, so that the cells are fine enough for it, and evaluated on both.
  const PatchModel& now = session.model();
  const std::vector<Surface> then = surfaces_of(before.patches);
  const Tessellator tessellator(now);
  PictureInput input;
  input.before = tessellator.mesh(then);
  input.after = tessellator.mesh();
  input.before_lines = tessellator.borders(then);
  input.after_lines = tessellator.borders();
  Mesh others;
  std::vector<LineSet> edges;
  add_other_faces(before, common, busy, others, edges);
  if (!others.empty()) {
    append(input.before, others, 0);
    append(input.after, others, 0);
  }
  for (const LineSet& lines : edges) {
    input.before_lines.push_back(lines);
    input.after_lines.push_back(lines);
  }
  input.unit = before.patches.unit;
  for (const Certificate& certificate : certificates) {
    for (const MoveRecord& move : certificate.moves) {
      input.moves.emplace_back(move.from, move.from + move.got);
    }
    input.title += (input.title.empty() ? "" : ", ") + certificate.name;
  }
  if (!input.moves.empty()) {
    const Vec3 point = input.moves.front().first;
    // The outward normal at the moved place: that of the nearest vertex of the picture.
    size_t nearest = 0;
    for (size_t k = 1; k < input.before.positions.size(); ++k) {
      if ((input.before.positions[k] - point).squaredNorm() <
          (input.before.positions[nearest] - point).squaredNorm()) {
        nearest = k;
      }
    }
    input.focus = Focus{point, input.before.normals[nearest]};
  }
  const VolumeRecord& first = certificates.front().volume;
  const VolumeRecord& last = certificates.back().volume;
  double change = 0.0;  // the sum keeps what the difference of two large volumes would lose
  for (const Certificate& certificate : certificates) {
    change += certificate.volume.relative_change * certificate.volume.before / first.before;
  }
  const char* unit = input.unit.c_str();
  input.caption = {format("volume before %.12g %s\u00b3", first.before, unit),
                   format("volume after %.12g %s\u00b3", last.after, unit),
                   format("relative change %.2g", change)};
  return edit_picture(input);
}

}  // namespace isochor::app
