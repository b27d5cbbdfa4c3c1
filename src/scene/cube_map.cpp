#include "scene/cube_map.h"

#include <algorithm>

#include "base/parallel.h"

namespace goldthread {
namespace {

struct FaceFrame {
  vec3 ahead, up;
};

constexpr std::array<FaceFrame, 6> kFrames{{{{1, 0, 0}, {0, 1, 0}},
                                            {{-1, 0, 0}, {0, 1, 0}},
                                            {{0, 1, 0}, {0, 0, -1}},
                                            {{0, -1, 0}, {0, 0, 1}},
                                            {{0, 0, 1}, {0, 1, 0}},
                                            {{0, 0, -1}, {0, 1, 0}}}};

size_t face_towards(const vec3& d) {
  const vec3 a = glm::abs(d);
  const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
  return static_cast<size_t>(2 * axis + (d[axis] < 0 ? 1 : 0));
}

}  // namespace

bool CubeMap::is_whole() const {
  const uint32_t size = faces[0].width;
  return size > 0 && std::all_of(faces.begin(), faces.end(), [size](const FloatImage& face) {
           return face.width == size && face.height == size && face.pixels.size() == size_t{size} * size;
         });
}

const vec3& CubeMap::towards(const vec3& direction) const {
  const size_t number = face_towards(direction);
  const FaceFrame& frame = kFrames[number];
  const FloatImage& face = faces[number];
  const float depth = dot(direction, frame.ahead);
  const auto along = [&](float share) {
    const float place = (0.5f + 0.5f * share / depth) * static_cast<float>(face.width);
    return std::min(static_cast<uint32_t>(std::max(place, 0.0f)), face.width - 1);
  };
  const uint32_t column = along(dot(direction, cross(frame.ahead, frame.up)));
  return face.pixels[size_t{along(-dot(direction, frame.up))} * face.width + column];
}

FloatImage equirectangular_of(const CubeMap& cube, const glm::quat& rotation) {
  constexpr uint32_t kPlaces = 4;
  FloatImage out;
  out.width = std::min(4 * std::min(cube.faces[0].width, kMostPixelsRound), kMostPixelsRound);
  out.height = out.width / 2;
  out.pixels.resize(size_t{out.width} * out.height);
  const glm::quat back = glm::inverse(rotation);
  const auto at = [&](uint32_t pixel, uint32_t place) {
    return (static_cast<float>(pixel) + (static_cast<float>(place) + 0.5f) / kPlaces) /
           static_cast<float>(out.height) * kPi;
  };
  parallel_for(
      out.height,
      [&](size_t row) {
        for (uint32_t column = 0; column < out.width; ++column) {
          vec3 sum(0);
          for (uint32_t place = 0; place < kPlaces * kPlaces; ++place) {
            const float polar = at(static_cast<uint32_t>(row), place / kPlaces);
            const float azimuth = at(column, place % kPlaces) - kPi;
            const vec3 d(std::sin(polar) * std::sin(azimuth), std::cos(polar),
                         -std::sin(polar) * std::cos(azimuth));
            sum += cube.towards(back * d);
          }
          out.pixels[row * out.width + column] = sum / static_cast<float>(kPlaces * kPlaces);
        }
      },
      8);
  return out;
}

}  // namespace goldthread
