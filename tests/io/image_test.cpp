#include "isochor/io/image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "io/temp_folder.h"
#include "isochor/base/error.h"

namespace isochor {
namespace {

using ::testing::HasSubstr;

Image random_image(unsigned seed, int width, int height) {
  Image image(width, height);
  std::mt19937 random(seed);
  for (auto& byte : image.rgb) byte = static_cast<std::uint8_t>(random());
  return image;
}

TEST(Image, PngRoundTripKeepsEveryBit) {
  for (const auto& [width, height] : {std::pair(1, 1), {7, 3}, {1, 200}, {301, 2}, {64, 64}}) {
    const Image image = random_image(17, width, height);
    EXPECT_EQ(decode_png(encode_png(image)), image) << width << " x " << height;
  }
}

TEST(Image, SameImageGivesTheSameBytes) {
  EXPECT_EQ(encode_png(random_image(3, 50, 40)), encode_png(random_image(3, 50, 40)));
  EXPECT_NE(encode_png(random_image(3, 50, 40)), encode_png(random_image(4, 50, 40)));
}

TEST(Image, FilesAreReadBackAndLeaveNothingElse) {
  const testing::TempFolder folder;
  const Image image = random_image(5, 20, 30);
  write_png(folder.file("a.png"), image);
  write_png(folder.file("a.png"), image);  // over an existing file
  EXPECT_EQ(read_png(folder.file("a.png")), image);
  EXPECT_EQ(folder.file_count(), 1);
}

TEST(Image, BadPngNamesTheFileAndTheReason) {
  const testing::TempFolder folder;
  const std::string good = encode_png(random_image(6, 40, 40));
  folder.write("cut.png", good.substr(0, good.size() / 2));
  folder.write("text.png", "this is no picture");
  for (const char* name : {"cut.png", "text.png", "missing.png"}) {
    try {
      read_png(folder.file(name));
      FAIL() << name;
    } catch (const InputError& error) {
      EXPECT_EQ(error.file(), folder.file(name));
      EXPECT_FALSE(error.reason().empty());
    }
  }
}

TEST(Image, UnwritableFolderIsAnErrorThatNamesThePath) {
  try {
    write_png("/no/such/folder/a.png", random_image(7, 2, 2));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("/no/such/folder/a.png"));
  }
}

TEST(Image, SizesOutsideTheRangeAreRefused) {
  EXPECT_THROW(Image(0, 5), PreconditionError);
  EXPECT_THROW(Image(5, -1), PreconditionError);
  EXPECT_THROW(Image(40000, 5), PreconditionError);
  EXPECT_THROW(encode_png(Image()), PreconditionError);
}

}  // namespace
}  // namespace isochor
