#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "goldthread/bake.h"
#include "scene/procedural.h"
#include "session/fix_normals.h"
#include "session/shell_check.h"

namespace goldthread {
namespace {

using testing::HasSubstr;

/// A scene file that goes when the test does.
class TemporaryObj {
 public:
  explicit TemporaryObj(const std::string& text) {
    name_ =
        (std::filesystem::temp_directory_path() / ("goldthread_inspect_" + std::to_string(getpid()) + ".obj"))
            .string();
    std::ofstream(name_) << text;
  }
  ~TemporaryObj() { std::remove(name_.c_str()); }
  const std::string& name() const { return name_; }

 private:
  std::string name_;
};

nlohmann::json facts_of(const std::string& obj) {
  const TemporaryObj file(obj);
  const Result<SceneInfo> info = inspect(file.name());
  EXPECT_TRUE(info) << (info ? "" : info.error().line());
  return info ? nlohmann::json::parse(info->json) : nlohmann::json();
}

// A tetrahedron: as given its faces look outwards.
const std::string kCorners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
const std::string kOutward = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const std::string kInward = "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";

TEST(Inspect, CountsATetrahedron) {
  const auto facts = facts_of(kCorners + kOutward);
  EXPECT_EQ(facts["triangles"], 4);
  EXPECT_EQ(facts["shells"]["count"], 1);
  EXPECT_EQ(facts["shells"]["closed"], 1);
  EXPECT_EQ(facts["problems"]["boundary_edges"], 0);
  EXPECT_NEAR(facts["area_m2"].get<double>(), 1.5 + std::sqrt(3.0) / 2, 1e-5);
  EXPECT_THAT(facts["warnings"].dump(), HasSubstr("no light"));
}

TEST(Inspect, FindsWhatIsWrong) {
  EXPECT_EQ(facts_of(kCorners + kInward)["problems"]["inside_out_shells"], 1);
  EXPECT_EQ(facts_of(kCorners + "f 1 2 3\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")["problems"]["inconsistent_shells"],
            1);
  EXPECT_EQ(facts_of(kCorners + kOutward + "f 1 3 2\n")["problems"]["duplicate"], 1);
  EXPECT_EQ(facts_of(kCorners + "f 1 2 3\n")["problems"]["boundary_edges"], 3);
  EXPECT_EQ(facts_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 30 0 0\nf 1 2 3\nf 1 4 3\n")["problems"]["thin"], 1);
  EXPECT_EQ(
      facts_of(
          "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n")["problems"]
                                                                                      ["non_manifold_edges"],
      1);
}

TEST(Inspect, MissingFileIsAnError) {
  const Result<SceneInfo> info = inspect("no/such/scene.glb");
  ASSERT_FALSE(info);
  EXPECT_EQ(info.error().code, ErrorCode::kBadInput);
}

Scene cube_scene(bool inward) {
  Scene scene = std::move(*build_procedural("furnace", 48));
  if (!inward) {
    for (Primitive& p : scene.meshes[0].primitives) {
      for (size_t i = 0; i < p.indices.size(); i += 3) std::swap(p.indices[i + 1], p.indices[i + 2]);
      for (vec3& n : p.normals) n = -n;
    }
  }
  return scene;
}

double signed_volume(const Scene& scene) {
  const JoinedMesh joined = join_primitives(scene.meshes[0]);
  return find_winding(joined.mesh, joined.twins).shells[0].volume;
}

TEST(FixNormals, ARoomWithACameraStaysARoom) {
  Scene scene = cube_scene(true);
  EXPECT_EQ(fix_normals(scene).triangles, 0u);
  EXPECT_NEAR(signed_volume(scene), -1, 1e-5);
}

TEST(FixNormals, ABoxInsideOutIsTurnedWithItsNormals) {
  Scene scene = cube_scene(true);
  scene.cameras[0].position = {3, 3, 3};
  const FixedNormals fixed = fix_normals(scene);
  EXPECT_EQ(fixed.triangles, 48u);
  EXPECT_EQ(fixed.shells, 1u);
  EXPECT_NEAR(signed_volume(scene), 1, 1e-5);
  const Scene outward = cube_scene(false);
  EXPECT_EQ(scene.meshes[0].primitives[0].normals, outward.meshes[0].primitives[0].normals);
  EXPECT_EQ(fix_normals(scene).triangles, 0u) << "a second time finds nothing";
}

TEST(FixNormals, TwoSidedSurfacesAreLeftAlone) {
  Scene scene = cube_scene(true);
  scene.cameras.clear();
  scene.materials[0].double_sided = true;
  EXPECT_EQ(fix_normals(scene).triangles, 0u);
}

TEST(FixNormals, ShellsOfOurScenesAreSound) {
  for (const auto& [name, sentence] : procedural_names()) {
    Scene scene = std::move(*build_procedural(name, 0));
    EXPECT_EQ(fix_normals(scene).triangles, 0u) << name;
  }
}

}  // namespace
}  // namespace goldthread
