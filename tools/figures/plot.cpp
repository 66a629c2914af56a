#include "figures/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>

namespace figures {
namespace {

constexpr double kWidth = 760, kHeight = 460;
constexpr double kLeft = 80, kRight = 230, kTop = 44, kBottom = 58;
constexpr int kTicks = 7;

// Told apart in grey and by most colour-blind readers.
constexpr std::array<const char*, 6> kColours{"#0b5394", "#cc4125", "#38761d",
                                              "#e69f00", "#674ea7", "#434343"};

std::string number(double value) {
  std::ostringstream out;
  out.precision(6);
  out << value;
  return out.str();
}

// A round step, 1, 2 or 5 times a power of ten, that cuts `range` into at most kTicks parts.
double round_step(double range) {
  const double rough = range / kTicks;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10.0 * power;
}

struct Axis {
  double low = 0, high = 1;   // what is shown; exponents of ten when logarithmic
  double begin = 0, end = 1;  // on the page
  bool logarithmic = false;
  std::vector<double> ticks;

  double place(double value) const {
    const double at = logarithmic ? std::log10(std::max(value, 1.0)) : value;
    return begin + (at - low) / (high - low) * (end - begin);
  }
};

Axis linear_axis(double low, double high, double begin, double end) {
  if (high <= low) high = low + 1;
  Axis axis{low, high, begin, end, false, {}};
  const double step = round_step(high - low);
  axis.high = std::ceil(high / step - 1e-9) * step;
  axis.low = std::floor(low / step + 1e-9) * step;
  for (int k = 0; axis.low + k * step <= axis.high + step / 2; ++k) {
    axis.ticks.push_back(axis.low + k * step);
  }
  return axis;
}

Axis logarithmic_axis(double high, double begin, double end) {
  Axis axis{0, std::max(1.0, std::ceil(std::log10(std::max(high, 1.0)))), begin, end, true, {}};
  for (int exponent = 0; exponent <= static_cast<int>(axis.high); ++exponent) {
    axis.ticks.push_back(std::pow(10.0, exponent));
  }
  return axis;
}

struct Range {
  double x_low = std::numeric_limits<double>::infinity();
  double x_high = -std::numeric_limits<double>::infinity();
  double y_high = 0;
};

Range range_of(const Plot& plot) {
  Range range;
  for (const Curve& curve : plot.curves) {
    for (const auto& [x, y] : curve.points) {
      range.x_low = std::min(range.x_low, x);
      range.x_high = std::max(range.x_high, x);
      range.y_high = std::max(range.y_high, y);
    }
  }
  if (range.x_low > range.x_high) range.x_low = range.x_high = 0;
  if (range.x_low > 0 && range.x_low < range.x_high / 4) range.x_low = 0;
  return range;
}

void line(std::ostream& out, double x1, double y1, double x2, double y2, const char* style) {
  out << "<line x1=\"" << number(x1) << "\" y1=\"" << number(y1) << "\" x2=\"" << number(x2)
      << "\" y2=\"" << number(y2) << "\" " << style << "/>\n";
}

void text(std::ostream& out, double x, double y, const std::string& content,
          const std::string& attributes) {
  out << "<text x=\"" << number(x) << "\" y=\"" << number(y) << "\" " << attributes << ">"
      << escaped(content) << "</text>\n";
}

void draw_axes(std::ostream& out, const Plot& plot, const Axis& x, const Axis& y) {
  const char* grid = "stroke=\"#dddddd\"";
  for (const double tick : x.ticks) {
    line(out, x.place(tick), y.begin, x.place(tick), y.end, grid);
    text(out, x.place(tick), y.begin + 18, number(tick), "text-anchor=\"middle\"");
  }
  for (const double tick : y.ticks) {
    line(out, x.begin, y.place(tick), x.end, y.place(tick), grid);
    text(out, x.begin - 8, y.place(tick) + 4, number(tick), "text-anchor=\"end\"");
  }
  line(out, x.begin, y.begin, x.end, y.begin, "stroke=\"#000000\"");
  line(out, x.begin, y.begin, x.begin, y.end, "stroke=\"#000000\"");
  text(out, (x.begin + x.end) / 2, kHeight - 14, plot.x_label, "text-anchor=\"middle\"");
  const double middle = (y.begin + y.end) / 2;
  text(out, 18, middle, plot.y_label,
       "text-anchor=\"middle\" transform=\"rotate(-90 18 " + number(middle) + ")\"");
  text(out, x.begin, 24, plot.title, "font-size=\"15\" font-weight=\"bold\"");
}

void draw_curves(std::ostream& out, const Plot& plot, const Axis& x, const Axis& y) {
  double legend = kTop + 8;
  for (size_t k = 0; k < plot.curves.size(); ++k) {
    const Curve& curve = plot.curves[k];
    const std::string colour = kColours[k % kColours.size()];
    const std::string style = "stroke=\"" + colour + "\" stroke-width=\"2\"" +
                              (curve.dashed ? " stroke-dasharray=\"7 4\"" : "");
    out << "<polyline fill=\"none\" " << style << " points=\"";
    for (const auto& [at, value] : curve.points) {
      out << number(x.place(at)) << "," << number(y.place(value)) << " ";
    }
    out << "\"/>\n";
    for (const auto& [at, value] : curve.points) {
      out << "<circle cx=\"" << number(x.place(at)) << "\" cy=\"" << number(y.place(value))
          << "\" r=\"2.2\" fill=\"" << colour << "\"/>\n";
    }
    line(out, x.end + 16, legend, x.end + 44, legend, style.c_str());
    text(out, x.end + 50, legend + 4, curve.name, "text-anchor=\"start\"");
    legend += 22;
  }
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string to_svg(const Plot& plot) {
  const Range range = range_of(plot);
  const Axis x = linear_axis(range.x_low, range.x_high, kLeft, kWidth - kRight);
  const Axis y = plot.logarithmic ? logarithmic_axis(range.y_high, kHeight - kBottom, kTop)
                                  : linear_axis(plot.y_low, range.y_high, kHeight - kBottom, kTop);
  std::ostringstream out;
  out << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << kWidth << "\" height=\"" << kHeight
      << "\" viewBox=\"0 0 " << kWidth << " " << kHeight
      << "\" font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\" font-size=\"12\">\n"
      << "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  draw_axes(out, plot, x, y);
  draw_curves(out, plot, x, y);
  out << "</svg>\n";
  return out.str();
}

std::string to_csv(const Plot& plot) {
  std::map<double, std::vector<std::optional<double>>> lines;
  for (size_t k = 0; k < plot.curves.size(); ++k) {
    for (const auto& [x, y] : plot.curves[k].points) {
      auto& values = lines[x];
      values.resize(plot.curves.size());
      values[k] = y;
    }
  }
  std::ostringstream out;
  out.precision(10);
  out << '"' << plot.x_label << '"';
  for (const Curve& curve : plot.curves) out << ",\"" << curve.name << '"';
  out << "\n";
  for (const auto& [x, values] : lines) {
    out << x;
    for (const auto& value : values) {
      out << ",";
      if (value) out << *value;
    }
    out << "\n";
  }
  return out.str();
}

void write_file(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path);
}

}  // namespace figures
