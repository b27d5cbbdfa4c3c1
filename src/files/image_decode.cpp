#include "files/image_decode.h"

#include <fmt/format.h>
#include <webp/decode.h>
// libjpeg's header needs size_t and FILE from here
#include <cstddef>
#include <cstdio>

#include <jerror.h>
#include <jpeglib.h>
#include <png.h>

#include <csetjmp>
#include <cstring>

#include "base/huge_pages.h"

namespace goldthread {
namespace {

Error broken(const std::string& message) {
  return Error{ErrorCode::kBadInput, message, "", "", "export the picture again"};
}

/// Refuses dimensions before memory is taken for them. The encoded bytes unpack to `most_pixels` at most.
Status check_size(uint64_t width, uint64_t height, uint64_t most_pixels) {
  if (width == 0 || height == 0) return broken("the picture has no pixels");
  if (width > kLargestImageSide || height > kLargestImageSide)
    return broken(
        fmt::format("the picture is {} x {}, more than {} a side", width, height, kLargestImageSide));
  if (width * height > most_pixels)
    return broken(
        fmt::format("the picture claims {} x {} pixels, more than its bytes can hold", width, height));
  return Nothing{};
}

Image blank(uint64_t width, uint64_t height) {
  Image image;
  image.width = uint32_t(width);
  image.height = uint32_t(height);
  image.rgba = zeros_in_huge_pages<uint8_t>(width * height * 4);
  return image;
}

// libpng and libjpeg report errors by longjmp. Everything with a destructor therefore lives in the caller of
// the function that calls setjmp, which holds plain values only.

struct PngSource {
  std::span<const uint8_t> left;
  char message[128] = {};
  std::jmp_buf escape;
};

void png_fetch(png_structp png, png_bytep out, size_t size) {
  PngSource& source = *static_cast<PngSource*>(png_get_io_ptr(png));
  if (size > source.left.size()) png_error(png, "the picture is cut off");
  std::memcpy(out, source.left.data(), size);
  source.left = source.left.subspan(size);
}

[[noreturn]] void png_fail(png_structp png, png_const_charp message) {
  PngSource& source = *static_cast<PngSource*>(png_get_error_ptr(png));
  std::strncpy(source.message, message, sizeof(source.message) - 1);
  std::longjmp(source.escape, 1);
}

void png_ignore(png_structp, png_const_charp) {}

/// Any PNG as rows of 8-bit RGBA.
void ask_png_for_rgba(png_structp png) {
  png_set_expand(png);
  png_set_scale_16(png);
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 255, PNG_FILLER_AFTER);
  png_set_interlace_handling(png);
}

bool png_read_header(png_structp png, png_infop info, PngSource& source) {
  if (setjmp(source.escape)) return false;
  png_set_user_limits(png, kLargestImageSide, kLargestImageSide);
  png_set_chunk_malloc_max(png, 1 << 24);
  png_set_chunk_cache_max(png, 128);
  png_set_read_fn(png, &source, png_fetch);
  png_read_info(png, info);
  return true;
}

bool png_read_pixels(png_structp png, png_infop info, PngSource& source, png_bytepp rows, size_t row_bytes) {
  if (setjmp(source.escape)) return false;
  ask_png_for_rgba(png);
  png_read_update_info(png, info);
  if (png_get_rowbytes(png, info) != row_bytes) png_error(png, "unexpected row length");
  png_read_image(png, rows);
  png_read_end(png, nullptr);
  return true;
}

Result<Image> read_png(png_structp png, png_infop info, PngSource& source) {
  const size_t size = source.left.size();
  if (!png_read_header(png, info, source)) return broken(fmt::format("PNG: {}", source.message));
  const uint64_t width = png_get_image_width(png, info), height = png_get_image_height(png, info);
  // Deflate packs at most 1032 to 1.
  const uint64_t bits = uint64_t(png_get_bit_depth(png, info)) * png_get_channels(png, info);
  if (Status status = check_size(width, height, size * 1032 * 8 / std::max<uint64_t>(bits, 1)); !status)
    return status.error();
  Image image = blank(width, height);
  std::vector<png_bytep> rows(height);
  for (size_t y = 0; y < rows.size(); ++y) rows[y] = image.rgba.data() + y * width * 4;
  if (!png_read_pixels(png, info, source, rows.data(), width * 4))
    return broken(fmt::format("PNG: {}", source.message));
  return image;
}

Result<Image> decode_png(std::span<const uint8_t> bytes) {
  PngSource source;
  source.left = bytes;
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, png_fail, png_ignore);
  if (!png) return broken("PNG: libpng does not start");
  png_infop info = png_create_info_struct(png);
  Result<Image> image = info ? read_png(png, info, source) : broken("PNG: libpng does not start");
  png_destroy_read_struct(&png, &info, nullptr);
  return image;
}

struct JpegState {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  std::jmp_buf escape;
  char message[JMSG_LENGTH_MAX] = {};
};

[[noreturn]] void jpeg_fail(j_common_ptr jpeg) {
  JpegState& state = *static_cast<JpegState*>(jpeg->client_data);
  state.errors.format_message(jpeg, state.message);
  std::longjmp(state.escape, 1);
}

/// Some warnings mean missing pixels, which libjpeg would leave grey; the others are harmless.
void jpeg_warn(j_common_ptr jpeg, int level) {
  if (level >= 0) return;
  const int code = jpeg->err->msg_code;
  if (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER || code == JWRN_HUFF_BAD_CODE) jpeg_fail(jpeg);
}

bool jpeg_header(JpegState& state, std::span<const uint8_t> bytes) {
  if (setjmp(state.escape)) return false;
  jpeg_create_decompress(&state.jpeg);
  jpeg_mem_src(&state.jpeg, bytes.data(), static_cast<unsigned long>(bytes.size()));
  jpeg_read_header(&state.jpeg, TRUE);
  // Four-channel pictures are CMYK, which libjpeg hands out as it is.
  const bool cmyk = state.jpeg.num_components == 4;
  state.jpeg.out_color_space = cmyk ? JCS_CMYK : JCS_EXT_RGBA;
  return true;
}

bool jpeg_pixels(JpegState& state, uint8_t* rgba) {
  if (setjmp(state.escape)) return false;
  jpeg_start_decompress(&state.jpeg);
  const size_t row_bytes = size_t(state.jpeg.output_width) * 4;
  while (state.jpeg.output_scanline < state.jpeg.output_height) {
    JSAMPROW row = rgba + state.jpeg.output_scanline * row_bytes;
    jpeg_read_scanlines(&state.jpeg, &row, 1);
  }
  jpeg_finish_decompress(&state.jpeg);
  return true;
}

/// Ink to light. Adobe's files, which nearly all are, store the inks inverted.
void cmyk_to_rgba(Image& image, bool inverted) {
  for (size_t i = 0; i < image.rgba.size(); i += 4) {
    uint8_t* p = &image.rgba[i];
    const uint32_t black = inverted ? p[3] : 255u - p[3];
    for (int c = 0; c < 3; ++c) p[c] = uint8_t((inverted ? p[c] : 255u - p[c]) * black / 255);
    p[3] = 255;
  }
}

Result<Image> read_jpeg(JpegState& state, std::span<const uint8_t> bytes) {
  if (!jpeg_header(state, bytes)) return broken(fmt::format("JPEG: {}", state.message));
  // An 8x8 block takes at least 2 bits (a DC and an end-of-block code of one bit each) and chroma may be
  // shared by 4 x 4 blocks; progressive files may leave out even those, so that 4096 pixels a byte is
  // generous.
  if (Status status = check_size(state.jpeg.image_width, state.jpeg.image_height, bytes.size() * 4096);
      !status)
    return status.error();
  Image image = blank(state.jpeg.image_width, state.jpeg.image_height);
  if (!jpeg_pixels(state, image.rgba.data())) return broken(fmt::format("JPEG: {}", state.message));
  if (state.jpeg.num_components == 4) cmyk_to_rgba(image, state.jpeg.saw_Adobe_marker);
  return image;
}

Result<Image> decode_jpeg(std::span<const uint8_t> bytes) {
  JpegState state;
  state.jpeg.err = jpeg_std_error(&state.errors);
  state.errors.error_exit = jpeg_fail;
  state.errors.emit_message = jpeg_warn;
  state.jpeg.client_data = &state;
  Result<Image> image = read_jpeg(state, bytes);
  jpeg_destroy_decompress(&state.jpeg);
  return image;
}

Result<Image> decode_webp(std::span<const uint8_t> bytes) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK)
    return broken("WebP: the header is broken");
  if (features.has_animation) return broken("WebP: animations are not supported");
  // Lossless pictures of one colour have no least size a pixel; WebP's own limit of 16383 a side has to do.
  if (Status status = check_size(uint64_t(features.width), uint64_t(features.height), UINT64_MAX); !status)
    return status.error();
  Image image = blank(uint64_t(features.width), uint64_t(features.height));
  if (!WebPDecodeRGBAInto(bytes.data(), bytes.size(), image.rgba.data(), image.rgba.size(),
                          features.width * 4))
    return broken("WebP: the picture is broken or cut off");
  return image;
}

bool starts_with(std::span<const uint8_t> bytes, size_t at, std::string_view magic) {
  return bytes.size() >= at + magic.size() && std::memcmp(bytes.data() + at, magic.data(), magic.size()) == 0;
}

}  // namespace

Result<Image> decode_image(std::span<const uint8_t> bytes) {
  if (bytes.empty()) return broken("the picture is empty");
  if (starts_with(bytes, 0, "\x89PNG\r\n\x1a\n")) return decode_png(bytes);
  if (starts_with(bytes, 0, "\xFF\xD8\xFF")) return decode_jpeg(bytes);
  if (starts_with(bytes, 0, "RIFF") && starts_with(bytes, 8, "WEBP")) return decode_webp(bytes);
  if (starts_with(bytes, 0, "\xABKTX")) return broken("KTX2 pictures are not supported");
  return broken("the picture is neither PNG, JPEG nor WebP");
}

}  // namespace goldthread
