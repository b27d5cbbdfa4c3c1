#include "files/image_write.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <half.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <vector>

#include "base/parallel.h"
#include "files/atomic_file.h"
#include "files/png_encode.h"
#include "math/colour.h"

namespace goldthread {
namespace {

Error not_a_picture(const std::string& file) {
  return {ErrorCode::kCannotWrite, "the picture has no pixels, or more than the format can hold", file, "",
          "choose another width and height"};
}

bool consistent(const FloatImage& image) {
  return image.width > 0 && image.height > 0 && image.pixels.size() == size_t{image.width} * image.height;
}

/// NaN becomes black: a broken pixel must not turn into whatever the conversion happens to give.
uint8_t to_byte(float linear) {
  return std::isnan(linear) ? uint8_t{0} : static_cast<uint8_t>(std::lround(255 * linear_to_srgb(linear)));
}

/// The EXR file in memory, so that disk trouble is AtomicFile's to report.
std::string encode_exr(const FloatImage& image, const LayeredImage* more, ExrDepth depth) {
  Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer frame;
  std::vector<std::vector<half>> halves;  // that the frame reads
  const auto add = [&](const std::string& name, const float* first, size_t stride) {
    if (depth == ExrDepth::kHalf) {
      std::vector<half>& own = halves.emplace_back(size_t{image.width} * image.height);
      for (size_t i = 0; i < own.size(); ++i)
        own[i] = half(std::clamp(first[i * stride / sizeof(float)], -static_cast<float>(HALF_MAX),
                                 static_cast<float>(HALF_MAX)));
      header.channels().insert(name, Imf::Channel(Imf::HALF));
      frame.insert(name, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(own.data()), sizeof(half),
                                    sizeof(half) * image.width));
      return;
    }
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    auto* base = reinterpret_cast<char*>(const_cast<float*>(first));  // Imf reads only
    frame.insert(name, Imf::Slice(Imf::FLOAT, base, stride, stride * image.width));
  };
  const char* names[3] = {"R", "G", "B"};
  const auto* pixels = reinterpret_cast<const float*>(image.pixels.data());
  for (size_t channel = 0; channel < 3; ++channel) add(names[channel], pixels + channel, sizeof(vec3));
  if (more != nullptr) {
    for (const auto& [name, values] : more->layers) add(name, values.data(), sizeof(float));
    for (const auto& [name, text] : more->notes) header.insert(name, Imf::StringAttribute(text));
  }
  Imf::StdOSStream stream;
  {
    Imf::OutputFile output(stream, header);
    output.setFrameBuffer(frame);
    output.writePixels(static_cast<int>(image.height));
  }
  return stream.str();
}

Status write_exr(const std::string& file, const FloatImage& image, const LayeredImage* more, ExrDepth depth) {
  constexpr uint32_t kLargest = 1u << 30;  // Imf counts in int
  if (!consistent(image) || image.width > kLargest || image.height > kLargest) return not_a_picture(file);
  try {
    const std::string bytes = encode_exr(image, more, depth);
    return write_file_atomically(file, {reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
  } catch (const std::exception& failure) {
    return Error{ErrorCode::kCannotWrite, std::string("OpenEXR: ") + failure.what(), file, "", ""};
  }
}

}  // namespace

Status write_png(const std::string& file, const FloatImage& image) {
  if (!consistent(image)) return not_a_picture(file);
  std::vector<uint8_t> pixels(image.pixels.size() * 3);
  parallel_for(image.height, [&](size_t row) {
    for (size_t i = row * image.width; i < (row + 1) * image.width; ++i)
      for (int c = 0; c < 3; ++c) pixels[3 * i + static_cast<size_t>(c)] = to_byte(image.pixels[i][c]);
  });
  const std::vector<uint8_t> bytes = encode_png(image.width, image.height, 3, pixels);
  if (bytes.empty()) return not_a_picture(file);
  return write_file_atomically(file, bytes);
}

Status write_exr(const std::string& file, const FloatImage& image) {
  return write_exr(file, image, nullptr, ExrDepth::kFloat);
}

Status write_layered_exr(const std::string& file, const LayeredImage& image, ExrDepth depth) {
  for (const auto& [name, values] : image.layers)
    if (values.size() != image.image.pixels.size()) return not_a_picture(file);
  return write_exr(file, image.image, &image, depth);
}

}  // namespace goldthread
