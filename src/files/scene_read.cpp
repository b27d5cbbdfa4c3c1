#include "files/scene_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "files/file_name.h"
#include "files/gltf_read.h"
#include "files/gltf_read_container.h"
#include "files/mesh_read.h"
#include "scene/light_check.h"

namespace goldthread {
namespace {

/// A GLB under any name is one.
bool starts_like_glb(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  char magic[4] = {};
  stream.read(magic, sizeof(magic));
  return stream && std::memcmp(magic, "glTF", 4) == 0;
}

Result<Scene> read_any(const std::string& file, NormalTextures normals) {
  std::error_code ignored;
  const auto kind = std::filesystem::status(file, ignored);
  if (!std::filesystem::exists(kind))
    return bad_input(file, "", "cannot open: no such file", "check the path");
  const std::string extension = file_extension(file);
  if (extension == ".gltf" || extension == ".glb") return read_gltf(file, normals);
  if (std::filesystem::is_regular_file(kind) && starts_like_glb(file)) return read_gltf(file, normals);
  for (const char* known : {".obj", ".ply", ".stl", ".fbx", ".dae"})
    if (extension == known) return read_mesh_file(file);
  return bad_input(file, "", fmt::format("the extension \"{}\" is not supported", extension),
                   "use .gltf, .glb, .obj, .ply, .stl, .fbx or .dae");
}

}  // namespace

Result<Scene> read_scene(const std::string& file, NormalTextures normals) {
  Result<Scene> scene = read_any(file, normals);
  if (scene) put_out_absurd_lights(*scene);
  return scene;
}

}  // namespace goldthread
