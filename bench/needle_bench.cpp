// Long thin triangles under a lamp (thesis figure 4.9): cut regularly into four of their own shape, and as
// the solver cuts them, with as many triangles. Both show the exact light of their vertices, so that nothing
// but the cuts is compared. Then a whole car of such triangles, baked.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "element/element_pool.h"
#include "files/image_write.h"
#include "folder.h"
#include "goldthread/bake.h"
#include "math/form_factor.h"
#include "reconstruct/triangulate.h"

namespace goldthread {
namespace {

// A panel in y = 0, metres, of as many needles along x, and a lamp over it that faces down.
constexpr float kLength = 4, kWidth = 1;
constexpr uint32_t kNeedles = 24, kRegularLevels = 2;
const std::array<vec3, 4> kLamp{vec3(1.2f, 0.6f, 0.4f), vec3(1.6f, 0.6f, 0.4f), vec3(1.6f, 0.6f, 0.6f),
                                vec3(1.2f, 0.6f, 0.6f)};
constexpr uint32_t kPixels = 240;  // a metre

float light_at(const vec3& p) {
  const vec3 up(0, 1, 0);
  return std::max(0.0f, dot(up, polygon_form_factor(p, up, kLamp)));
}

using Triangle = std::array<vec3, 3>;

std::vector<Triangle> panel() {
  std::vector<Triangle> triangles;
  for (uint32_t i = 0; i < kNeedles / 2; ++i) {
    const float near = 2 * kWidth * static_cast<float>(i) / kNeedles,
                far = 2 * kWidth * static_cast<float>(i + 1) / kNeedles;
    const vec3 a(0, 0, near), b(0, 0, far), c(kLength, 0, far), d(kLength, 0, near);
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  }
  return triangles;
}

std::vector<Triangle> cut_regularly(std::vector<Triangle> triangles) {
  for (uint32_t level = 0; level < kRegularLevels; ++level) {
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : triangles) {
      const vec3 ab = 0.5f * (a + b), bc = 0.5f * (b + c), ca = 0.5f * (c + a);
      for (const Triangle& t : {Triangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
        finer.push_back(t);
    }
    triangles = std::move(finer);
  }
  return triangles;
}

/// The largest leaves are cut until there are `wanted` triangles.
std::vector<Triangle> cut_as_the_solver_does(size_t wanted) {
  Scene scene;
  Primitive primitive;
  for (const Triangle& t : panel())
    for (const vec3& p : t) {
      primitive.indices.push_back(static_cast<uint32_t>(primitive.positions.size()));
      primitive.positions.push_back(p);
    }
  scene.materials.emplace_back();
  scene.meshes.push_back({"panel", {primitive}});
  scene.instances.push_back({0, mat4(1), 0, {}});
  const SurfaceSet surfaces = build_surfaces(scene, CancelToken());
  ElementPool pool(surfaces);
  std::vector<Triangle> triangles;
  while (triangles.size() < wanted) {
    std::vector<ElementId> leaves;
    for (ElementId id = 0; id < pool.size(); ++id)
      if (pool[id].first_child == kNoElement && !pool[id].indivisible) leaves.push_back(id);
    std::sort(leaves.begin(), leaves.end(),
              [&](ElementId a, ElementId b) { return pool[a].area > pool[b].area; });
    leaves.resize(std::max<size_t>(1, leaves.size() / 16));
    std::sort(leaves.begin(), leaves.end());
    pool.expand(leaves);
    triangles.clear();
    const LeafMesh* mesh = pool.leaf_mesh(0);
    if (mesh == nullptr) continue;  // still above its triangles
    std::vector<uint32_t> loop;
    for (uint32_t f = 0; f < mesh->face_count(); ++f) {
      mesh->loop(f, loop);
      std::vector<vec3> corners;
      for (const uint32_t v : loop) corners.push_back(mesh->positions()[v]);
      std::vector<UVec3> pieces;
      triangulate_face(corners, pieces);
      for (const UVec3& t : pieces) triangles.push_back({corners[t.x], corners[t.y], corners[t.z]});
    }
  }
  return triangles;
}

/// Barycentric weights of a place in the panel's plane.
vec3 weights_of(const Triangle& t, const vec3& p) {
  const auto twice = [](const vec3& a, const vec3& b, const vec3& c) {
    return (b.x - a.x) * (c.z - a.z) - (b.z - a.z) * (c.x - a.x);
  };
  const float whole = twice(t[0], t[1], t[2]);
  if (whole == 0) return vec3(-1);
  const float v = twice(t[0], p, t[2]) / whole, w = twice(t[0], t[1], p) / whole;
  return {1 - v - w, v, w};
}

/// Calls visit(x, y, place, triangle, weights) for every pixel; rows from `kWidth` down.
template <typename Visit>
void for_each_pixel(const std::vector<Triangle>& triangles, const Visit& visit) {
  for (const Triangle& t : triangles) {
    const vec3 low = glm::min(t[0], glm::min(t[1], t[2])), high = glm::max(t[0], glm::max(t[1], t[2]));
    for (auto y = static_cast<uint32_t>(low.z * kPixels); static_cast<float>(y) < high.z * kPixels; ++y)
      for (auto x = static_cast<uint32_t>(low.x * kPixels); static_cast<float>(x) < high.x * kPixels; ++x) {
        const vec3 place((static_cast<float>(x) + 0.5f) / kPixels, 0,
                         (static_cast<float>(y) + 0.5f) / kPixels);
        const vec3 w = weights_of(t, place);
        if (std::min({w.x, w.y, w.z}) >= 0) visit(x, y, place, t, w);
      }
  }
}

/// Light as it is interpolated, above a picture of the triangles; returns the RMS error over the mean.
double paint(const std::vector<Triangle>& triangles, float brightest, FloatImage& image, uint32_t column) {
  double squares = 0, sum = 0, count = 0;
  const auto pixel = [&](uint32_t x, uint32_t y) -> vec3& {
    return image.pixels[y * image.width + column + x];
  };
  for_each_pixel(triangles, [&](uint32_t x, uint32_t y, const vec3& place, const Triangle& t, const vec3& w) {
    const float said = w.x * light_at(t[0]) + w.y * light_at(t[1]) + w.z * light_at(t[2]),
                truth = light_at(place);
    squares += static_cast<double>((said - truth) * (said - truth));
    sum += static_cast<double>(truth);
    count += 1;
    pixel(x, y) = vec3(said / brightest);
    // Metres from the nearest side.
    float side = 1;
    for (int k = 0; k < 3; ++k) {
      const vec3 &a = t[static_cast<size_t>(k)], &b = t[static_cast<size_t>((k + 1) % 3)];
      side = std::min(side, length(cross(b - a, place - a)) / length(b - a));
    }
    pixel(x, y + static_cast<uint32_t>(kWidth * kPixels) + 8) = vec3(side < 0.7f / kPixels ? 0.05f : 0.9f);
  });
  return std::sqrt(squares / count) / (sum / count);
}

void compare_cuts() {
  const std::vector<Triangle> regular = cut_regularly(panel()), ours = cut_as_the_solver_does(regular.size());
  const auto width = static_cast<uint32_t>(kLength * kPixels);
  FloatImage image;
  image.width = 2 * width + 8;
  image.height = static_cast<uint32_t>(2 * kWidth * kPixels) + 8;
  image.pixels.assign(size_t{image.width} * image.height, vec3(1));
  const float brightest = 1.1f * light_at({1.4f, 0, 0.5f});
  const double first = paint(regular, brightest, image, 0), second = paint(ours, brightest, image, width + 8);
  fmt::print("{} needles of 1:{:.0f}\n", kNeedles, kLength / (2 * kWidth / kNeedles));
  fmt::print("regular refinement  {:5} triangles, RMS error {:5.1f}%\n", regular.size(), 100 * first);
  fmt::print("as the solver cuts  {:5} triangles, RMS error {:5.1f}%\n", ours.size(), 100 * second);
  const std::string file = "out/bench/needles.png";
  if (const Status status = write_png(file, image); !status) throw std::runtime_error(status.error().line());
  fmt::print("left and right, light above triangles: {}\n", file);
}

void bake_car() {
  const Folder folder;
  const std::string car = folder.path("car.glb"), picture = "out/bench/car.png";
  if (const Result<uint64_t> made = make_scene({"car", 0, car}); !made)
    throw std::runtime_error(made.error().line());
  BakeOptions options;
  options.input = car;
  options.outputs = {picture};
  if (const Result<BakeResult> baked = bake(options); !baked) throw std::runtime_error(baked.error().line());
  fmt::print("a car of long thin triangles: {}\n", picture);
}

}  // namespace
}  // namespace goldthread

int main() {
  try {
    std::filesystem::create_directories("out/bench");
    goldthread::compare_cuts();
    goldthread::bake_car();
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
