#include "isochor/io/value.h"

#include "isochor/base/error.h"
#include "isochor/io/json_reader.h"

namespace isochor {
namespace {

using internal::Json;

Json convert(const Value& value) {
  struct Visitor {
    Json operator()(std::monostate) const { return nullptr; }
    Json operator()(bool b) const { return b; }
    Json operator()(long i) const { return i; }
    Json operator()(double d) const { return d; }
    Json operator()(const std::string& s) const { return s; }
    Json operator()(const Value::List& list) const {
      Json out = Json::array();
      for (const Value& item : list) out.push_back(convert(item));
      return out;
    }
    Json operator()(const Value::Object& object) const {
      Json out = Json::object();
      for (const auto& [key, item] : object) internal::append(out, key, convert(item));
      return out;
    }
  };
  return std::visit(Visitor{}, value.content());
}

}  // namespace

Value::Value(const Vec3& value) : content_(List{value.x(), value.y(), value.z()}) {}

Value& Value::push(Value item) {
  auto* list = std::get_if<List>(&content_);
  ISOCHOR_REQUIRE(list != nullptr, "not a list");
  list->push_back(std::move(item));
  return *this;
}

Value& Value::set(const std::string& key, Value item) {
  auto* object = std::get_if<Object>(&content_);
  ISOCHOR_REQUIRE(object != nullptr, "not an object");
  object->emplace_back(key, std::move(item));
  return *this;
}

std::string to_json(const Value& value, int indent) {
  return convert(value).dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace isochor
