// Real files: light into every model of the shared folder, and the validator's word on the result.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "files/gltf_builder.h"
#include "files/light_samples.h"
#include "files/scene_read.h"
#include "files/scene_write.h"
#include "files/written_gltf.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> shared_models() {
  std::vector<std::string> names;
  std::error_code absent;
  for (const auto& entry : fs::directory_iterator(std::string(GOLDTHREAD_SHARED) + "/scenes", absent))
    if (entry.path().extension() == ".glb") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  if (names.empty()) names.push_back("none");
  return names;
}

class SharedModels : public ::testing::TestWithParam<std::string> {};

TEST_P(SharedModels, TakeLightAndLoseNothing) {
  const std::string file = std::string(GOLDTHREAD_SHARED) + "/scenes/" + GetParam() + ".glb";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not here";
  const test::TempFolder folder;
  const Result<Scene> scene = read_scene(file);
  ASSERT_TRUE(scene) << scene.error().line();
  const std::string plain = folder.path("plain.glb"), refined = folder.path("refined.gltf"),
                    unlit = folder.path("unlit.glb");

  Status status = write_lit_scene(plain, *scene, test::light_all(*scene), {OutputMode::kVertexLight, 1});
  ASSERT_TRUE(status) << status.error().line();
  test::expect_valid(plain);
  nlohmann::json before = test::WrittenGltf(file).json;
  before.erase("buffers");
  for (nlohmann::json& node : before["nodes"]) node.erase("mesh");  // instances lit differently get their own
  test::expect_kept(before, test::WrittenGltf(plain).json);

  const Lighting lighting = test::light_refined(*scene);
  status = write_lit_scene(refined, *scene, lighting, {OutputMode::kVertexLight, 1});
  ASSERT_TRUE(status) << status.error().line();
  test::expect_valid(refined);
  const Result<Scene> again = read_scene(refined);
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_EQ(again->triangle_count(), 2 * scene->triangle_count());
  EXPECT_LT(length(again->bounds().size() - scene->bounds().size()), 1e-4f * scene->bounds().diagonal());

  status = write_lit_scene(unlit, *scene, lighting, {OutputMode::kUnlit, 0.01f});
  ASSERT_TRUE(status) << status.error().line();
  test::expect_valid(unlit);
}

INSTANTIATE_TEST_SUITE_P(Folder, SharedModels, ::testing::ValuesIn(shared_models()), [](const auto& info) {
  std::string name = info.param;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
  return name;
});

}  // namespace
}  // namespace goldthread
