// Pictures as plain data, and PNG files.
//
// Pixels are 8-bit sRGB, row by row from the top left.
//
// Law: read_png(write_png(image)) == image, bit for bit.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace isochor {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // 3 * width * height

  Image() = default;
  // All pixels black. Throws PreconditionError unless both sizes are in [1, 32768].
  Image(int width, int height);

  std::uint8_t* pixel(int x, int y) { return &rgb[3 * (static_cast<size_t>(y) * width + x)]; }
  const std::uint8_t* pixel(int x, int y) const {
    return &rgb[3 * (static_cast<size_t>(y) * width + x)];
  }
  friend bool operator==(const Image& a, const Image& b) {
    return a.width == b.width && a.height == b.height && a.rgb == b.rgb;
  }
};

// The bytes of a PNG file; the same image always gives the same bytes.
std::string encode_png(const Image& image);
// Throws InputError (file left empty) when the bytes are not a complete PNG.
Image decode_png(const std::string& bytes);

// Atomically; throws InputError naming the path.
void write_png(const std::string& path, const Image& image);
Image read_png(const std::string& path);

}  // namespace isochor
