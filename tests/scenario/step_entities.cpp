#include "scenario/step_entities.h"

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace isochor::testing {

namespace {

// The items of "(a,(b,c),'d')" at its outer level.
std::vector<std::string> items(const std::string& list) {
  std::vector<std::string> result;
  int depth = 0;
  std::string item;
  for (char c : list) {
    if (c == ')' && --depth == 0) break;
    if (c == ',' && depth == 1) {
      result.push_back(item);
      item.clear();
    } else if (depth > 0) {
      item += c;
    }
    if (c == '(') ++depth;
  }
  result.push_back(item);
  return result;
}

std::vector<std::string> arguments(const std::map<int, std::string>& entities, int number) {
  const std::string& text = entities.at(number);
  return items(text.substr(text.find('(')));
}

int reference(const std::string& item) { return std::stoi(item.substr(1)); }

Vec3 point(const std::map<int, std::string>& entities, const std::string& item) {
  const auto coordinates = items(arguments(entities, reference(item))[1]);
  Vec3 p = Vec3::Zero();  // a point of the parameter plane has only two
  for (size_t k = 0; k < coordinates.size(); ++k) {
    p[static_cast<Eigen::Index>(k)] = std::strtod(coordinates[k].c_str(), nullptr);
  }
  return p;
}

KnotVector knot_vector(const std::string& degree, const std::string& counts,
                       const std::string& values) {
  const auto count_items = items(counts), value_items = items(values);
  std::vector<double> knots;
  for (size_t i = 0; i < count_items.size(); ++i) {
    knots.insert(knots.end(), std::stoul(count_items[i]),
                 std::strtod(value_items.at(i).c_str(), nullptr));
  }
  return {std::stoi(degree), knots};
}

}  // namespace

std::map<int, std::string> step_entities(const std::string& text) {
  std::map<int, std::string> entities;
  std::string flat;
  for (char c : text) {
    if (c != '\n' && c != '\r') flat += c;
  }
  size_t at = flat.find("DATA;") + 5;
  while (at < flat.size() && flat[at] == '#') {
    const size_t end = flat.find(';', at), equals = flat.find('=', at);
    entities[std::stoi(flat.substr(at + 1))] = flat.substr(equals + 1, end - equals - 1);
    at = end + 1;
  }
  return entities;
}

std::vector<int> entities_named(const std::map<int, std::string>& entities,
                                const std::string& name) {
  std::vector<int> numbers;
  for (const auto& [number, text] : entities) {
    if (text.rfind(name + "(", 0) == 0) numbers.push_back(number);
  }
  return numbers;
}

Surface step_surface(const std::map<int, std::string>& entities, int number) {
  const auto a = arguments(entities, number);
  std::vector<Vec3> poles;
  for (const std::string& row : items(a.at(3))) {
    for (const std::string& item : items(row)) poles.push_back(point(entities, item));
  }
  return {knot_vector(a.at(1), a.at(8), a.at(10)), knot_vector(a.at(2), a.at(9), a.at(11)), poles};
}

StepCurve step_curve(const std::map<int, std::string>& entities, int number) {
  const auto a = arguments(entities, number);
  std::vector<Vec3> poles;
  for (const std::string& item : items(a.at(2))) poles.push_back(point(entities, item));
  return {knot_vector(a.at(1), a.at(6), a.at(7)), poles};
}

std::string read_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(path + " cannot be read");
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace isochor::testing
