#include "isochor/io/edits_json.h"

#include <algorithm>

#include "isochor/base/error.h"
#include "isochor/io/closing_json.h"
#include "isochor/io/json_reader.h"

namespace isochor {
namespace {

using internal::Json;
using internal::JsonObject;
using internal::JsonValue;

[[noreturn]] void refuse(const JsonValue& value, const std::string& what) {
  value.fail(what + " is not available in this version");
}

std::array<int, 2> parse_index_pair(const JsonValue& value) {
  const std::vector<int> pair = value.integers();
  if (pair.size() != 2) value.fail("expected [i, j], found " + value.print());
  if (pair[0] < 0 || pair[1] < 0) value.fail("an index is negative: " + value.print());
  return {pair[0], pair[1]};
}

std::array<double, 2> parse_interval(const JsonValue& value) {
  const Uv pair = value.uv();
  if (!(pair.u < pair.v)) value.fail("expected [low, high] with low < high");
  return {pair.u, pair.v};
}

double parse_positive(const JsonValue& value) {
  const double number = value.number();
  if (!(number > 0.0)) value.fail("must be positive, found " + value.print());
  return number;
}

// Reads the keys that say where; the caller reads the rest of the object.
Place parse_place(JsonObject& object) {
  Place place;
  if (object.has("near")) {
    place.kind = Place::Kind::kNear;
    place.near = object["near"].vec3();
    return place;
  }
  place.patch = object["patch"].text();
  const int given = object.has("uv") + object.has("uv01") + object.has("pole");
  if (given != 1) {
    object.value().fail("name the place by exactly one of \"uv\", \"uv01\", \"pole\" or \"near\"");
  }
  if (object.has("pole")) {
    place.kind = Place::Kind::kCoefficient;
    const auto [i, j] = parse_index_pair(object["pole"]);
    place.i = i;
    place.j = j;
  } else {
    place.normalised = object.has("uv01");
    place.uv = object[place.normalised ? "uv01" : "uv"].uv();
  }
  return place;
}

Move parse_move(const JsonValue& value) {
  JsonObject object(value);
  Move move;
  move.place = parse_place(object);
  if (object.has("by") == object.has("to")) {
    value.fail(
        "say where it goes by exactly one of \"by\" (a displacement) or \"to\" (a position)");
  }
  move.relative = object.has("by");
  move.vector = object[move.relative ? "by" : "to"].vec3();
  object.with("drag", [&](const JsonValue& steps) {
    for (size_t i = 0; i < steps.size(); ++i) move.drag.push_back(steps.at(i).vec3());
  });
  object.finish();
  return move;
}

int parse_axis(const JsonValue& value) {
  const std::string name = value.text();
  if (name == "x") return 0;
  if (name == "y") return 1;
  if (name == "z") return 2;
  value.fail("expected \"x\", \"y\" or \"z\", found " + value.print());
}

Hold parse_hold(const JsonValue& value) {
  JsonObject object(value);
  Hold hold;
  if (object.has("symmetry")) {
    hold.kind = Hold::Kind::kSymmetry;
    hold.axis = parse_axis(object["symmetry"]);
  } else if (object.has("edge")) {
    hold.kind = Hold::Kind::kEdge;
    const std::vector<std::string> pair = object["edge"].texts();
    if (pair.size() != 2) value.fail("an edge is named by its two faces");
    hold.edge = {pair[0], pair[1]};
  } else if (object.has("plane")) {
    hold.kind = Hold::Kind::kPlane;
    JsonObject plane(object["plane"]);
    hold.plane_point = plane["point"].vec3();
    const JsonValue normal = plane["normal"];
    hold.plane_normal = normal.vec3();
    if (!(hold.plane_normal.norm() > 0.0)) normal.fail("the normal is zero");
    plane.finish();
  } else {
    hold.place = parse_place(object);
    object.with("normal", [&](const JsonValue& normal) {
      if (!normal.boolean()) return;
      hold.kind = Hold::Kind::kNormal;
      if (hold.place.kind == Place::Kind::kCoefficient) {
        normal.fail("a coefficient has no normal: name a point of the surface");
      }
    });
  }
  object.finish();
  return hold;
}

Scale parse_scale(const JsonValue& value) {
  Scale scale;
  if (value.is_string()) {
    if (value.text() != "finest")
      value.fail("expected \"finest\" or an object, found " + value.print());
    return scale;
  }
  JsonObject object(value);
  if (object.has("level")) refuse(object["level"], "a wavelet level");
  if (object.has("every") == object.has("knots")) {
    value.fail("expected exactly one of \"every\" or \"knots\"");
  }
  object.with("every", [&](const JsonValue& every) {
    scale.kind = Scale::Kind::kEvery;
    scale.every = every.integer();
    if (scale.every < 1) every.fail("must be at least 1, found " + every.print());
  });
  object.with("knots", [&](const JsonValue& knots) {
    scale.kind = Scale::Kind::kKnots;
    JsonObject patches(knots);
    for (const std::string& patch : patches.keys()) {
      const JsonValue lists = patches[patch];
      if (lists.size() != 2) lists.fail("expected [kept knots along u, kept knots along v]");
      scale.knots[patch] = {lists.at(0).numbers(), lists.at(1).numbers()};
    }
  });
  object.finish();
  return scale;
}

Refine parse_refine(const JsonValue& value) {
  Refine refine;
  if (value.is_string()) {
    if (value.text() != "auto") value.fail("expected \"auto\", found " + value.print());
    refine.kind = Refine::Kind::kAuto;
    return refine;
  }
  JsonObject object(value);
  if (object.has("spans") == object.has("length")) {
    value.fail("expected exactly one of \"spans\" or \"length\"");
  }
  object.with("spans", [&](const JsonValue& spans) {
    refine.kind = Refine::Kind::kSpans;
    refine.spans = parse_index_pair(spans);
    if (refine.spans[0] < 1 || refine.spans[1] < 1) spans.fail("spans must be at least 1");
  });
  object.with("length", [&](const JsonValue& length) {
    refine.kind = Refine::Kind::kLength;
    refine.length = parse_positive(length);
  });
  object.finish();
  return refine;
}

Follow parse_follow(const JsonValue& value) {
  Follow follow;
  JsonObject object(value);
  const JsonValue faces = object["faces"];
  for (size_t k = 0; k < faces.size(); ++k) follow.faces.push_back(faces.at(k).text());
  if (follow.faces.empty()) faces.fail("the list is empty: name the faces that follow");
  follow.tolerance = parse_positive(object["tolerance"]);
  object.finish();
  return follow;
}

Extent parse_extent(const JsonValue& value) {
  Extent extent;
  if (value.is_string()) {
    if (value.text() != "all") value.fail("expected \"all\" or an object, found " + value.print());
    extent.kind = Extent::Kind::kAll;
    return extent;
  }
  JsonObject object(value);
  const std::vector<std::string> kinds = object.keys();
  if (kinds.size() != 1) value.fail("expected exactly one kind of extent, found " + value.print());
  const std::string& kind = kinds.front();
  const JsonValue what = object[kind];
  if (kind == "rings") {
    extent.rings = what.integer();
    if (extent.rings < 0) what.fail("must not be negative");
  } else if (kind == "radius") {
    extent.kind = Extent::Kind::kRadius;
    extent.radius = parse_positive(what);
  } else if (kind == "loop") {
    extent.kind = Extent::Kind::kLoop;
    JsonObject loop(what);
    extent.patch = loop["patch"].text();
    const JsonValue corners = loop["uv"];
    for (size_t i = 0; i < corners.size(); ++i) extent.loop.push_back(corners.at(i).uv());
    if (extent.loop.size() < 3) corners.fail("a loop needs at least three corners");
    loop.finish();
  } else if (kind == "points") {
    extent.kind = Extent::Kind::kPoints;
    extent.points = what.integers();
  } else if (kind == "poles") {
    extent.kind = Extent::Kind::kPoles;
    JsonObject patches(what);
    for (const std::string& patch : patches.keys()) {
      const JsonValue list = patches[patch];
      for (size_t i = 0; i < list.size(); ++i) {
        const auto [row, column] = parse_index_pair(list.at(i));
        extent.poles[patch].emplace_back(row, column);
      }
    }
  } else if (kind == "box") {
    extent.kind = Extent::Kind::kBox;
    JsonObject box(what);
    extent.patch = box["patch"].text();
    extent.u = parse_interval(box["u"]);
    extent.v = parse_interval(box["v"]);
    box.finish();
  } else if (kind == "faces") {
    extent.kind = Extent::Kind::kFaces;
    extent.faces = what.texts();
  } else {
    value.fail("unknown key \"" + kind + "\"");
  }
  return extent;
}

VolumeGoal parse_volume(const JsonValue& value) {
  VolumeGoal goal;
  if (value.is_string()) {
    if (value.text() == "keep") return goal;
    if (value.text() != "free") {
      value.fail("expected \"keep\", \"free\" or an object, found " + value.print());
    }
    goal.kind = VolumeGoal::Kind::kFree;
    return goal;
  }
  JsonObject object(value);
  const std::vector<std::string> kinds = object.keys();
  if (kinds.size() != 1) value.fail("expected exactly one of \"target\", \"factor\", \"change\"");
  if (kinds[0] == "target") {
    goal.kind = VolumeGoal::Kind::kTarget;
  } else if (kinds[0] == "factor") {
    goal.kind = VolumeGoal::Kind::kFactor;
  } else if (kinds[0] == "change") {
    goal.kind = VolumeGoal::Kind::kChange;
  } else {
    value.fail("unknown key \"" + kinds[0] + "\"");
  }
  goal.value = object[kinds[0]].number();
  return goal;
}

Sink parse_sink(const JsonValue& value) {
  Sink sink;
  if (value.is_string() && value.text() == "extent") return sink;
  if (value.is_object() && value.raw().contains("direction")) {
    JsonObject object(value);
    sink.kind = Sink::Kind::kDirection;
    sink.direction = object["direction"].vec3();
    if (!(sink.direction.norm() > 0.0)) value.fail("the direction is zero");
    object.finish();
    return sink;
  }
  sink.kind = Sink::Kind::kOtherExtent;
  sink.extent = parse_extent(value);
  return sink;
}

std::array<int, 3> parse_axis_order(const JsonValue& value) {
  const std::string text = value.text();
  std::array<int, 3> order{};
  std::string sorted = text;
  std::sort(sorted.begin(), sorted.end());
  if (sorted != "xyz")
    value.fail("expected an order of the axes such as \"xyz\", found " + value.print());
  for (size_t i = 0; i < 3; ++i) order[i] = text[i] - 'x';
  return order;
}

Continuity parse_continuity(const JsonValue& value) {
  const std::string name = value.text();
  for (Continuity keep : {Continuity::kMeasured, Continuity::kTangent, Continuity::kC0}) {
    if (name == name_of(keep)) return keep;
  }
  value.fail("expected \"measured\", \"G1\" or \"C0\", found " + value.print());
}

// One word for all joins, or {"default": word, "edges": [{"edge": [A, B], "keep": word}, ...]}.
void parse_continuities(const JsonValue& value, Edit& edit) {
  if (!value.is_object()) {
    edit.continuity = parse_continuity(value);
    return;
  }
  JsonObject object(value);
  object.with("default", [&](const JsonValue& word) { edit.continuity = parse_continuity(word); });
  const JsonValue edges = object["edges"];
  for (size_t i = 0; i < edges.size(); ++i) {
    JsonObject edge(edges.at(i));
    const JsonValue names = edge["edge"];
    const std::vector<std::string> pair = names.texts();
    if (pair.size() != 2) names.fail("an edge is named by its two faces");
    edit.edge_continuity.push_back({{pair[0], pair[1]}, parse_continuity(edge["keep"])});
    edge.finish();
  }
  object.finish();
}

void parse_solver_keys(JsonObject& object, Edit& edit) {
  object.with("continuity", [&](const JsonValue& value) { parse_continuities(value, edit); });
  object.with("method", [&](const JsonValue& value) {
    const std::string name = value.text();
    if (name == "isotropic") {
      edit.method = Method::kIsotropic;
    } else if (name == "axis") {
      edit.method = Method::kAxis;
    } else if (name == "taylor") {
      edit.method = Method::kTaylor;
    } else {
      value.fail("expected \"isotropic\", \"axis\" or \"taylor\", found " + value.print());
    }
  });
  object.with("axis_order",
              [&](const JsonValue& value) { edit.axis_order = parse_axis_order(value); });
  const std::string advice = "write \"metric\": \"coefficients\"";
  if (!object.has("metric")) {
    object.value().fail(
        "the key \"metric\" is missing and its default \"energy\" is not available "
        "in this version: " +
        advice);
  }
  const JsonValue metric = object["metric"];
  if (metric.is_object() || metric.text() == "energy") {
    metric.fail("the metric \"energy\" is not available in this version: " + advice);
  }
  if (metric.text() != "coefficients") metric.fail("unknown metric " + metric.print());
}

Edit parse_edit(const JsonValue& value) {
  JsonObject object(value);
  Edit edit;
  object.with("name", [&](const JsonValue& name) { edit.name = name.text(); });
  object.with("scale", [&](const JsonValue& scale) { edit.scale = parse_scale(scale); });
  object.with("refine", [&](const JsonValue& refine) { edit.refine = parse_refine(refine); });
  object.with("extent", [&](const JsonValue& extent) { edit.extent = parse_extent(extent); });
  object.with("move", [&](const JsonValue& moves) {
    for (size_t i = 0; i < moves.size(); ++i) edit.moves.push_back(parse_move(moves.at(i)));
  });
  object.with("hold", [&](const JsonValue& holds) {
    for (size_t i = 0; i < holds.size(); ++i) edit.holds.push_back(parse_hold(holds.at(i)));
  });
  object.with("follow", [&](const JsonValue& follow) { edit.follow = parse_follow(follow); });
  object.with("volume", [&](const JsonValue& volume) { edit.volume = parse_volume(volume); });
  object.with("sink", [&](const JsonValue& sink) { edit.sink = parse_sink(sink); });
  object.with("open", [&](const JsonValue& open) { edit.open = open.boolean(); });
  object.with("close", [&](const JsonValue& list) { edit.close = internal::parse_close(list); });
  parse_solver_keys(object, edit);
  object.finish();
  return edit;
}

}  // namespace

EditScript parse_edits(const std::string& text, const std::string& file) {
  const Json document = internal::parse_json(text, file);
  JsonObject object(JsonValue(document, "", file));
  internal::check_header(object, "isochor_edits", 1);
  object.with("defaults", [](const JsonValue& version) {
    if (version.integer() != 1)
      version.fail("defaults of version " + version.print() + " are not known");
  });
  EditScript script;
  object.with("close", [&](const JsonValue& list) { script.close = internal::parse_close(list); });
  const JsonValue edits = object["edits"];
  for (size_t i = 0; i < edits.size(); ++i) script.edits.push_back(parse_edit(edits.at(i)));
  object.finish();
  return script;
}

}  // namespace isochor
