// Geometry of a glTF primitive as it becomes where light needs other vertices than the file has.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "files/gltf_document.h"
#include "files/gltf_elements.h"
#include "goldthread/error.h"
#include "scene/lighting.h"
#include "scene/scene.h"

namespace goldthread {

/// How to get values of the document as it was before light came.
struct SourceReader {
  /// The attribute `name` of a primitive of the file, or of its morph target `target` when that is not
  /// negative. `lit` names the same primitive in Scene's terms.
  std::function<Result<Elements>(const LitMesh& lit, uint32_t mesh, uint32_t primitive,
                                 const std::string& name, int target)>
      attribute;
  /// Any accessor of the file that has `count` elements.
  std::function<Result<Elements>(uint32_t accessor, size_t count)> accessor;
};

/// Which side of its triangles a primitive shows.
enum class Facing { kFront, kBack };

/// Writes primitives' attributes and indices anew where the mesh is another or is compressed; otherwise the
/// file's own accessors stay. What has the same vertices shares them. Borrows all that it is given.
class GeometryWriter {
 public:
  GeometryWriter(GltfDocument& document, const Scene& scene, const SourceReader& read)
      : document_(document), scene_(scene), read_(read) {}

  /// `primitive` is the JSON of primitive number `place` of the file's mesh `mesh`; `lit` must live as long
  /// as this. With kBack triangles are wound the other way, and normals and tangents turned, so that the back
  /// is lit as the front of a one-sided material. Attributes of an earlier bake's light are dropped.
  Status renew(Json& primitive, const LitMesh& lit, uint32_t mesh, uint32_t place, Facing facing);

  /// Takes extensions off the document's lists that no primitive uses any more.
  void drop_unused_extensions();

 private:
  struct Written {
    const LitMesh* lit;
    Facing facing;
    Json primitive;
  };
  Status check_vertex_count(const Json& primitive, const LitMesh& lit) const;
  Status rewrite_attributes(Json& attributes, const LitMesh& lit, uint32_t mesh, uint32_t place, int target,
                            Facing facing);
  void rewrite_indices(Json& primitive, const LitMesh& lit, Facing facing);

  GltfDocument& document_;
  const Scene& scene_;
  const SourceReader& read_;
  std::map<std::pair<uint32_t, uint32_t>, std::vector<Written>> written_;  ///< by file mesh and primitive
};

/// Whether two have the same vertices and faces.
bool same_mesh(const LitMesh& a, const LitMesh& b);

/// What goldthread's exporters may be told to write and do not fit the scene: an index out of range, arrays
/// of different lengths. `values` is how many there are, one a vertex.
Status check_mesh(const Scene& scene, const LitMesh& lit, size_t values);

/// The primitive that a mesh belongs to.
const Primitive& source_of(const Scene& scene, const LitMesh& lit);

}  // namespace goldthread
