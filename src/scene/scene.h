// The scene as values: what every importer fills and every other room reads. Nothing here knows a file
// format.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "math/box.h"
#include "math/vec.h"
#include "scene/image.h"
#include "scene/light.h"
#include "scene/material.h"
#include "scene/sky.h"

namespace goldthread {

/// Triangles of one material, in the mesh's own space. Indices are triangle lists (strips and fans are
/// expanded by the importer) and always in range; positions may still be degenerate or not finite.
struct Primitive {
  std::vector<vec3> positions;
  std::vector<vec3> normals;       ///< per vertex, or empty: then faces are flat, as glTF demands
  std::vector<vec2> texcoords[2];  ///< per vertex, or empty
  std::vector<vec4> colours;       ///< per vertex linear RGBA that multiplies the base colour, or empty
  std::vector<uint32_t> indices;   ///< 3 per triangle
  uint32_t material = 0;           ///< index in Scene::materials, always valid
  uint32_t source_primitive = 0;   ///< which primitive of the file's mesh this came from
  /// Per vertex, or empty: unit, along the normal texture's red, and in w the sign of the bitangent, its
  /// green, w * cross(normal, tangent) (glTF's TANGENT).
  std::vector<vec4> tangents;

  size_t triangle_count() const { return indices.size() / 3; }
};

struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;  ///< only those made of triangles
};

/// One placement of a mesh. Skinned nodes are given meshes of their own, already in world space.
struct Instance {
  uint32_t mesh = 0;
  mat4 transform{1};         ///< mesh space to world; may mirror and scale unevenly
  uint32_t source_node = 0;  ///< the file's node
  std::string name;
};

struct Camera {
  std::string name;
  vec3 position{0}, forward{0, 0, -1}, up{0, 1, 0};
  float vertical_fov = 0.8f;      ///< radians; 0 for orthographic
  float orthographic_height = 0;  ///< metres, for orthographic
  float aspect = 0;               ///< width / height, 0 when the file leaves it open
};

struct Scene {
  std::string file;  ///< where it was read from; empty for procedural scenes
  std::vector<Image> images;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  Sky sky;
  std::vector<std::string> warnings;  ///< what the importer had to change or leave out, a line each

  size_t triangle_count() const;  ///< over all instances
  Box bounds() const;             ///< of the finite vertices of all instances, world space
};

}  // namespace goldthread
