// From lit primitives to pages: every triangle has a place, and instances and sides have their own.
#include "represent/atlas_layout.h"

#include <gtest/gtest.h>

#include <set>

#include "scene/small_scenes.h"

namespace goldthread {
namespace {

const CancelToken kNever;

/// A two-sided cube and a one-sided grid that is there twice, at half size the second time; light on all of
/// them.
struct Room {
  Scene scene;
  Lighting lighting;
  std::vector<FaceClusterTree> trees;
  std::vector<AtlasPart> parts;

  Room() {
    Material shell = test::diffuse(0.5f);
    shell.double_sided = true;
    test::add(scene, shapes::cube(2), shell);
    test::add(scene, shapes::flat_grid(3), test::diffuse(0.5f));
    scene.instances.push_back({1, test::scale(vec3(0.5f)), 0, {}});
    for (const Mesh& mesh : scene.meshes)
      trees.push_back(build_face_clusters(weld(mesh.primitives[0].positions, mesh.primitives[0].indices)));
    for (uint32_t n = 0; n < 3; ++n) {
      LitPrimitive lit;
      lit.instance = n;
      lit.irradiance.resize(source(n).positions.size(), vec3(1));
      if (n == 0) lit.irradiance_back = lit.irradiance;
      lighting.primitives.push_back(lit);
      parts.push_back({n, 0, &trees[scene.instances[n].mesh], n == 2 ? 0.5f : 1.0f});
    }
  }
  const Primitive& source(uint32_t instance) const {
    return scene.meshes[scene.instances[instance].mesh].primitives[0];
  }
  std::optional<LightAtlas> lay_out(const PackOptions& pages, AtlasStats& stats) const {
    return lay_out_atlas(scene, lighting, parts, {{}, pages}, kNever, stats);
  }
};

TEST(AtlasLayout, EveryTriangleOfEverySideHasItsPlace) {
  const Room room;
  AtlasStats stats;
  const std::optional<LightAtlas> atlas = room.lay_out({128, 1, 2, 0}, stats);
  ASSERT_TRUE(atlas);
  EXPECT_EQ(atlas->pages.size(), 1u);
  EXPECT_GT(stats.placed, stats.charts.charts);
  std::set<std::tuple<uint32_t, bool, uint32_t>> seen;
  for (const MappedMesh& mesh : atlas->meshes) {
    const Primitive& source = room.source(mesh.instance);
    for (size_t f = 0; f < mesh.faces.size(); ++f) {
      EXPECT_TRUE(seen.emplace(mesh.instance, mesh.back, mesh.face_parents[f]).second);
      // Corner k of a face is corner k of its parent, and lies on the page.
      for (int k = 0; k < 3; ++k) {
        const VertexOrigin& origin = mesh.origins[mesh.faces[f][k]];
        const int corner = origin.weights.x == 1 ? 1 : origin.weights.y == 1 ? 2 : 0;
        EXPECT_EQ(source.indices[3 * origin.triangle + size_t(corner)],
                  source.indices[3 * mesh.face_parents[f] + size_t(k)]);
        const vec2& at = mesh.coordinates[mesh.faces[f][k]];
        EXPECT_TRUE(at.x > 0 && at.y > 0 && at.x < 1 && at.y < 1);
      }
    }
  }
  EXPECT_EQ(seen.size(), 2 * room.source(0).triangle_count() + 2 * room.source(1).triangle_count());
}

TEST(AtlasLayout, ABackThatNobodyShowsHasNoPlace) {
  // Light on the back of what is one-sided, as of a lampshade's: it comes through, but the back is not drawn.
  Room room;
  room.lighting.primitives[1].irradiance_back = room.lighting.primitives[1].irradiance;
  AtlasStats stats;
  const std::optional<LightAtlas> atlas = room.lay_out({128, 1, 2, 0}, stats);
  ASSERT_TRUE(atlas);
  size_t backs = 0;
  for (const MappedMesh& mesh : atlas->meshes) {
    backs += mesh.back;
    EXPECT_TRUE(!mesh.back || mesh.instance == 0);
  }
  EXPECT_GT(backs, 0u);
}

TEST(AtlasLayout, TheDensityIsThatOfTheWorld) {
  const Room room;
  AtlasStats stats;
  const std::optional<LightAtlas> atlas = room.lay_out({256, 1, 2, 20}, stats);
  ASSERT_TRUE(atlas);
  EXPECT_EQ(atlas->texels_per_metre, 20);
  double texels[3] = {0, 0, 0};
  for (const MappedMesh& mesh : atlas->meshes)
    for (const UVec3& face : mesh.faces) {
      const vec2 a = mesh.coordinates[face.x], b = mesh.coordinates[face.y], c = mesh.coordinates[face.z];
      texels[mesh.instance] +=
          256.0 * 256.0 * std::abs(double((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x))) / 2;
    }
  EXPECT_NEAR(texels[0], 2 * 6 * 400, 20);  // both sides of the cube
  EXPECT_NEAR(texels[1], 400, 4);
  EXPECT_NEAR(texels[2], 100, 1);  // half as long, a quarter of the area
}

TEST(AtlasLayout, MeshesArePartedByPage) {
  const Room room;
  AtlasStats stats;
  const std::optional<LightAtlas> atlas = room.lay_out({64, 8, 2, 20}, stats);
  ASSERT_TRUE(atlas);
  EXPECT_GT(atlas->pages.size(), 1u);
  std::set<uint32_t> used;
  for (const MappedMesh& mesh : atlas->meshes) {
    EXPECT_LT(mesh.page, atlas->pages.size());
    used.insert(mesh.page);
  }
  EXPECT_EQ(used.size(), atlas->pages.size());
}

TEST(AtlasLayout, TrianglesThatAreThereTwiceShareAPlace) {
  Room room;
  Primitive& grid = room.scene.meshes[1].primitives[0];
  // The first triangle again, beginning with another corner.
  for (const uint32_t k : {1u, 2u, 0u}) grid.indices.push_back(grid.indices[k]);
  room.trees[1] = build_face_clusters(weld(grid.positions, grid.indices));
  AtlasStats stats;
  const std::optional<LightAtlas> atlas = room.lay_out({128, 1, 2, 0}, stats);
  ASSERT_TRUE(atlas);
  for (const MappedMesh& mesh : atlas->meshes) {
    if (mesh.instance != 1) continue;
    std::vector<vec2> first, again;
    for (size_t f = 0; f < mesh.faces.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        if (mesh.face_parents[f] == 0) first.push_back(mesh.coordinates[mesh.faces[f][k]]);
        if (mesh.face_parents[f] == 18) again.push_back(mesh.coordinates[mesh.faces[f][k]]);
      }
    ASSERT_EQ(first.size(), 3u);
    ASSERT_EQ(again.size(), 3u);
    for (size_t k = 0; k < 3; ++k) EXPECT_EQ(again[k], first[(k + 1) % 3]);
  }
}

TEST(AtlasLayout, NoRoomIsToldAndNothingLitNeedsNone) {
  Room room;
  AtlasStats stats;
  EXPECT_FALSE(room.lay_out({4, 1, 4, 0}, stats));
  room.lighting.primitives.clear();
  const std::optional<LightAtlas> atlas = room.lay_out({64, 1, 2, 0}, stats);
  ASSERT_TRUE(atlas);
  EXPECT_TRUE(atlas->pages.empty());
}

}  // namespace
}  // namespace goldthread
