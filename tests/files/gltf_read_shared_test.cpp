// Real files: every model of the shared folder, against the table beside them.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "files/scene_read.h"

namespace goldthread {
namespace {

struct SharedScene {
  const char* name;
  size_t triangles, primitives, emissive_materials, lights;
};

class SharedScenes : public ::testing::TestWithParam<SharedScene> {};

TEST_P(SharedScenes, HaveTheCountsOfTheirTable) {
  const SharedScene& expected = GetParam();
  const std::string file = std::string(GOLDTHREAD_SHARED) + "/scenes/" + expected.name + ".glb";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  const Result<Scene> scene = read_scene(file);
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(scene->triangle_count(), expected.triangles);
  EXPECT_EQ(scene->lights.size(), expected.lights);
  EXPECT_FALSE(scene->bounds().empty());
  size_t primitives = 0, emissive = 0;
  for (const Mesh& mesh : scene->meshes) primitives += mesh.primitives.size();
  for (const Material& material : scene->materials) emissive += material.emits();
  EXPECT_EQ(primitives, expected.primitives);
  EXPECT_EQ(emissive, expected.emissive_materials);
  for (const std::string& warning : scene->warnings) std::cout << warning << "\n";
}

INSTANTIATE_TEST_SUITE_P(
    Table, SharedScenes,
    ::testing::Values(
        SharedScene{"cornell-original", 36, 8, 1, 0}, SharedScene{"cornell-sphere", 2188, 8, 1, 0},
        SharedScene{"sponza", 66450, 37, 0, 0}, SharedScene{"conference-lit", 124635, 44, 8, 0},
        SharedScene{"bathroom", 380290, 853, 1, 0}, SharedScene{"small-house", 145844, 85, 0, 8},
        SharedScene{"sportscar-room", 300617, 1082, 6, 0}, SharedScene{"engine-room", 121510, 41, 1, 0},
        SharedScene{"chess-room", 178862, 15, 1, 0}, SharedScene{"house", 10497, 2, 0, 0},
        SharedScene{"jpm", 20458, 8, 0, 0}, SharedScene{"as1-oc-214", 21556, 18, 0, 0}),
    [](const auto& info) {
      std::string name = info.param.name;
      std::replace(name.begin(), name.end(), '-', '_');
      return name;
    });

}  // namespace
}  // namespace goldthread
