// Light into a glTF document: new attributes, refined meshes, meshes of their own for instances lit
// differently.
#pragma once
#include <functional>

#include "files/gltf_build.h"
#include "files/gltf_document.h"
#include "files/gltf_elements.h"
#include "files/scene_write.h"
#include "goldthread/error.h"

namespace goldthread {

/// How to get values of the document as it was before light came.
struct SourceReader {
  /// The attribute `name` of a primitive of the file, or of its morph target `target` when that is not
  /// negative. `lit` names the same primitive in Scene's terms.
  std::function<Result<Elements>(const LitPrimitive& lit, uint32_t mesh, uint32_t primitive,
                                 const std::string& name, int target)>
      attribute;
  /// Any accessor of the file that has `count` elements.
  std::function<Result<Elements>(uint32_t accessor, size_t count)> accessor;
};

/// Changes the primitives in `lighting`, and no others. May throw Json::exception on a document whose members
/// have other types than glTF gives them.
Status add_lighting(GltfDocument& document, const DocumentMap& map, const Scene& scene,
                    const Lighting& lighting, const SceneWriteOptions& options, const SourceReader& read);

}  // namespace goldthread
