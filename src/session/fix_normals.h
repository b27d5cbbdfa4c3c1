// --fix-normals: one winding a shell, closed shells outwards, rooms inwards.
#pragma once
#include <cstdint>

#include "scene/scene.h"

namespace goldthread {

struct FixedNormals {
  uint64_t triangles = 0;  ///< turned
  uint32_t shells = 0;     ///< with turned triangles
};

/// Turns triangles of `scene` (their last two corners change places; vertices keep their numbers) and the
/// vertex normals that belong to them. Meshes of which everything is two-sided are left alone: there the
/// winding does not matter.
FixedNormals fix_normals(Scene& scene);

}  // namespace goldthread
