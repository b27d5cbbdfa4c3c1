// Light maps in glTF files: what a viewer reads there is the light that went in, and nothing else changed.
#include "files/gltf_light_map.h"

#include <gtest/gtest.h>

#include "files/gltf_builder.h"
#include "files/image_decode.h"
#include "files/scene_read.h"
#include "files/scene_write.h"
#include "files/written_gltf.h"
#include "math/colour.h"
#include "scene/light_atlas_lookup.h"

namespace goldthread {
namespace {

using nlohmann::json;
using test::expect_valid;
using test::GltfBuilder;
using test::TempFolder;
using test::WrittenGltf;

Scene read(const std::string& file) {
  Result<Scene> scene = read_scene(file);
  if (!scene) throw std::runtime_error(scene.error().line());
  return *std::move(scene);
}

/// Every triangle by itself in the left half of a page of its own number, its back in the right half; the
/// light is a ramp along u, brighter on later pages.
LightAtlas atlas_of(const Scene& scene, uint32_t pages) {
  LightAtlas atlas;
  for (uint32_t p = 0; p < pages; ++p) {
    AtlasPage page{{8, 8, {}}, std::vector<uint8_t>(64, 1)};
    for (uint32_t i = 0; i < 64; ++i) page.irradiance.pixels.push_back(float(p + 1) * vec3(i % 8, 1, 0.5f));
    atlas.pages.push_back(page);
  }
  uint32_t next = 0;
  for (uint32_t n = 0; n < scene.instances.size(); ++n) {
    const Mesh& mesh = scene.meshes[scene.instances[n].mesh];
    for (uint32_t p = 0; p < mesh.primitives.size(); ++p)
      for (const bool back : {false, true}) {
        if (back && !scene.materials[mesh.primitives[p].material].double_sided) continue;
        for (uint32_t t = 0; t < mesh.primitives[p].triangle_count(); ++t) {
          MappedMesh mapped;
          mapped.instance = n;
          mapped.primitive = p;
          mapped.source_mesh = false;
          mapped.back = back;
          mapped.page = next++ % pages;
          mapped.origins = {{t, vec2(0)}, {t, vec2(1, 0)}, {t, vec2(0, 1)}};
          mapped.faces = {UVec3(0, 1, 2)};
          mapped.face_parents = {t};
          const float left = back ? 0.55f : 0.05f;
          mapped.coordinates = {vec2(left, 0.1f), vec2(left + 0.4f, 0.1f), vec2(left, 0.8f)};
          atlas.meshes.push_back(mapped);
        }
      }
  }
  return atlas;
}

std::vector<EncodedPage> encoded(const LightAtlas& atlas) {
  std::vector<EncodedPage> pages;
  for (const AtlasPage& page : atlas.pages) pages.push_back(encode_page(page));
  return pages;
}

Status write(const std::string& file, const Scene& scene, const LightAtlas& atlas) {
  return write_mapped_scene(file, scene, atlas, encoded(atlas));
}

/// The light map's irradiance as a viewer has it: its texture's linear value times the intensity.
FloatImage shown_page(const WrittenGltf& written, const json& material) {
  const json& map = material["extensions"]["MOZ_lightmap"];
  const size_t image = written.json["textures"][map["index"].get<size_t>()]["source"];
  const std::vector<unsigned char>& bytes = written.model.images.at(image).image;
  const Result<Image> decoded = decode_image({bytes.data(), bytes.size()});
  if (!decoded) throw std::runtime_error(decoded.error().line());
  FloatImage page{decoded->width, decoded->height, {}};
  const float intensity = map["intensity"];
  for (size_t i = 0; i < decoded->rgba.size(); i += 4)
    page.pixels.push_back(intensity / 255 *
                          vec3(decoded->rgba[i], decoded->rgba[i + 1], decoded->rgba[i + 2]));
  return page;
}

GltfBuilder one_triangle(bool two_sided) {
  GltfBuilder b;
  json& primitive = b.triangle({{"name", "only"}});
  primitive["material"] = 0;
  b.doc["accessors"][0]["min"] = {0, 0, 0};
  b.doc["accessors"][0]["max"] = {1, 1, 0};
  b.push("materials", {{"name", "paint"}, {"doubleSided", two_sided}, {"extras", {{"tag", 1}}}});
  return b;
}

TEST(GltfLightMap, AViewerReadsTheLightThatWentIn) {
  const TempFolder folder;
  const Scene scene = read(folder.write("in.gltf", one_triangle(false).text()));
  const LightAtlas atlas = atlas_of(scene, 1);
  const std::string out = folder.path("out.glb");
  const Status status = write(out, scene, atlas);
  ASSERT_TRUE(status) << status.error().line();
  expect_valid(out);
  const WrittenGltf written(out);
  const json& primitive = written.primitive(0);
  const json& material = written.json["materials"][primitive["material"].get<size_t>()];
  EXPECT_EQ(material["name"], "paint");
  EXPECT_EQ(material["extras"]["tag"], 1);
  EXPECT_EQ(material["extensions"]["MOZ_lightmap"]["texCoord"], 1);
  const FloatImage page = shown_page(written, material);
  ASSERT_EQ(page.pixels.size(), 64u);
  for (size_t i = 0; i < 64; ++i)
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(page.pixels[i][c], atlas.pages[0].irradiance.pixels[i][c], 7.0f / 255 + 1e-4f);
  const std::vector<float> coordinates = written.attribute("TEXCOORD_1");
  for (size_t v = 0; v < 3; ++v) {
    EXPECT_EQ(coordinates[2 * v], atlas.meshes[0].coordinates[v].x);
    EXPECT_EQ(coordinates[2 * v + 1], atlas.meshes[0].coordinates[v].y);
  }
  // Not known as sRGB: browsers would convert it.
  const auto& png = written.model.images[0].image;
  EXPECT_EQ(std::string(png.begin(), png.end()).find("sRGB"), std::string::npos);
}

TEST(GltfLightMap, BothSidesBecomeTrianglesOfTheirOwn) {
  const TempFolder folder;
  GltfBuilder source = one_triangle(true);
  json& primitive = source.doc["meshes"][0]["primitives"][0];
  primitive["attributes"]["NORMAL"] =
      source.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", test::kFloat);
  primitive["attributes"]["TANGENT"] =
      source.accessor<float>({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, "VEC4", test::kFloat);
  const Scene scene = read(folder.write("in.gltf", source.text()));
  const std::string out = folder.path("out.glb");
  ASSERT_TRUE(write(out, scene, atlas_of(scene, 1)));
  expect_valid(out);
  const WrittenGltf written(out);
  ASSERT_EQ(written.json["meshes"][0]["primitives"].size(), 2u);
  for (size_t side = 0; side < 2; ++side) {
    const json& material = written.json["materials"][written.primitive(0, side)["material"].get<size_t>()];
    EXPECT_FALSE(material.value("doubleSided", false));
    // The winding faces the side that is lit, and so do the normals.
    const std::vector<float> p = written.attribute("POSITION", 0, side),
                             n = written.attribute("NORMAL", 0, side);
    const std::vector<float> i = written.values(written.primitive(0, side)["indices"]);
    const auto corner = [&](size_t k) {
      const auto v = size_t(i[k]);
      return vec3(p[3 * v], p[3 * v + 1], p[3 * v + 2]);
    };
    const vec3 face = cross(corner(1) - corner(0), corner(2) - corner(0));
    EXPECT_GT(face.z * n[2], 0);
    EXPECT_EQ(n[2], side == 0 ? 1 : -1);
    const std::vector<float> tangent = written.attribute("TANGENT", 0, side);
    EXPECT_EQ(tangent[0], side == 0 ? 1 : -1);
    EXPECT_EQ(tangent[3], side == 0 ? 1 : -1);
  }
}

TEST(GltfLightMap, PagesAndInstancesHaveMeshesOfTheirOwnThatShareTheRest) {
  const TempFolder folder;
  GltfBuilder source = one_triangle(false);
  source.push("nodes", {{"mesh", 0}, {"translation", {5, 0, 0}}});
  source.doc["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = read(folder.write("in.gltf", source.text()));
  ASSERT_EQ(scene.instances.size(), 2u);
  const std::string out = folder.path("out.glb");
  ASSERT_TRUE(write(out, scene, atlas_of(scene, 2)));
  expect_valid(out);
  const WrittenGltf written(out);
  const size_t first = written.json["nodes"][0]["mesh"], second = written.json["nodes"][1]["mesh"];
  ASSERT_NE(first, second);
  EXPECT_EQ(written.primitive(first)["attributes"]["POSITION"],
            written.primitive(second)["attributes"]["POSITION"]);
  EXPECT_NE(written.primitive(first)["attributes"]["TEXCOORD_1"],
            written.primitive(second)["attributes"]["TEXCOORD_1"]);
  EXPECT_NE(written.primitive(first)["material"], written.primitive(second)["material"]);
  EXPECT_EQ(written.json["images"].size(), 2u);
}

TEST(GltfLightMap, ASetThatTheAuthorMadeIsKept) {
  const TempFolder folder;
  GltfBuilder source = one_triangle(false);
  json& attributes = source.doc["meshes"][0]["primitives"][0]["attributes"];
  for (const char* name : {"TEXCOORD_0", "TEXCOORD_1"})
    attributes[name] = source.accessor<float>({0, 0, 1, 0, 0, 1}, "VEC2", test::kFloat);
  const Scene scene = read(folder.write("in.gltf", source.text()));
  const std::string out = folder.path("out.glb"), again = folder.path("again.glb");
  ASSERT_TRUE(write(out, scene, atlas_of(scene, 1)));
  expect_valid(out);
  const WrittenGltf written(out);
  EXPECT_EQ(written.attribute("TEXCOORD_1"), (std::vector<float>{0, 0, 1, 0, 0, 1}));
  EXPECT_EQ(written.json["materials"].back()["extensions"]["MOZ_lightmap"]["texCoord"], 2);
  // Baking that once more replaces its map and makes no third set.
  const Scene lit = read(out);
  ASSERT_TRUE(write(again, lit, atlas_of(lit, 1)));
  expect_valid(again);
  const WrittenGltf rewritten(again);
  EXPECT_EQ(rewritten.json["materials"].back()["extensions"]["MOZ_lightmap"]["texCoord"], 2);
  EXPECT_FALSE(rewritten.primitive(0)["attributes"].contains("TEXCOORD_3"));
}

TEST(GltfLightMap, LampsAreOffForViewersAndOnForUs) {
  const TempFolder folder;
  GltfBuilder source = one_triangle(false);
  source.doc["extensionsUsed"] = {"KHR_lights_punctual"};
  source.doc["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"intensity", 40.0}, {"extras", {{"radius", 0.25}}}}, {{"type", "point"}}};
  for (int lamp = 0; lamp < 2; ++lamp)
    source.push("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", lamp}}}}}});
  source.doc["scenes"][0]["nodes"] = {0, 1, 2};
  const Scene scene = read(folder.write("in.gltf", source.text()));
  const std::string out = folder.path("out.glb");
  ASSERT_TRUE(write(out, scene, atlas_of(scene, 1)));
  expect_valid(out);
  for (const json& lamp : WrittenGltf(out).json["extensions"]["KHR_lights_punctual"]["lights"])
    EXPECT_EQ(lamp["intensity"], 0.0);
  const Scene lit = read(out);
  ASSERT_EQ(lit.lights.size(), 2u);
  EXPECT_EQ(lit.lights[0].intensity, vec3(40));
  EXPECT_EQ(lit.lights[0].radius, 0.25f);
  EXPECT_EQ(lit.lights[1].intensity, vec3(1));
}

TEST(GltfLightMap, VariantsKeepTheLight) {
  const TempFolder folder;
  GltfBuilder source = one_triangle(false);
  source.push("materials", {{"name", "other"}});
  source.doc["extensionsUsed"] = {"KHR_materials_variants"};
  source.doc["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "night"}}};
  source.doc["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] = {
      {{"material", 1}, {"variants", {0}}}};
  const Scene scene = read(folder.write("in.gltf", source.text()));
  const std::string out = folder.path("out.glb");
  ASSERT_TRUE(write(out, scene, atlas_of(scene, 1)));
  expect_valid(out);
  const WrittenGltf written(out);
  const json& mapping = written.primitive(0)["extensions"]["KHR_materials_variants"]["mappings"][0];
  const json& material = written.json["materials"][mapping["material"].get<size_t>()];
  EXPECT_EQ(material["name"], "other");
  EXPECT_TRUE(material["extensions"].contains("MOZ_lightmap"));
  // Colours on the page are those of one variant: it is the only one left.
  const LightAtlas atlas = atlas_of(scene, 1);
  const std::vector<BakedPage> pages = {
      encode_baked_page(atlas.pages[0].irradiance, std::vector<float>(64, 1.0f), 1)};
  ASSERT_TRUE(write_baked_scene(out, scene, atlas, pages));
  expect_valid(out);
  EXPECT_FALSE(WrittenGltf(out).primitive(0).contains("extensions"));
}

TEST(GltfLightMap, BakedPagesAreUnlitBaseColours) {
  const TempFolder folder;
  GltfBuilder source = one_triangle(false);
  json& material = source.doc["materials"][0];
  material["emissiveFactor"] = {1, 1, 1};
  material["alphaMode"] = "BLEND";
  material["pbrMetallicRoughness"]["baseColorFactor"] = {1, 0, 0, 0.5};
  const Scene scene = read(folder.write("in.gltf", source.text()));
  const LightAtlas atlas = atlas_of(scene, 1);
  std::vector<float> alpha(64, 0.5f);
  const std::vector<BakedPage> pages = {encode_baked_page(atlas.pages[0].irradiance, alpha, 0.25f)};
  const std::string out = folder.path("out.glb");
  ASSERT_TRUE(write_baked_scene(out, scene, atlas, pages));
  expect_valid(out);
  const WrittenGltf written(out);
  const json& shown = written.json["materials"][written.primitive(0)["material"].get<size_t>()];
  EXPECT_TRUE(shown["extensions"].contains("KHR_materials_unlit"));
  EXPECT_FALSE(shown.contains("emissiveFactor"));
  EXPECT_EQ(shown["alphaMode"], "BLEND");
  EXPECT_EQ(shown["name"], "paint");
  const json& texture = shown["pbrMetallicRoughness"]["baseColorTexture"];
  EXPECT_EQ(texture["texCoord"], 1);
  EXPECT_FALSE(shown["pbrMetallicRoughness"].contains("baseColorFactor"));
  const std::vector<unsigned char>& bytes = written.model.images[0].image;
  const Result<Image> picture = decode_image({bytes.data(), bytes.size()});
  ASSERT_TRUE(picture);
  // Texel 2 of each row has 2 nits in red, half of what is shown; 1 in green, a quarter.
  EXPECT_EQ(picture->rgba[8], 188);
  EXPECT_EQ(picture->rgba[9], 137);
  EXPECT_EQ(picture->rgba[11], 128);
}

TEST(GltfLightMap, OcclusionIsTheLuminanceAndAllElseStays) {
  const TempFolder folder;
  GltfBuilder source = one_triangle(false);
  source.doc["materials"][0]["emissiveFactor"] = {1, 1, 1};
  const Scene scene = read(folder.write("in.gltf", source.text()));
  const LightAtlas atlas = atlas_of(scene, 1);
  const std::vector<EncodedPage> grey = {encode_grey_page(atlas.pages[0])};
  const std::string out = folder.path("out.glb");
  ASSERT_TRUE(write_occluded_scene(out, scene, atlas, grey));
  expect_valid(out);
  const WrittenGltf written(out);
  json shown = written.json["materials"][written.primitive(0)["material"].get<size_t>()];
  const json occlusion = shown["occlusionTexture"];
  EXPECT_EQ(occlusion["texCoord"], 1);
  const double white = occlusion["extras"]["goldthread_lux"];
  shown.erase("occlusionTexture");
  EXPECT_EQ(shown, source.doc["materials"][0]);
  EXPECT_FALSE(written.json.contains("extensionsUsed"));
  const std::vector<unsigned char>& bytes = written.model.images[0].image;
  const Result<Image> picture = decode_image({bytes.data(), bytes.size()});
  ASSERT_TRUE(picture);
  for (size_t texel = 0; texel < 64; ++texel) {
    if (!atlas.pages[0].covered[texel]) continue;
    const double lux = std::min<double>(luminance(atlas.pages[0].irradiance.pixels[texel]), white);
    EXPECT_NEAR(picture->rgba[4 * texel] * white / 255, lux, white / 255);
    EXPECT_EQ(picture->rgba[4 * texel], picture->rgba[4 * texel + 1]);
  }
  // Baked again, the page takes the old one's place and set of coordinates.
  const Scene again = read(out);
  LightAtlas twice = atlas_of(again, 1);
  ASSERT_TRUE(write_occluded_scene(folder.path("again.glb"), again, twice, grey));
  expect_valid(folder.path("again.glb"));
  EXPECT_FALSE(WrittenGltf(folder.path("again.glb")).primitive(0)["attributes"].contains("TEXCOORD_2"));
}

TEST(GltfLightMap, LightOfAnotherKindTakesThePlaceOfTheEarlier) {
  const TempFolder folder;
  const Scene scene = read(folder.write("in.gltf", one_triangle(false).text()));
  const LightAtlas atlas = atlas_of(scene, 1);
  const std::vector<EncodedPage> grey = {encode_grey_page(atlas.pages[0])};
  const auto material_of = [](const std::string& file) {
    const WrittenGltf written(file);
    return json(written.json["materials"][written.primitive(0)["material"].get<size_t>()]);
  };
  const std::string mapped = folder.path("a.glb"), occluded = folder.path("b.glb"),
                    last = folder.path("c.glb");
  ASSERT_TRUE(write(mapped, scene, atlas));
  const Scene second = read(mapped);
  ASSERT_TRUE(write_occluded_scene(occluded, second, atlas_of(second, 1), grey));
  expect_valid(occluded);
  EXPECT_TRUE(material_of(occluded).contains("occlusionTexture"));
  EXPECT_FALSE(material_of(occluded).contains("extensions"));
  const Scene third = read(occluded);
  ASSERT_TRUE(write(last, third, atlas_of(third, 1)));
  expect_valid(last);
  EXPECT_FALSE(material_of(last).contains("occlusionTexture"));
  EXPECT_TRUE(material_of(last)["extensions"].contains("MOZ_lightmap"));
}

TEST(GltfLightMap, AnAtlasThatDoesNotFitIsAnError) {
  const TempFolder folder;
  const Scene scene = read(folder.write("in.gltf", one_triangle(false).text()));
  LightAtlas atlas = atlas_of(scene, 1);
  atlas.meshes[0].origins[1].triangle = 7;
  EXPECT_FALSE(write(folder.path("out.glb"), scene, atlas));
}

TEST(LightAtlasLookup, AnswersAsTheTextureDoes) {
  const TempFolder folder;
  const Scene scene = read(folder.write("in.gltf", one_triangle(true).text()));
  const LightAtlas atlas = atlas_of(scene, 1);
  const LightAtlasLookup lookup(scene, atlas);
  // A ramp along u: texel x has x at (x + 1/2) / 8.
  for (const bool back : {false, true}) {
    const vec2 weights(0.25f, 0.25f);
    const float u = (back ? 0.55f : 0.05f) + 0.25f * 0.4f;
    const std::optional<vec3> light = lookup.irradiance(0, 0, 0, weights, back);
    ASSERT_TRUE(light);
    EXPECT_NEAR(light->x, 8 * u - 0.5f, 1e-4);
    EXPECT_NEAR(light->y, 1, 1e-5);
  }
  EXPECT_FALSE(lookup.irradiance(1, 0, 0, vec2(0.25f), false));
}

}  // namespace
}  // namespace goldthread
