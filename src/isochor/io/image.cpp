#include "isochor/io/image.h"

#include <png.h>

#include <algorithm>
#include <cstring>

#include "isochor/base/error.h"
#include "isochor/io/file.h"

namespace isochor {
namespace {

constexpr int kMaxSide = 32768;

}  // namespace

Image::Image(int columns, int rows) : width(columns), height(rows) {
  ISOCHOR_REQUIRE(1 <= columns && columns <= kMaxSide, columns);
  ISOCHOR_REQUIRE(1 <= rows && rows <= kMaxSide, rows);
  rgb.assign(3 * static_cast<size_t>(columns) * static_cast<size_t>(rows), 0);
}

std::string encode_png(const Image& image) {
  ISOCHOR_REQUIRE(image.width > 0 && image.height > 0, image.width, image.height);
  png_image header;
  std::memset(&header, 0, sizeof header);
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(header), '\0');
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr) ==
      0) {
    throw InputError("", "", std::string("the PNG encoder failed: ") + header.message);
  }
  bytes.resize(size);
  return bytes;
}

Image decode_png(const std::string& bytes) {
  png_image header;
  std::memset(&header, 0, sizeof header);
  header.version = PNG_IMAGE_VERSION;
  const auto refuse = [&header]() {
    const std::string reason = header.message;
    png_image_free(&header);
    throw InputError("", "", "not a readable PNG: " + reason);
  };
  if (png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()) == 0) refuse();
  if (header.width > kMaxSide || header.height > kMaxSide) {
    png_image_free(&header);
    throw InputError("", "", "the picture is larger than " + std::to_string(kMaxSide) + " pixels");
  }
  header.format = PNG_FORMAT_RGB;
  Image image(static_cast<int>(header.width), static_cast<int>(header.height));
  const png_color white = {255, 255, 255};
  if (png_image_finish_read(&header, &white, image.rgb.data(), 0, nullptr) == 0) refuse();
  return image;
}

void write_png(const std::string& path, const Image& image) { write_file(path, encode_png(image)); }

Image read_png(const std::string& path) {
  try {
    return decode_png(read_file(path));
  } catch (const InputError& error) {
    throw error.in_file(path);
  }
}

}  // namespace isochor
