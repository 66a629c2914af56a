#include "isochor/step/part21_splines.h"

#include <algorithm>

#include "isochor/base/error.h"
#include "isochor/step/part21_edit.h"

namespace isochor::internal {
namespace {

// Lists of instances with too many repeated knots are damage; this keeps them from eating memory.
constexpr double kMostMultiplicity = 1000.0;

class Reader {
 public:
  Reader(const Part21File& file, const Part21Instance& instance)
      : file_(file), instance_(instance) {}

  SplineText simple(const std::vector<Part21Value>& a, bool surface, bool knots) {
    const size_t directions = surface ? 2 : 1;
    degrees_and_points(a, 1, directions);
    const size_t first = surface ? 8 : 6;
    if (knots) knot_lists(a, first, directions);
    text_.instance = &instance_;
    return std::move(text_);
  }

  std::optional<SplineText> complex() {
    const auto parts = file_.records(instance_);
    const auto part = [&](std::string_view keyword) -> const Part21Record* {
      for (const auto& p : parts) {
        if (p.keyword == keyword) return &p;
      }
      return nullptr;
    };
    const bool surface = part("B_SPLINE_SURFACE") != nullptr;
    const std::string kind = surface ? "SURFACE" : "CURVE";
    const auto* base = part("B_SPLINE_" + kind);
    if (base == nullptr) return std::nullopt;
    const size_t directions = surface ? 2 : 1;
    degrees_and_points(base->arguments, 0, directions);
    if (const auto* knots = part("B_SPLINE_" + kind + "_WITH_KNOTS")) {
      knot_lists(knots->arguments, 0, directions);
    }
    text_.bezier = part("BEZIER_" + kind) != nullptr;
    if (const auto* rational = part("RATIONAL_B_SPLINE_" + kind)) {
      numbers(at(rational->arguments, 0), text_.weights);
    }
    text_.instance = &instance_;
    return std::move(text_);
  }

  SplineText bezier(const std::vector<Part21Value>& a, bool surface) {
    text_.bezier = true;
    return simple(a, surface, false);
  }

 private:
  [[noreturn]] void refuse(const std::string& reason) const {
    file_.refuse(instance_.span.begin, "#" + std::to_string(instance_.number) + ": " + reason);
  }

  const Part21Value& at(const std::vector<Part21Value>& a, size_t k) const {
    if (k >= a.size()) refuse("has too few arguments");
    return a[k];
  }

  void degrees_and_points(const std::vector<Part21Value>& a, size_t first, size_t directions) {
    for (size_t k = 0; k < directions; ++k) {
      const Part21Value& degree = at(a, first + k);
      if (!degree.is(Part21Kind::kInteger) || degree.number < 1 ||
          degree.number > kMostMultiplicity) {
        refuse("has no valid degree");
      }
      text_.degrees.push_back(static_cast<int>(degree.number));
    }
    const Part21Value& list = at(a, first + directions);
    if (directions == 1) {
      points(list);
    } else {
      if (!list.is(Part21Kind::kList)) refuse("has no list of points");
      for (const auto& row : list.items) points(row);
    }
  }

  void points(const Part21Value& list) {
    if (!list.is(Part21Kind::kList)) refuse("has no list of points");
    for (const auto& point : list.items) {
      if (!point.is(Part21Kind::kReference)) refuse("has a pole that is no reference");
      text_.points.push_back(point);
    }
  }

  // Lists of numbers, or lists of lists.
  void numbers(const Part21Value& list, std::vector<double>& out) const {
    for (const auto& item : list.items) {
      if (item.is(Part21Kind::kList)) {
        numbers(item, out);
      } else if (item.numeric()) {
        out.push_back(item.number);
      } else {
        refuse("has something else in a list of numbers");
      }
    }
  }

  void knot_lists(const std::vector<Part21Value>& a, size_t first, size_t directions) {
    for (size_t k = 0; k < directions; ++k) {
      std::vector<double> counts, values, flat;
      numbers(at(a, first + k), counts);
      numbers(at(a, first + directions + k), values);
      if (counts.size() != values.size()) refuse("has not one multiplicity for each knot");
      for (size_t j = 0; j < values.size(); ++j) {
        if (!(counts[j] >= 1.0 && counts[j] <= kMostMultiplicity)) {
          refuse("has a multiplicity that is not valid");
        }
        flat.insert(flat.end(), static_cast<size_t>(counts[j]), values[j]);
      }
      text_.knots.push_back(std::move(flat));
    }
  }

  const Part21File& file_;
  const Part21Instance& instance_;
  SplineText text_;
};

// Weights that are all equal cancel.
std::vector<double> effective(const std::vector<double>& weights) {
  const bool equal =
      std::all_of(weights.begin(), weights.end(), [&](double w) { return w == weights.front(); });
  return equal ? std::vector<double>() : weights;
}

// "(a,b,c)" of anything.
template <typename Text>
std::string list_text(size_t count, const Text& item) {
  std::string text = "(";
  for (size_t k = 0; k < count; ++k) text += (k > 0 ? "," : "") + item(k);
  return text + ")";
}

template <typename Text>
std::string grid_text(const std::vector<KnotVector>& knots, const Text& item) {
  const auto rows = static_cast<size_t>(knots[0].size());
  if (knots.size() == 1) return list_text(rows, item);
  const auto columns = static_cast<size_t>(knots[1].size());
  return list_text(rows, [&](size_t i) {
    return list_text(columns, [&](size_t j) { return item(i * columns + j); });
  });
}

// Whether the first and the last poles of a direction are the same.
bool closed(const SplineValue& value, size_t direction) {
  const auto rows = static_cast<size_t>(value.knots[0].size());
  const size_t columns = value.knots.size() == 1 ? 1 : static_cast<size_t>(value.knots[1].size());
  const size_t lines = direction == 0 ? columns : rows;
  for (size_t k = 0; k < lines; ++k) {
    const size_t first = direction == 0 ? k : k * columns;
    const size_t last = direction == 0 ? (rows - 1) * columns + k : k * columns + columns - 1;
    if (value.poles[first] != value.poles[last]) return false;
  }
  return true;
}

std::string knots_text(const SplineValue& value) {
  std::string counts, values;
  for (const KnotVector& vector : value.knots) {
    std::vector<double> breaks = vector.knots();
    breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
    counts += list_text(breaks.size(),
                        [&](size_t k) { return std::to_string(vector.multiplicity(breaks[k])); }) +
              ",";
    values += list_text(breaks.size(), [&](size_t k) { return step_real(breaks[k]); }) + ",";
  }
  return counts + values + ".UNSPECIFIED.";
}

}  // namespace

std::optional<SplineText> spline_text(const Part21File& file, const Part21Instance& instance) {
  Reader reader(file, instance);
  if (instance.complex()) return reader.complex();
  const std::string_view kind = instance.keyword;
  const bool surface = kind.size() > 7 && kind.substr(kind.size() - 7) == "SURFACE";
  if (kind == "B_SPLINE_SURFACE_WITH_KNOTS" || kind == "B_SPLINE_CURVE_WITH_KNOTS") {
    const bool knots_of_surface = kind == "B_SPLINE_SURFACE_WITH_KNOTS";
    return reader.simple(file.record(instance, kind).arguments, knots_of_surface, true);
  }
  if (kind == "BEZIER_SURFACE" || kind == "BEZIER_CURVE") {
    return reader.bezier(file.record(instance, kind).arguments, surface);
  }
  for (const char* uniform : {"QUASI_UNIFORM_", "UNIFORM_"}) {
    if (kind == std::string(uniform) + (surface ? "SURFACE" : "CURVE")) {
      return reader.simple(file.record(instance, kind).arguments, surface, false);
    }
  }
  return std::nullopt;
}

SplineValue spline_value(const Surface& surface) {
  return {{surface.u_knots(), surface.v_knots()}, surface.poles(), surface.weights()};
}

bool same_basis(const SplineText& text, const SplineValue& value) {
  if (text.degrees.size() != value.knots.size() || text.points.size() != value.poles.size()) {
    return false;
  }
  if (effective(text.weights) != effective(value.weights)) return false;
  for (size_t k = 0; k < value.knots.size(); ++k) {
    if (text.degrees[k] != value.knots[k].degree()) return false;
    if (text.knots.empty()) {
      const bool one_span = value.knots[k].size() == text.degrees[k] + 1;
      if (!text.bezier || !one_span || value.knots[k].begin() != 0.0 ||
          value.knots[k].end() != 1.0) {
        return false;
      }
    } else if (text.knots[k] != value.knots[k].knots()) {
      return false;
    }
  }
  return true;
}

Vec3 point_of(const Part21File& file, const Part21Instance& instance) {
  const auto record = file.record(instance, "CARTESIAN_POINT");
  const auto refuse = [&] {
    file.refuse(instance.span.begin,
                "#" + std::to_string(instance.number) + " has not three coordinates");
  };
  if (record.arguments.size() != 2 || record.arguments[1].items.size() != 3) refuse();
  for (const auto& x : record.arguments[1].items) {
    if (!x.numeric()) refuse();
  }
  const auto& x = record.arguments[1].items;
  return {x[0].number, x[1].number, x[2].number};
}

std::string spline_body(const SplineValue& value, const std::vector<std::uint64_t>& points) {
  ISOCHOR_REQUIRE(points.size() == value.poles.size(), points.size(), value.poles.size());
  const bool surface = value.knots.size() == 2;
  std::string degrees, flags = ".UNSPECIFIED.,";
  for (size_t k = 0; k < value.knots.size(); ++k) {
    degrees += std::to_string(value.knots[k].degree()) + ",";
    flags += closed(value, k) ? ".T.," : ".F.,";
  }
  flags += ".F.";
  const std::string base =
      degrees + grid_text(value.knots, [&](size_t k) { return "#" + std::to_string(points[k]); }) +
      "," + flags;
  const std::string kind = surface ? "SURFACE" : "CURVE";
  if (value.weights.empty()) {
    return "B_SPLINE_" + kind + "_WITH_KNOTS(''," + base + "," + knots_text(value) + ")";
  }
  const std::string weights =
      grid_text(value.knots, [&](size_t k) { return step_real(value.weights[k]); });
  return "(BOUNDED_" + kind + "()B_SPLINE_" + kind + "(" + base + ")B_SPLINE_" + kind +
         "_WITH_KNOTS(" + knots_text(value) + ")" + (surface ? "" : "CURVE()") +
         "GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_" + kind + "(" + weights +
         ")REPRESENTATION_ITEM('')" + (surface ? "SURFACE()" : "") + ")";
}

}  // namespace isochor::internal
