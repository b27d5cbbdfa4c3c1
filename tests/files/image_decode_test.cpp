// Pictures encoded here and decoded again, whole and damaged.
#include <gmock/gmock.h>
#include <webp/encode.h>

#include <cstddef>
#include <cstdio>

#include <jpeglib.h>

#include "files/image_decode.h"
#include "files/png_encode.h"

namespace goldthread {
namespace {

using Bytes = std::vector<uint8_t>;
using ::testing::HasSubstr;

const Bytes kFourPixels = {255, 0, 0, 255, 0, 255, 0, 128, 0, 0, 255, 0, 10, 20, 30, 40};

Bytes jpeg_of_grey(uint32_t width, uint32_t height, uint8_t value, int components) {
  jpeg_compress_struct jpeg;
  jpeg_error_mgr errors;
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* out = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &out, &size);
  jpeg.image_width = width;
  jpeg.image_height = height;
  jpeg.input_components = components;
  jpeg.in_color_space = components == 1 ? JCS_GRAYSCALE : components == 3 ? JCS_RGB : JCS_CMYK;
  jpeg_set_defaults(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  Bytes row(size_t(width) * size_t(components), value);
  for (uint32_t y = 0; y < height; ++y) {
    JSAMPROW rows = row.data();
    jpeg_write_scanlines(&jpeg, &rows, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  const Bytes bytes(out, out + size);
  std::free(out);
  return bytes;
}

void overwrite_32(Bytes& bytes, size_t at, uint32_t value) {
  for (size_t i = 0; i < 4; ++i) bytes[at + i] = uint8_t(value >> (24 - 8 * i));
}

TEST(ImageDecode, PngExactly) {
  const Result<Image> image = decode_image(encode_png(2, 2, 4, kFourPixels));
  ASSERT_TRUE(image) << image.error().line();
  EXPECT_EQ(image->width, 2u);
  EXPECT_EQ(image->height, 2u);
  EXPECT_EQ(image->rgba, kFourPixels);
}

TEST(ImageDecode, PngWithoutAlphaIsOpaque) {
  const Result<Image> image = decode_image(encode_png(1, 1, 3, Bytes{9, 8, 7}));
  ASSERT_TRUE(image);
  EXPECT_EQ(image->rgba, (Bytes{9, 8, 7, 255}));
}

TEST(ImageDecode, JpegGreyColourAndInks) {
  for (const int components : {1, 3}) {
    const Result<Image> image = decode_image(jpeg_of_grey(17, 9, 100, components));
    ASSERT_TRUE(image) << image.error().line();
    ASSERT_EQ(image->rgba.size(), 17u * 9 * 4);
    for (size_t i = 0; i < image->rgba.size(); ++i) EXPECT_NEAR(image->rgba[i], i % 4 == 3 ? 255 : 100, 2);
  }
  const Result<Image> inks = decode_image(jpeg_of_grey(8, 8, 255, 4));  // Adobe's way: 255 is no ink
  ASSERT_TRUE(inks);
  EXPECT_NEAR(inks->rgba[0], 255, 2);
  EXPECT_EQ(inks->rgba[3], 255);
}

TEST(ImageDecode, WebpExactly) {
  uint8_t* out = nullptr;
  const size_t size = WebPEncodeLosslessRGBA(Bytes(16, 200).data(), 2, 2, 8, &out);
  const Bytes bytes(out, out + size);
  WebPFree(out);
  const Result<Image> image = decode_image(bytes);
  ASSERT_TRUE(image) << image.error().line();
  EXPECT_EQ(image->rgba, Bytes(16, 200));
  EXPECT_FALSE(decode_image(std::span(bytes).first(size / 2)));
}

TEST(ImageDecode, TruncatedNeverComesInPart) {
  const Bytes png = encode_png(64, 64, 4, Bytes(64 * 64 * 4, 77)), jpeg = jpeg_of_grey(64, 64, 50, 3);
  for (const Bytes& whole : {png, jpeg})
    for (size_t size = 0; size + 2 < whole.size(); size += 3)
      EXPECT_FALSE(decode_image(std::span(whole).first(size))) << size;
}

TEST(ImageDecode, ClaimedSizesAreCheckedFirst) {
  Bytes png = encode_png(2, 2, 4, kFourPixels);
  overwrite_32(png, 16, 16384);  // width; libpng checks the chunk's sum, so this is caught there or by size
  overwrite_32(png, 20, 16384);
  EXPECT_FALSE(decode_image(png));
  Bytes jpeg = jpeg_of_grey(8, 8, 1, 1);
  for (size_t i = 0; i + 9 < jpeg.size(); ++i)
    if (jpeg[i] == 0xFF && jpeg[i + 1] == 0xC0) jpeg[i + 5] = jpeg[i + 7] = 0xFF;
  const Result<Image> huge = decode_image(jpeg);
  ASSERT_FALSE(huge);
  EXPECT_THAT(huge.error().message, HasSubstr("more than 16384"));
}

TEST(ImageDecode, OtherThings) {
  EXPECT_FALSE(decode_image({}));
  EXPECT_THAT(decode_image(Bytes{'B', 'M', 0, 0}).error().message, HasSubstr("neither"));
}

}  // namespace
}  // namespace goldthread
