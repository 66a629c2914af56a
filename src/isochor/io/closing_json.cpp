#include "isochor/io/closing_json.h"

namespace isochor::internal {

std::vector<ClosingPlane> parse_close(const JsonValue& list) {
  std::vector<ClosingPlane> planes;
  for (size_t i = 0; i < list.size(); ++i) {
    const JsonValue value = list.at(i);
    JsonObject object(value);
    if (object.has("symmetry")) {
      const JsonValue axis = object["symmetry"];
      if (axis.text() != "x" && axis.text() != "y" && axis.text() != "z") {
        axis.fail("expected \"x\", \"y\" or \"z\", found " + axis.print());
      }
      planes.push_back({Vec3::Unit(axis.text()[0] - 'x'), 0.0, true});
    } else if (object.has("plane")) {
      JsonObject plane(object["plane"]);
      const JsonValue normal = plane["normal"];
      if (!(normal.vec3().norm() > 0.0)) normal.fail("the normal is zero");
      planes.push_back(closing_plane(normal.vec3(), plane["offset"].number(), "close"));
      plane.finish();
    } else {
      value.fail("expected {\"symmetry\": AXIS} or {\"plane\": {\"normal\", \"offset\"}}");
    }
    object.finish();
  }
  return planes;
}

Json format_close(const std::vector<ClosingPlane>& planes) {
  Json list = Json::array();
  for (const ClosingPlane& plane : planes) {
    if (plane.mirror) {
      int axis = 0;
      plane.normal.maxCoeff(&axis);
      list.push_back({{"symmetry", std::string(1, static_cast<char>('x' + axis))}});
    } else {
      list.push_back({{"plane",
                       {{"normal", {plane.normal.x(), plane.normal.y(), plane.normal.z()}},
                        {"offset", plane.offset}}}});
    }
  }
  return list;
}

}  // namespace isochor::internal
