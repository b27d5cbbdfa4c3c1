// Known answers: materials and the pictures they use.
#include <gmock/gmock.h>

#include "files/gltf_builder.h"
#include "files/png_encode.h"
#include "files/scene_read.h"

namespace goldthread {
namespace {

using namespace test;
using ::testing::Contains;
using ::testing::HasSubstr;

Scene read_built(const GltfBuilder& builder, NormalTextures normals = NormalTextures::kLeftOut) {
  TempFolder folder;
  Result<Scene> scene = read_scene(folder.write("scene.gltf", builder.text()), normals);
  EXPECT_TRUE(scene) << scene.error().line();
  return scene ? *std::move(scene) : Scene{};
}

std::string red_png() {
  const std::vector<uint8_t> pixels = {255, 0, 0, 255, 0, 0};
  const std::vector<uint8_t> png = encode_png(2, 1, 3, pixels);
  return std::string(png.begin(), png.end());
}

/// One triangle of one material, and a red picture as texture 0 from a bufferView.
GltfBuilder with_material(json material) {
  GltfBuilder b;
  b.triangle()["material"] = 0;
  b.push("materials", std::move(material));
  b.push("images", {{"bufferView", b.view(red_png())}, {"mimeType", "image/png"}, {"name", "red"}});
  b.push("textures", {{"source", 0}});
  return b;
}

TEST(GltfMaterials, DefaultsOfTheFormat) {
  const Material m = read_built(with_material(json::object())).materials.at(0);
  EXPECT_EQ(m.base_colour, vec3(1));
  EXPECT_EQ(m.metallic, 1);
  EXPECT_EQ(m.alpha_mode, AlphaMode::kOpaque);
  EXPECT_FALSE(m.double_sided || m.unlit || m.emits() || m.base_colour_texture.present());
}

json glass(json members) {
  return {{"extensions", {{"KHR_materials_transmission", std::move(members)}}}};
}

TEST(GltfMaterials, TransmissionIsItsFactorAndTexture) {
  const Scene scene = read_built(
      with_material(glass({{"transmissionFactor", 0.75}, {"transmissionTexture", {{"index", 0}}}})));
  EXPECT_EQ(scene.materials[0].transmission, 0.75f);
  EXPECT_EQ(scene.materials[0].transmission_texture.image, 0);
  EXPECT_FALSE(scene.materials[0].is_glass());  // metallicFactor is missing, and that means metal
  const Scene none = read_built(with_material(glass(json::object())));
  EXPECT_EQ(none.materials[0].transmission, 0);
}

TEST(GltfMaterials, TransmissionOutOfRangeIsClampedAndNamed) {
  for (const auto& [given, kept] : {std::pair(1.5, 1.0f), std::pair(-0.5, 0.0f)}) {
    const Scene scene = read_built(with_material(glass({{"transmissionFactor", given}})));
    EXPECT_EQ(scene.materials[0].transmission, kept);
    EXPECT_THAT(scene.warnings, Contains(HasSubstr("material 0: transmissionFactor is")));
  }
}

TEST(GltfMaterials, TransmissionTextureMustExist) {
  TempFolder folder;
  const GltfBuilder b =
      with_material(glass({{"transmissionFactor", 1}, {"transmissionTexture", {{"index", 7}}}}));
  const Result<Scene> scene = read_scene(folder.write("scene.gltf", b.text()));
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().line(), HasSubstr("there is no texture 7"));
}

TEST(GltfMaterials, VolumesTakeHalfTheirLightAtEachSurface) {
  json material = glass({{"transmissionFactor", 1}});
  json& volume = material["extensions"]["KHR_materials_volume"];
  volume = {{"thicknessFactor", 0.5}, {"attenuationDistance", 0.25}, {"attenuationColor", {0.25, 1, 0}}};
  const vec3 tint = read_built(with_material(material)).materials[0].volume_tint;
  EXPECT_FLOAT_EQ(tint.x * tint.x, 0.0625f);  // 0.25 to the power of two distances
  EXPECT_EQ(vec2(tint.y, tint.z), vec2(1, 0));
  volume["thicknessFactor"] = 0;  // thin
  EXPECT_EQ(read_built(with_material(material)).materials[0].volume_tint, vec3(1));
}

TEST(GltfMaterials, DiffuseTransmissionHasAColourOfItsOwn) {
  const json extension = {{"diffuseTransmissionFactor", 0.25},
                          {"diffuseTransmissionTexture", {{"index", 0}}},
                          {"diffuseTransmissionColorFactor", {0.5, 2, -1}},
                          {"diffuseTransmissionColorTexture", {{"index", 0}, {"texCoord", 1}}}};
  const Scene scene =
      read_built(with_material({{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                                {"extensions", {{"KHR_materials_diffuse_transmission", extension}}}}));
  const Material& m = scene.materials[0];
  EXPECT_TRUE(m.is_translucent() && m.lit_behind() && !m.double_sided);
  EXPECT_EQ(m.diffuse_transmission, 0.25f);
  EXPECT_EQ(m.diffuse_transmission_texture.image, 0);
  EXPECT_EQ(m.diffuse_transmission_colour, vec3(0.5f, 1, 0));
  EXPECT_EQ(m.diffuse_transmission_colour_texture.texcoord, 1);
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("diffuseTransmissionColorFactor is not within 0 to 1")));
}

TEST(GltfMaterials, FactorsAndFlags) {
  const Material m =
      read_built(with_material({{"name", "paint"},
                                {"pbrMetallicRoughness",
                                 {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.5}}},
                                {"alphaMode", "MASK"},
                                {"alphaCutoff", 0.25},
                                {"doubleSided", true},
                                {"emissiveFactor", {1, 0.5, 0}},
                                {"extensions",
                                 {{"KHR_materials_emissive_strength", {{"emissiveStrength", 100}}},
                                  {"KHR_materials_unlit", json::object()}}}}))
          .materials.at(0);
  EXPECT_EQ(m.name, "paint");
  EXPECT_EQ(m.base_colour, vec3(0.1f, 0.2f, 0.3f));
  EXPECT_FLOAT_EQ(m.alpha, 0.4f);
  EXPECT_FLOAT_EQ(m.metallic, 0.5f);
  EXPECT_EQ(m.alpha_mode, AlphaMode::kMask);
  EXPECT_FLOAT_EQ(m.alpha_cutoff, 0.25f);
  EXPECT_TRUE(m.double_sided);
  EXPECT_TRUE(m.unlit);
  EXPECT_EQ(m.emission, vec3(100, 50, 0));
}

TEST(GltfMaterials, TexturesShareAPictureAndKeepTheirPlacement) {
  GltfBuilder b = with_material(
      {{"pbrMetallicRoughness",
        {{"baseColorTexture",
          {{"index", 0},
           {"texCoord", 0},
           {"extensions",
            {{"KHR_texture_transform",
              {{"offset", {0.5, 0.25}}, {"rotation", 1.5}, {"scale", {2, 3}}, {"texCoord", 1}}}}}}},
         {"metallicRoughnessTexture", {{"index", 1}}}}},
       {"emissiveFactor", {1, 1, 1}},
       {"emissiveTexture", {{"index", 0}}}});
  b.push("samplers", {{"wrapS", 33071}, {"wrapT", 33648}});
  b.push("textures", {{"source", 0}, {"sampler", 0}});
  const Scene scene = read_built(b);
  ASSERT_EQ(scene.images.size(), 1u);
  EXPECT_EQ(scene.images[0].name, "red");
  EXPECT_EQ(scene.images[0].width, 2u);
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.base_colour_texture.texcoord, 1);
  EXPECT_EQ(m.base_colour_texture.offset, vec2(0.5f, 0.25f));
  EXPECT_EQ(m.base_colour_texture.scale, vec2(2, 3));
  EXPECT_FLOAT_EQ(m.base_colour_texture.rotation, 1.5f);
  EXPECT_EQ(m.base_colour_texture.wrap_u, Wrap::kRepeat);
  EXPECT_EQ(m.metallic_texture.image, 0);
  EXPECT_EQ(m.metallic_texture.wrap_u, Wrap::kClamp);
  EXPECT_EQ(m.metallic_texture.wrap_v, Wrap::kMirror);
  EXPECT_EQ(m.emission_texture.image, 0);
}

TEST(GltfMaterials, SpecularGlossinessGivesItsDiffuse) {
  const Material m =
      read_built(with_material(
                     {{"extensions",
                       {{"KHR_materials_pbrSpecularGlossiness",
                         {{"diffuseFactor", {0.5, 0.25, 0.125, 1}}, {"diffuseTexture", {{"index", 0}}}}}}}}))
          .materials.at(0);
  EXPECT_EQ(m.base_colour, vec3(0.5f, 0.25f, 0.125f));
  EXPECT_EQ(m.metallic, 0);
  EXPECT_EQ(m.base_colour_texture.image, 0);
}

const json kTextured = {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}};

TEST(GltfMaterials, PicturesFromDataUrisAndFiles) {
  GltfBuilder b = with_material(kTextured);
  b.doc["images"] = {{{"uri", "data:image/png;base64," + base64(red_png())}}};
  EXPECT_EQ(read_built(b).materials[0].base_colour_texture.image, 0);
  b.doc["images"] = {{{"uri", "my%20red.png"}}};
  TempFolder folder;
  folder.write("my red.png", red_png());
  const Result<Scene> scene = read_scene(folder.write("scene.gltf", b.text()));
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->materials[0].base_colour_texture.image, 0);
  EXPECT_TRUE(scene->warnings.empty());
}

TEST(GltfMaterials, MissingAndBrokenPicturesAreWarnings) {
  GltfBuilder b = with_material(kTextured);
  b.doc["images"] = {{{"uri", "gone.png"}}};
  Scene scene = read_built(b);
  EXPECT_FALSE(scene.materials[0].base_colour_texture.present());
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("gone.png")));
  b.doc["images"] = {{{"uri", "data:image/png;base64," + base64(red_png().substr(0, 50))}}};
  scene = read_built(b);
  EXPECT_FALSE(scene.materials[0].base_colour_texture.present());
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("image 0")));
}

TEST(GltfMaterials, PicturesThatNothingDiffuseUsesAreNotLookedAt) {
  GltfBuilder b = with_material({{"normalTexture", {{"index", 0}}}, {"emissiveTexture", {{"index", 0}}}});
  b.doc["images"] = {{{"uri", "gone.png"}}};
  const Scene scene = read_built(b);
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_TRUE(scene.images.empty());
}

TEST(GltfMaterials, BasisUniversalIsAWarning) {
  GltfBuilder b = with_material(kTextured);
  b.doc["extensionsRequired"] = {"KHR_texture_basisu"};
  b.doc["images"] = {{{"uri", "data:image/ktx2;base64," + base64("\xABKTX 20\xBB\r\n\x1A\n")}}};
  b.doc["textures"] = {{{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}}};
  const Scene scene = read_built(b);
  EXPECT_FALSE(scene.materials[0].base_colour_texture.present());
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("KTX2")));
}

TEST(GltfMaterials, WebpSourceComesFirstAndFallsBack) {
  GltfBuilder b = with_material(kTextured);
  b.push("images", {{"uri", "broken.webp"}});
  b.doc["textures"] = {{{"source", 0}, {"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}}};
  const Scene scene = read_built(b);
  EXPECT_EQ(scene.materials[0].base_colour_texture.image, 0);
  EXPECT_EQ(scene.images[0].name, "red");
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("broken.webp")));
}

TEST(GltfMaterials, NormalTexturesComeWithScaleAndTangents) {
  GltfBuilder b = with_material({{"normalTexture", {{"index", 0}, {"scale", 0.5}, {"texCoord", 1}}}});
  json& primitive = b.doc["meshes"][0]["primitives"][0];
  primitive["attributes"]["NORMAL"] = b.vec3s({0, 0, 1, 0, 0, 1, 0, 0, 1});
  primitive["attributes"]["TANGENT"] =
      b.accessor<float>({2, 0, 0, 1, 1, 0, 0, 1, 0, 3, 0, -1}, "VEC4", kFloat);
  Scene scene = read_built(b, NormalTextures::kRead);
  EXPECT_EQ(scene.materials[0].normal_texture.image, 0);
  EXPECT_EQ(scene.materials[0].normal_texture.texcoord, 1);
  EXPECT_EQ(scene.materials[0].normal_scale, 0.5f);
  EXPECT_EQ(scene.meshes[0].primitives[0].tangents,
            (std::vector<vec4>{{1, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0, -1}}));
  // Who does not ask gets none, and no tangents without a texture.
  EXPECT_FALSE(read_built(b).materials[0].normal_texture.present());
  EXPECT_TRUE(read_built(b).meshes[0].primitives[0].tangents.empty());
  EXPECT_TRUE(read_built(b).images.empty());
  b.doc["materials"][0].erase("normalTexture");
  EXPECT_TRUE(read_built(b, NormalTextures::kRead).meshes[0].primitives[0].tangents.empty());
  // What has no direction is named, and all are taken from elsewhere.
  b.doc["materials"][0]["normalTexture"] = {{"index", 0}};
  b.doc["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] =
      b.accessor<float>({0, 0, 0, 1, 1, 0, 0, 1, 0, 3, 0, -1}, "VEC4", kFloat);
  scene = read_built(b, NormalTextures::kRead);
  EXPECT_TRUE(scene.meshes[0].primitives[0].tangents.empty());
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("1 of 3 tangents have no direction")));
}

}  // namespace
}  // namespace goldthread
