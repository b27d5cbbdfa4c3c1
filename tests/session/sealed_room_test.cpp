// A closed room in full sun, of walls that run through each other and through one large ground: nothing of
// what is outside gets in.
#include <gtest/gtest.h>

#include "reconstruct/adaptive_gather.h"
#include "session/effort.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::Solved;

// The room's inside, metres, and how its walls stand out.
constexpr float kHalf = 2, kHigh = 3, kThick = 0.2f, kBelow = 0.5f, kBeyond = 0.3f;

/// A box as six quads of their own corners: its normals are split.
shapes::Soup box(const vec3& low, const vec3& high) {
  shapes::Soup soup;
  const auto add = [&](const vec3& corner, const vec3& across, const vec3& up) {
    const auto n = uint32_t(soup.positions.size());
    for (const vec3& p : {corner, corner + across, corner + across + up, corner + up})
      soup.positions.push_back(p);
    for (const uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) soup.indices.push_back(n + k);
  };
  const vec3 x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
  add(low, z, y);
  add(low + x, y, z);
  add(low, x, z);
  add(low + y, z, x);
  add(low, y, x);
  add(low + z, x, y);
  return soup;
}

struct Wall {
  vec3 low, high;
};

/// Solid walls and a solid roof, or sheets without thickness; turned about the upright by `turn` radians, so
/// that no wall lies along a cut of the ground.
Scene room(bool solid, float turn) {
  Scene scene;
  Material material = test::diffuse(0.7f);
  material.double_sided = !solid;
  const uint32_t grey = test::add(scene, std::move(material));
  test::add(scene, test::parallelogram({-6, 0, 6}, {12, 0, 0}, {0, 0, -12}), grey);
  const float o = kHalf + kThick, b = kHalf + kBeyond;
  const std::vector<Wall> walls =
      solid ? std::vector<Wall>{{{-o, -kBelow, -o}, {-kHalf, kHigh + 0.1f, o}},
                                {{kHalf, -kBelow, -o}, {o, kHigh + 0.1f, o}},
                                {{-o, -kBelow, -o}, {o, kHigh + 0.1f, -kHalf}},
                                {{-o, -kBelow, kHalf}, {o, kHigh + 0.1f, o}},
                                {{-o - 0.3f, kHigh, -o - 0.3f}, {o + 0.3f, kHigh + 0.2f, o + 0.3f}}}
            : std::vector<Wall>{{{-kHalf, -kBelow, -b}, {-kHalf, kHigh + kBeyond, b}},
                                {{kHalf, -kBelow, -b}, {kHalf, kHigh + kBeyond, b}},
                                {{-b, -kBelow, -kHalf}, {b, kHigh + kBeyond, -kHalf}},
                                {{-b, -kBelow, kHalf}, {b, kHigh + kBeyond, kHalf}},
                                {{-b, kHigh, -b}, {b, kHigh, b}}};
  const mat4 turned = glm::rotate(mat4(1), turn, vec3(0, 1, 0));
  for (const Wall& wall : walls) {
    if (solid) {
      test::add(scene, box(wall.low, wall.high), grey, turned);
      continue;
    }
    const vec3 size = wall.high - wall.low;
    const vec3 across = size.x > 0 ? vec3(size.x, 0, 0) : vec3(0, 0, size.z);
    const vec3 up = size.y > 0 ? vec3(0, size.y, 0) : vec3(0, 0, size.z);
    test::add(scene, test::parallelogram(wall.low, across, up), grey, turned);
  }
  scene.lights.push_back(
      test::lamp(LightKind::kDirectional, 100000, vec3(0), normalize(vec3(0.5f, -0.8f, 0.3f))));
  scene.sky.radiance = vec3(1500);
  return scene;
}

struct Found {
  double inside = 0, outside = 0;  // lux: the most, and the mean of what is lit
  size_t count = 0;
};

/// At every light point that a face of the room's inside shows.
Found light_in(bool solid, float turn, uint32_t seed) {
  Effort effort = effort_for(tolerated_error(Quality::kDraft));
  effort.solve.discontinuities = effort.solve.shafts = true;
  effort.solve.seed = seed;
  Solved solved(room(solid, turn), effort.solve);
  solved.solve();
  ReconstructStats stats;
  AdaptiveGather gather(*solved.solver, effort.reconstruct, CancelToken(), stats);
  gather.run();
  const mat3 back(glm::rotate(mat4(1), -turn, vec3(0, 1, 0)));
  Found out;
  double lit = 0;
  for (uint32_t part = 0; part < solved.set->parts.size(); ++part) {
    const PartPoints& points = gather.points(part);
    for (const bool behind : {false, true}) {
      if (behind && !gather.is_two_sided(part)) continue;
      for (uint32_t f = 0; f + 1 < points.corner_first.size(); ++f) {
        const vec3 n = behind ? -points.face_normals[f] : points.face_normals[f];
        const vec3 p = back * (points.face_centres[f] + 1e-3f * n);
        const bool in = std::abs(p.x) < kHalf && std::abs(p.z) < kHalf && p.y > 0 && p.y < kHigh;
        for (uint32_t c = points.corner_first[f]; c < points.corner_first[f + 1]; ++c) {
          const auto e = double(largest(gather.light(part, behind)[points.corners[c]]));
          if (in) {
            out.inside = std::max(out.inside, e);
            ++out.count;
          } else if (e > 1000) {
            out.outside += e;
            lit += 1;
          }
        }
      }
    }
  }
  out.outside /= lit;
  return out;
}

TEST(SealedRoom, StaysDarkInFullSun) {
  for (const bool solid : {true, false})
    for (const float turn : {0.0f, 0.35f, 0.8f})
      for (const uint32_t seed : {0u, 1u, 5u, 12u}) {
        const Found light = light_in(solid, turn, seed);
        EXPECT_GT(light.count, 60u);
        EXPECT_GT(light.outside, 20000);
        EXPECT_LT(light.inside, 1e-4 * light.outside)
            << (solid ? "solid" : "sheets") << " turned by " << turn << ", seed " << seed;
      }
}

}  // namespace
}  // namespace goldthread
