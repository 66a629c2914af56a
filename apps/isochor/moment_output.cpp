#include "moment_output.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "isochor/base/error.h"
#include "terminal.h"

namespace isochor::app {
namespace {

Value rows_of(const Matrix3& matrix) {
  Value rows = Value::list();
  for (int i = 0; i < 3; ++i) rows.push(Vec3(matrix.row(i)));
  return rows;
}

#ifdef ISOCHOR_WITH_OCCT
// The patches are all of the model.
bool whole_patches(const LoadedModel& loaded) {
  if (!loaded.solid) return true;
  const auto& faces = loaded.solid->faces;
  return std::all_of(faces.begin(), faces.end(), [](const FaceFacts& face) {
    return face.patch >= 0 && face.trim == TrimKind::kNatural;
  });
}
#endif

const char* name_of(PlaneSide side) {
  return side == PlaneSide::kCut          ? "part"
         : side == PlaneSide::kEverything ? "everything"
                                          : "nothing";
}

// Of a half model only the half is counted.
std::string counted_text(const LoadedModel& loaded) {
  const auto& planes = loaded.surroundings.closing;
  if (planes.empty()) return "the model";
  return "the model as closed by " + text_of(planes) + ", without any mirror image";
}

std::string triple(const Vec3& v) { return format("%.17g %.17g %.17g", v.x(), v.y(), v.z()); }

void print_tensor(const Common& common, const char* name, const Matrix3& tensor,
                  const Matrix3& bound, const std::string& unit) {
  print(common, format("%s, %s^5 (error at most %.2g):", name, unit.c_str(), bound.maxCoeff()));
  for (int i = 0; i < 3; ++i) print(common, "  " + triple(tensor.row(i)));
}

}  // namespace

Moments moments_of(const LoadedModel& loaded) {
  const std::vector<ClosingPlane>& planes = loaded.surroundings.closing;
  const std::optional<Vec3> origin = common_point(planes);
  if (!planes.empty() && !origin) {
    throw InputError(
        loaded.path, "--moments",
        "need closing planes with a point in common; " + text_of(planes) + " have none");
  }
  try {
#ifdef ISOCHOR_WITH_OCCT
    if (loaded.solid && loaded.solid->moments) return moments_from(*loaded.solid->moments);
#endif
    const MomentForm form(loaded.patches);
    if (origin) return moments_from(form.integrals(loaded.patches.points, *origin));
    return form.moments(loaded.patches.points);
  } catch (const InputError& error) {
    throw error.in_file(loaded.path);
  }
}

Value to_value(const Moments& m) {
  return Value::object()
      .set("volume", m.volume.value)
      .set("volume_bound", m.volume.bound)
      .set("centroid", m.centroid)
      .set("centroid_bound", m.centroid_bound)
      .set("second_moments", rows_of(m.second))
      .set("second_moments_bound", rows_of(m.second_bound))
      .set("inertia", rows_of(m.inertia))
      .set("inertia_bound", rows_of(m.inertia_bound))
      .set("principal_moments", m.principal)
      .set("principal_moments_bound", m.principal_bound)
      .set("principal_axes", rows_of(m.axes.transpose()))
      .set("principal_axes_bound", m.axis_bound);
}

void print_moments(const Common& common, const Moments& m, const std::string& unit) {
  print(common,
        format("centroid, %s (error at most %.2g): ", unit.c_str(), m.centroid_bound.maxCoeff()) +
            triple(m.centroid));
  print_tensor(common, "second moments about the centroid", m.second, m.second_bound, unit);
  print_tensor(common, "inertia about the centroid, density 1", m.inertia, m.inertia_bound, unit);
  print(common, format("principal moments, %s^5 (error at most %.2g), and axes:", unit.c_str(),
                       m.principal_bound));
  for (int k = 0; k < 3; ++k) {
    const bool known = m.axis_bound[k] < 0.5;
    print(common, format("  %.17g  along %s (%s)", m.principal[k], triple(m.axes.col(k)).c_str(),
                         known ? format("within %.2g rad", m.axis_bound[k]).c_str()
                               : "not determined: its neighbour is as large"));
  }
}

void require_plane(const std::vector<double>& plane) {
  const Vec3 normal(plane[0], plane[1], plane[2]);
  if (!(normal.norm() > 0.0) || !std::isfinite(normal.norm()) || !std::isfinite(plane[3])) {
    throw InputError("", "--section", "needs a normal that is not zero, and a height: NX,NY,NZ,H");
  }
}

Section section_of(const LoadedModel& loaded, const std::vector<double>& plane) {
#ifdef ISOCHOR_WITH_OCCT
  if (!whole_patches(loaded) && loaded.solid->section) return *loaded.solid->section;
#endif
  return section(loaded.patches, Vec3(plane[0], plane[1], plane[2]), plane[3]);
}

Value to_value(const Section& s) {
  return Value::object()
      .set("normal", s.normal)
      .set("height", s.height)
      .set("area", s.area)
      .set("bound", s.bound)
      .set("centroid", std::isinf(s.centroid_bound) ? Value() : Value(s.centroid))
      .set("centroid_bound", s.centroid_bound)
      .set("coplanar", s.coplanar);
}

void print_section(const Common& common, const Section& s, const std::string& unit) {
  print(common, format("section, %s^2: %.17g (error at most %.2g)", unit.c_str(), s.area, s.bound));
  if (!std::isinf(s.centroid_bound)) {
    print(common, format("centroid of the section (error at most %.2g): ", s.centroid_bound) +
                      triple(s.centroid));
  }
  if (s.coplanar) print(common, "a face lies in the plane: the area is the limit from below");
}

std::optional<ClosingPlane> parse_below(const std::string& text) {
  if (text.empty()) return std::nullopt;
  try {
    return parse_waterline(text);
  } catch (const InputError& error) {
    throw InputError("--below", error.entity(), error.reason());
  }
}

PartBelow below_of(const LoadedModel& loaded, const ClosingPlane& plane) {
#ifdef ISOCHOR_WITH_OCCT
  if (!whole_patches(loaded) && loaded.solid->below) return *loaded.solid->below;
#endif
  return part_below(loaded.patches, plane, loaded.surroundings.closing);
}

Value to_value(const PartBelow& part, const LoadedModel& loaded) {
  const bool known = !std::isinf(part.centroid_bound);
  return Value::object()
      .set("normal", part.normal)
      .set("height", part.height)
      .set("extent", name_of(part.side))
      .set("volume", part.volume)
      .set("bound", part.bound)
      .set("proven", part.proven)
      .set("centroid", known ? Value(part.centroid) : Value())
      .set("centroid_bound", part.centroid_bound)
      .set("counted", counted_text(loaded));
}

void print_below(const Common& common, const PartBelow& part, const LoadedModel& loaded) {
  const char* unit = loaded.patches.unit.c_str();
  const std::string plane = text_of({part.normal, part.height, false});
  print(common, format("below %s, %s^3: %.17g (error at most %.2g%s)", plane.c_str(), unit,
                       part.volume, part.bound, part.proven ? "" : ", an estimate"));
  if (part.side != PlaneSide::kCut) {
    print(common,
          std::string("the plane misses the model: ") + name_of(part.side) + " of it lies below");
  }
  if (!std::isinf(part.centroid_bound)) {
    print(common,
          format("centroid of that part, %s (error at most %.2g): ", unit, part.centroid_bound) +
              triple(part.centroid));
  }
  if (!loaded.surroundings.closing.empty()) print(common, "counted: " + counted_text(loaded));
}

}  // namespace isochor::app
