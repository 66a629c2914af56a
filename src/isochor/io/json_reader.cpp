#include "isochor/io/json_reader.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "isochor/base/error.h"
#include "isochor/exact/rational.h"

namespace isochor::internal {
namespace {

// The library's message without its own "[json.exception...]" prefix.
std::string plain_message(const std::string& what) {
  const size_t end = what.find("] ");
  return end == std::string::npos ? what : what.substr(end + 2);
}

}  // namespace

Json parse_json(const std::string& text, const std::string& file) {
  std::vector<std::set<std::string>> open_objects;
  const auto reject_repeats = [&](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) open_objects.emplace_back();
    if (event == Json::parse_event_t::object_end) open_objects.pop_back();
    if (event == Json::parse_event_t::key) {
      const auto key = parsed.get<std::string>();
      if (!open_objects.back().insert(key).second) {
        throw InputError(file, key, "the key occurs twice in one object");
      }
    }
    return true;
  };
  try {
    return Json::parse(text, reject_repeats);
  } catch (const Json::exception& error) {
    throw InputError(file, "", "not valid JSON: " + plain_message(error.what()));
  }
}

void JsonValue::fail(const std::string& reason) const { throw InputError(*file_, where_, reason); }

std::string JsonValue::print() const {
  std::string text = value_->dump();
  constexpr size_t kLongest = 60;
  return text.size() <= kLongest ? text : text.substr(0, kLongest) + "...";
}

double JsonValue::number() const {
  double result = 0.0;
  if (value_->is_number()) {
    result = value_->get<double>();
  } else if (value_->is_string()) {
    try {
      result = Rational::parse(value_->get<std::string>()).to_double();
    } catch (const InputError& error) {
      fail(error.reason());
    }
  } else {
    fail("expected a number, found " + print());
  }
  if (!std::isfinite(result)) fail("expected a finite number, found " + print());
  return result;
}

int JsonValue::integer() const {
  if (!value_->is_number_integer()) fail("expected an integer, found " + print());
  const auto wide = value_->get<std::int64_t>();
  if (wide < -2147483647 || wide > 2147483647) fail("the integer " + print() + " is too large");
  return static_cast<int>(wide);
}

bool JsonValue::boolean() const {
  if (!value_->is_boolean()) fail("expected true or false, found " + print());
  return value_->get<bool>();
}

std::string JsonValue::text() const {
  if (!value_->is_string()) fail("expected a text, found " + print());
  return value_->get<std::string>();
}

size_t JsonValue::size() const {
  if (!value_->is_array()) fail("expected a list, found " + print());
  return value_->size();
}

JsonValue JsonValue::at(size_t i) const {
  return JsonValue((*value_)[i], where_ + "[" + std::to_string(i) + "]", *file_);
}

Vec3 JsonValue::vec3() const {
  if (size() != 3) fail("expected [x, y, z], found " + print());
  return Vec3(at(0).number(), at(1).number(), at(2).number());
}

Uv JsonValue::uv() const {
  if (size() != 2) fail("expected [u, v], found " + print());
  return Uv{at(0).number(), at(1).number()};
}

std::vector<double> JsonValue::numbers() const {
  std::vector<double> result;
  for (size_t i = 0; i < size(); ++i) result.push_back(at(i).number());
  return result;
}

std::vector<int> JsonValue::integers() const {
  std::vector<int> result;
  for (size_t i = 0; i < size(); ++i) result.push_back(at(i).integer());
  return result;
}

std::vector<std::string> JsonValue::texts() const {
  std::vector<std::string> result;
  for (size_t i = 0; i < size(); ++i) result.push_back(at(i).text());
  return result;
}

JsonObject::JsonObject(const JsonValue& value) : value_(value) {
  if (!value.is_object()) value.fail("expected an object { ... }, found " + value.print());
}

bool JsonObject::has(const std::string& key) const { return value_.raw().contains(key); }

JsonValue JsonObject::operator[](const std::string& key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
  if (!has(key)) value_.fail("the key \"" + key + "\" is missing");
  const std::string where = value_.where().empty() ? key : value_.where() + "." + key;
  return JsonValue(value_.raw()[key], where, *value_.file_);
}

std::vector<std::string> JsonObject::keys() {
  std::vector<std::string> all;
  for (const auto& item : value_.raw().items()) all.push_back(item.key());
  known_ = all;
  return all;
}

void JsonObject::finish() const {
  for (const auto& item : value_.raw().items()) {
    if (std::find(known_.begin(), known_.end(), item.key()) == known_.end()) {
      value_.fail("unknown key \"" + item.key() + "\"");
    }
  }
}

void check_header(JsonObject& object, const std::string& kind, int newest) {
  if (!object.has(kind)) {
    object.value().fail("not an " + kind + " file: the key \"" + kind + "\" is missing");
  }
  const JsonValue version = object[kind];
  if (version.integer() < 1 || version.integer() > newest) {
    version.fail("version " + version.print() + " is not known, the newest is " +
                 std::to_string(newest));
  }
  object.with("requires", [](const JsonValue& features) {
    for (const std::string& feature : features.texts()) {
      features.fail("requires \"" + feature + "\", which this version does not have");
    }
  });
}

}  // namespace isochor::internal
