#include "scene/environment_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace goldthread {
namespace {

// Scales a pixel and puts out its channels that are no light; whether there were any.
bool repair(vec3& pixel, float scale) {
  bool repaired = false;
  for (int k = 0; k < 3; ++k) {
    const float nits = pixel[k] * scale;
    const bool good = nits >= 0 && nits <= EnvironmentMap::kMostNits;  // not a number is neither
    pixel[k] = good ? nits : 0.0f;
    repaired |= !good;
  }
  return repaired;
}

}  // namespace

Result<EnvironmentMap> EnvironmentMap::make(FloatImage picture, float scale, float rotation,
                                            Repairs* repairs) {
  if (picture.pixels.empty() || picture.pixels.size() != size_t{picture.width} * picture.height)
    return Error{ErrorCode::kBadInput, "the environment has no pixels", "", "", "give another picture"};
  if (!(scale >= 0) || !std::isfinite(scale) || !std::isfinite(rotation))
    return Error{ErrorCode::kUsage, "the environment's scale or rotation is no number", "", "",
                 "scales are 0 or more, rotations finite"};
  uint64_t repaired = 0;
  EnvironmentMap map;
  for (vec3& pixel : picture.pixels) {
    repaired += repair(pixel, scale) ? 1 : 0;
    map.dark_ = map.dark_ && pixel == vec3(0);
  }
  if (repaired == picture.pixels.size())
    return Error{ErrorCode::kBadInput,
                 "no pixel of the environment is luminance: all are negative, infinite or not numbers", "",
                 "", "export it again as linear RGB"};
  if (repairs != nullptr) repairs->pixels = repaired;
  map.picture_ = std::make_shared<const FloatImage>(std::move(picture));
  map.rotation_ = rotation;
  return map;
}

vec3 EnvironmentMap::radiance(const vec3& direction) const {
  constexpr double kTurn = 2 * std::numbers::pi;
  const dvec3 d(direction);
  const double azimuth = std::atan2(d.x, -d.z) - double{rotation_};
  const double u = 0.5 + azimuth / kTurn;
  const double v = 0.5 - std::atan2(d.y, std::hypot(d.x, d.z)) / std::numbers::pi;
  const auto along = [](double share, uint32_t size) {
    return std::min(static_cast<uint32_t>(std::max(share, 0.0) * size), size - 1);
  };
  const uint32_t column = along(u - std::floor(u), picture_->width), row = along(v, picture_->height);
  return picture_->pixels[size_t{row} * picture_->width + column];
}

}  // namespace goldthread
