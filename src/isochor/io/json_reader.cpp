#include "isochor/io/json_reader.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <unordered_set>

#include "isochor/base/error.h"

namespace isochor::internal {
namespace {

// The library's message without its own "[json.exception...]" prefix, and without the megabytes
// that it may quote.
std::string plain_message(const std::string& what) {
  const size_t end = what.find("] ");
  const std::string text = end == std::string::npos ? what : what.substr(end + 2);
  constexpr size_t kHead = 200, kTail = 60;
  if (text.size() <= kHead + kTail) return text;
  return text.substr(0, kHead) + "..." + text.substr(text.size() - kTail);
}

// Builds the tree from the events of the parser, in time linear in the text: the library's own
// builder looks through all keys of an object for each new one.
class TreeBuilder {
 public:
  explicit TreeBuilder(const std::string& file) : file_(file) {}
  Json take() { return std::move(root_); }

  bool null() { return put(nullptr); }
  bool boolean(bool value) { return put(value); }
  bool number_integer(std::int64_t value) { return put(value); }
  bool number_unsigned(std::uint64_t value) { return put(value); }
  bool number_float(double value, const std::string&) { return put(value); }
  bool string(std::string& value) { return put(std::move(value)); }
  bool binary(Json::binary_t&) { return false; }  // not in texts
  bool start_object(size_t) {
    open(Json::object());
    keys_.emplace_back();
    return true;
  }
  bool key(std::string& key) {
    if (!keys_.back().insert(key).second) {
      throw InputError(file_, key, "the key occurs twice in one object");
    }
    key_ = key;
    return true;
  }
  bool end_object() {
    keys_.pop_back();
    open_.pop_back();
    return true;
  }
  bool start_array(size_t) {
    open(Json::array());
    return true;
  }
  bool end_array() {
    open_.pop_back();
    return true;
  }
  bool parse_error(size_t, const std::string&, const Json::exception& error) {
    throw InputError(file_, "", "not valid JSON: " + plain_message(error.what()));
  }

 private:
  Json* place(Json value) {
    if (open_.empty()) return &(root_ = std::move(value));
    Json& parent = *open_.back();
    if (parent.is_object()) return &append(parent, key_, std::move(value));
    parent.push_back(std::move(value));
    return &parent.back();
  }
  bool put(Json value) {
    place(std::move(value));
    return true;
  }
  // No file of ours is deep, and code that walks a tree should not meet the end of the stack.
  void open(Json value) {
    constexpr size_t kDeepest = 64;
    if (open_.size() == kDeepest) {
      throw InputError(file_, key_, "lists and objects are nested more than 64 deep");
    }
    open_.push_back(place(std::move(value)));
  }

  const std::string& file_;
  Json root_;
  std::vector<Json*> open_;  // from the outermost; the innermost grows, so all stay where they are
  std::vector<std::unordered_set<std::string>> keys_;  // of the open objects
  std::string key_;
};

}  // namespace

Json parse_json(const std::string& text, const std::string& file) {
  TreeBuilder builder(file);
  Json::sax_parse(text, &builder);
  return builder.take();
}

Json& append(Json& object, const std::string& key, Json value) {
  auto& members = object.get_ref<Json::object_t&>();
  return static_cast<Json::object_t::Container&>(members)
      .emplace_back(key, std::move(value))
      .second;
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

Rational JsonValue::rational() const {
  if (value_->is_number_integer()) return Rational::parse(value_->dump());
  if (!value_->is_string()) return Rational(number());
  try {
    return Rational::parse(value_->get_ref<const std::string&>());
  } catch (const InputError& error) {
    fail(error.reason() + ", found " + print());
  }
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
