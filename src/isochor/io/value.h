// A tree of values to be printed as JSON: what reports and `--json` results are made of.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "isochor/base/vec3.h"

namespace isochor {

// null, a truth value, a number, a text, a list or an object whose keys keep their order.
class Value {
 public:
  Value() = default;
  Value(bool value) : content_(value) {}                      // NOLINT: literals are values
  Value(int value) : content_(static_cast<long>(value)) {}    // NOLINT
  Value(long value) : content_(value) {}                      // NOLINT
  Value(double value) : content_(value) {}                    // NOLINT
  Value(const char* value) : content_(std::string(value)) {}  // NOLINT
  Value(std::string value) : content_(std::move(value)) {}    // NOLINT
  Value(const Vec3& value);                                   // NOLINT: [x, y, z]
  template <typename Item>
  Value(const std::vector<Item>& items) : content_(List()) {  // NOLINT
    for (const Item& item : items) push(Value(item));
  }

  static Value list() { return Value(List()); }
  static Value object() { return Value(Object()); }

  // Appends to a list; adds a key to an object. PreconditionError on other kinds.
  Value& push(Value item);
  Value& set(const std::string& key, Value item);

  using List = std::vector<Value>;
  using Object = std::vector<std::pair<std::string, Value>>;
  using Content = std::variant<std::monostate, bool, long, double, std::string, List, Object>;
  const Content& content() const { return content_; }

 private:
  explicit Value(List list) : content_(std::move(list)) {}
  explicit Value(Object object) : content_(std::move(object)) {}
  Content content_;
};

// JSON text; doubles are printed so that reading gives the same double, non-finite ones as null.
std::string to_json(const Value& value, int indent = 2);

}  // namespace isochor
