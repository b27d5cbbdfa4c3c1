// A glTF document made from a Scene that came from no glTF file.
#pragma once
#include <vector>

#include "files/gltf_document.h"
#include "scene/scene.h"

namespace goldthread {

/// Which part of a document each part of a Scene is.
struct DocumentMap {
  static constexpr uint32_t kNone = 0xffffffffu;
  std::vector<uint32_t> nodes;   ///< per instance: the node that holds its mesh
  std::vector<uint32_t> copies;  ///< per instance: which of the node's GPU instances it is, else 0
  std::vector<std::vector<uint32_t>>
      primitives;  ///< per mesh and primitive: its number in the file's mesh, or kNone
};

struct BuiltDocument {
  GltfDocument document;
  DocumentMap map;
};

/// Everything glTF can say about the scene: meshes, materials, textures (as PNG), lights, cameras, a node for
/// each instance. Triangles with corners that are not finite are left out, as glTF allows no such numbers.
/// The sky is left out: glTF has no word for it.
BuiltDocument build_document(const Scene& scene);

/// Values as such a document has them: normals of unit length whatever they were, colours in 0..1.
std::vector<vec3> unit_normals(const std::vector<vec3>& normals);
std::vector<vec4> clamp_colours(const std::vector<vec4>& colours);

}  // namespace goldthread
