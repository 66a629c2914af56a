#include "isochor/picture/text.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <utility>
#include <vector>

#include "isochor/picture/stroke_font.h"

namespace isochor {
namespace {

constexpr double kCapHeight = 12.0;  // of the font's grid
constexpr double kGap = 2.6;         // between letters, on the grid
constexpr double kStroke = 1.45;     // width of a regular stroke, on the grid
constexpr int kPieces = 6;           // straight pieces for one curve piece

struct Point {
  double x, y;
};
using Polyline = std::vector<Point>;

struct Glyph {
  double width = 6.0;
  std::vector<Polyline> strokes;
};

Point middle(const Point& a, const Point& b) { return {0.5 * (a.x + b.x), 0.5 * (a.y + b.y)}; }

void add_curve(Polyline& line, const Point& a, const Point& b, const Point& c) {
  for (int k = 1; k <= kPieces; ++k) {
    const double t = static_cast<double>(k) / kPieces, s = 1.0 - t;
    line.push_back({s * s * a.x + 2.0 * s * t * b.x + t * t * c.x,
                    s * s * a.y + 2.0 * s * t * b.y + t * t * c.y});
  }
}

Polyline smooth(const Polyline& legs) {
  Polyline line = {legs.front()};
  Point from = legs.front();
  for (size_t k = 1; k + 1 < legs.size(); ++k) {
    const Point to = k + 2 == legs.size() ? legs.back() : middle(legs[k], legs[k + 1]);
    add_curve(line, from, legs[k], to);
    from = to;
  }
  return line;
}

Polyline smooth_closed(const Polyline& legs) {
  const size_t n = legs.size();
  Polyline line = {middle(legs[n - 1], legs[0])};
  for (size_t k = 0; k < n; ++k) {
    add_curve(line, middle(legs[(k + n - 1) % n], legs[k]), legs[k],
              middle(legs[k], legs[(k + 1) % n]));
  }
  return line;
}

Glyph parse(const internal::GlyphSource& source) {
  Glyph glyph;
  glyph.width = source.width;
  std::istringstream strokes(source.strokes);
  for (std::string stroke; std::getline(strokes, stroke, ';');) {
    const char kind = stroke.empty() ? ' ' : stroke.front();
    if (kind == '~' || kind == '@') stroke.front() = ' ';
    std::istringstream points(stroke);
    Polyline line;
    char comma = ',';
    for (Point p{}; points >> p.x >> comma >> p.y;) line.push_back(p);
    if (line.size() < 2) continue;
    glyph.strokes.push_back(kind == '~' ? smooth(line) : kind == '@' ? smooth_closed(line) : line);
  }
  return glyph;
}

const Glyph& glyph_of(char32_t code) {
  static const std::map<char32_t, Glyph> glyphs = [] {
    std::map<char32_t, Glyph> all;
    for (const auto& source : internal::kGlyphs) all.emplace(source.code, parse(source));
    return all;
  }();
  static const Glyph box = parse({U' ', 6.0, "0,0 6,0 6,10 0,10 0,0"});
  const auto found = glyphs.find(code);
  return found != glyphs.end() ? found->second : box;
}

// Broken UTF-8 gives U+FFFD, which has no glyph.
std::vector<char32_t> decode(std::string_view text) {
  std::vector<char32_t> codes;
  for (size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const int more = byte < 0x80       ? 0
                     : byte >> 5 == 6  ? 1
                     : byte >> 4 == 14 ? 2
                     : byte >> 3 == 30 ? 3
                                       : -1;
    char32_t code = more <= 0 ? byte : byte & (0x3Fu >> more);
    size_t used = 1;
    for (; more > 0 && used <= static_cast<size_t>(more) && i + used < text.size(); ++used) {
      const auto next = static_cast<unsigned char>(text[i + used]);
      if (next >> 6 != 2) break;
      code = code << 6 | (next & 0x3Fu);
    }
    const bool complete = more >= 0 && used == static_cast<size_t>(more) + 1;
    codes.push_back(complete ? code : U'\uFFFD');
    i += used;
  }
  return codes;
}

double distance(double x, double y, const Point& a, const Point& b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double length2 = dx * dx + dy * dy;
  const double s =
      length2 > 0.0 ? std::clamp(((x - a.x) * dx + (y - a.y) * dy) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(x - a.x - s * dx, y - a.y - s * dy);
}

void draw_glyph(Image& image, double x, double y, const Glyph& glyph, const TextStyle& style) {
  const double unit = style.cap_height / kCapHeight;
  const double half = std::max(0.5 * kStroke * style.weight * unit, 0.45);
  const int x0 = std::max(0, static_cast<int>(std::floor(x - 2.0 * half)));
  const int x1 =
      std::min(image.width - 1, static_cast<int>(std::ceil(x + glyph.width * unit + 2.0 * half)));
  const int y0 = std::max(0, static_cast<int>(std::floor(y - 14.5 * unit)));
  const int y1 = std::min(image.height - 1, static_cast<int>(std::ceil(y + 5.5 * unit)));
  for (int py = y0; py <= y1; ++py) {
    for (int px = x0; px <= x1; ++px) {
      const double gx = (px + 0.5 - x) / unit, gy = (y - py - 0.5) / unit;
      double nearest = 1e300;
      for (const Polyline& line : glyph.strokes) {
        for (size_t k = 1; k < line.size(); ++k) {
          nearest = std::min(nearest, distance(gx, gy, line[k - 1], line[k]));
        }
      }
      const double cover = std::clamp(half + 0.5 - nearest * unit, 0.0, 1.0);
      if (cover <= 0.0) continue;
      std::uint8_t* pixel = image.pixel(px, py);
      for (size_t c = 0; c < 3; ++c) {
        const double mixed = pixel[c] + cover * (255.0 * style.colour[c] - pixel[c]);
        pixel[c] = static_cast<std::uint8_t>(std::lround(std::clamp(mixed, 0.0, 255.0)));
      }
    }
  }
}

}  // namespace

double text_width(std::string_view text, const TextStyle& style) {
  double width = 0.0;
  for (char32_t code : decode(text)) width += glyph_of(code).width + kGap;
  return std::max(0.0, width - kGap) * style.cap_height / kCapHeight;
}

void draw_text(Image& image, double x, double y, std::string_view text, const TextStyle& style) {
  for (char32_t code : decode(text)) {
    const Glyph& glyph = glyph_of(code);
    draw_glyph(image, x, y, glyph, style);
    x += (glyph.width + kGap) * style.cap_height / kCapHeight;
  }
}

std::string fitted(std::string_view text, const TextStyle& style, double width) {
  if (text_width(text, style) <= width) return std::string(text);
  std::string best = "…";
  for (size_t length = 1; length < text.size(); ++length) {
    if ((static_cast<unsigned char>(text[length]) >> 6) == 2) continue;  // inside a character
    const std::string shorter = std::string(text.substr(0, length)) + "…";
    if (text_width(shorter, style) > width) break;
    best = shorter;
  }
  return best;
}

}  // namespace isochor
