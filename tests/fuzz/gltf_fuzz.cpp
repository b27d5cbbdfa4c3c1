// Anything as a glTF file: reading it ends in a scene whose indices are in range, or in an Error that names
// the file.
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "files/scene_read.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

void check_scene(const goldthread::Scene& scene) {
  for (const goldthread::Instance& instance : scene.instances) require(instance.mesh < scene.meshes.size());
  for (const goldthread::Mesh& mesh : scene.meshes)
    for (const goldthread::Primitive& primitive : mesh.primitives) {
      const size_t vertices = primitive.positions.size();
      require(primitive.material < scene.materials.size());
      require(primitive.indices.size() % 3 == 0);
      for (const uint32_t index : primitive.indices) require(index < vertices);
      for (const size_t size : {primitive.normals.size(), primitive.colours.size(),
                                primitive.texcoords[0].size(), primitive.texcoords[1].size()})
        require(size == 0 || size == vertices);
    }
  for (const goldthread::Material& material : scene.materials)
    for (const auto* texture :
         {&material.base_colour_texture, &material.metallic_texture, &material.emission_texture})
      require(texture->image < int64_t(scene.images.size()));
  for (const goldthread::Image& image : scene.images)
    require(image.rgba.size() == size_t(image.width) * image.height * 4);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::string file =
      (std::filesystem::temp_directory_path() / ("goldthread_fuzz_" + std::to_string(::getpid()) + ".gltf"))
          .string();
  std::FILE* out = std::fopen(file.c_str(), "wb");
  require(out && std::fwrite(data, 1, size, out) == size);
  std::fclose(out);
  const goldthread::Result<goldthread::Scene> scene = goldthread::read_scene(file);
  if (scene)
    check_scene(*scene);
  else
    require(scene.error().file == file && !scene.error().message.empty());
  return 0;
}
