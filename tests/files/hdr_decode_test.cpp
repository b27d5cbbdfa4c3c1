// Radiance pictures: what they say, and what becomes of broken ones.
#include "files/hdr_decode.h"

#include <gmock/gmock.h>

#include "base/rng.h"

namespace goldthread {
namespace {

using ::testing::HasSubstr;

using Bytes = std::vector<unsigned char>;

Bytes bytes_of(const std::string& header, std::initializer_list<int> pixels) {
  Bytes bytes(header.begin(), header.end());
  for (const int value : pixels) bytes.push_back(static_cast<unsigned char>(value));
  return bytes;
}

std::string header(const std::string& resolution, const std::string& more = "") {
  return "#?RADIANCE\n# a remark\nFORMAT=32-bit_rle_rgbe\n" + more + "\n" + resolution + "\n";
}

FloatImage good(const Bytes& bytes) {
  const Result<FloatImage> image = decode_radiance_picture(bytes);
  EXPECT_TRUE(image) << image.error().line();
  return image ? *image : FloatImage();
}

std::string error_of(const Bytes& bytes) {
  const Result<FloatImage> image = decode_radiance_picture(bytes);
  return image ? "was read" : image.error().message;
}

/// Eight pixels: red a run of 64, green stretches, blue 0, exponents 129 and 130.
Bytes row_of_runs() {
  return bytes_of(header("-Y 1 +X 8"),
                  {2, 2, 0, 8, 136, 64, 3, 1, 2, 3, 133, 128, 136, 0, 132, 129, 132, 130});
}

TEST(HdrDecode, FlatPixelsAreMantissasTimesAPowerOfTwo) {
  const FloatImage image = good(bytes_of(header("-Y 2 +X 2"), {128, 64, 0, 129, 128, 0, 0, 130,  //
                                                               0, 0, 0, 0, 0, 0, 255, 120}));
  ASSERT_EQ(image.pixels.size(), 4u);
  EXPECT_EQ(image.pixels[0], vec3(1, 0.5f, 0));
  EXPECT_EQ(image.pixels[1], vec3(2, 0, 0));
  EXPECT_EQ(image.pixels[2], vec3(0));
  EXPECT_EQ(image.pixels[3], vec3(0, 0, 255 / 65536.0f));
}

TEST(HdrDecode, RunsOfChannels) {
  const FloatImage image = good(row_of_runs());
  ASSERT_EQ(image.width, 8u);
  EXPECT_EQ(image.pixels[0], vec3(0.5f, 1 / 128.0f, 0));
  EXPECT_EQ(image.pixels[2], vec3(0.5f, 3 / 128.0f, 0));
  EXPECT_EQ(image.pixels[3], vec3(0.5f, 1, 0));
  EXPECT_EQ(image.pixels[4], vec3(1, 2, 0));
  EXPECT_EQ(image.pixels[7], vec3(1, 2, 0));
}

TEST(HdrDecode, OldRunsRepeatThePixelBefore) {
  const FloatImage image = good(bytes_of(header("-Y 1 +X 5"), {128, 0, 0, 129, 1, 1, 1, 3, 0, 128, 0, 129}));
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(image.pixels[i], vec3(1, 0, 0));
  EXPECT_EQ(image.pixels[4], vec3(0, 1, 0));
}

TEST(HdrDecode, ExposuresAreTakenOff) {
  const FloatImage image =
      good(bytes_of(header("-Y 1 +X 1", "EXPOSURE=2\nEXPOSURE=4\n"), {128, 128, 128, 129}));
  EXPECT_EQ(image.pixels[0], vec3(0.125f));
}

TEST(HdrDecode, BadFilesAreNamed) {
  EXPECT_THAT(error_of({}), HasSubstr("#?"));
  EXPECT_THAT(error_of(bytes_of("#?RADIANCE\n", {})), HasSubstr("header has no end"));
  EXPECT_THAT(error_of(bytes_of("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", {1, 2, 3, 4})),
              HasSubstr("not RGBE"));
  EXPECT_THAT(error_of(bytes_of(header("+Y 1 +X 1"), {1, 2, 3, 4})), HasSubstr("top left"));
  EXPECT_THAT(error_of(bytes_of(header("-Y 0 +X 1"), {1, 2, 3, 4})), HasSubstr("no pixels"));
  EXPECT_THAT(error_of(bytes_of(header("-Y 20000 +X 1"), {1, 2, 3, 4})), HasSubstr("more than 16384"));
  EXPECT_THAT(error_of(bytes_of(header("-Y 16000 +X 16000"), {1, 2, 3, 4})), HasSubstr("bytes can hold"));
  EXPECT_THAT(error_of(bytes_of(header("-Y 1 +X 1", "EXPOSURE=0\n"), {1, 2, 3, 4})), HasSubstr("exposure"));
  EXPECT_THAT(error_of(bytes_of(header("-Y 2 +X 1"), {1, 2, 3, 4})), HasSubstr("row 1"));
  EXPECT_THAT(error_of(bytes_of(header("-Y 1 +X 3"), {9, 9, 9, 128, 1, 1, 1, 9})), HasSubstr("row 0"));
  EXPECT_THAT(error_of(bytes_of(header("-Y 1 +X 8"), {2, 2, 0, 9, 136, 64})), HasSubstr("row 0"));
}

TEST(HdrDecode, EveryTruncationIsAnError) {
  const Bytes whole = row_of_runs();
  for (size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(decode_radiance_picture(std::span(whole.data(), size))) << size;
}

TEST(HdrDecode, ChangedBytesNeverCrash) {
  const Bytes whole = row_of_runs();
  int read = 0;
  for (uint32_t i = 0; i < 20000; ++i) {
    Bytes bytes = whole;
    for (uint32_t k = 0; k < 1 + i % 3; ++k)
      bytes[hash(i, k) % bytes.size()] = static_cast<unsigned char>(hash(i, k + 9));
    const Result<FloatImage> image = decode_radiance_picture(bytes);
    if (!image) continue;
    ++read;
    EXPECT_EQ(image->pixels.size(), size_t{image->width} * image->height);
  }
  EXPECT_GT(read, 0);
}

}  // namespace
}  // namespace goldthread
