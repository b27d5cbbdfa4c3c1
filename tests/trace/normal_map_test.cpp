// Normal textures: which way they bend, and the light that comes of it.
#include "trace/normal_map.h"

#include <array>

#include "trace/texel_receivers.h"
#include "trace/traced.h"

namespace goldthread {
namespace {

using namespace test;

const vec3 kUp(0, 0, 1);
constexpr std::array<uint8_t, 3> kRed{218, 128, 218};    ///< 45 degrees towards the tangent
constexpr std::array<uint8_t, 3> kGreen{127, 218, 218};  ///< 45 degrees towards the bitangent
constexpr std::array<uint8_t, 3> kFlat{128, 127, 255};

/// A floor of the plane z = 0 round the origin, facing up, with a normal texture of one colour; its texture
/// coordinates grow along `u` and `v`.
struct Floor {
  Scene scene;
  Floor(const std::array<uint8_t, 3>& colour, const vec3& u, const vec3& v, float reflectance = 0) {
    Material material = diffuse(reflectance);
    scene.images.push_back({1, 1, {colour[0], colour[1], colour[2], 255}, "normals"});
    material.normal_texture.image = 0;
    Primitive& p = add(scene, square(2, 0, true), std::move(material));
    for (const vec3& q : p.positions) p.texcoords[0].emplace_back(dot(q, u), dot(q, v));
  }
  Primitive& primitive() { return scene.meshes[0].primitives[0]; }
  void give_tangents(const vec4& tangent) {
    primitive().normals.assign(4, kUp);
    primitive().tangents.assign(4, tangent);
  }
};

/// u to the right and v down, as pictures are.
Floor upright(const std::array<uint8_t, 3>& colour, float reflectance = 0) {
  return {colour, {1, 0, 0}, {0, -1, 0}, reflectance};
}

/// The normal measured at a place of the front, and that the texels' is the same.
vec3 normal_at(Scene scene, const vec3& place = vec3(0.3f, -0.2f, 0)) {
  const bool inside = [&] {
    for (const vec2& uv : scene.meshes[0].primitives[0].texcoords[0])
      if (glm::any(glm::lessThan(uv, vec2(0))) || glm::any(glm::greaterThan(uv, vec2(1)))) return false;
    return true;
  }();
  const Traced t(std::move(scene));
  const Receiver r = t.receiver(place, kUp);
  if (!inside) return r.normal;
  for (const Receiver& texel : texel_receivers(*t.traced, {4, 4, {}}).receivers) {
    EXPECT_LT(length(texel.normal - r.normal), 1e-6f);
  }
  return r.normal;
}

void expect_normal(const vec3& normal, const vec3& expected) {
  EXPECT_LT(length(normal - normalize(expected)), 1e-6f)
      << normal.x << " " << normal.y << " " << normal.z << " is not along " << expected.x << " " << expected.y
      << " " << expected.z;
}

TEST(NormalMap, RedLeansToGrowingUAndGreenUpThePicture) {
  expect_normal(normal_at(upright(kRed).scene), {1, 0, 1});
  expect_normal(normal_at(upright(kGreen).scene), {0, 1, 1});
  expect_normal(normal_at(Floor(kRed, {0, 1, 0}, {1, 0, 0}).scene), {0, 1, 1});
  expect_normal(normal_at(Floor(kGreen, {0, 1, 0}, {1, 0, 0}).scene), {-1, 0, 1});
}

TEST(NormalMap, MirroredCoordinatesMirrorIt) {
  expect_normal(normal_at(Floor(kRed, {-1, 0, 0}, {0, -1, 0}).scene), {-1, 0, 1});
  expect_normal(normal_at(Floor(kGreen, {-1, 0, 0}, {0, -1, 0}).scene), {0, 1, 1});
  expect_normal(normal_at(Floor(kGreen, {1, 0, 0}, {0, 1, 0}).scene), {0, -1, 1});
}

TEST(NormalMap, TexelsAreBentAsPlacesAre) {
  Floor floor = upright(kRed);
  for (vec2& uv : floor.primitive().texcoords[0]) uv = uv / 4.0f + 0.5f;
  expect_normal(normal_at(floor.scene), {1, 0, 1});
}

TEST(NormalMap, TheFilesTangentsGoFirst) {
  for (const float w : {1.0f, -1.0f}) {
    Floor red = upright(kRed), green = upright(kGreen);
    red.give_tangents({0, 1, 0, w});
    green.give_tangents({0, 1, 0, w});
    expect_normal(normal_at(red.scene), {0, 1, 1});
    expect_normal(normal_at(green.scene), {-w, 0, 1});
  }
}

TEST(NormalMap, InstancesTurnScaleAndMirrorIt) {
  for (const bool given : {false, true})
    for (const auto& [colour, expected] :
         {std::pair(kRed, vec3(-1, 0, 1)), std::pair(kGreen, vec3(0, 1, 1))}) {
      Floor floor = upright(colour);
      if (given) floor.give_tangents({1, 0, 0, 1});
      floor.scene.instances[0].transform = scale({-3, 2, 1});  // as it is cast is as it is seen
      expect_normal(normal_at(floor.scene), expected);
      floor.scene.instances[0].transform = turn(kPi / 2, kUp);
      expect_normal(normal_at(floor.scene), colour == kRed ? vec3(0, 1, 1) : vec3(-1, 0, 1));
    }
}

TEST(NormalMap, ScaleCountsAlongTheTangents) {
  Floor floor = upright(kRed);
  floor.scene.materials[0].normal_scale = 0.5f;
  expect_normal(normal_at(floor.scene), {0.5f, 0, 1});
  floor.scene.materials[0].normal_scale = -1;
  expect_normal(normal_at(floor.scene), {-1, 0, 1});
}

TEST(NormalMap, BacksAreBentWithTheirFronts) {
  Floor floor = upright(kRed);
  floor.scene.materials[0].double_sided = true;
  for (vec2& uv : floor.primitive().texcoords[0]) uv = uv / 4.0f + 0.5f;
  const Traced t(std::move(floor.scene));
  const Receiver back = t.receiver(vec3(0.3f, -0.2f, 0), -kUp);
  EXPECT_TRUE(back.back);
  expect_normal(back.normal, {-1, 0, -1});
  EXPECT_EQ(back.surface, -kUp);
  const std::vector<Receiver> texels = texel_receivers(*t.traced, {2, 2, {}}).receivers;
  ASSERT_EQ(texels.size(), 8u);
  expect_normal(texels[7].normal, {-1, 0, -1});
  EXPECT_EQ(texels[7].surface, -kUp);
}

TEST(NormalMap, WithoutAFrameItStaysAsItIs) {
  EXPECT_EQ(normal_at(Floor(kRed, vec3(0), vec3(0)).scene), kUp);
  Floor bare = upright(kRed);
  bare.primitive().texcoords[0].clear();
  const Traced t(std::move(bare.scene));
  EXPECT_EQ(t.receiver(vec3(0), kUp).normal, kUp);
}

TEST(NormalMap, RandomAndVertexReceiversAreNotBent) {
  const Traced t(upright(kRed).scene);
  for (const Receiver& r : random_receivers(*t.traced, 20, 1)) EXPECT_EQ(r.normal, kUp);
  for (const Receiver& r : vertex_receivers(*t.traced)) EXPECT_EQ(r.normal, kUp);
}

/// A floor of reflectance 0.7 below a wall, sky and a lamp.
Traced lit_floor(Floor floor) {
  add(floor.scene, parallelogram({1, -2, -1}, {0, 0, 3}, {0, 4, 0}), diffuse(0.5f, 100));
  floor.scene.sky.radiance = vec3(100);
  floor.scene.lights.push_back(lamp(LightKind::kPoint, 100, {-1, 0, 1}));
  return Traced(std::move(floor.scene));
}

TEST(NormalMap, AFlatOneChangesNothingToTheBit) {
  Floor plain = upright(kFlat, 0.7f);
  plain.scene.materials[0].normal_texture.image = -1;
  const Traced flat = lit_floor(upright(kFlat, 0.7f)), none = lit_floor(std::move(plain));
  for (const vec3& given : {kUp, normalize(vec3(0.2f, 0.1f, 1))}) {
    const Receiver a = flat.receiver({0.3f, -0.2f, 0}, given), b = none.receiver({0.3f, -0.2f, 0}, given);
    EXPECT_EQ(a.normal, b.normal);
    EXPECT_EQ(a.origin, b.origin);
    EXPECT_EQ(a.surface, vec3(0));
    const IrradianceValue light = flat.at({0.3f, -0.2f, 0}, given, 1024),
                          same = none.at({0.3f, -0.2f, 0}, given, 1024);
    EXPECT_GT(light.mean.x, 100);
    EXPECT_EQ(light.mean, same.mean);
    EXPECT_EQ(light.standard_error, same.standard_error);
  }
}

TEST(NormalMap, DirectionalLightByTheBentCosine) {
  const vec3 to_light = normalize(vec3(1, 2, 3));
  const auto lux = [&](Floor floor) {
    floor.scene.lights.push_back(lamp(LightKind::kDirectional, 1000, vec3(0), -to_light));
    return Traced(std::move(floor.scene)).at({0.3f, -0.2f, 0}, kUp, 64).mean.x;
  };
  const auto truth = [&](const vec3& normal) { return 1000 * double(dot(normalize(normal), to_light)); };
  EXPECT_NEAR(lux(upright(kRed)), truth({1, 0, 1}), 1e-2);
  EXPECT_NEAR(lux(upright(kGreen)), truth({0, 1, 1}), 1e-2);
  EXPECT_NEAR(lux(Floor(kRed, {-1, 0, 0}, {0, -1, 0})), truth({-1, 0, 1}), 1e-2);
  EXPECT_NEAR(lux(Floor(kGreen, {1, 0, 0}, {0, 1, 0})), truth({0, -1, 1}), 1e-2);
  Floor given = upright(kGreen);
  given.give_tangents({1, 0, 0, -1});
  EXPECT_NEAR(lux(std::move(given)), truth({0, -1, 1}), 1e-2);
}

TEST(NormalMap, LightFromBelowTheSurfaceIsNone) {
  Floor floor = upright(kRed);
  floor.scene.lights.push_back(lamp(LightKind::kDirectional, 1000, vec3(0), normalize(vec3(-1, 0, 0.5f))));
  EXPECT_EQ(Traced(std::move(floor.scene)).at({0.3f, -0.2f, 0}, kUp, 64).mean.x, 0);
}

// Of an even sky a plane leaning by a sees (1 + cos a) / 2; what it sees below is the floor itself, at no
// distance, and brings nothing, however bright the floor is.
TEST(NormalMap, OfAnEvenSkyWhatIsAboveTheSurface) {
  for (const float reflectance : {0.0f, 0.8f}) {
    Floor floor = upright(kRed, reflectance);
    floor.scene.sky.radiance = vec3(100);
    expect_estimates(Traced(std::move(floor.scene)).at({0.3f, -0.2f, 0}, kUp),
                     100 * double(kPi) * (1 + std::sqrt(0.5)) / 2);
  }
}

}  // namespace
}  // namespace goldthread
