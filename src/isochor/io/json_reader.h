// Strict reading of JSON: every value is asked for by name and type, unknown and repeated keys are
// errors, and each error says where in the file ("edits[0].extent.radius") and what was found.
// Internal to io: this is the only layer that sees the JSON library.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "isochor/base/vec3.h"
#include "isochor/exact/rational.h"

namespace isochor::internal {

using Json = nlohmann::ordered_json;

// Parses a whole document in time linear in its length. Throws InputError with line and column,
// also for repeated keys and for lists and objects nested more than 64 deep.
Json parse_json(const std::string& text, const std::string& file);

// Adds a key that the object does not have, which is not checked: constant time, where the library
// looks through all keys.
Json& append(Json& object, const std::string& key, Json value);

// A JSON value and where it stands.
class JsonValue {
 public:
  JsonValue(const Json& value, std::string where, const std::string& file)
      : value_(&value), where_(std::move(where)), file_(&file) {}

  const Json& raw() const { return *value_; }
  const std::string& where() const { return where_; }
  bool is_string() const { return value_->is_string(); }
  bool is_object() const { return value_->is_object(); }
  bool is_array() const { return value_->is_array(); }
  bool is_null() const { return value_->is_null(); }

  // A finite number, or an exact string such as "3/2" or "0.1".
  double number() const;
  // The same without rounding: a number with a point or an exponent is the double nearest to it, as
  // everywhere in JSON; an integer below 2^64 and a string are exactly what is written.
  Rational rational() const;
  int integer() const;
  bool boolean() const;
  std::string text() const;
  Vec3 vec3() const;
  Uv uv() const;
  size_t size() const;  // of an array
  JsonValue at(size_t i) const;
  std::vector<double> numbers() const;
  std::vector<int> integers() const;
  std::vector<std::string> texts() const;

  // Throws InputError("file: where: reason").
  [[noreturn]] void fail(const std::string& reason) const;
  // A short print of the value for messages.
  std::string print() const;

 private:
  friend class JsonObject;
  const Json* value_;
  std::string where_;
  const std::string* file_;
};

// An object whose keys must all be asked for before `finish`.
class JsonObject {
 public:
  explicit JsonObject(const JsonValue& value);

  bool has(const std::string& key) const;
  // The value of a key that must be there.
  JsonValue operator[](const std::string& key);
  // Calls `use` with the value when the key is there.
  template <typename Use>
  void with(const std::string& key, Use use) {
    if (has(key)) use((*this)[key]);
  }
  // Throws for the first key that nobody asked for, listing the known ones.
  void finish() const;
  // All keys, in file order; marks them as used (for maps with free keys).
  std::vector<std::string> keys();
  const JsonValue& value() const { return value_; }

 private:
  JsonValue value_;
  std::vector<std::string> known_;
};

// Checks `"kind": version` and `"requires"` of the top-level object.
void check_header(JsonObject& object, const std::string& kind, int newest);

}  // namespace isochor::internal
