#include "session/reference_picture.h"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <optional>

#include "base/rng.h"
#include "files/image_read.h"
#include "files/image_write.h"
#include "trace/preview.h"

namespace goldthread {
namespace {

constexpr const char* kSeedNote = "goldthread.seed";
constexpr const char* kSceneNote = "goldthread.scene";

std::optional<uint64_t> number(const LayeredImage& image, const char* note, int base) {
  const auto found = image.notes.find(note);
  if (found == image.notes.end()) return {};
  const std::string& text = found->second;
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

}  // namespace

uint64_t picture_fingerprint(const TracedScene& scene) {
  const Camera camera = first_camera(scene.scene());
  uint64_t print = scene.fingerprint();
  const auto add = [&](float value) {
    print = (print ^ hash(std::bit_cast<uint32_t>(value))) * 0x100000001b3u;
  };
  for (const vec3& v : {camera.position, camera.forward, camera.up})
    for (int k = 0; k < 3; ++k) add(v[k]);
  for (const float value : {camera.vertical_fov, camera.orthographic_height, camera.aspect}) add(value);
  return print;
}

Status write_picture(const std::string& file, const ReferenceImage& picture, uint64_t seed,
                     uint64_t fingerprint) {
  LayeredImage layered;
  layered.image = picture.image;
  std::vector<float>&samples = layered.layers["samples"], &error = layered.layers["error"];
  for (const PixelSums& pixel : picture.pixels) {
    samples.push_back(static_cast<float>(pixel.passes * kBatches));
    error.push_back(static_cast<float>(pixel.standard_error()));
  }
  layered.notes[kSeedNote] = fmt::format("{}", seed);
  layered.notes[kSceneNote] = fmt::format("{:016x}", fingerprint);
  return write_layered_exr(file, layered);
}

Result<SavedPicture> read_picture_to_go_on(const std::string& file) {
  const Result<LayeredImage> read = read_layered_exr(file);
  if (!read) return read.error();
  const LayeredImage& image = *read;
  const auto samples = image.layers.find("samples"), error = image.layers.find("error");
  const std::optional<uint64_t> seed = number(image, kSeedNote, 10), scene = number(image, kSceneNote, 16);
  if (samples == image.layers.end() || error == image.layers.end() || !seed || !scene)
    return Error{ErrorCode::kBadInput,
                 "does not say how many samples its pixels have",
                 file,
                 {},
                 "give an .exr that reference -o wrote"};
  SavedPicture picture{*seed, *scene, image.image.width, image.image.height, {}};
  for (size_t i = 0; i < image.image.pixels.size(); ++i) {
    const float count = samples->second[i] / static_cast<float>(kBatches), deviation = error->second[i];
    if (!(count >= 0 && count < 1e9f && count == std::floor(count) && deviation >= 0) ||
        !std::isfinite(deviation) || !is_finite(image.image.pixels[i]))
      return Error{ErrorCode::kBadInput, "holds no number of samples, no error or no light", file,
                   fmt::format("pixel {}, {}", i % picture.width, i / picture.width), "render it anew"};
    picture.pixels.push_back(PixelSums::of(dvec3(image.image.pixels[i]), static_cast<double>(deviation),
                                           static_cast<uint32_t>(count)));
  }
  return picture;
}

}  // namespace goldthread
