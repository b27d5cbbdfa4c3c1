#include "trace/texel_receivers.h"

#include "scene/procedural.h"
#include "trace/traced.h"

namespace goldthread {
namespace {

using namespace test;

/// `square` with u along x and v along y, from 0 to 1.
Primitive& add_laid_out(Scene& scene, float half, float height, Material material) {
  Primitive& p = add(scene, square(half, height, true), std::move(material));
  for (const vec3& q : p.positions) p.texcoords[0].push_back(vec2(q) / (2 * half) + 0.5f);
  return p;
}

TexelLayout layout_of(uint32_t width, uint32_t height) {
  return {width, height, {}};
}

TEST(TexelReceivers, StandWhereTheirTexelsAre) {
  Scene scene;
  add_laid_out(scene, 1, 0.5f, diffuse(0.5f));
  scene.instances.push_back({0, move(vec3(10, 0, 0)), 0, {}});
  const Traced t(std::move(scene));
  const TexelReceivers texels = texel_receivers(*t.traced, layout_of(8, 4));
  ASSERT_EQ(texels.receivers.size(), 64u);
  for (size_t i = 0; i < 64; ++i) {
    const Receiver& r = texels.receivers[i];
    EXPECT_EQ(r.instance, i / 32);
    EXPECT_EQ(r.texel_x, i % 8);
    EXPECT_EQ(r.texel_y, i / 8 % 4);
    const vec3 place(-1 + (float(r.texel_x) + 0.5f) / 4 + 10 * float(r.instance),
                     -1 + (float(r.texel_y) + 0.5f) / 2, 0.5f);
    EXPECT_LT(length(r.point - place), 1e-5f);
    EXPECT_EQ(r.normal, vec3(0, 0, 1));
    EXPECT_NEAR(r.origin.z - r.point.z, t.traced->epsilon(), 1e-6f);
    EXPECT_LT(length(t.traced->point(r.triangle, r.weights) - r.point), 1e-6f);
  }
  EXPECT_EQ(texels.problems.parts, 2u);
}

TEST(TexelReceivers, NormalsAreTheFilesBetweenItsVertices) {
  Scene scene;
  Primitive& p = add_laid_out(scene, 1, 0, diffuse(0.5f));
  p.normals = {normalize(vec3(-1, 0, 1)), normalize(vec3(1, 0, 1)), normalize(vec3(1, 0, 1)),
               normalize(vec3(-1, 0, 1))};
  scene.materials.back().double_sided = true;
  scene.instances[0].transform[0][0] = -2;  // mirrored and twice as wide: normals lean half as much
  const Traced t(std::move(scene));
  const TexelReceivers texels = texel_receivers(*t.traced, layout_of(4, 1));
  ASSERT_EQ(texels.receivers.size(), 8u);
  for (size_t i = 0; i < 8; ++i) {
    const Receiver& r = texels.receivers[i];
    EXPECT_EQ(r.back, i >= 4);
    const float side = r.back ? -1.0f : 1.0f, across = r.point.x / 2;  // -1..1
    // A share of the way between two unit vectors, then unit.
    const vec3 expected = side * normalize(vec3(across, 0, 2));
    EXPECT_LT(length(r.normal - expected), 1e-6f);
    EXPECT_GT((r.origin.z - r.point.z) * side, 0);
  }
  // They are the vertices' where those are.
  const std::vector<Receiver> vertices = vertex_receivers(*t.traced);
  EXPECT_LT(length(vertices[0].normal - normalize(vec3(vertices[0].point.x / 2, 0, 2))), 1e-6f);
}

TEST(TexelReceivers, WhatHasNoTexelsIsCounted) {
  Scene scene;
  add_laid_out(scene, 1, 0, diffuse(0.5f));
  add(scene, square(1, 1, true), diffuse(0.5f));  // no coordinates
  Primitive& overlapping = add_laid_out(scene, 1, 2, diffuse(0.5f));
  overlapping.texcoords[0] = {vec2(0), vec2(1, 0), vec2(1), vec2(1, 0.001f)};  // the second lies on the first
  Primitive& beyond = add_laid_out(scene, 1, 3, diffuse(0.5f));
  for (vec2& uv : beyond.texcoords[0]) uv += 2.0f;
  Primitive& collapsed = add_laid_out(scene, 1, 4, diffuse(0.5f));
  collapsed.texcoords[0].assign(4, vec2(0.5f));
  add_laid_out(scene, 1, 5, diffuse(0.5f));
  scene.materials.back().unlit = true;
  const Traced t(std::move(scene));
  const TexelReceivers texels = texel_receivers(*t.traced, layout_of(16, 16));
  const TexelProblems& problems = texels.problems;
  EXPECT_EQ(problems.parts, 5u);
  EXPECT_EQ(problems.without_uv, 1u);
  EXPECT_EQ(problems.without_texel, 2u);
  EXPECT_EQ(problems.overlapping, 1u);
  EXPECT_EQ(problems.outside, 2u);
  EXPECT_EQ(problems.without_uv_area, 2u);
  for (const Receiver& r : texels.receivers) EXPECT_TRUE(r.instance == 0 || r.instance == 2);
}

TEST(TexelReceivers, TheSecondCoordinatesComeFirst) {
  Scene scene;
  Primitive& both = add_laid_out(scene, 1, 0, diffuse(0.5f));
  for (const vec2& uv : both.texcoords[0]) both.texcoords[1].push_back(0.5f * uv);
  add_laid_out(scene, 1, 1, diffuse(0.5f));
  const Traced t(std::move(scene));
  EXPECT_EQ(texel_receivers(*t.traced, layout_of(8, 8)).receivers.size(), 16u + 64u);
  EXPECT_EQ(texel_receivers(*t.traced, {8, 8, 0u}).receivers.size(), 128u);
  const TexelReceivers second = texel_receivers(*t.traced, {8, 8, 1u});
  EXPECT_EQ(second.receivers.size(), 16u);
  EXPECT_EQ(second.problems.without_uv, 1u);
}

TEST(TexelReceivers, HolesOfMasksHaveNone) {
  Scene scene;
  Primitive& p = add_laid_out(scene, 1, 0, diffuse(0.5f));
  p.colours = {vec4(1, 1, 1, 0), vec4(1), vec4(1), vec4(1, 1, 1, 0)};  // alpha is u
  scene.materials.back().alpha_mode = AlphaMode::kMask;
  scene.materials.back().alpha_cutoff = 0.5f;
  const Traced t(std::move(scene));
  const TexelReceivers texels = texel_receivers(*t.traced, layout_of(8, 8));
  EXPECT_EQ(texels.receivers.size(), 32u);
  for (const Receiver& r : texels.receivers) EXPECT_GE(r.texel_x, 4u);
}

TEST(TexelReceivers, UnderAnEvenSkyAllReceivePiTimesItsLuminance) {
  Scene scene;
  add_laid_out(scene, 1, 0, diffuse(0.5f));
  scene.sky.radiance = vec3(100, 50, 25);
  const Traced t(std::move(scene));
  const TexelReceivers texels = texel_receivers(*t.traced, layout_of(6, 5));
  ASSERT_EQ(texels.receivers.size(), 30u);
  for (const IrradianceSums& sums : t.sums(texels.receivers, 256)) {
    const IrradianceValue value = evaluate(sums);
    for (int k = 0; k < 3; ++k) {
      const double truth = double(kPi) * double(t.scene->sky.radiance[k]);
      EXPECT_NEAR(value.mean[k], truth, 4 * value.standard_error[k] + 1e-5 * truth);
      EXPECT_LT(value.standard_error[k], 0.05 * truth);
    }
  }
}

/// The box with each triangle in a cell of its own.
Scene unwrapped_cornell_box() {
  Scene scene = *build_procedural("cornell-box", 0);
  for (Mesh& mesh : scene.meshes)
    for (Primitive& p : mesh.primitives) {
      Primitive apart = p;
      apart.positions.clear();
      apart.normals.clear();
      apart.indices.clear();
      const auto cells = uint32_t(std::ceil(std::sqrt(double(p.triangle_count()))));
      for (uint32_t i = 0; i < p.indices.size(); ++i) {
        apart.positions.push_back(p.positions[p.indices[i]]);
        if (!p.normals.empty()) apart.normals.push_back(p.normals[p.indices[i]]);
        const vec2 cell(i / 3 % cells, i / 3 / cells), corner(i % 3 == 1, i % 3 == 2);
        apart.texcoords[1].push_back((cell + 0.02f + 0.9f * corner) / float(cells));
        apart.indices.push_back(i);
      }
      p = std::move(apart);
    }
  return scene;
}

// With the same seed and in the same order texels and given points take the same paths; where rounding of a
// place sends one another way, both still are estimates of the same.
TEST(TexelReceivers, AgreeWithGivenPointsInTheCornellBox) {
  const Traced t(unwrapped_cornell_box());
  const std::vector<Receiver> texels = texel_receivers(*t.traced, layout_of(16, 16)).receivers;
  ASSERT_GT(texels.size(), 200u);
  std::vector<Receiver> points;
  for (const Receiver& r : texels) points.push_back(t.receiver(r.point, r.normal));
  const std::vector<IrradianceSums> of_texels = t.sums(texels, 256, 3), of_points = t.sums(points, 256, 3);
  size_t same = 0, lit = 0;
  for (size_t i = 0; i < texels.size(); ++i) {
    const IrradianceValue a = evaluate(of_texels[i]), b = evaluate(of_points[i]);
    const double error = std::hypot(a.standard_error.y, b.standard_error.y);
    EXPECT_NEAR(a.mean.y, b.mean.y, 5 * error + 1e-6);
    same += std::abs(a.mean.y - b.mean.y) <= 0.05 * a.standard_error.y + 1e-9;
    lit += a.mean.y > 1;
  }
  EXPECT_GT(double(same), 0.95 * double(texels.size()));
  EXPECT_GT(lit, texels.size() / 2);
}

}  // namespace
}  // namespace goldthread
