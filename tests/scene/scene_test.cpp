#include "scene/scene.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

namespace goldthread {
namespace {

Scene two_instances() {
  Scene scene;
  Primitive primitive;
  const float inf = std::numeric_limits<float>::infinity();
  primitive.positions = {vec3(0), vec3(1, 0, 0), vec3(0, 1, 0), vec3(inf, 0, 0)};
  primitive.indices = {0, 1, 2};
  scene.materials.resize(1);
  scene.meshes.push_back({"triangle", {primitive, primitive}});
  scene.instances.resize(2);
  scene.instances[1].transform = glm::translate(mat4(1), vec3(5, 0, -1));
  return scene;
}

TEST(Scene, TrianglesCountForEachInstance) {
  EXPECT_EQ(two_instances().triangle_count(), 4u);
  EXPECT_EQ(Scene{}.triangle_count(), 0u);
}

TEST(Scene, BoundsAreOfFiniteVerticesInTheWorld) {
  const Box box = two_instances().bounds();
  EXPECT_EQ(box.low, vec3(0, 0, -1));
  EXPECT_EQ(box.high, vec3(6, 1, 0));
  EXPECT_TRUE(Scene{}.bounds().empty());
}

}  // namespace
}  // namespace goldthread
