// Edit scripts as text; reading them is in edits_json.cpp.
#include "isochor/io/closing_json.h"
#include "isochor/io/edits_json.h"
#include "isochor/io/json_reader.h"

namespace isochor {
namespace {

using internal::Json;

Json numbers(const Vec3& v) { return Json{v.x(), v.y(), v.z()}; }

void put_place(Json& out, const Place& place) {
  if (place.kind == Place::Kind::kNear) {
    out["near"] = numbers(place.near);
    return;
  }
  out["patch"] = place.patch;
  if (place.kind == Place::Kind::kCoefficient) {
    out["pole"] = {place.i, place.j};
  } else {
    out[place.normalised ? "uv01" : "uv"] = {place.uv.u, place.uv.v};
  }
}

Json format_extent(const Extent& extent) {
  Json out;
  switch (extent.kind) {
    case Extent::Kind::kRings:
      out["rings"] = extent.rings;
      break;
    case Extent::Kind::kRadius:
      out["radius"] = extent.radius;
      break;
    case Extent::Kind::kLoop: {
      Json corners = Json::array();
      for (const Uv& uv : extent.loop) corners.push_back({uv.u, uv.v});
      out["loop"] = {{"patch", extent.patch}, {"uv", corners}};
      break;
    }
    case Extent::Kind::kPoints:
      out["points"] = extent.points;
      break;
    case Extent::Kind::kPoles:
      for (const auto& [patch, list] : extent.poles) out["poles"][patch] = list;
      break;
    case Extent::Kind::kBox:
      out["box"] = {{"patch", extent.patch}, {"u", extent.u}, {"v", extent.v}};
      break;
    case Extent::Kind::kFaces:
      out["faces"] = extent.faces;
      break;
    case Extent::Kind::kAll:
      out = "all";
      break;
  }
  return out;
}

Json format_scale(const Scale& scale) {
  if (scale.kind == Scale::Kind::kEvery) return Json{{"every", scale.every}};
  if (scale.kind == Scale::Kind::kFinest) return "finest";
  Json out;
  for (const auto& [patch, lists] : scale.knots) out["knots"][patch] = {lists[0], lists[1]};
  return out;
}

Json format_volume(const VolumeGoal& goal) {
  switch (goal.kind) {
    case VolumeGoal::Kind::kKeep:
      return "keep";
    case VolumeGoal::Kind::kFree:
      return "free";
    case VolumeGoal::Kind::kTarget:
      return Json{{"target", goal.value}};
    case VolumeGoal::Kind::kFactor:
      return Json{{"factor", goal.value}};
    case VolumeGoal::Kind::kChange:
      return Json{{"change", goal.value}};
  }
  return nullptr;
}

Json format_move(const Move& move) {
  Json out;
  put_place(out, move.place);
  out[move.relative ? "by" : "to"] = numbers(move.vector);
  for (const Vec3& step : move.drag) out["drag"].push_back(numbers(step));
  return out;
}

Json format_hold(const Hold& hold) {
  Json out;
  if (hold.kind == Hold::Kind::kSymmetry) {
    out["symmetry"] = std::string(1, static_cast<char>('x' + hold.axis));
  } else if (hold.kind == Hold::Kind::kEdge) {
    out["edge"] = hold.edge;
  } else if (hold.kind == Hold::Kind::kPlane) {
    out["plane"] = {{"point", numbers(hold.plane_point)}, {"normal", numbers(hold.plane_normal)}};
  } else {
    put_place(out, hold.place);
    if (hold.kind == Hold::Kind::kNormal) out["normal"] = true;
  }
  return out;
}

Json format_continuity(const Edit& edit) {
  if (edit.edge_continuity.empty()) return name_of(edit.continuity);
  Json edges = Json::array();
  for (const EdgeContinuity& item : edit.edge_continuity) {
    edges.push_back({{"edge", item.edge}, {"keep", name_of(item.keep)}});
  }
  return Json{{"default", name_of(edit.continuity)}, {"edges", edges}};
}

Json format_edit(const Edit& edit) {
  Json out;
  if (!edit.name.empty()) out["name"] = edit.name;
  out["scale"] = format_scale(edit.scale);
  if (edit.refine.kind == Refine::Kind::kAuto) out["refine"] = "auto";
  if (edit.refine.kind == Refine::Kind::kSpans) out["refine"] = {{"spans", edit.refine.spans}};
  if (edit.refine.kind == Refine::Kind::kLength) out["refine"] = {{"length", edit.refine.length}};
  out["extent"] = format_extent(edit.extent);
  out["move"] = Json::array();
  for (const Move& move : edit.moves) out["move"].push_back(format_move(move));
  if (!edit.holds.empty()) out["hold"] = Json::array();
  for (const Hold& hold : edit.holds) out["hold"].push_back(format_hold(hold));
  out["continuity"] = format_continuity(edit);
  if (edit.follow.any()) {
    out["follow"] = {{"faces", edit.follow.faces}, {"tolerance", edit.follow.tolerance}};
  }
  out["volume"] = format_volume(edit.volume);
  out["method"] = name_of(edit.method);
  if (edit.method == Method::kAxis) {
    std::string order;
    for (int axis : edit.axis_order) order += static_cast<char>('x' + axis);
    out["axis_order"] = order;
  }
  out["metric"] = "coefficients";
  if (edit.open) out["open"] = true;
  if (!edit.close.empty()) out["close"] = internal::format_close(edit.close);
  if (edit.sink.kind == Sink::Kind::kOtherExtent) out["sink"] = format_extent(edit.sink.extent);
  if (edit.sink.kind == Sink::Kind::kDirection) {
    out["sink"] = {{"direction", numbers(edit.sink.direction)}};
  }
  return out;
}

}  // namespace

std::string format_edits(const EditScript& script) {
  Json document;
  document["isochor_edits"] = 1;
  document["defaults"] = 1;
  if (!script.close.empty()) document["close"] = internal::format_close(script.close);
  document["edits"] = Json::array();
  for (const Edit& edit : script.edits) document["edits"].push_back(format_edit(edit));
  return document.dump(2) + "\n";
}

}  // namespace isochor
