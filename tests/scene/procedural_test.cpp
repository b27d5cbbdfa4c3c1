#include "scene/procedural.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "mesh/components.h"
#include "mesh/dual_graph.h"
#include "mesh/triangle_mesh.h"

namespace goldthread {
namespace {

Scene make(std::string_view name, uint64_t triangles = 0) {
  Result<Scene> scene = build_procedural(name, triangles);
  EXPECT_TRUE(scene) << name;
  return scene ? std::move(*scene) : Scene{};
}

/// Calls visit(a, b, c, normals of the three, primitive) for every triangle in world space.
template <typename Visit>
void for_each_triangle(const Scene& scene, const Visit& visit) {
  for (const Instance& instance : scene.instances) {
    const mat4& m = instance.transform;
    const mat3 turn = area_vector_transform(mat3(m));
    for (const Primitive& p : scene.meshes[instance.mesh].primitives) {
      for (size_t i = 0; i < p.indices.size(); i += 3) {
        std::array<vec3, 3> corners, normals;
        for (size_t k = 0; k < 3; ++k) {
          corners[k] = vec3(m * vec4(p.positions[p.indices[i + k]], 1));
          normals[k] = turn * p.normals[p.indices[i + k]];
        }
        visit(corners, normals, p);
      }
    }
  }
}

struct Measures {
  dvec3 area_sum{0};
  double area = 0, volume = 0;
};

Measures measure(const Scene& scene) {
  Measures m;
  for_each_triangle(scene, [&](const auto& c, const auto&, const Primitive&) {
    const dvec3 a(c[0]), b(c[1]), d(c[2]);
    const dvec3 area = 0.5 * cross(b - a, d - a);
    m.area_sum += area;
    m.area += length(area);
    m.volume += dot(a, area) / 3;
  });
  return m;
}

uint32_t component_count(const Scene& scene) {
  uint32_t count = 0;
  for (const Instance& instance : scene.instances) {
    for (const Primitive& p : scene.meshes[instance.mesh].primitives) {
      const TriangleMesh mesh = weld(p.positions, p.indices);
      count += find_components(find_twins(mesh)).count;
    }
  }
  return count;
}

/// Every half-edge of all welded triangles has exactly one opposite.
bool is_watertight(const Scene& scene) {
  std::vector<vec3> positions;
  std::vector<uint32_t> indices;
  for_each_triangle(scene, [&](const auto& corners, const auto&, const Primitive&) {
    for (const vec3& corner : corners) {
      indices.push_back(uint32_t(positions.size()));
      positions.push_back(corner);
    }
  });
  const TriangleMesh mesh = weld(positions, indices);
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const UVec3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  return std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
    const auto other = edges.find({edge.first.second, edge.first.first});
    return edge.second == 1 && other != edges.end();
  });
}

double emitted_power(const Scene& scene) {
  double power = 0;
  for_each_triangle(scene, [&](const auto& c, const auto&, const Primitive& p) {
    const vec3 exitance = kPi * scene.materials[p.material].emission;
    power += double(length(area_vector(c[0], c[1], c[2]))) * double(exitance.y);
  });
  return power;
}

TEST(Procedural, UnknownNameListsTheKnown) {
  const Result<Scene> scene = build_procedural("teapot", 0);
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().code, ErrorCode::kUsage);
  for (const auto& [name, sentence] : procedural_names())
    EXPECT_NE(scene.error().line().find(name), std::string::npos) << name;
}

TEST(Procedural, AbsurdCountIsAnError) {
  EXPECT_FALSE(build_procedural("sphere", uint64_t(1) << 60));
}

class EveryScene : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Procedural, EveryScene,
                         testing::Values("cornell-box", "furnace", "sphere", "office", "car", "two-rooms"));

TEST_P(EveryScene, IsSound) {
  for (const uint64_t wish : {uint64_t(0), uint64_t(40'000)}) {
    const Scene scene = make(GetParam(), wish);
    EXPECT_FALSE(scene.cameras.empty());
    EXPECT_GT(emitted_power(scene), 0);
    for (const Material& material : scene.materials) {
      EXPECT_EQ(material.metallic, 0) << material.name;
      EXPECT_GT(std::min({material.base_colour.x, material.base_colour.y, material.base_colour.z}), 0);
      EXPECT_LT(std::max({material.base_colour.x, material.base_colour.y, material.base_colour.z}), 0.9f);
    }
    size_t wrong = 0, degenerate = 0;
    for_each_triangle(scene, [&](const auto& c, const auto& normals, const Primitive& p) {
      const vec3 area = area_vector(c[0], c[1], c[2]);
      if (!is_finite(area) || length(area) <= 0) ++degenerate;
      for (const vec3& normal : normals)
        if (!(dot(normal, area) > 0) || std::abs(length(normal) - 1) > 1e-3f) ++wrong;
      EXPECT_LT(p.material, scene.materials.size());
    });
    EXPECT_EQ(degenerate, 0u);
    EXPECT_EQ(wrong, 0u) << "normals that are not unit or point to the back";
  }
}

TEST_P(EveryScene, IsTheSameEveryTime) {
  const Scene a = make(GetParam(), 20'000), b = make(GetParam(), 20'000);
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (size_t m = 0; m < a.meshes.size(); ++m) {
    ASSERT_EQ(a.meshes[m].primitives.size(), b.meshes[m].primitives.size());
    for (size_t p = 0; p < a.meshes[m].primitives.size(); ++p) {
      EXPECT_EQ(a.meshes[m].primitives[p].positions, b.meshes[m].primitives[p].positions);
      EXPECT_EQ(a.meshes[m].primitives[p].indices, b.meshes[m].primitives[p].indices);
    }
  }
}

TEST(Procedural, CornellBoxIsThePublishedOne) {
  const Scene scene = make("cornell-box");
  EXPECT_EQ(scene.triangle_count(), 38u);
  EXPECT_NEAR(scene.bounds().high.x, 0.556f, 1e-6f);
  EXPECT_NEAR(scene.bounds().high.y, 0.5488f, 1e-6f);
  EXPECT_NEAR(scene.bounds().high.z, 0.5592f, 1e-6f);
  // The light: 130 mm by 105 mm.
  EXPECT_NEAR(emitted_power(scene), double(kPi) * 2400 * 0.130 * 0.105, 1e-2);
}

TEST(Procedural, FurnaceIsAClosedUnitCubeSeenFromInside) {
  for (const uint64_t wish : {uint64_t(0), uint64_t(12), uint64_t(1000), uint64_t(100'000)}) {
    const Scene scene = make("furnace", wish);
    const double wished = wish == 0 ? 12 : double(wish);
    EXPECT_NEAR(double(scene.triangle_count()), wished, 0.06 * wished);
    const Measures m = measure(scene);
    EXPECT_NEAR(m.area, 6, 1e-5);
    EXPECT_NEAR(m.volume, -1, 1e-5);  // fronts inside
    EXPECT_NEAR(length(m.area_sum), 0, 1e-6);
    EXPECT_TRUE(is_watertight(scene));
    EXPECT_NEAR(emitted_power(scene), 6, 1e-5);  // E = 1 on 6 m2
  }
}

TEST(Procedural, SphereIsClosedAndTendsToTheSphere) {
  for (const uint64_t wish : {uint64_t(20), uint64_t(1'000), uint64_t(31'000), uint64_t(1'000'000)}) {
    const Scene scene = make("sphere", wish);
    EXPECT_NEAR(double(scene.triangle_count()), double(wish), 0.05 * double(wish));
    const Measures m = measure(scene);
    EXPECT_LT(m.volume, 0);
    EXPECT_NEAR(length(m.area_sum), 0, 1e-5);
    const double sphere = 4 * double(kPi);
    EXPECT_LT(m.area, sphere);
    EXPECT_GT(m.area, sphere * (1 - 8.0 / double(wish)));
    EXPECT_TRUE(wish > 100'000 || is_watertight(scene));
  }
}

TEST(Procedural, RoomsAreClosed) {
  // Two-rooms' shell is made on a lattice; its furniture stands inside.
  Scene scene = make("two-rooms");
  const std::set<std::string> furniture = {"table", "column", "plinth", "sculpture"};
  std::erase_if(scene.instances, [&](const Instance& i) { return furniture.count(i.name) > 0; });
  EXPECT_TRUE(is_watertight(scene));
  EXPECT_LT(measure(scene).volume, 0);
}

TEST(Procedural, OfficeHasTheSizeOfASmallModel) {
  const Scene scene = make("office");
  EXPECT_GE(scene.triangle_count(), 1'000u);
  EXPECT_LE(scene.triangle_count(), 10'000u);
}

TEST(Procedural, CarMeetsItsCount) {
  EXPECT_NEAR(double(make("car").triangle_count()), 250'000, 2'500);
  for (const double wish : {10'000.0, 31'000.0, 125'000.0, 500'000.0})
    EXPECT_NEAR(double(make("car", uint64_t(wish)).triangle_count()), wish, 0.05 * wish);
}

TEST(Procedural, CarIsOneShapeAtEveryCount) {
  const Scene coarse = make("car", 10'000), fine = make("car", 250'000);
  EXPECT_EQ(component_count(coarse), component_count(fine));
  EXPECT_GE(component_count(coarse), 100u);
  EXPECT_EQ(coarse.instances.size(), fine.instances.size());
  EXPECT_EQ(coarse.bounds().low, fine.bounds().low);
  EXPECT_EQ(coarse.bounds().high, fine.bounds().high);
  EXPECT_NEAR(measure(coarse).area, measure(fine).area, 0.01 * measure(fine).area);
  EXPECT_EQ(emitted_power(coarse), emitted_power(fine));
}

TEST(Procedural, CarHasLongThinTriangles) {
  const Scene scene = make("car", 250'000);
  size_t thin = 0;
  for_each_triangle(scene, [&](const auto& c, const auto&, const Primitive&) {
    const float longest = std::max({length(c[1] - c[0]), length(c[2] - c[1]), length(c[0] - c[2])});
    const float height = 2 * length(area_vector(c[0], c[1], c[2])) / longest;
    if (longest > 5 * height) ++thin;
  });
  EXPECT_GT(double(thin), 0.8 * double(scene.triangle_count()));
}

}  // namespace
}  // namespace goldthread
