#include <filesystem>

#include "files/file_name.h"
#include "files/scene_write.h"
#include "goldthread/bake.h"
#include "scene/procedural.h"

namespace goldthread {

Result<uint64_t> make_scene(const MakeOptions& options) {
  const std::string extension = file_extension(options.output);
  if (extension != ".glb" && extension != ".gltf") {
    return Error{ErrorCode::kUsage, "cannot tell the output's format", options.output, "",
                 "end it in .glb or .gltf"};
  }
  const Result<Scene> scene = build_procedural(options.name, options.triangles);
  if (!scene) return scene.error();
  const Status status = write_scene(options.output, *scene);
  if (!status) return status.error();
  return uint64_t{scene->triangle_count()};
}

std::vector<std::pair<std::string, std::string>> scene_names() {
  return procedural_names();
}

}  // namespace goldthread
