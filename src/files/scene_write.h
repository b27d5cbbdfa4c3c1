// A lit scene as glTF: the source file with light added, and nothing else changed.
#pragma once
#include <string>
#include <vector>

#include "goldthread/bake.h"
#include "goldthread/error.h"
#include "scene/lighting.h"
#include "scene/scene.h"

namespace goldthread {

struct SceneWriteOptions {
  OutputMode mode = OutputMode::kVertexLight;
  float exposure = 1;  ///< kUnlit: outgoing radiance in nits * exposure becomes COLOR_0, clamped to 0..1
};

/// Writes `scene` with `lighting` to `file` (.glb or .gltf + .bin). When scene.file is glTF, that file is
/// read again and everything in it survives (animations, extras, unknown extensions): only primitives in
/// `lighting` change. Draco and meshopt compressed primitives that change are written uncompressed. An
/// instance whose light differs from another of the same mesh gets a mesh of its own.
Status write_lit_scene(const std::string& file, const Scene& scene, const Lighting& lighting,
                       const SceneWriteOptions& options);

/// Writes a scene that came from no glTF file (procedural, OBJ ...), without light.
Status write_scene(const std::string& file, const Scene& scene);

}  // namespace goldthread
