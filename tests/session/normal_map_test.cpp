// Normal maps from a glTF file to the light at given places.
#include <gtest/gtest.h>

#include "files/png_encode.h"
#include "goldthread/reference.h"
#include "session/baked.h"

namespace goldthread {
namespace {

using test::baked;
using test::draft;
using test::GltfBuilder;
using test::json;
using test::TempFolder;

/// A floor of 2 by 2 m facing up (+y) whose normals lean by 45 degrees to +x, by a picture; sun from there.
GltfBuilder leaning_floor() {
  GltfBuilder b;
  const std::vector<uint8_t> png = encode_png(1, 1, 3, std::vector<uint8_t>{218, 128, 218});
  b.push("images", {{"bufferView", b.view(std::string(png.begin(), png.end()))}, {"mimeType", "image/png"}});
  b.push("textures", {{"source", 0}});
  b.push("materials", {{"pbrMetallicRoughness", {{"metallicFactor", 0}}}, {"normalTexture", {{"index", 0}}}});
  const int texcoords = b.accessor<float>({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", test::kFloat);
  b.mesh({{"attributes",
           {{"POSITION", b.vec3s({-1, 0, -1, 1, 0, -1, 1, 0, 1, -1, 0, 1})}, {"TEXCOORD_0", texcoords}}},
          {"indices", b.indices({0, 2, 1, 0, 3, 2})},
          {"material", 0}});
  b.doc["extensionsUsed"] = {"KHR_lights_punctual"};
  b.doc["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "directional"}, {"intensity", 1000}}};
  const double half =
      45.0 / 2 * double(kPi) / 180;  // a quarter turn down, then up to 45 degrees from above, from +x
  const double s = std::sin(half), c = std::cos(half), r = std::sqrt(0.5);
  // Turned about z by -45 degrees after -z was turned to -y: the light comes from (1, 1, 0).
  b.push("nodes", {{"rotation", {-c * r, s * r, -s * r, c * r}},
                   {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  return b;
}

TEST(NormalMaps, PointsAreBentAndVerticesAreNot) {
  const TempFolder folder;
  const std::string file = folder.write("scene.gltf", leaning_floor().text());
  const std::string places =
      folder.write("places.json", R"([{"point": [0.2, 0, 0.3], "normal": [0, 1, 0]}])");
  const auto lux_of = [&](const std::string& result, size_t i) {
    return double(json::parse(test::bytes_of_file(result)).at("points")[i].at("irradiance")[1]);
  };
  ReferenceOptions options;
  options.input = file;
  options.points_file = places;
  options.samples = 64;
  options.json_file = folder.path("reference.json");
  const Result<ReferenceResult> traced = reference(options);
  ASSERT_TRUE(traced) << traced.error().line();
  EXPECT_NEAR(lux_of(options.json_file, 0), 1000, 0.1);

  // What is gone on from is bent, too, and only once.
  ReferenceOptions more;
  more.input = file;
  more.resume_file = options.json_file;
  more.samples = 128;
  more.json_file = folder.path("more.json");
  const Result<ReferenceResult> resumed = reference(more);
  ASSERT_TRUE(resumed) << resumed.error().line();
  EXPECT_NEAR(lux_of(more.json_file, 0), 1000, 0.1);
  EXPECT_TRUE(json::parse(test::bytes_of_file(more.json_file))["points"][0].contains("surface"));

  ReferenceOptions vertices;
  vertices.input = file;
  vertices.vertices = true;
  vertices.samples = 64;
  vertices.json_file = folder.path("vertices.json");
  ASSERT_TRUE(reference(vertices));
  EXPECT_NEAR(lux_of(vertices.json_file, 0), 1000 * std::sqrt(0.5), 0.1);

  BakeOptions bake_options = draft(file, {folder.path("lit.gltf")});
  bake_options.points_file = places;
  bake_options.json_file = folder.path("bake.json");
  baked(bake_options);
  EXPECT_NEAR(lux_of(bake_options.json_file, 0), 1000, 0.1);
}

}  // namespace
}  // namespace goldthread
