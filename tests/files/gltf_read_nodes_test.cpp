// Known answers: where nodes put meshes and cameras.
#include <gmock/gmock.h>

#include "files/gltf_builder.h"
#include "files/scene_read.h"

namespace goldthread {
namespace {

using namespace test;

constexpr double kHalf = 0.7071067811865476;  ///< sine and cosine of 45 degrees: quarter turns as quaternions

Scene read_built(const GltfBuilder& builder) {
  TempFolder folder;
  Result<Scene> scene = read_scene(folder.write("scene.gltf", builder.text()));
  EXPECT_TRUE(scene) << scene.error().line();
  return scene ? *std::move(scene) : Scene{};
}

MATCHER_P(Near, expected, "") {
  return length(arg - expected) < 1e-5f;
}

vec3 transformed(const Instance& instance, const vec3& p) {
  return vec3(instance.transform * vec4(p, 1));
}

TEST(GltfNodes, TransformsChainFromTheRoot) {
  GltfBuilder b;
  b.triangle({{"translation", {1, 0, 0}}, {"scale", {2, 2, 2}}});
  b.push("nodes", {{"children", {0}}, {"rotation", {0, 0, kHalf, kHalf}}, {"translation", {0, 0, 5}}});
  const Scene scene = read_built(b);
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_THAT(transformed(scene.instances[0], vec3(1, 0, 0)), Near(vec3(0, 3, 5)));
  EXPECT_EQ(scene.instances[0].source_node, 0u);
}

TEST(GltfNodes, MatrixIsByColumns) {
  GltfBuilder b;
  b.triangle({{"matrix", {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1}}});
  EXPECT_THAT(transformed(read_built(b).instances[0], vec3(1, 0, 0)), Near(vec3(7, 9, 9)));
}

TEST(GltfNodes, MirroredAndUnevenScaleIsKept) {
  GltfBuilder b;
  b.triangle({{"scale", {-1, 2, 3}}});
  const Scene scene = read_built(b);
  EXPECT_FLOAT_EQ(glm::determinant(mat3(scene.instances[0].transform)), -6);
}

TEST(GltfNodes, NodesShareMeshes) {
  GltfBuilder b;
  b.triangle({{"name", "left"}});
  b.push("nodes", {{"mesh", 0}, {"name", "right"}, {"translation", {1, 0, 0}}});
  const Scene scene = read_built(b);
  EXPECT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[1].mesh, scene.instances[0].mesh);
  EXPECT_EQ(scene.instances[1].name, "right");
  EXPECT_EQ(scene.instances[1].source_node, 1u);
  EXPECT_EQ(scene.triangle_count(), 2u);
}

TEST(GltfNodes, OnlyTheDefaultSceneIsShown) {
  GltfBuilder b;
  b.triangle();
  b.triangle();
  b.push("nodes", {{"children", {1}}});
  b.doc["scenes"] = {{{"nodes", {0}}}, {{"nodes", {2}}}};
  EXPECT_EQ(read_built(b).instances[0].source_node, 0u);
  b.doc["scene"] = 1;
  const Scene scene = read_built(b);
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].source_node, 1u);
}

TEST(GltfNodes, GpuInstancing) {
  GltfBuilder b;
  const int moved = b.vec3s({1, 0, 0, 0, 2, 0});
  const int turned =
      b.accessor<int16_t>({0, 0, 0, 32767, 0, 0, 23170, 23170}, "VEC4", kShort, {{"normalized", true}});
  const int scaled = b.vec3s({1, 1, 1, 3, 3, 3});
  b.triangle({{"translation", {0, 0, 10}},
              {"extensions",
               {{"EXT_mesh_gpu_instancing",
                 {{"attributes", {{"TRANSLATION", moved}, {"ROTATION", turned}, {"SCALE", scaled}}}}}}}});
  const Scene scene = read_built(b);
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_THAT(transformed(scene.instances[0], vec3(1, 0, 0)), Near(vec3(2, 0, 10)));
  EXPECT_THAT(transformed(scene.instances[1], vec3(1, 0, 0)), Near(vec3(0, 5, 10)));
  EXPECT_EQ(scene.instances[1].source_node, 0u);
}

TEST(GltfNodes, HierarchyAHundredThousandDeep) {
  GltfBuilder b;
  b.triangle();
  const int depth = 100000;
  for (int i = 0; i < depth; ++i) b.push("nodes", {{"children", {i}}, {"translation", {0, 0, 0.5}}});
  EXPECT_THAT(transformed(read_built(b).instances[0], vec3(0)), Near(vec3(0, 0, depth * 0.5f)));
}

TEST(GltfCameras, PerspectiveLooksAlongMinusZ) {
  GltfBuilder b;
  b.push("cameras",
         {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}, {"aspectRatio", 1.5}}}});
  b.push("nodes",
         {{"camera", 0}, {"name", "eye"}, {"translation", {0, 1, 0}}, {"rotation", {0, kHalf, 0, kHalf}}});
  const Scene scene = read_built(b);
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_THAT(scene.cameras[0].forward, Near(vec3(-1, 0, 0)));
  EXPECT_THAT(scene.cameras[0].up, Near(vec3(0, 1, 0)));
  EXPECT_THAT(scene.cameras[0].position, Near(vec3(0, 1, 0)));
  EXPECT_FLOAT_EQ(scene.cameras[0].vertical_fov, 1.0f);
  EXPECT_FLOAT_EQ(scene.cameras[0].aspect, 1.5f);
  EXPECT_EQ(scene.cameras[0].name, "eye");
}

TEST(GltfCameras, OrthographicHeightIsTwiceItsMagnification) {
  GltfBuilder b;
  b.push("cameras", {{"type", "orthographic"},
                     {"orthographic", {{"xmag", 4}, {"ymag", 2}, {"znear", 0.1}, {"zfar", 9}}}});
  b.push("nodes", {{"camera", 0}});
  const Camera camera = read_built(b).cameras.at(0);
  EXPECT_EQ(camera.vertical_fov, 0);
  EXPECT_FLOAT_EQ(camera.orthographic_height, 4);
  EXPECT_FLOAT_EQ(camera.aspect, 2);
}

}  // namespace
}  // namespace goldthread
