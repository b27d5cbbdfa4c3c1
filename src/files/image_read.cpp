#include "files/image_read.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>

#include "files/file_name.h"
#include "files/gltf_read_container.h"
#include "files/hdr_decode.h"
#include "files/image_decode.h"
#include "files/mesh_import.h"
#include "math/colour.h"

namespace goldthread {
namespace {

/// `more`, where it is given, takes what is in the file besides colour.
Result<FloatImage> read_exr(const std::string& file, LayeredImage* more) {
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
    const auto add = [&](const std::string& name, float* first, size_t stride) {
      // Imf wants the address of pixel (0, 0), which may lie outside the window.
      char* base = reinterpret_cast<char*>(first) -
                   (window.min.x + window.min.y * width) * static_cast<int64_t>(stride);
      frame.insert(name, Imf::Slice(Imf::FLOAT, base, stride, stride * image.width));
    };
    auto* pixels = reinterpret_cast<float*>(image.pixels.data());
    for (size_t channel = 0; channel < (grey ? 1 : 3); ++channel)
      add(names[channel], pixels + channel, sizeof(vec3));
    if (more != nullptr) {
      const Imf::ChannelList& channels = input.header().channels();
      for (auto c = channels.begin(); c != channels.end(); ++c) {
        const std::string name = c.name();
        if (c.channel().type != Imf::FLOAT || name == "R" || name == "G" || name == "B" || name == "Y")
          continue;
        std::vector<float>& layer = more->layers[name];
        layer.resize(image.pixels.size());
        add(name, layer.data(), sizeof(float));
      }
      for (auto a = input.header().begin(); a != input.header().end(); ++a)
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
          more->notes[a.name()] = text->value();
    }
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
  if (extension == ".exr") return read_exr(file, nullptr);
  if (is_radiance_picture(*bytes)) {
    Result<FloatImage> picture = decode_radiance_picture(*bytes);
    if (picture) return picture;
    Error error = picture.error();
    error.file = file;
    return error;
  }
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

Result<LayeredImage> read_layered_exr(const std::string& file) {
  if (const Result<Bytes> bytes = read_file_bytes(file); !bytes) return bytes.error();
  LayeredImage layered;
  Result<FloatImage> image = read_exr(file, &layered);
  if (!image) return image.error();
  layered.image = std::move(*image);
  return layered;
}

}  // namespace goldthread
