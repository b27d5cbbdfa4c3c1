#include "files/image_read.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>

#include "files/file_name.h"
#include "files/gltf_read_container.h"
#include "files/image_decode.h"
#include "files/mesh_import.h"
#include "math/colour.h"

namespace goldthread {
namespace {

Result<FloatImage> read_exr(const std::string& file) {
  try {
    Imf::InputFile input(file.c_str());
    const Imath::Box2i window = input.header().dataWindow();
    const int64_t width = int64_t{window.max.x} - window.min.x + 1,
                  height = int64_t{window.max.y} - window.min.y + 1;
    if (width < 1 || height < 1 || width > kLargestImageSide || height > kLargestImageSide)
      return bad_input(file, "", fmt::format("a picture of {} x {} pixels", width, height),
                       "make it smaller");
    const bool grey = input.header().channels().findChannel("R") == nullptr;
    if (grey && input.header().channels().findChannel("Y") == nullptr)
      return bad_input(file, "", "has neither channels R, G, B nor Y", "export it as RGB");
    FloatImage image;
    image.width = static_cast<uint32_t>(width);
    image.height = static_cast<uint32_t>(height);
    image.pixels.resize(size_t{image.width} * image.height);
    Imf::FrameBuffer frame;
    const char* names[3] = {grey ? "Y" : "R", "G", "B"};
    // Imf wants the address of pixel (0, 0), which may lie outside the window.
    auto* base = reinterpret_cast<char*>(image.pixels.data()) -
                 (window.min.x + window.min.y * width) * static_cast<int64_t>(sizeof(vec3));
    for (size_t channel = 0; channel < (grey ? 1 : 3); ++channel)
      frame.insert(names[channel], Imf::Slice(Imf::FLOAT, base + channel * sizeof(float), sizeof(vec3),
                                              sizeof(vec3) * image.width));
    input.setFrameBuffer(frame);
    input.readPixels(window.min.y, window.max.y);
    if (grey)
      for (vec3& pixel : image.pixels) pixel = vec3(pixel.x);
    return image;
  } catch (const std::exception& error) {
    return bad_input(file, "", fmt::format("cannot be read as EXR: {}", plain_text(error.what())),
                     "export it again");
  }
}

}  // namespace

Result<FloatImage> read_picture(const std::string& file) {
  const Result<Bytes> bytes = read_file_bytes(file);
  if (!bytes) return bytes.error();
  const std::string extension = file_extension(file);
  if (extension == ".exr") return read_exr(file);
  const Result<Image> encoded = decode_image(*bytes);
  if (!encoded) {
    Error error = encoded.error();
    error.file = file;
    return error;
  }
  FloatImage image;
  image.width = encoded->width;
  image.height = encoded->height;
  image.pixels.resize(size_t{image.width} * image.height);
  for (size_t i = 0; i < image.pixels.size(); ++i)
    for (int k = 0; k < 3; ++k)
      image.pixels[i][k] =
          srgb_to_linear(static_cast<float>(encoded->rgba[4 * i + static_cast<size_t>(k)]) / 255.0f);
  return image;
}

}  // namespace goldthread
