// Whole bakes in a folder of their own, and what they left there.
#pragma once
#include <fstream>
#include <iterator>
#include <set>

#include "files/gltf_builder.h"
#include "files/written_gltf.h"
#include "goldthread/bake.h"

namespace goldthread::test {

inline std::string bytes_of_file(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Names of everything in a folder.
inline std::set<std::string> names_in(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.insert(entry.path().filename());
  return names;
}

/// A procedural scene written to `folder`.
inline std::string made(const TempFolder& folder, const std::string& name, uint64_t triangles = 0) {
  const std::string file = folder.path(name + ".glb");
  const Result<uint64_t> count = make_scene({name, triangles, file});
  if (!count) throw std::runtime_error(count.error().line());
  return file;
}

/// A square floor of metres and a lamp of a square metre above it, as a file to be spoiled. Accessors: 0 and
/// 1 are the floor's positions and indices, 2 and 3 the lamp's.
inline GltfBuilder lit_floor() {
  GltfBuilder b;
  b.push("materials",
         {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorFactor", {0.5, 0.5, 0.5, 1}}}}});
  b.push("materials", {{"pbrMetallicRoughness", {{"metallicFactor", 0}}}, {"emissiveFactor", {1, 1, 1}}});
  const auto square = [&](float y, bool up, int material) {
    const int positions = b.vec3s({-1, y, -1, 1, y, -1, 1, y, 1, -1, y, 1});
    const int indices =
        b.indices(up ? std::vector<uint16_t>{0, 2, 1, 0, 3, 2} : std::vector<uint16_t>{0, 1, 2, 0, 2, 3});
    b.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"material", material}});
  };
  square(0, true, 0);
  square(2, false, 1);
  return b;
}

inline BakeOptions draft(const std::string& input, std::vector<std::string> outputs) {
  BakeOptions options;
  options.input = input;
  options.outputs = std::move(outputs);
  options.quality = Quality::kDraft;
  return options;
}

/// The bake's result; a failure of the test and an empty one if it ended in an error.
inline BakeResult baked(const BakeOptions& options, const BakeListener& listener = {}) {
  Result<BakeResult> result = bake(options, listener);
  if (result) return *std::move(result);
  ADD_FAILURE() << result.error().line();
  return {};
}

}  // namespace goldthread::test
