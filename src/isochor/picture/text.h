// Labels on finished pictures, in a built-in stroke font.
//
// Sizes are cap heights in pixels. Text is UTF-8; characters without a glyph show as an empty box.
#pragma once

#include <string>
#include <string_view>

#include "isochor/io/image.h"
#include "isochor/picture/colour.h"

namespace isochor {

struct TextStyle {
  double cap_height = 10.0;
  Rgb colour = {0.20, 0.22, 0.26};  // sRGB
  double weight = 1.0;              // 1 regular, 1.5 bold
};

// The width of a line of text, in pixels.
double text_width(std::string_view text, const TextStyle& style);

// Draws with the left end of the baseline at (x, y); what falls outside the image is cut off.
void draw_text(Image& image, double x, double y, std::string_view text, const TextStyle& style);

// `text` shortened with an ellipsis to at most `width` pixels.
std::string fitted(std::string_view text, const TextStyle& style, double width);

}  // namespace isochor
