// Attributes between the corners of a refined mesh.
#include <gtest/gtest.h>

#include "files/gltf_elements.h"

namespace goldthread {
namespace {

TEST(GltfRefine, WhiteBetweenWhitesIsWhite) {
  // Weights that sum to one only nearly; glTF allows no colour above 1.
  const std::vector<vec4> white(3, vec4(1));
  const std::vector<uint32_t> indices{0, 1, 2};
  std::vector<VertexOrigin> origins;
  for (int i = 1; i < 60; ++i)
    for (int j = 1; i + j < 60; ++j) origins.push_back({0, vec2(float(i) / 59, float(j) / 61)});
  const Elements refined = refine_elements(to_elements(white), "COLOR_0", false, indices, origins);
  ASSERT_EQ(refined.count, origins.size());
  for (size_t i = 0; i < refined.count; ++i)
    for (uint32_t c = 0; c < 4; ++c) EXPECT_EQ(refined.value(i, c), 1.0f) << i;
}

TEST(GltfRefine, BlendsByTheWeights) {
  const std::vector<vec4> corners{vec4(0, 0, 0, 1), vec4(1, 0, 0, 1), vec4(0, 1, 0.5f, 1)};
  const std::vector<uint32_t> indices{0, 1, 2};
  const std::vector<VertexOrigin> origins{{0, vec2(0.25f, 0.5f)}, {0, vec2(0, 1)}};
  const Elements refined = refine_elements(to_elements(corners), "COLOR_0", false, indices, origins);
  EXPECT_EQ(refined.value(0, 0), 0.25f);
  EXPECT_EQ(refined.value(0, 1), 0.5f);
  EXPECT_EQ(refined.value(0, 2), 0.25f);
  EXPECT_EQ(refined.value(1, 2), 0.5f);  // a corner, exactly
}

}  // namespace
}  // namespace goldthread
