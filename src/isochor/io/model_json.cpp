#include "isochor/io/model_json.h"

#include <utility>

#include "isochor/base/error.h"
#include "isochor/bspline/continuity.h"
#include "isochor/bspline/joins.h"
#include "isochor/io/json_reader.h"

namespace isochor {
namespace {

using internal::Json;
using internal::JsonObject;
using internal::JsonValue;

KnotVector parse_knots(int degree, const JsonValue& value) {
  std::vector<double> knots = value.numbers();
  const std::string wrong = KnotVector::defect(degree, knots);
  if (!wrong.empty()) value.fail(wrong);
  return KnotVector(degree, std::move(knots));
}

// Reads a #u x #v list of lists; `each` gets every entry in u-major order.
template <typename Each>
void read_grid(const JsonValue& grid, int u_size, int v_size, Each each) {
  if (static_cast<int>(grid.size()) != u_size) {
    grid.fail("expected " + std::to_string(u_size) + " rows (knots minus degree minus 1), found " +
              std::to_string(grid.size()));
  }
  for (size_t i = 0; i < grid.size(); ++i) {
    const JsonValue row = grid.at(i);
    if (static_cast<int>(row.size()) != v_size) {
      row.fail("expected " + std::to_string(v_size) + " entries, found " +
               std::to_string(row.size()));
    }
    for (size_t j = 0; j < row.size(); ++j) each(row.at(j));
  }
}

Patch parse_patch(const JsonValue& value, size_t number, size_t point_count) {
  JsonObject object(value);
  const JsonValue degree = object["degree"];
  const std::vector<int> degrees = degree.integers();
  if (degrees.size() != 2) degree.fail("expected [degree along u, degree along v]");
  const JsonValue knots = object["knots"];
  if (knots.size() != 2) knots.fail("expected [knots along u, knots along v]");
  Patch patch{"",
              "face:" + std::to_string(number + 1),
              parse_knots(degrees[0], knots.at(0)),
              parse_knots(degrees[1], knots.at(1)),
              {},
              {},
              false,
              {},
              {}};
  object.with("name", [&](const JsonValue& name) { patch.name = name.text(); });
  object.with("reversed", [&](const JsonValue& reversed) { patch.reversed = reversed.boolean(); });
  read_grid(object["poles"], patch.u_size(), patch.v_size(), [&](const JsonValue& id) {
    const int index = id.integer();
    if (index < 0 || static_cast<size_t>(index) >= point_count) {
      id.fail("no point " + std::to_string(index) + " in the table of " +
              std::to_string(point_count));
    }
    patch.points.push_back(index);
  });
  if (object.has("weights") && !object["weights"].is_null()) {
    read_grid(object["weights"], patch.u_size(), patch.v_size(), [&](const JsonValue& weight) {
      const double w = weight.number();
      if (!(w > 0.0)) weight.fail("a weight must be positive, found " + weight.print());
      patch.weights.push_back(w);
    });
  }
  object.finish();
  return patch;
}

}  // namespace

PatchModel parse_model(const std::string& text, const std::string& file) {
  const Json document = internal::parse_json(text, file);
  JsonObject object(JsonValue(document, "", file));
  internal::check_header(object, "isochor_model", 1);
  PatchModel model;
  object.with("unit", [&](const JsonValue& unit) { model.unit = unit.text(); });
  const JsonValue points = object["points"];
  for (size_t i = 0; i < points.size(); ++i) model.points.push_back(points.at(i).vec3());
  const JsonValue patches = object["patches"];
  if (patches.size() == 0) patches.fail("a model needs at least one patch");
  for (size_t q = 0; q < patches.size(); ++q) {
    model.patches.push_back(parse_patch(patches.at(q), q, model.points.size()));
  }
  object.with("ties", [&](const JsonValue& ties) {
    for (size_t i = 0; i < ties.size(); ++i) {
      const std::vector<int> pair = ties.at(i).integers();
      if (pair.size() != 2) ties.at(i).fail("expected a pair of point ids");
      model.ties.emplace_back(pair[0], pair[1]);
    }
  });
  object.finish();
  try {
    validate(model);
  } catch (const InputError& error) {
    throw error.in_file(file);
  }
  model.joins = find_joins(model);
  derive_locks(model);
  return model;
}

std::string format_model(const PatchModel& model) {
  Json document;
  document["isochor_model"] = 1;
  document["unit"] = model.unit;
  Json points = Json::array();
  for (const Vec3& p : model.points) points.push_back({p.x(), p.y(), p.z()});
  document["points"] = std::move(points);
  Json patches = Json::array();
  for (const Patch& patch : model.patches) {
    Json entry;
    entry["name"] = patch.name;
    entry["degree"] = {patch.u_knots.degree(), patch.v_knots.degree()};
    entry["knots"] = {patch.u_knots.knots(), patch.v_knots.knots()};
    Json poles = Json::array();
    Json weights = Json::array();
    for (int i = 0; i < patch.u_size(); ++i) {
      Json pole_row = Json::array();
      Json weight_row = Json::array();
      for (int j = 0; j < patch.v_size(); ++j) {
        pole_row.push_back(patch.point(i, j));
        if (!patch.weights.empty()) {
          weight_row.push_back(patch.weights[static_cast<size_t>(i) * patch.v_size() + j]);
        }
      }
      poles.push_back(std::move(pole_row));
      weights.push_back(std::move(weight_row));
    }
    entry["poles"] = std::move(poles);
    entry["weights"] = patch.weights.empty() ? Json() : std::move(weights);
    entry["reversed"] = patch.reversed;
    patches.push_back(std::move(entry));
  }
  document["patches"] = std::move(patches);
  if (!model.ties.empty()) {
    Json ties = Json::array();
    for (const auto& [a, b] : model.ties) ties.push_back({a, b});
    document["ties"] = std::move(ties);
  }
  return document.dump() + "\n";
}

}  // namespace isochor
