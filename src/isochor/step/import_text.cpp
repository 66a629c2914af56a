#include "isochor/step/import_text.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "isochor/base/error.h"

namespace isochor::internal {
namespace {

constexpr size_t kListed = 20;

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

enum class Role { kOther, kRepresentation, kSolid, kShell, kFace, kSet, kPoint };

Role role_of(std::string_view keyword) {
  static constexpr std::array<std::pair<std::string_view, Role>, 14> kRoles = {{
      {"ADVANCED_FACE", Role::kFace},
      {"FACE_SURFACE", Role::kFace},
      {"CARTESIAN_POINT", Role::kPoint},
      {"DIRECTION", Role::kPoint},
      {"CLOSED_SHELL", Role::kShell},
      {"OPEN_SHELL", Role::kShell},
      {"CONNECTED_FACE_SET", Role::kShell},
      {"MANIFOLD_SOLID_BREP", Role::kSolid},
      {"BREP_WITH_VOIDS", Role::kSolid},
      {"FACETED_BREP", Role::kSolid},
      {"FACETED_BREP_AND_BREP_WITH_VOIDS", Role::kSolid},
      {"GEOMETRIC_SET", Role::kSet},
      {"GEOMETRIC_CURVE_SET", Role::kSet},
      {"GEOMETRIC_SET_REPLICA", Role::kSet},
  }};
  for (const auto& [name, role] : kRoles) {
    if (keyword == name) return role;
  }
  return ends_with(keyword, "SHAPE_REPRESENTATION") ? Role::kRepresentation : Role::kOther;
}

bool is_surface(const std::vector<Part21Record>& records) {
  return std::any_of(records.begin(), records.end(), [](const Part21Record& record) {
    return ends_with(record.keyword, "SURFACE") || ends_with(record.keyword, "PLANE") ||
           record.keyword == "B_SPLINE_SURFACE_WITH_KNOTS" ||
           ends_with(record.keyword, "SURFACE_OF_REVOLUTION") ||
           ends_with(record.keyword, "SURFACE_OF_LINEAR_EXTRUSION");
  });
}

class Reading {
 public:
  explicit Reading(const Part21File& file) : file_(file) {
    const auto& instances = file.instances();
    nodes_.resize(instances.size() + 1);
    for (size_t k = 0; k < instances.size(); ++k) {
      nodes_[k].references = references_.size();
      read(k);
    }
    nodes_.back().references = references_.size();
    for (size_t k = 0; k < instances.size(); ++k) {
      if (nodes_[k].role == Role::kRepresentation) reach(k);
    }
    for (size_t k = 0; k < instances.size(); ++k) count(k);
    shapes_.entities = static_cast<int>(instances.size());
    if (more_broken_ > 0) shapes_.broken.push_back(std::to_string(more_broken_) + " more");
  }

  StatedShapes take() { return std::move(shapes_); }

 private:
  struct Node {
    Role role = Role::kOther;
    bool surface = false, reached = false, in_set = false;
    size_t references = 0;  // where its references begin in references_; they end at the next one's
  };

  void broken(std::string text) {
    if (shapes_.broken.size() < kListed) {
      shapes_.broken.push_back(std::move(text));
    } else {
      ++more_broken_;
    }
  }

  std::string name(const Part21Instance& instance) const {
    return "#" + std::to_string(instance.number) + " (line " + std::to_string(instance.line) +
           (instance.complex() ? "" : ", " + std::string(instance.keyword)) + ")";
  }

  void read(size_t k) {
    const Part21Instance& instance = file_.instances()[k];
    Node& node = nodes_[k];
    std::vector<Part21Record> records;
    try {
      records = file_.records(instance);
    } catch (const InputError& e) {
      broken(e.entity() + ": " + e.reason());
      return;
    }
    for (const Part21Record& record : records) {
      if (node.role == Role::kOther) node.role = role_of(record.keyword);
      for (const Part21Value& value : record.arguments) follow(instance, value);
    }
    node.surface = is_surface(records);
    if (node.role == Role::kPoint && !has_coordinates(records.front())) {
      broken(name(instance) + ": has no one to three numbers as coordinates");
    }
  }

  static bool has_coordinates(const Part21Record& record) {
    if (record.arguments.size() != 2 || !record.arguments[1].is(Part21Kind::kList)) return false;
    const auto& items = record.arguments[1].items;
    return !items.empty() && items.size() <= 3 &&
           std::all_of(items.begin(), items.end(), [](const Part21Value& item) {
             return item.numeric() && std::isfinite(item.number);
           });
  }

  // No list of the standard does: knots, weights, multiplicities, coordinates. Points count their
  // coordinates anyway.
  static bool mixes_numbers(const std::vector<Part21Value>& items) {
    const auto numbers = std::count_if(items.begin(), items.end(),
                                       [](const Part21Value& item) { return item.numeric(); });
    return numbers > 0 && numbers < static_cast<long>(items.size());
  }

  void follow(const Part21Instance& from, const Part21Value& value) {
    if (value.is(Part21Kind::kReference)) {
      const Part21Instance* to = file_.find(value.reference);
      if (to == nullptr) {
        broken(name(from) + ": refers to #" + std::to_string(value.reference) +
               ", which does not exist");
      } else {
        references_.push_back(static_cast<size_t>(to - file_.instances().data()));
      }
    }
    if (value.is(Part21Kind::kList) && mixes_numbers(value.items)) {
      broken(name(from) + ": has a list that mixes numbers with what is none");
    }
    for (const Part21Value& item : value.items) follow(from, item);
  }

  void reach(size_t start) {
    std::vector<size_t> waiting = {start};
    while (!waiting.empty()) {
      const size_t k = waiting.back();
      waiting.pop_back();
      if (nodes_[k].reached) continue;
      nodes_[k].reached = true;
      for (size_t at = nodes_[k].references; at < nodes_[k + 1].references; ++at) {
        const size_t to = references_[at];
        if (nodes_[k].role == Role::kSet) nodes_[to].in_set = true;
        waiting.push_back(to);
      }
    }
  }

  void count(size_t k) {
    const Node& node = nodes_[k];
    const bool face = node.role == Role::kFace || (node.surface && node.in_set);
    if (face && !node.reached) shapes_.unused.push_back(name(file_.instances()[k]));
    if (!node.reached) return;
    shapes_.counts.solids += node.role == Role::kSolid;
    shapes_.counts.shells += node.role == Role::kShell;
    if (!face) return;
    ++shapes_.counts.faces;
    shapes_.faces.push_back({file_.instances()[k].number, k, name(file_.instances()[k])});
  }

  const Part21File& file_;
  StatedShapes shapes_;
  std::vector<Node> nodes_;  // one for each instance, and an end
  std::vector<size_t> references_;
  int more_broken_ = 0;
};

// Face instances of a text that our grammar refuses: "= ADVANCED_FACE (".
int rough_face_count(const std::string& text) {
  int count = 0;
  for (const std::string_view keyword : {"ADVANCED_FACE", "FACE_SURFACE"}) {
    for (size_t at = text.find(keyword); at != std::string::npos;
         at = text.find(keyword, at + keyword.size())) {
      const size_t before = at == 0 ? std::string::npos : text.find_last_not_of(" \t\r\n", at - 1);
      count += before != std::string::npos && text[before] == '=' ? 1 : 0;
    }
  }
  return count;
}

StatedShapes unreadable(const std::string& path, const InputError& why) {
  StatedShapes shapes;
  shapes.readable = false;
  shapes.broken.push_back(why.entity() + ": " + why.reason());
  shapes.counts.faces = rough_face_count(file_bytes(path));
  return shapes;
}

}  // namespace

StatedShapes stated_shapes(const Part21File& file) { return Reading(file).take(); }

StatedShapes stated_shapes(const std::string& path) {
  try {
    return stated_shapes(load_part21(path));
  } catch (const InputError& e) {
    return unreadable(path, e);
  }
}

}  // namespace isochor::internal
