// Looking at glTF files that were written: their JSON, their accessors, and Khronos' opinion of them.
#pragma once
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "files/gltf_elements.h"
#include "files/gltf_load.h"
#include "files/gltf_read_container.h"

namespace goldthread::test {

struct WrittenGltf {
  nlohmann::json json;
  tinygltf::Model model;

  explicit WrittenGltf(const std::string& file) {
    const Result<Bytes> bytes = read_file_bytes(file);
    if (!bytes) throw std::runtime_error(bytes.error().line());
    const Result<GltfChunks> chunks = split_gltf(*bytes, file);
    if (!chunks) throw std::runtime_error(chunks.error().line());
    json = nlohmann::json::parse(chunks->json);
    Result<tinygltf::Model> loaded = load_gltf_model(file);
    if (!loaded) throw std::runtime_error(loaded.error().line());
    model = *std::move(loaded);
  }

  const nlohmann::json& primitive(size_t mesh, size_t index = 0) const {
    return json["meshes"][mesh]["primitives"][index];
  }

  /// All components of an accessor, one element after the other.
  std::vector<float> values(int accessor) const {
    const size_t count = model.accessors.at(static_cast<size_t>(accessor)).count;
    const Result<Elements> elements = read_elements(model, accessor, count, "");
    if (!elements) throw std::runtime_error(elements.error().line());
    std::vector<float> result;
    for (size_t i = 0; i < count; ++i)
      for (uint32_t c = 0; c < elements->components(); ++c) result.push_back(elements->value(i, c));
    return result;
  }
  std::vector<float> attribute(const char* name, size_t mesh = 0, size_t index = 0) const {
    return values(primitive(mesh, index)["attributes"].at(name));
  }
};

/// Everything that `before` says, `after` says too, in the same words; arrays may only have grown.
inline void expect_kept(const nlohmann::json& before, const nlohmann::json& after,
                        const std::string& path = "") {
  ASSERT_EQ(before.type(), after.type()) << path;
  if (before.is_object()) {
    for (const auto& [key, value] : before.items()) {
      ASSERT_TRUE(after.contains(key)) << path << "/" << key;
      expect_kept(value, after[key], path + "/" + key);
    }
  } else if (before.is_array()) {
    ASSERT_LE(before.size(), after.size()) << path;
    for (size_t i = 0; i < before.size(); ++i)
      expect_kept(before[i], after[i], path + "/" + std::to_string(i));
  } else {
    EXPECT_EQ(before, after) << path;
  }
}

/// Runs Khronos' validator, where it is installed (`npm ci` in tools/).
inline void expect_valid(const std::string& file) {
  const auto tools = std::filesystem::path(__FILE__).parent_path().parent_path().parent_path() / "tools";
  static const bool here = std::filesystem::exists(tools / "node_modules/gltf-validator") &&
                           std::system("node --version > /dev/null 2>&1") == 0;
  if (!here) {
    std::printf("not validated, as node or tools/node_modules is missing: %s\n", file.c_str());
    return;
  }
  const std::string command = "node '" + (tools / "validate_gltf.mjs").string() + "' '" + file + "'";
  EXPECT_EQ(std::system(command.c_str()), 0) << file;
}

}  // namespace goldthread::test
