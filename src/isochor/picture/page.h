// Putting rendered views, labels and a legend together on one page.
#pragma once

#include <string>
#include <vector>

#include "isochor/io/image.h"
#include "isochor/picture/colour.h"
#include "isochor/picture/raster.h"

namespace isochor::internal {

inline constexpr int kMargin = 26;       // round the page and between panels, pixels
inline constexpr int kTitleHeight = 46;  // for the page's title
inline constexpr int kLabelHeight = 28;  // for a panel's title
inline constexpr int kLineHeight = 22;   // for a line of the caption
inline constexpr int kLegendHeight = 70;

// What one panel shows; the meshes and lines are looked at only while drawing.
struct View {
  std::string label;
  Camera camera;  // with the panel's size
  const Mesh* mesh = nullptr;
  Rgb colour = {0.655, 0.700, 0.755};  // sRGB
  const ColourScale* scale = nullptr;  // colour by the mesh's scalars instead
  const std::vector<LineSet>* lines = nullptr;
  std::vector<std::pair<Vec3, Vec3>> moves;  // drawn as arrows with a dot at the start
  std::vector<Vec3> dots;
};
Image render_view(const View& view);

// A white page with helpers to fill it.
class Page {
 public:
  Page(int width, int height);
  const Image& image() const { return image_; }

  void title(const std::string& text);
  // The panel with its top left corner at (x, y); its label goes above.
  void panel(int x, int y, const View& view);
  // Caption lines from (x, y) downwards, at most `width` pixels wide.
  void caption(int x, int y, int width, const std::vector<std::string>& lines);
  // A colour bar of the given width with ticks, `heading` above and a word at either end.
  void legend(int x, int y, int width, const ColourScale& scale, const std::string& heading);

 private:
  void rectangle(int x, int y, int width, int height, const Rgb& srgb);
  Image image_;
};

}  // namespace isochor::internal
