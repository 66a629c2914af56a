#include "isochor/step/surgical.h"

#include <algorithm>
#include <map>
#include <optional>

#include "isochor/base/error.h"
#include "isochor/step/part21_edit.h"
#include "isochor/step/part21_references.h"
#include "isochor/step/surgical_points.h"
#include "isochor/step/surgical_topology.h"

namespace isochor::internal {
namespace {

// Why the way of single lines ends, in words.
struct GiveUp {
  std::string reason;
};

std::string name_of(const Part21Instance& instance) {
  return "#" + std::to_string(instance.number);
}

// Instances that make another shape of a surface they name, or offer it as a shape of its own.
bool makes_geometry(std::string_view keyword) {
  for (const char* kind :
       {"OFFSET_SURFACE", "CURVE_BOUNDED_SURFACE", "SURFACE_REPLICA", "ORIENTED_SURFACE",
        "SURFACE_PATCH", "GEOMETRIC_SET", "GEOMETRIC_CURVE_SET", "COMPOSITE_CURVE_SEGMENT",
        "TRIMMED_CURVE", "OFFSET_CURVE_3D", "CURVE_REPLICA", "REPARAMETRISED_COMPOSITE_CURVE"}) {
    if (keyword == kind) return true;
  }
  return keyword.size() > 14 && keyword.substr(keyword.size() - 14) == "REPRESENTATION" &&
         keyword.find("PRESENTATION_REPRESENTATION") == std::string_view::npos;
}

class Surgeon {
 public:
  Surgeon(const Part21File& file, const SurgicalEdit& edit)
      : file_(file), edit_(edit), references_(file), out_(file), points_(file, out_) {}

  SurgicalText run() {
    SurgicalText result;
    try {
      for (const auto& moved : edit_.surfaces) find_face(moved);
      for (size_t k = 0; k < edit_.surfaces.size(); ++k) surface(k);
      curves();
      vertices();
    } catch (const GiveUp& reason) {
      result.refusal = reason.reason;
      return result;
    }
    update_measures(file_, references_, edited_, edit_.measures, out_, result.notices);
    result.text = out_.text();
    result.lines_appended = out_.lines_appended();
    result.lines_repointed = out_.lines_changed();
    return result;
  }

 private:
  const Part21Instance& user(const Part21Use& use) const { return file_.instances()[use.user]; }

  void find_face(const MovedSurface& moved) {
    if (moved.entity == 0) throw GiveUp{moved.handle + " is not found in the text of the file"};
    faces_.push_back(face_text(file_, moved.entity));
    edited_.insert(moved.entity);
    add_boundary(file_, faces_.back(), boundary_);
  }

  // ---- surfaces

  // Whether only edited faces take their shape from the surface.
  bool ours(const Part21Instance& surface, int depth = 0) const {
    if (depth > 8) return false;
    for (const Part21Use& use : references_.to(surface.number)) {
      const Part21Instance& by = user(use);
      if (by.complex()) {
        // Styles and the like are simple; what else a complex instance makes of it is not known.
        return false;
      }
      const bool face = by.keyword == "ADVANCED_FACE" || by.keyword == "FACE_SURFACE";
      if (face && edited_.count(by.number) == 0) return false;
      if (by.keyword == "RECTANGULAR_TRIMMED_SURFACE" && !ours(by, depth + 1)) return false;
      if (makes_geometry(by.keyword) && edited_.count(surface.number) == 0) return false;
    }
    return true;
  }

  // Whether the surface may become this one for all that name it.
  bool alone(size_t index) const {
    const Surface& after = edit_.surfaces[index].after;
    for (size_t k = 0; k < faces_.size(); ++k) {
      if (faces_[k].surface != faces_[index].surface) continue;
      const Surface& other = edit_.surfaces[k].after;
      if (other.u_knots() != after.u_knots() || other.v_knots() != after.v_knots() ||
          other.poles() != after.poles() || other.weights() != after.weights()) {
        return false;
      }
    }
    return ours(*faces_[index].surface);
  }

  void surface(size_t index) {
    const MovedSurface& moved = edit_.surfaces[index];
    const FaceText& face = faces_[index];
    const SplineValue value = spline_value(moved.after);
    if (written_.count(face.surface->number) > 0) return;
    const auto text = spline_text(file_, *face.surface);
    if (!text && !moved.converted) {
      throw GiveUp{name_of(*face.surface) + ", the surface of " + moved.handle +
                   ", is no B-spline surface in the file"};
    }
    if (text && same_basis(*text, value)) {
      const auto poles = new_poles(*text, moved);
      if (alone(index)) {
        for (size_t k = 0; k < poles.size(); ++k) {
          out_.repoint(*face.surface, text->points[k], poles[k]);
        }
        written_.insert(face.surface->number);
        return;
      }
      return place(index, out_.append(*face.surface, copied(*text, value, poles)));
    }
    place(index, out_.append(*face.surface, fresh_body(*face.surface, text, value)));
  }

  // In a new basis. Poles that are where old ones were use their points.
  std::string fresh_body(const Part21Instance& old, const std::optional<SplineText>& text,
                         const SplineValue& value) {
    std::map<std::array<double, 3>, std::uint64_t> known;
    if (text) {
      for (const auto& reference : text->points) {
        const Part21Instance& point = file_.follow(old, reference);
        const Vec3 p = point_of(file_, point);
        known.emplace(std::array<double, 3>{p.x(), p.y(), p.z()}, point.number);
      }
    }
    std::vector<std::uint64_t> poles;
    for (const Vec3& p : value.poles) {
      const auto same = known.find({p.x(), p.y(), p.z()});
      poles.push_back(same == known.end() ? points_.fresh(old, p) : same->second);
    }
    return spline_body(value, poles);
  }

  // The points of the poles: old ones where nothing moved.
  std::vector<std::uint64_t> new_poles(const SplineText& text, const MovedSurface& moved) {
    const auto& before = moved.before.poles();
    const auto& after = moved.after.poles();
    const bool same_grid = before.size() == after.size();
    std::vector<std::uint64_t> poles;
    for (size_t k = 0; k < after.size(); ++k) {
      const Part21Instance& old = file_.follow(*text.instance, text.points[k]);
      if (same_grid && before[k] == after[k]) {
        poles.push_back(old.number);
        continue;
      }
      if (same_grid && point_of(file_, old) != before[k]) {
        throw GiveUp{"the poles of " + moved.handle +
                     " are not those in the file (several length units, or repaired?)"};
      }
      poles.push_back(points_.at(old, after[k]));
    }
    return poles;
  }

  // A copy of the instance with other poles: everything else stays as the file says it.
  std::string copied(const SplineText& text, const SplineValue& value,
                     const std::vector<std::uint64_t>& poles) const {
    if (text.instance->complex() || text.points.size() != poles.size()) {
      return spline_body(value, poles);
    }
    const std::string_view old = file_.text();
    std::string body;
    size_t at = text.instance->body.begin;
    for (size_t k = 0; k < poles.size(); ++k) {
      body.append(old.substr(at, text.points[k].span.begin - at));
      body += "#" + std::to_string(poles[k]);
      at = text.points[k].span.end;
    }
    body.append(old.substr(at, text.instance->body.end - at));
    return body;
  }

  // Lets a face use a new surface, or all users when there are no others.
  void place(size_t index, std::uint64_t created) {
    const FaceText& face = faces_[index];
    const MovedSurface& moved = edit_.surfaces[index];
    const Part21Instance& old = *face.surface;
    const bool plane = old.keyword == "PLANE";
    if (alone(index)) {
      for (const Part21Use& use : references_.to(old.number)) {
        if (user(use).keyword == "PCURVE" && moved.converted && !plane) {
          throw GiveUp{moved.handle + " was converted, and the file has parameter curves on it"};
        }
        repoint(use, created);
      }
      written_.insert(old.number);
      return;
    }
    if (face.holder == nullptr || face.holder != face.face) {
      throw GiveUp{"the surface of " + moved.handle + ", " + name_of(old) +
                   ", is used by something else that trims it"};
    }
    out_.repoint(*face.holder, face.reference, created);
    own_parameter_curves(face, moved, created);
  }

  // The parameter curves of the face's edges on the surface it leaves. Faces that stay on it keep
  // theirs; a curve that they share is copied for this face.
  void own_parameter_curves(const FaceText& face, const MovedSurface& moved,
                            std::uint64_t created) {
    BoundaryText own;
    add_boundary(file_, face, own);
    left_.insert(face.face->number);
    for (const auto& [number, edge] : own.edges) {
      const auto on_old = parameter_curves_on(edge, *face.surface);
      if (on_old.empty()) continue;
      if (moved.converted) {
        throw GiveUp{moved.handle + " was converted, and the file has parameter curves on it"};
      }
      bool stays = false;
      for (const Part21Instance* other : faces_around(file_, references_, *edge.edge)) {
        if (left_.count(other->number) > 0) continue;
        stays = stays || face_text(file_, other->number).surface == face.surface;
      }
      if (!stays) {
        for (const auto& [pcurve, surface] : on_old) out_.repoint(*pcurve, surface, created);
        continue;
      }
      if (on_old.size() > 1) {
        throw GiveUp{"it is not clear which parameter curves of #" + std::to_string(number) +
                     " belong to " + moved.handle};
      }
      copy_parameter_curve(edge, *on_old[0].first, on_old[0].second, created);
    }
  }

  // With their references to the surface.
  std::vector<std::pair<const Part21Instance*, Part21Value>> parameter_curves_on(
      const EdgeText& edge, const Part21Instance& surface) const {
    std::vector<std::pair<const Part21Instance*, Part21Value>> found;
    for (const Part21Instance* pcurve : edge.pcurves) {
      const auto record = file_.record(*pcurve, "PCURVE");
      if (record.arguments.size() < 2 || record.arguments[1].reference != surface.number) continue;
      found.emplace_back(pcurve, record.arguments[1]);
    }
    return found;
  }

  void copy_parameter_curve(const EdgeText& edge, const Part21Instance& pcurve,
                            const Part21Value& surface, std::uint64_t created) {
    const std::string before(file_.text({pcurve.body.begin, surface.span.begin}));
    const std::string behind(file_.text({surface.span.end, pcurve.body.end}));
    const std::uint64_t copy = out_.append(pcurve, before + "#" + std::to_string(created) + behind);
    const auto record = file_.record(*edge.holder, edge.holder->keyword);
    const Part21Value& last = record.arguments[2].items.back();
    out_.replace(*edge.holder, last.span,
                 std::string(file_.text(last.span)) + ",#" + std::to_string(copy));
  }

  void repoint(const Part21Use& use, std::uint64_t to) {
    Part21Value value;
    value.kind = Part21Kind::kReference;
    value.reference = use.target;
    value.span = use.span;
    out_.repoint(user(use), value, to);
  }

  // ---- curves

  void curves() {
    std::vector<const MovedCurve*> unknown;
    std::set<std::uint64_t> taken = edit_.known_edges;
    for (const auto& moved : edit_.curves) {
      if (moved.edge == 0) {
        unknown.push_back(&moved);
        continue;
      }
      const auto found = boundary_.edges.find(moved.edge);
      if (found == boundary_.edges.end()) {
        throw GiveUp{"#" + std::to_string(moved.edge) + " is no edge of the edited faces"};
      }
      taken.insert(moved.edge);
      curve(found->second, moved.curve);
    }
    for (const MovedCurve* moved : unknown) {
      const EdgeText* match = nullptr;
      for (const auto& [number, edge] : boundary_.edges) {
        if (taken.count(number) > 0 || !same_ends(edge, *moved)) continue;
        if (match != nullptr) {
          throw GiveUp{"an edge that moves could be " + name_of(*match->edge) + " or #" +
                       std::to_string(number)};
        }
        match = &edge;
      }
      // Seams that the file leaves out have nothing to change.
      if (match == nullptr) continue;
      taken.insert(match->edge->number);
      curve(*match, moved->curve);
    }
  }

  bool same_ends(const EdgeText& edge, const MovedCurve& moved) const {
    const auto place = [&](int end) {
      return point_of(file_, *boundary_.vertices.at(edge.ends[end]->number).point);
    };
    const Vec3 a = place(0), b = place(1);
    const auto near = [&](const Vec3& p, const Vec3& q) { return (p - q).norm() <= moved.near; };
    return (near(a, moved.ends[0]) && near(b, moved.ends[1])) ||
           (near(a, moved.ends[1]) && near(b, moved.ends[0]));
  }

  void curve(const EdgeText& edge, const SplineValue& value) {
    if (edge.curve->keyword == "PCURVE") {
      throw GiveUp{name_of(*edge.edge) + " has a curve in parameters only"};
    }
    if (edge.holder != edge.edge && references_.to(edge.holder->number).size() > 1) {
      for (const Part21Use& use : references_.to(edge.holder->number)) {
        if (user(use).keyword == "EDGE_CURVE" && user(use).number != edge.edge->number) {
          throw GiveUp{name_of(*edge.holder) + " is the curve of two edges"};
        }
      }
    }
    const auto text = spline_text(file_, *edge.curve);
    std::vector<std::uint64_t> poles;
    if (!text || !same_basis(*text, value)) {
      out_.repoint(*edge.holder, edge.reference,
                   out_.append(*edge.curve, fresh_body(*edge.curve, text, value)));
      return;
    }
    for (size_t k = 0; k < value.poles.size(); ++k) {
      const Part21Instance& old = file_.follow(*text->instance, text->points[k]);
      poles.push_back(points_.at(old, value.poles[k]));
    }
    if (references_.to(edge.curve->number).size() == 1) {
      for (size_t k = 0; k < poles.size(); ++k) {
        out_.repoint(*edge.curve, text->points[k], poles[k]);
      }
      return;
    }
    out_.repoint(*edge.holder, edge.reference,
                 out_.append(*edge.curve, copied(*text, value, poles)));
  }

  // ---- vertices

  void vertices() {
    std::map<std::uint64_t, const MovedPoint*> by_number;
    for (const auto& moved : edit_.points) {
      if (moved.vertex != 0) by_number.emplace(moved.vertex, &moved);
    }
    for (const auto& [number, vertex] : boundary_.vertices) {
      const auto known = by_number.find(number);
      const MovedPoint* moved = known == by_number.end() ? nullptr : known->second;
      if (moved == nullptr && edit_.known_vertices.count(number) == 0) moved = by_place(vertex);
      if (moved == nullptr) continue;
      const Vec3 old = point_of(file_, *vertex.point);
      const Vec3 place = old == moved->before ? moved->after : old + (moved->after - moved->before);
      out_.repoint(*vertex.vertex, vertex.reference, points_.at(*vertex.point, place));
    }
  }

  const MovedPoint* by_place(const VertexText& vertex) const {
    const Vec3 old = point_of(file_, *vertex.point);
    const MovedPoint* found = nullptr;
    for (const auto& moved : edit_.points) {
      if (!((old - moved.before).norm() <= moved.near)) continue;
      if (found != nullptr && found->after != moved.after) {
        throw GiveUp{name_of(*vertex.vertex) + " lies where two corners move differently"};
      }
      found = &moved;
    }
    return found;
  }

  const Part21File& file_;
  const SurgicalEdit& edit_;
  Part21References references_;
  Part21Edit out_;
  NewPoints points_;
  std::vector<FaceText> faces_;      // of edit_.surfaces
  std::set<std::uint64_t> edited_;   // faces, or surfaces that stand for one
  std::set<std::uint64_t> written_;  // surfaces that are what was meant
  std::set<std::uint64_t> left_;     // faces that have left their surface
  BoundaryText boundary_;
};

}  // namespace

SurgicalText edit_text(const Part21File& file, const SurgicalEdit& edit) {
  if (edit.surfaces.empty()) {
    SurgicalText same;
    same.text = file.text();
    return same;
  }
  return Surgeon(file, edit).run();
}

}  // namespace isochor::internal
