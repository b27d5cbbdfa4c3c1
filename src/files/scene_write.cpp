#include "files/scene_write.h"

#include <utility>

#include "files/gltf_build.h"
#include "files/gltf_write.h"

namespace goldthread {

Status write_scene(const std::string& file, const Scene& scene) {
  return write_gltf_document(file, build_document(scene).document);
}

}  // namespace goldthread
