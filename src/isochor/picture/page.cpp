#include "isochor/picture/page.h"

#include <algorithm>
#include <cmath>

#include "isochor/picture/text.h"

namespace isochor::internal {
namespace {

constexpr Rgb kFrame = {0.80, 0.82, 0.85};
constexpr Rgb kArrow = {0.90, 0.47, 0.05};
const TextStyle kTitleStyle = {13.0, {0.13, 0.15, 0.19}, 1.35};
const TextStyle kLabelStyle = {10.0, {0.22, 0.25, 0.30}, 1.2};
const TextStyle kCaptionStyle = {9.0, {0.27, 0.30, 0.35}, 1.0};
const TextStyle kTickStyle = {8.0, {0.27, 0.30, 0.35}, 1.0};

// A shaft with two barbs in the plane of the picture; seen end-on only the dot remains.
LineSet arrow(const Camera& camera, const Vec3& from, const Vec3& to) {
  LineSet lines;
  lines.colour = kArrow;
  lines.width = 2.6;
  lines.add({from, to});
  const Vec3 along = to - from;
  const Vec3 flat = along - camera.toward.dot(along) * camera.toward;
  const double length = flat.norm() * camera.scale;
  if (length < 6.0) return lines;
  const Vec3 back = flat * (-std::min(11.0, 0.6 * length) / length);
  const Vec3 side = 0.45 * camera.toward.cross(back);
  lines.add({to + back + side, to, to + back - side});
  return lines;
}

}  // namespace

Image render_view(const View& view) {
  Raster raster(view.camera);
  if (view.scale != nullptr) {
    raster.draw(*view.mesh, *view.scale);
  } else {
    raster.draw(*view.mesh, view.colour);
  }
  raster.outline();
  if (view.lines != nullptr) {
    for (const LineSet& lines : *view.lines) raster.draw(lines);
  }
  for (const auto& [from, to] : view.moves) {
    raster.draw(arrow(view.camera, from, to));
    raster.dot(from, kArrow, 4.0);
  }
  for (const Vec3& at : view.dots) raster.dot(at, kArrow, 4.5);
  return raster.image();
}

Page::Page(int width, int height) : image_(width, height) {
  std::fill(image_.rgb.begin(), image_.rgb.end(), std::uint8_t{255});
}

void Page::rectangle(int x, int y, int width, int height, const Rgb& srgb) {
  for (int py = std::max(0, y); py < std::min(image_.height, y + height); ++py) {
    for (int px = std::max(0, x); px < std::min(image_.width, x + width); ++px) {
      for (size_t c = 0; c < 3; ++c) {
        image_.pixel(px, py)[c] = static_cast<std::uint8_t>(std::lround(255.0 * srgb[c]));
      }
    }
  }
}

void Page::title(const std::string& text) {
  draw_text(image_, kMargin, kMargin + 13.0,
            fitted(text, kTitleStyle, image_.width - 2.0 * kMargin), kTitleStyle);
}

void Page::panel(int x, int y, const View& view) {
  const Image inside = render_view(view);
  rectangle(x - 1, y - 1, inside.width + 2, inside.height + 2, kFrame);
  for (int row = 0; row < inside.height && y + row < image_.height; ++row) {
    const int columns = std::min(inside.width, image_.width - x);
    std::copy_n(inside.pixel(0, row), 3 * columns, image_.pixel(x, y + row));
  }
  draw_text(image_, x, y - 9.0, fitted(view.label, kLabelStyle, inside.width), kLabelStyle);
}

void Page::caption(int x, int y, int width, const std::vector<std::string>& lines) {
  for (const std::string& line : lines) {
    y += kLineHeight;
    draw_text(image_, x, y - 6.0, fitted(line, kCaptionStyle, width), kCaptionStyle);
  }
}

void Page::legend(int x, int y, int width, const ColourScale& scale, const std::string& heading) {
  const int top = y + 24, height = 14;
  draw_text(image_, x, y + 14.0, fitted(heading, kCaptionStyle, width), kCaptionStyle);
  rectangle(x - 1, top - 1, width + 2, height + 2, kFrame);
  for (int k = 0; k < width; ++k) {
    const double value = scale.limit() * (2.0 * (k + 0.5) / width - 1.0);
    rectangle(x + k, top, 1, height, srgb_from_linear(scale.at(value)));
  }
  double free_from = x - 40.0;
  for (double tick : scale.ticks()) {
    const double at = x + 0.5 * width * (tick / scale.limit() + 1.0);
    rectangle(static_cast<int>(std::lround(at - 0.5)), top + height, 1, 5, kFrame);
    const std::string text = (tick > 0.0 ? "+" : "") + short_number(tick);
    const double wide = text_width(text, kTickStyle);
    if (at - 0.5 * wide < free_from) continue;
    draw_text(image_, at - 0.5 * wide, top + height + 18.0, text, kTickStyle);
    free_from = at + 0.5 * wide + 8.0;
  }
}

}  // namespace isochor::internal
