// Which way the faces of a cube map look, and what becomes of them.
#include "scene/cube_map.h"

#include <gtest/gtest.h>

#include "scene/environment_map.h"
#include "scene/small_skies.h"

namespace goldthread {
namespace {

using test::even_picture;

/// Each face of one luminance, 1 to 6.
CubeMap painted(uint32_t size = 4) {
  CubeMap cube;
  for (size_t i = 0; i < 6; ++i) cube.faces[i] = even_picture(size, size, vec3(float(i + 1)));
  return cube;
}

vec3 seen(const FloatImage& picture, const vec3& direction) {
  return EnvironmentMap::make(picture, 1, 0)->radiance(direction);
}

TEST(CubeMap, FacesLookAlongTheirAxes) {
  const FloatImage picture = equirectangular_of(painted(), {1, 0, 0, 0});
  const vec3 axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (size_t i = 0; i < 6; ++i) EXPECT_EQ(seen(picture, axes[i]).x, float(i + 1)) << i;
}

// As seen from inside, right-handed: of the face ahead (-Z) the right is +X, of that at the right (+X) it is
// +Z; above, -Z is up and what is right is -X.
TEST(CubeMap, CornersOfFacesLieWhereTheyAreSeen) {
  const auto marked = [](size_t face, uint32_t column, uint32_t row) {
    CubeMap cube = painted();
    cube.faces[face].pixels[row * 4 + column] = vec3(100);
    return cube;
  };
  EXPECT_EQ(marked(5, 3, 0).towards({0.8f, 0.8f, -1}).x, 100);
  EXPECT_EQ(marked(4, 3, 0).towards({-0.8f, 0.8f, 1}).x, 100);
  EXPECT_EQ(marked(0, 3, 0).towards({1, 0.8f, 0.8f}).x, 100);
  EXPECT_EQ(marked(1, 3, 3).towards({-1, -0.8f, -0.8f}).x, 100);
  EXPECT_EQ(marked(2, 3, 0).towards({-0.8f, 1, -0.8f}).x, 100);
  EXPECT_EQ(marked(3, 3, 0).towards({-0.8f, -1, 0.8f}).x, 100);
  EXPECT_EQ(marked(5, 3, 0).towards({-0.8f, 0.8f, -1}).x, 6);
}

TEST(CubeMap, NeighbouringFacesMeetWithoutAJump) {
  // Luminance by direction, painted through `towards` backwards: each pixel is what its own middle says.
  CubeMap cube = painted(32);
  const auto wanted = [](const vec3& d) { return vec3(2) + normalize(d); };
  for (int i = 0; i < 400000; ++i) {
    const float z = 1 - 2 * (float(i) + 0.5f) / 400000, r = std::sqrt(1 - z * z), turn = 2.399963f * float(i);
    const vec3 d(r * std::cos(turn), r * std::sin(turn), z);
    const_cast<vec3&>(cube.towards(d)) = wanted(d);
  }
  const FloatImage picture = equirectangular_of(cube, {1, 0, 0, 0});
  for (int i = 0; i < 1000; ++i) {
    const float z = 1 - 2 * (float(i) + 0.5f) / 1000, r = std::sqrt(1 - z * z), turn = 2.399963f * float(i);
    const vec3 d(r * std::cos(turn), r * std::sin(turn), z);
    EXPECT_LT(length(seen(picture, d) - wanted(d)), 0.12f);
  }
}

TEST(CubeMap, RotationTurnsTheSurroundings) {
  const glm::quat quarter = glm::angleAxis(kPi / 2, vec3(0, 1, 0));  // -Z to -X
  const FloatImage picture = equirectangular_of(painted(), quarter);
  EXPECT_EQ(seen(picture, {-1, 0, 0}).x, 6);
  EXPECT_EQ(seen(picture, {0, 1, 0}).x, 3);
  EXPECT_EQ(seen(picture, {0, 0, -1}).x, 1);
}

TEST(CubeMap, WholeOnesAreSquaresOfOneSize) {
  CubeMap cube = painted();
  EXPECT_TRUE(cube.is_whole());
  cube.faces[3] = even_picture(4, 2, vec3(1));
  EXPECT_FALSE(cube.is_whole());
  EXPECT_FALSE(CubeMap().is_whole());
}

}  // namespace
}  // namespace goldthread
