#include "files/png_encode.h"

#include <png.h>

namespace goldthread {
namespace {

/// What outlives libpng's longjmp: nothing here has a destructor of its own.
struct Encoder {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::vector<uint8_t>* bytes = nullptr;
  bool out_of_memory = false;
};

void append(png_structp png, png_bytep data, png_size_t size) {
  auto* encoder = static_cast<Encoder*>(png_get_io_ptr(png));
  try {
    encoder->bytes->insert(encoder->bytes->end(), data, data + size);
  } catch (...) {  // no exception may cross libpng's C frames
    encoder->out_of_memory = true;
  }
  if (encoder->out_of_memory) png_error(png, "out of memory");
}

void no_flush(png_structp) {}
void quiet(png_structp, png_const_charp) {}

bool run(Encoder& encoder, uint32_t width, uint32_t height, uint32_t channels, const uint8_t* pixels,
         PngContent content) {
  if (setjmp(png_jmpbuf(encoder.png))) return false;
  png_set_write_fn(encoder.png, &encoder, append, no_flush);
  const int colour_type = channels == 4 ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB;
  png_set_IHDR(encoder.png, encoder.info, width, height, 8, colour_type, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (content == PngContent::kSrgb) png_set_sRGB(encoder.png, encoder.info, PNG_sRGB_INTENT_RELATIVE);
  png_write_info(encoder.png, encoder.info);
  for (uint32_t row = 0; row < height; ++row)
    png_write_row(encoder.png, pixels + size_t{row} * width * channels);
  png_write_end(encoder.png, encoder.info);
  return true;
}

}  // namespace

std::vector<uint8_t> encode_png(uint32_t width, uint32_t height, uint32_t channels,
                                std::span<const uint8_t> pixels, PngContent content) {
  std::vector<uint8_t> bytes;
  if (width == 0 || height == 0 || pixels.size() != size_t{width} * height * channels) return bytes;
  Encoder encoder;
  encoder.bytes = &bytes;
  encoder.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, quiet, quiet);
  if (!encoder.png) return bytes;
  encoder.info = png_create_info_struct(encoder.png);
  const bool done = encoder.info && run(encoder, width, height, channels, pixels.data(), content);
  png_destroy_write_struct(&encoder.png, &encoder.info);
  if (!done) bytes.clear();
  return bytes;
}

}  // namespace goldthread
