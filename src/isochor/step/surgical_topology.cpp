#include "isochor/step/surgical_topology.h"

#include "isochor/base/error.h"

namespace isochor::internal {
namespace {

// Wrappers around one surface; more is a circle.
constexpr int kMostWrappers = 8;

bool is_face(std::string_view keyword) {
  return keyword == "ADVANCED_FACE" || keyword == "FACE_SURFACE";
}

bool has_parameter_curves(std::string_view keyword) {
  return keyword == "SURFACE_CURVE" || keyword == "SEAM_CURVE" || keyword == "INTERSECTION_CURVE" ||
         keyword == "BOUNDED_SURFACE_CURVE";
}

std::string name_of(const Part21Instance& instance) {
  return "#" + std::to_string(instance.number);
}

class Walker {
 public:
  explicit Walker(const Part21File& file) : file_(file) {}

  const Part21Value& argument(const Part21Record& record, const Part21Instance& instance,
                              size_t k) const {
    if (k < record.arguments.size()) return record.arguments[k];
    file_.refuse(instance.span.begin, name_of(instance) + " has too few arguments");
  }

  const Part21Instance& follow(const Part21Instance& from, std::string_view keyword,
                               size_t k) const {
    return file_.follow(from, argument(file_.record(from, keyword), from, k));
  }

  EdgeText edge(const Part21Instance& instance) const {
    EdgeText found;
    found.edge = found.holder = &instance;
    const auto record = file_.record(instance, "EDGE_CURVE");
    found.ends[0] = &file_.follow(instance, argument(record, instance, 1));
    found.ends[1] = &file_.follow(instance, argument(record, instance, 2));
    found.reference = argument(record, instance, 3);
    found.curve = &file_.follow(instance, found.reference);
    if (!has_parameter_curves(found.curve->keyword)) return found;
    const Part21Instance& holder = *found.curve;
    const auto curves = file_.record(holder, holder.keyword);
    found.holder = &holder;
    found.reference = argument(curves, holder, 1);
    found.curve = &file_.follow(holder, found.reference);
    for (const auto& item : argument(curves, holder, 2).items) {
      const Part21Instance& pcurve = file_.follow(holder, item);
      if (pcurve.keyword == "PCURVE") found.pcurves.push_back(&pcurve);
    }
    return found;
  }

  void add_vertex(const Part21Instance& instance, BoundaryText& boundary) const {
    auto& vertex = boundary.vertices[instance.number];
    if (vertex.vertex != nullptr) return;
    vertex.reference = argument(file_.record(instance, "VERTEX_POINT"), instance, 1);
    vertex.point = &file_.follow(instance, vertex.reference);
    vertex.vertex = &instance;
  }

  void add_loop(const Part21Instance& loop, BoundaryText& boundary) const {
    if (loop.keyword == "VERTEX_LOOP") return add_vertex(follow(loop, "VERTEX_LOOP", 1), boundary);
    const auto record = file_.record(loop, "EDGE_LOOP");
    for (const auto& item : argument(record, loop, 1).items) {
      const Part21Instance& oriented = file_.follow(loop, item);
      const Part21Instance& curve = follow(oriented, "ORIENTED_EDGE", 3);
      auto& known = boundary.edges[curve.number];
      if (known.edge != nullptr) continue;
      known = edge(curve);
      add_vertex(*known.ends[0], boundary);
      add_vertex(*known.ends[1], boundary);
    }
  }

 private:
  const Part21File& file_;
};

}  // namespace

FaceText face_text(const Part21File& file, std::uint64_t entity) {
  const Part21Instance* instance = file.find(entity);
  if (instance == nullptr) {
    throw InputError(file.path(), "#" + std::to_string(entity), "is not in the file");
  }
  FaceText found;
  found.surface = instance;
  const Walker walker(file);
  if (is_face(instance->keyword)) {
    found.face = found.holder = instance;
    const auto record = file.record(*instance, instance->keyword);
    found.reference = walker.argument(record, *instance, 2);
    found.surface = &file.follow(*instance, found.reference);
  }
  for (int k = 0; found.surface->keyword == "RECTANGULAR_TRIMMED_SURFACE"; ++k) {
    if (k == kMostWrappers) {
      file.refuse(found.surface->span.begin, name_of(*found.surface) + " trims itself");
    }
    found.holder = found.surface;
    found.reference =
        walker.argument(file.record(*found.holder, found.holder->keyword), *found.holder, 1);
    found.surface = &file.follow(*found.holder, found.reference);
  }
  return found;
}

void add_boundary(const Part21File& file, const FaceText& face, BoundaryText& boundary) {
  if (face.face == nullptr) return;
  const Walker walker(file);
  const auto record = file.record(*face.face, face.face->keyword);
  for (const auto& item : walker.argument(record, *face.face, 1).items) {
    const Part21Instance& bound = file.follow(*face.face, item);
    walker.add_loop(walker.follow(bound, bound.keyword, 1), boundary);
  }
}

std::vector<const Part21Instance*> faces_around(const Part21File& file,
                                                const Part21References& references,
                                                const Part21Instance& edge) {
  std::vector<const Part21Instance*> level = {&edge};
  // Oriented edges, loops, bounds, faces.
  for (int step = 0; step < 4; ++step) {
    std::vector<const Part21Instance*> above;
    for (const Part21Instance* instance : level) {
      for (const Part21Use& use : references.to(instance->number)) {
        const Part21Instance& by = file.instances()[use.user];
        const bool right = step == 0   ? by.keyword == "ORIENTED_EDGE"
                           : step == 1 ? by.keyword == "EDGE_LOOP"
                           : step == 2
                               ? by.keyword == "FACE_BOUND" || by.keyword == "FACE_OUTER_BOUND"
                               : is_face(by.keyword);
        if (right) above.push_back(&by);
      }
    }
    level = std::move(above);
  }
  return level;
}

}  // namespace isochor::internal
