#include "files/image_write.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "files/gltf_builder.h"
#include "files/png_encode.h"

namespace goldthread {
namespace {

using test::TempFolder;

std::vector<uint8_t> decode_rgb(const std::string& file, uint32_t& width, uint32_t& height) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_file(&image, file.c_str())) << image.message;
  image.format = PNG_FORMAT_RGB;
  std::vector<uint8_t> pixels(PNG_IMAGE_SIZE(image));
  EXPECT_TRUE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr));
  width = image.width;
  height = image.height;
  return pixels;
}

TEST(ImageWrite, PngIsSrgbEncodedAndClamped) {
  const TempFolder folder;
  const std::string file = folder.path("a.png");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const FloatImage image{2, 2, {vec3(0, 1, 5), vec3(0.2158605f), vec3(-1, nan, 0.0031308f), vec3(1)}};
  ASSERT_TRUE(write_png(file, image));
  uint32_t width = 0, height = 0;
  EXPECT_EQ(decode_rgb(file, width, height),
            (std::vector<uint8_t>{0, 255, 255, 128, 128, 128, 0, 0, 10, 255, 255, 255}));
  EXPECT_EQ(width, 2u);
  EXPECT_EQ(height, 2u);
}

TEST(ImageWrite, ExrKeepsEveryFloat) {
  const TempFolder folder;
  const std::string file = folder.path("a.exr");
  const FloatImage image{3, 1, {vec3(0, 1e-20f, 1e20f), vec3(-3.25f, 0.1f, 7), vec3(1, 2, 3)}};
  ASSERT_TRUE(write_exr(file, image));
  Imf::InputFile input(file.c_str());
  std::vector<vec3> pixels(3);
  Imf::FrameBuffer frame;
  const char* names[] = {"R", "G", "B"};
  for (size_t c = 0; c < 3; ++c) {
    ASSERT_NE(input.header().channels().findChannel(names[c]), nullptr);
    EXPECT_EQ(input.header().channels().findChannel(names[c])->type, Imf::FLOAT);
    frame.insert(names[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(pixels.data()) + 4 * c,
                                      sizeof(vec3), 3 * sizeof(vec3)));
  }
  input.setFrameBuffer(frame);
  input.readPixels(0, 0);
  EXPECT_EQ(pixels, image.pixels);
}

TEST(ImageWrite, RefusesWhatIsNoPictureAndWhereItMayNotWrite) {
  const FloatImage none, torn{4, 4, {vec3(0)}}, good{1, 1, {vec3(0)}};
  for (const auto& write : {write_png, write_exr}) {
    for (const FloatImage* image : {&none, &torn}) {
      const Status status = write("/dev/null", *image);
      ASSERT_FALSE(status);
      EXPECT_EQ(status.error().code, ErrorCode::kCannotWrite);
    }
    const Status status = write("/proc/a.img", good);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().file, "/proc/a.img");
    EXPECT_FALSE(write("/dev/full", good));
  }
}

TEST(PngEncode, SamePixelsSameBytes) {
  const std::vector<uint8_t> pixels(4 * 5 * 3, 77);
  const auto bytes = encode_png(5, 3, 4, pixels);
  EXPECT_FALSE(bytes.empty());
  EXPECT_EQ(bytes, encode_png(5, 3, 4, pixels));
  EXPECT_TRUE(encode_png(5, 4, 4, pixels).empty());
  EXPECT_TRUE(encode_png(0, 0, 4, {}).empty());
}

}  // namespace
}  // namespace goldthread
