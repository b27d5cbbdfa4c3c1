#include "files/solution_file.h"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "files/gltf_builder.h"
#include "scene/small_skies.h"

namespace goldthread {
namespace {

using test::TempFolder;

/// Every member has a value of its own, so that one that is forgotten or swapped shows.
Solution full_solution() {
  Solution s;
  s.report_json = R"({"converged": true})";
  s.scene.file = "rooms/a.glb";
  s.scene.warnings = {"one", "two"};
  s.scene.sky.radiance = vec3(1, 2, 3);
  s.scene.images = {{2, 1, {1, 2, 3, 4, 5, 6, 7, 8}, "wood"}};
  Material material;
  material.name = "m";
  material.base_colour = vec3(0.1f, 0.2f, 0.3f);
  material.alpha = 0.5f;
  material.base_colour_texture = {0, 1, Wrap::kClamp, Wrap::kMirror, vec2(0.1f), vec2(2), 0.7f};
  material.metallic = 0.25f;
  material.emission = vec3(10, 20, std::numeric_limits<float>::infinity());
  material.emission_texture.image = 0;
  material.alpha_mode = AlphaMode::kMask;
  material.alpha_cutoff = 0.3f;
  material.double_sided = true;
  material.unlit = true;
  s.scene.materials = {material};
  Primitive primitive;
  primitive.positions = {vec3(0), vec3(1, 0, 0), vec3(0, 1, 0)};
  primitive.normals.assign(3, vec3(0, 0, 1));
  primitive.texcoords[1].assign(3, vec2(0.5f));
  primitive.colours.assign(3, vec4(0.5f));
  primitive.indices = {0, 1, 2};
  primitive.source_primitive = 4;
  s.scene.meshes = {{"mesh", {primitive}}};
  Instance instance;
  instance.transform[3] = vec4(1, 2, 3, 1);
  instance.source_node = 9;
  instance.name = "node";
  s.scene.instances = {instance};
  s.scene.lights = {
      {"l", LightKind::kSpot, vec3(1, 2, 3), vec3(4), vec3(0, 0, 1), 0.1f, 0.2f, 5, 0.3f, 0.4f}};
  LightProfile profile;
  profile.name = "a.ies";
  profile.polar = {0, 90};
  profile.azimuth = {0, 90, 360};
  profile.candela = {1, 0.5f, 0.25f, 0, 1, 0.5f};
  profile.changes_with_tilt = true;
  s.scene.lights.insert(s.scene.lights.end(), 2, Light());
  s.scene.lights[1].across = vec3(0, 0, 1);
  s.scene.lights[1].profile = s.scene.lights[2].profile = std::make_shared<const LightProfile>(profile);
  s.scene.cameras = {{"c", vec3(1), vec3(0, 1, 0), vec3(0, 0, 1), 0.5f, 2, 1.5f}};
  LitPrimitive lit;
  lit.source_mesh = false;
  lit.origins = {{0, vec2(0)}, {0, vec2(1, 0)}, {0, vec2(0, 1)}, {0, vec2(0.5f)}};
  lit.faces = {UVec3(0, 1, 3), UVec3(0, 3, 2)};
  lit.face_parents = {0, 0};
  lit.irradiance = {vec3(1), vec3(2), vec3(3), vec3(4)};
  lit.irradiance_back = {vec3(5), vec3(6), vec3(7), vec3(8)};
  s.lighting = {3, {lit}};
  MappedMesh mapped;
  mapped.source_mesh = false;
  mapped.back = true;
  mapped.origins = {{0, vec2(0)}, {0, vec2(1, 0)}, {0, vec2(0, 1)}};
  mapped.faces = {UVec3(0, 1, 2)};
  mapped.face_parents = {0};
  mapped.coordinates = {vec2(0.25f), vec2(0.5f, 0.25f), vec2(0.25f, 0.75f)};
  AtlasPage page;
  page.irradiance = {2, 1, {vec3(1), vec3(2)}};
  page.covered = {1, 0};
  LightAtlas& atlas = s.atlas.emplace();
  atlas.meshes.push_back(mapped);
  atlas.pages.push_back(page);
  atlas.texels_per_metre = 12.5f;
  return s;
}

std::string content(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void run_sql(const std::string& file, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
}

TEST(SolutionFile, ComesBackWhole) {
  const TempFolder folder;
  const std::string file = folder.path("a.gold");
  const Solution before = full_solution();
  ASSERT_TRUE(write_solution(file, before));
  const Result<Solution> after = read_solution(file);
  ASSERT_TRUE(after) << after.error().line();
  EXPECT_EQ(after->report_json, before.report_json);
  const Scene& scene = after->scene;
  EXPECT_EQ(scene.file, "rooms/a.glb");
  EXPECT_EQ(scene.warnings, before.scene.warnings);
  EXPECT_EQ(scene.sky.radiance, vec3(1, 2, 3));
  EXPECT_EQ(scene.images[0].rgba, before.scene.images[0].rgba);
  const Material& material = scene.materials[0];
  EXPECT_EQ(material.base_colour_texture.wrap_v, Wrap::kMirror);
  EXPECT_EQ(material.base_colour_texture.rotation, 0.7f);
  EXPECT_EQ(material.emission, before.scene.materials[0].emission);
  EXPECT_EQ(material.alpha_mode, AlphaMode::kMask);
  EXPECT_TRUE(material.double_sided && material.unlit);
  EXPECT_EQ(scene.meshes[0].primitives[0].positions, before.scene.meshes[0].primitives[0].positions);
  EXPECT_EQ(scene.meshes[0].primitives[0].source_primitive, 4u);
  EXPECT_EQ(scene.instances[0].transform, before.scene.instances[0].transform);
  EXPECT_EQ(scene.lights[0].kind, LightKind::kSpot);
  EXPECT_EQ(scene.lights[0].range, 5);
  EXPECT_EQ(scene.lights[0].angular_diameter, 0.3f);
  EXPECT_EQ(scene.lights[0].radius, 0.4f);
  EXPECT_FALSE(scene.lights[0].profile);
  EXPECT_EQ(scene.lights[1].across, vec3(0, 0, 1));
  ASSERT_TRUE(scene.lights[1].profile);
  EXPECT_EQ(scene.lights[1].profile, scene.lights[2].profile);
  EXPECT_EQ(scene.lights[1].profile->name, "a.ies");
  EXPECT_EQ(scene.lights[1].profile->azimuth, (std::vector<float>{0, 90, 360}));
  EXPECT_EQ(scene.lights[1].profile->candela, before.scene.lights[1].profile->candela);
  EXPECT_TRUE(scene.lights[1].profile->changes_with_tilt);
  EXPECT_EQ(scene.cameras[0].aspect, 1.5f);
  EXPECT_EQ(after->lighting.revision, 3u);
  EXPECT_EQ(after->lighting.primitives[0].faces, before.lighting.primitives[0].faces);
  EXPECT_EQ(after->lighting.primitives[0].irradiance_back, before.lighting.primitives[0].irradiance_back);

  ASSERT_TRUE(after->atlas);
  EXPECT_EQ(after->atlas->texels_per_metre, 12.5f);
  EXPECT_EQ(after->atlas->pages[0].irradiance.pixels, before.atlas->pages[0].irradiance.pixels);
  EXPECT_EQ(after->atlas->pages[0].covered, before.atlas->pages[0].covered);
  EXPECT_EQ(after->atlas->meshes[0].coordinates, before.atlas->meshes[0].coordinates);
  EXPECT_TRUE(after->atlas->meshes[0].back && !after->atlas->meshes[0].source_mesh);

  // What is read and written again is the same to the last byte: nothing that has a place is lost.
  ASSERT_TRUE(write_solution(folder.path("b.gold"), *after));
  EXPECT_EQ(content(file), content(folder.path("b.gold")));
}

TEST(SolutionFile, AreaLampsComeBackAndNeedAnArea) {
  const TempFolder folder;
  const std::string file = folder.path("a.gold");
  Solution before = full_solution();
  before.scene.lights[1].kind = LightKind::kRectangle;
  before.scene.lights[1].size = vec2(2, 0.5f);
  before.scene.lights[2].kind = LightKind::kDisc;
  before.scene.lights[2].size = vec2(0.25f);
  ASSERT_TRUE(write_solution(file, before));
  const Result<Solution> after = read_solution(file);
  ASSERT_TRUE(after) << after.error().line();
  EXPECT_EQ(after->scene.lights[1].kind, LightKind::kRectangle);
  EXPECT_EQ(after->scene.lights[1].size, vec2(2, 0.5f));
  EXPECT_EQ(after->scene.lights[2].size, vec2(0.25f));
  ASSERT_TRUE(write_solution(folder.path("b.gold"), *after));
  EXPECT_EQ(content(file), content(folder.path("b.gold")));
  run_sql(file, "DELETE FROM sections WHERE name='lamp_sizes'");
  const Result<Solution> cut = read_solution(file);
  ASSERT_FALSE(cut);
  EXPECT_NE(cut.error().line().find("light 1 is without an area"), std::string::npos) << cut.error().line();
}

TEST(SolutionFile, NormalTexturesComeBackWithTheirTangents) {
  const TempFolder folder;
  const std::string file = folder.path("a.gold");
  Solution before = full_solution();
  before.scene.materials[0].normal_texture = {0, 1, Wrap::kClamp, Wrap::kMirror, vec2(0.1f), vec2(2), 0.7f};
  before.scene.materials[0].normal_scale = 0.5f;
  before.scene.meshes[0].primitives[0].tangents.assign(3, vec4(1, 0, 0, -1));
  ASSERT_TRUE(write_solution(file, before));
  const Result<Solution> after = read_solution(file);
  ASSERT_TRUE(after) << after.error().line();
  EXPECT_EQ(after->scene.materials[0].normal_texture.rotation, 0.7f);
  EXPECT_EQ(after->scene.materials[0].normal_scale, 0.5f);
  EXPECT_EQ(after->scene.meshes[0].primitives[0].tangents, before.scene.meshes[0].primitives[0].tangents);
  ASSERT_TRUE(write_solution(folder.path("b.gold"), *after));
  EXPECT_EQ(content(file), content(folder.path("b.gold")));
  before.scene.materials[0].normal_texture.image = 7;
  ASSERT_TRUE(write_solution(file, before));
  EXPECT_FALSE(read_solution(file));
}

TEST(SolutionFile, LongSectionsComeInParts) {
  const TempFolder folder;
  Solution before = full_solution();
  before.report_json.assign((size_t{64} << 20) + 5, 'x');
  ASSERT_TRUE(write_solution(folder.path("a.gold"), before));
  const Result<Solution> after = read_solution(folder.path("a.gold"));
  ASSERT_TRUE(after) << after.error().line();
  EXPECT_TRUE(after->report_json == before.report_json);
}

TEST(SolutionFile, NamesAWrongVersionChecksumCountAndKind) {
  const TempFolder folder;
  const std::string good = folder.path("good.gold"), bad = folder.path("bad.gold");
  ASSERT_TRUE(write_solution(good, full_solution()));
  const std::pair<const char*, const char*> cases[] = {
      {"PRAGMA user_version=7", "format version 7"},
      {"PRAGMA application_id=1", "not a goldthread solution"},
      {"UPDATE parts SET bytes=zeroblob(length(bytes)) WHERE section='meshes'", "wrong checksum"},
      {"UPDATE sections SET size=size+1 WHERE name='lights'", "states"},
      {"UPDATE sections SET size=1000000000000 WHERE name='lights'", "states"},
      {"DELETE FROM sections WHERE name='images'", "is missing"},
      {"DROP TABLE parts", "is missing"},
  };
  for (const auto& [sql, message] : cases) {
    std::filesystem::copy_file(good, bad, std::filesystem::copy_options::overwrite_existing);
    run_sql(bad, sql);
    const Result<Solution> result = read_solution(bad);
    ASSERT_FALSE(result) << sql;
    EXPECT_EQ(result.error().code, ErrorCode::kBadInput);
    EXPECT_EQ(result.error().file, bad);
    EXPECT_NE(result.error().line().find(message), std::string::npos) << result.error().line();
  }
  EXPECT_FALSE(read_solution(folder.path("absent.gold")));
  EXPECT_FALSE(read_solution(folder.write("text.gold", "not a database at all")));
  EXPECT_FALSE(read_solution(folder.write("empty.gold", "")));
}

TEST(SolutionFile, RefusesContentThatContradictsItself) {
  const TempFolder folder;
  const std::string file = folder.path("a.gold");
  const std::pair<const char*, void (*)(Solution&)> cases[] = {
      {"index", [](Solution& s) { s.scene.meshes[0].primitives[0].indices[1] = 3; }},
      {"material", [](Solution& s) { s.scene.meshes[0].primitives[0].material = 1; }},
      {"mesh", [](Solution& s) { s.scene.instances[0].mesh = 1; }},
      {"pixels", [](Solution& s) { s.scene.images[0].width = 3; }},
      {"texture", [](Solution& s) { s.scene.materials[0].emission_texture.image = 1; }},
      {"kind", [](Solution& s) { s.scene.lights[0].kind = static_cast<LightKind>(9); }},
      {"vertices", [](Solution& s) { s.lighting.primitives[0].irradiance.pop_back(); }},
      {"origin", [](Solution& s) { s.lighting.primitives[0].origins[0].triangle = 1; }},
      {"face", [](Solution& s) { s.lighting.primitives[0].faces[0].y = 4; }},
      {"parents", [](Solution& s) { s.lighting.primitives[0].face_parents.pop_back(); }},
      {"page", [](Solution& s) { s.atlas->meshes[0].page = 1; }},
      {"another number", [](Solution& s) { s.atlas->meshes[0].coordinates.pop_back(); }},
      {"face", [](Solution& s) { s.atlas->meshes[0].faces[0].x = 3; }},
      {"another size", [](Solution& s) { s.atlas->pages[0].covered.pop_back(); }},
  };
  for (const auto& [word, spoil] : cases) {
    Solution solution = full_solution();
    spoil(solution);
    ASSERT_TRUE(write_solution(file, solution));
    const Result<Solution> result = read_solution(file);
    ASSERT_FALSE(result) << word;
    EXPECT_NE(result.error().message.find(word), std::string::npos) << result.error().line();
  }
}

TEST(SolutionFile, SurvivesBitsFlippedAnywhere) {
  const TempFolder folder;
  ASSERT_TRUE(write_solution(folder.path("a.gold"), full_solution()));
  const std::string good = content(folder.path("a.gold"));
  for (size_t at = 0; at < good.size(); at += 97) {
    std::string damaged = good;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x5a);
    const Result<Solution> result = read_solution(folder.write("b.gold", damaged));
    EXPECT_TRUE(result || result.error().code == ErrorCode::kBadInput) << at;
  }
  for (size_t size = 0; size < good.size(); size += 4096)
    EXPECT_FALSE(read_solution(folder.write("b.gold", good.substr(0, size))));
}

TEST(SolutionFile, LeavesTheOldFileWhenItCannotWrite) {
  for (const char* file : {"/proc/a.gold", "/dev/full"}) {
    const Status status = write_solution(file, full_solution());
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, ErrorCode::kCannotWrite);
    EXPECT_EQ(status.error().file, file);
  }
}

TEST(SolutionFile, SkiesComeBack) {
  TempFolder folder;
  const std::string file = folder.path("sky.gold");
  std::vector<std::pair<std::string, Sky>> skies = test::many_skies();
  FloatImage picture = test::even_picture(6, 3, vec3(1, 2, 3));
  picture.pixels[4] = vec3(70, 80, 90);
  skies.emplace_back("picture", test::sky_of(picture, 2, 0.5f));
  const Result<SkyModel> ground = SkyModel::overcast(SkyLevel::zenith_luminance(vec3(7)));
  skies.emplace_back("ground", test::sky_of(ground->with_ground(vec3(0.1f), vec3(50))));
  for (const auto& [name, sky] : skies) {
    SCOPED_TRACE(name);
    Solution solution;
    solution.scene.sky = sky;
    ASSERT_TRUE(write_solution(file, solution));
    const Result<Solution> back = read_solution(file);
    ASSERT_TRUE(back) << back.error().line();
    for (int azimuth = 0; azimuth < 360; azimuth += 25)
      for (int elevation = -80; elevation < 90; elevation += 20)
        EXPECT_EQ(back->scene.sky.radiance_towards(test::towards(elevation, azimuth)),
                  sky.radiance_towards(test::towards(elevation, azimuth)));
  }
}

}  // namespace
}  // namespace goldthread
