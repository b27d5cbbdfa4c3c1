// Where to look at a scene from that has no camera. See frame_camera in preview.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "trace/shown_scene.h"

namespace goldthread {
namespace {

constexpr float kAspect = 16.0f / 9;
constexpr float kRoomShare = 0.8f;  ///< of all directions from the middle that must meet something in a room
constexpr float kClosedShare = 0.97f;  ///< above this it has no open side to look in through

/// Directions spread evenly over the sphere (a Fibonacci spiral).
std::vector<vec3> sphere_directions(int count) {
  std::vector<vec3> directions;
  const float golden = kPi * (3 - std::sqrt(5.0f));
  for (int i = 0; i < count; ++i) {
    const float y = 1 - (2 * static_cast<float>(i) + 1) / static_cast<float>(count);
    const float radius = std::sqrt(std::max(0.0f, 1 - y * y)), angle = golden * static_cast<float>(i);
    directions.emplace_back(radius * std::cos(angle), y, radius * std::sin(angle));
  }
  return directions;
}

Ray ray_from(const vec3& origin, const vec3& direction) {
  Ray ray;
  ray.origin = origin;
  ray.direction = direction;
  return ray;
}

/// How a point is placed: the share of directions that meet a drawn surface, and how near the nearest few
/// are.
struct Surroundings {
  float hit_share = 0;
  float clearance = 0;
};

Surroundings look_around(const ShownScene& shown, const vec3& point, int count) {
  Surroundings around;
  std::vector<float> distances;
  for (const vec3& direction : sphere_directions(count)) {
    const Hit hit = shown.closest(ray_from(point, direction));
    if (!hit.missed()) distances.push_back(hit.distance);
  }
  around.hit_share = static_cast<float>(distances.size()) / static_cast<float>(count);
  if (distances.empty()) return around;
  const auto near = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 20);
  std::nth_element(distances.begin(), near, distances.end());
  around.clearance = *near;
  return around;
}

Camera camera_at(const vec3& position, const vec3& forward, float fov, float aspect) {
  Camera camera;
  camera.name = "framed";
  camera.position = position;
  camera.forward = normalize_or(forward, vec3(0, 0, -1));
  camera.up = std::abs(camera.forward.y) < 0.99f ? vec3(0, 1, 0) : vec3(0, 0, -1);
  camera.vertical_fov = fov;
  camera.aspect = aspect;
  return camera;
}

/// The camera that looks along `forward` from where all points just fit into its picture. With x across, y up
/// and z along the view, a camera at (x0, y0, -d) sees a point when |x - x0| <= wide * (z + d), and likewise
/// for y: the largest of x - wide * z and of -x - wide * z bound x0 and d.
Camera fit(std::span<const vec3> points, const vec3& forward, float fov, float aspect) {
  Camera camera = camera_at(vec3(0), forward, fov, aspect);
  const vec3 right = normalize(cross(camera.forward, camera.up)), up = cross(right, camera.forward);
  const float margin = 0.96f, tall = std::tan(fov / 2) * margin, wide = tall * aspect;
  vec2 most(std::numeric_limits<float>::lowest()), least(std::numeric_limits<float>::lowest());
  for (const vec3& point : points) {
    const vec2 across(dot(point, right), dot(point, up));
    const vec2 slope = vec2(wide, tall) * dot(point, camera.forward);
    most = glm::max(most, across - slope);
    least = glm::max(least, -across - slope);
  }
  const vec2 middle = 0.5f * (most - least), back = 0.5f * (most + least) / vec2(wide, tall);
  camera.position = middle.x * right + middle.y * up - std::max(back.x, back.y) * camera.forward;
  return camera;
}

std::array<vec3, 8> corners(const Box& box) {
  std::array<vec3, 8> points;
  for (size_t i = 0; i < 8; ++i)
    points[i] = glm::mix(box.low, box.high, vec3(i & 1 ? 1 : 0, i & 2 ? 1 : 0, i & 4 ? 1 : 0));
  return points;
}

/// Long views over many things, evenly, are good ones; holes and walls right before the lens are bad.
float score(const ShownScene& shown, const Camera& camera) {
  constexpr int kWide = 16, kTall = 9;
  const vec3 right = normalize(cross(camera.forward, camera.up)), up = cross(right, camera.forward);
  const float tall = std::tan(camera.vertical_fov / 2), wide = tall * camera.aspect;
  const float diagonal = shown.bounds().diagonal();
  std::map<uint32_t, int> seen;
  float depth = 0;
  int hits = 0, close = 0;
  for (int y = 0; y < kTall; ++y)
    for (int x = 0; x < kWide; ++x) {
      const float u = (2 * static_cast<float>(x) + 1) / kWide - 1,
                  v = (2 * static_cast<float>(y) + 1) / kTall - 1;
      const vec3 direction = normalize(camera.forward + u * wide * right + v * tall * up);
      const Hit hit = shown.closest(ray_from(camera.position, direction));
      if (hit.missed()) continue;
      ++hits;
      depth += std::min(hit.distance / diagonal, 1.0f);
      close += hit.distance < 0.06f * diagonal;
      ++seen[shown.surface_of(hit.triangle)];
    }
  if (hits == 0) return 0;
  float entropy = 0;
  for (const auto& [surface, count] : seen) {
    const float share = static_cast<float>(count) / static_cast<float>(hits);
    entropy -= share * std::log(share);
  }
  const float rays = kWide * kTall;
  const float missed = 1 - static_cast<float>(hits) / rays, too_close = static_cast<float>(close) / rays;
  return std::sqrt(depth / rays) * (0.5f + entropy) * (1 - missed) * (1 - too_close) * (1 - too_close);
}

/// Places at about eye height, and the ways to look from each.
std::vector<Camera> inside_candidates(const ShownScene& shown) {
  constexpr std::array<float, 7> kAcross{0.06f, 0.15f, 0.3f, 0.5f, 0.7f, 0.85f, 0.94f};
  constexpr std::array<float, 3> kUp{0.4f, 0.55f, 0.7f};
  constexpr float kFov = 0.96f;  // 55 degrees
  const Box& box = shown.bounds();
  std::vector<Camera> cameras;
  for (float x : kAcross)
    for (float y : kUp)
      for (float z : kAcross) {
        const vec3 position = box.low + box.size() * vec3(x, y, z);
        const Surroundings around = look_around(shown, position, 64);
        if (around.hit_share < kRoomShare || around.clearance < 0.015f * box.diagonal()) continue;
        for (int turn = 0; turn < 16; ++turn) {
          const float yaw = kPi / 8 * static_cast<float>(turn);
          for (float pitch : {-0.12f, -0.35f})
            cameras.push_back(camera_at(position, vec3(std::cos(yaw), pitch, std::sin(yaw)), kFov, kAspect));
        }
      }
  return cameras;
}

/// Straight in through each side, the near face of the box filling the picture: how one looks into a box
/// without lid.
std::vector<Camera> opening_candidates(const Box& box) {
  constexpr float kFov = 0.68f;
  std::vector<Camera> cameras;
  for (const vec3& forward : {vec3(0, 0, -1), vec3(0, 0, 1), vec3(-1, 0, 0), vec3(1, 0, 0)}) {
    const float width = forward.z != 0 ? box.size().x : box.size().z;
    const float aspect = std::clamp(width / std::max(box.size().y, 1e-6f), 0.75f, kAspect);
    cameras.push_back(fit(corners(box), forward, kFov, aspect));
  }
  return cameras;
}

Camera best_of(const ShownScene& shown, const std::vector<Camera>& cameras) {
  std::vector<float> scores(cameras.size());
  parallel_for(cameras.size(), [&](size_t i) { scores[i] = score(shown, cameras[i]); });
  return cameras[static_cast<size_t>(std::max_element(scores.begin(), scores.end()) - scores.begin())];
}

}  // namespace

Camera frame_camera(const ShownScene& shown) {
  const Box& box = shown.bounds();
  if (shown.empty() || !(box.diagonal() > 0)) return camera_at(vec3(0, 0, 3), vec3(0, 0, -1), 0.8f, kAspect);
  const float enclosed = look_around(shown, box.centre(), 512).hit_share;
  if (enclosed > kRoomShare) {
    std::vector<Camera> cameras = inside_candidates(shown);
    if (enclosed < kClosedShare)
      for (const Camera& camera : opening_candidates(box)) cameras.push_back(camera);
    if (!cameras.empty()) return best_of(shown, cameras);
  }
  return fit(shown.corner_points(), normalize(vec3(-0.55f, -0.5f, -0.8f)), 0.6f, kAspect);
}

}  // namespace goldthread
