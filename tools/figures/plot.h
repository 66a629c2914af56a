// Line plots as SVG and as comma-separated values.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace figures {

struct Curve {
  std::string name;
  std::vector<std::pair<double, double>> points;  // by ascending abscissa
  bool dashed = false;
};

struct Plot {
  std::string title;
  std::string x_label, y_label;
  std::vector<Curve> curves;
  bool logarithmic = false;  // powers of ten upwards; values below 1 are drawn at 1
  double y_low = 0;          // where a linear scale begins
};

std::string to_svg(const Plot& plot);
// One line for each abscissa of any curve; a curve's column is empty where it has no point.
std::string to_csv(const Plot& plot);

// The text with the characters that XML reserves written as entities.
std::string escaped(const std::string& text);

// Throws std::runtime_error with the path when the file cannot be written whole.
void write_file(const std::string& path, const std::string& text);

}  // namespace figures
