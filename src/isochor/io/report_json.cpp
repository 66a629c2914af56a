#include "isochor/io/report_json.h"

#include "isochor/base/instruction_set.h"
#include "isochor/io/edits_json.h"
#include "isochor/io/json_reader.h"

namespace isochor {
namespace {

Value place_records(const std::vector<MoveRecord>& records) {
  Value list = Value::list();
  for (const MoveRecord& record : records) {
    list.push(Value::object()
                  .set("place", record.place)
                  .set("from", record.from)
                  .set("asked", record.asked)
                  .set("got", record.got)
                  .set("error", record.error));
  }
  return list;
}

Value volume_value(const VolumeRecord& volume) {
  return Value::object()
      .set("before", volume.before)
      .set("after", volume.after)
      .set("relative_change", volume.relative_change)
      .set("bound", volume.bound)
      .set("total_bound", volume.total_bound)
      .set("wanted_change", volume.wanted_change)
      .set("kept", volume.kept);
}

Value follower_values(const std::vector<FollowRecord>& followers) {
  Value list = Value::list();
  for (const FollowRecord& record : followers) {
    list.push(Value::object()
                  .set("patch", record.patch)
                  .set("deviation", record.deviation)
                  .set("max_distance", record.max_distance)
                  .set("poles_before", record.poles_before)
                  .set("poles_after", record.poles_after));
  }
  return list;
}

Value conflict_values(const std::vector<NamedConflict>& conflicts) {
  Value list = Value::list();
  for (const NamedConflict& conflict : conflicts) {
    std::vector<std::string> multipliers;
    for (const Rational& multiplier : conflict.multipliers) {
      multipliers.push_back(multiplier.to_string());
    }
    list.push(Value::object()
                  .set("constraints", conflict.constraints)
                  .set("multipliers", multipliers)
                  .set("residual", conflict.residual));
  }
  return list;
}

// The edit with all defaults written out, as the tree of its own file format.
Value resolved_value(const Edit& edit) {
  const internal::Json document = internal::Json::parse(format_edits({{edit}}));
  struct Walk {
    Value operator()(const internal::Json& json) const {
      if (json.is_object()) {
        Value object = Value::object();
        for (const auto& item : json.items()) object.set(item.key(), (*this)(item.value()));
        return object;
      }
      if (json.is_array()) {
        Value list = Value::list();
        for (const auto& item : json) list.push((*this)(item));
        return list;
      }
      if (json.is_boolean()) return json.get<bool>();
      if (json.is_number_integer()) return json.get<long>();
      if (json.is_number()) return json.get<double>();
      if (json.is_string()) return json.get<std::string>();
      return {};
    }
  };
  return Walk{}(document["edits"][0]);
}

}  // namespace

Value certificate_value(const Certificate& c) {
  Value locked = Value::list();
  for (const LockRecord& record : c.locked) {
    locked.push(Value::object()
                    .set("patch", record.patch)
                    .set("reason", record.reason)
                    .set("coefficients", record.coefficients));
  }
  Value timings = Value::object();
  for (const auto& [name, milliseconds] : c.timings_ms) timings.set(name, milliseconds);
  return Value::object()
      .set("name", c.name)
      .set("outcome", std::string(name_of(c.outcome)))
      .set("reason", c.reason)
      .set("volume", volume_value(c.volume))
      .set("moves", place_records(c.moves))
      .set("holds", place_records(c.holds))
      .set("followers", follower_values(c.followers))
      .set("volume_of_followers", c.volume_of_followers)
      .set("joins", Value::object()
                        .set("count", c.joins.count)
                        .set("max_gap", c.joins.max_gap)
                        .set("max_angle_rad", c.joins.max_angle_rad)
                        .set("max_curvature_jump", c.joins.max_curvature_jump)
                        .set("angle_change_rad", c.joins.angle_change_rad))
      .set("skin", Value::object()
                       .set("relations", c.skin.relations)
                       .set("residual", c.skin.residual)
                       .set("joins", c.skin.change.joins)
                       .set("knot_lines", c.skin.change.knot_lines)
                       .set("poles", c.skin.change.poles)
                       .set("angle_change_rad", c.skin.change.angle_rad)
                       .set("curvature_change", c.skin.change.curvature))
      .set("constraints", Value::object()
                              .set("rows", c.rows)
                              .set("rank", c.rank)
                              .set("redundant", c.redundant)
                              .set("conflicting", c.conflicting)
                              .set("conflicts", conflict_values(c.conflicts))
                              .set("freedom_left", c.freedom_left))
      .set("moved", Value::object()
                        .set("coefficients", c.coefficients)
                        .set("poles", c.poles_moved)
                        .set("patches", c.patches_moved)
                        .set("max_distance", c.max_distance))
      .set("locked", locked)
      .set("energy", Value::object().set("before", c.energy_before).set("after", c.energy_after))
      .set("iterations", c.iterations)
      .set("stationarity", c.stationarity)
      .set("timings_ms", timings)
      .set("resolved",
           resolved_value(c.resolved).set("instruction_set", to_string(best_instruction_set())));
}

Outcome overall_outcome(const std::vector<Certificate>& certificates) {
  for (const Certificate& c : certificates) {
    if (c.outcome != Outcome::kDone) return c.outcome;
  }
  return Outcome::kDone;
}

std::string format_report(const std::vector<Certificate>& certificates, Outcome outcome,
                          const Value::Object& extra) {
  Value edits = Value::list();
  for (const Certificate& c : certificates) edits.push(certificate_value(c));
  Value report = Value::object()
                     .set("isochor_report", 1)
                     .set("outcome", std::string(name_of(outcome)))
                     .set("edits", edits);
  for (const auto& [key, value] : extra) report.set(key, value);
  return to_json(report);
}

}  // namespace isochor
