// The answer: what every solver ends in, and all that exporters, viewers and metrics ever see of one.
#pragma once
#include <cstdint>
#include <vector>

#include "math/vec.h"

namespace goldthread {

/// Where a final vertex lies on its source primitive: triangle and barycentric weights of its corners 1
/// and 2. A corner of the source is exactly (0,0), (1,0) or (0,1).
struct VertexOrigin {
  uint32_t triangle = 0;  ///< source triangle: Primitive::indices[3 * triangle ...]
  vec2 weights{0};
};

/// The triangles of one primitive of one instance as they are shown in the end.
struct LitMesh {
  uint32_t instance = 0;   ///< Scene::instances
  uint32_t primitive = 0;  ///< Mesh::primitives of that instance's mesh

  /// True: vertex i is the source's vertex i and the faces are the source's own; `origins`, `faces` and
  /// `face_parents` are empty. False: the mesh was refined, or split where light breaks at a crease.
  bool source_mesh = true;
  std::vector<VertexOrigin> origins;   ///< per vertex
  std::vector<UVec3> faces;            ///< wound as the source
  std::vector<uint32_t> face_parents;  ///< source triangle of each face
};

/// The light on one primitive of one instance.
struct LitPrimitive : LitMesh {
  std::vector<vec3> irradiance;  ///< lux, per vertex, arriving on the front
  std::vector<vec3>
      irradiance_back;  ///< lux, per vertex, on the back; empty unless the material is lit behind
};

struct Lighting {
  uint32_t revision = 0;                 ///< grows with every snapshot
  std::vector<LitPrimitive> primitives;  ///< those that receive light, by instance, then primitive
};

}  // namespace goldthread
