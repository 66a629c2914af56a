#include "make_data/model_text.h"

#include <algorithm>
#include <map>
#include <sstream>

#include "make_data/step_text.h"

namespace make_data {
namespace {

using isochor::Surface;
using isochor::Vec3;

bool before(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

std::string number(double value) {
  std::string text = step_real(value);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string knots_of(const isochor::KnotVector& knots) {
  std::string text;
  for (double knot : knots.knots()) text += (text.empty() ? "" : ",") + number(knot);
  return "[" + text + "]";
}

// A grid of entries, one row of text for each i.
template <typename Entry>
std::string grid_of(const Surface& surface, const Entry& entry) {
  std::string text;
  for (int i = 0; i < surface.u_size(); ++i) {
    text += i > 0 ? ",\n             [" : "[";
    for (int j = 0; j < surface.v_size(); ++j) text += (j > 0 ? "," : "") + entry(i, j);
    text += "]";
  }
  return "[" + text + "]";
}

}  // namespace

std::string model_text(const NamedSurfaces& surfaces) {
  std::map<Vec3, int, bool (*)(const Vec3&, const Vec3&)> numbers(before);
  std::vector<Vec3> points;
  std::ostringstream patches;
  for (const auto& [name, surface] : surfaces) {
    const auto point = [&, &shape = surface](int i, int j) {
      const auto [place, fresh] =
          numbers.emplace(shape.pole(i, j), static_cast<int>(points.size()));
      if (fresh) points.push_back(shape.pole(i, j));
      return std::to_string(place->second);
    };
    const auto weight = [&, &shape = surface](int i, int j) {
      return number(shape.weights()[shape.index(i, j)]);
    };
    patches << (patches.tellp() > 0 ? ",\n" : "") << "  {\"name\": \"" << name
            << "\", \"degree\": [" << surface.u_knots().degree() << ","
            << surface.v_knots().degree() << "],\n   \"knots\": [" << knots_of(surface.u_knots())
            << ",\n             " << knots_of(surface.v_knots())
            << "],\n   \"poles\": " << grid_of(surface, point)
            << ",\n   \"weights\": " << (surface.rational() ? grid_of(surface, weight) : "null")
            << ", \"reversed\": false}";
  }
  std::ostringstream text;
  text << "{\"isochor_model\": 1, \"unit\": \"m\",\n \"points\": [\n";
  for (size_t i = 0; i < points.size(); ++i) {
    text << "  [" << number(points[i].x()) << "," << number(points[i].y()) << ","
         << number(points[i].z()) << "]" << (i + 1 < points.size() ? ",\n" : "\n");
  }
  text << " ],\n \"patches\": [\n" << patches.str() << "\n ]}\n";
  return text.str();
}

}  // namespace make_data
