// glTF meshes: primitives as triangle lists, with morph targets and skins applied at rest.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "files/gltf_read_accessors.h"
#include "goldthread/error.h"
#include "scene/scene.h"

namespace goldthread {

/// What moves the vertices of a mesh besides the placement of its node.
struct MeshPose {
  std::vector<double> weights;  ///< of the morph targets; missing ones are 0
  bool skinned = false;         ///< true: vertices end up in world space
  std::vector<mat4> joints;     ///< joint to world times inverse bind, for skinned meshes
  mat4 node{1};                 ///< node to world, for primitives of a skinned mesh that have no joints
};

/// Reads mesh `index`, which exists. Triangles and vertices keep the file's order; strips and fans are
/// expanded, degenerate triangles and all, so that triangle numbers can be recomputed from the file. Points
/// and lines are left out with a warning. Primitives without a material get one that is appended to the scene
/// once, with a warning.
Result<Mesh> read_gltf_mesh(AccessorReader& reader, size_t index, const MeshPose& pose, Scene& scene);

/// Corners of the triangles that `mode` (triangles, strip or fan) makes of a run of vertices.
std::vector<uint32_t> expand_to_triangles(int mode, const std::vector<uint32_t>& run);

}  // namespace goldthread
