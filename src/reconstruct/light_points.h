// Where irradiance is wanted: the corners of the leaf mesh, one point for each smooth patch of surface that
// meets there.
#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "element/element_pool.h"
#include "scene/lighting.h"

namespace goldthread {

/// A corner of the leaf mesh with the normal that light falls on. Corners of adjoining faces are one point
/// where their normals agree, several where they crease, or lie on different sides of a seam
/// (LeafMesh::seam).
struct LightPoint {
  vec3 position{0};
  vec3 normal{0};       ///< unit, on the front: the source's vertex normals, or the faces' own
  uint32_t face = 0;    ///< the smallest leaf face it belongs to
  uint32_t vertex = 0;  ///< of the leaf mesh; of the part's own where that is uncut
  uint32_t sides = 0;   ///< PartPoints::sides_of its faces
};

/// The seams (LeafMesh::seam) that meet at a vertex.
struct SeamsAtVertex {
  std::vector<vec3> normals;  ///< unit, in the surface
  bool gap = false;           ///< one of them is a Seam::kGap
};

/// The final mesh of a part: triangulated leaf faces over light points.
struct PartPoints {
  std::vector<LightPoint> points;
  std::vector<uint32_t>
      corner_first;                ///< per leaf face, first of its corners in `corners`; one more at the end
  std::vector<uint32_t> corners;   ///< light point of each face corner, in the face's loop order
  std::vector<vec3> face_centres;  ///< per leaf face
  std::vector<vec3> face_normals;  ///< per leaf face, unit, on the front, of the geometry itself
  std::unordered_map<uint32_t, SeamsAtVertex> seams;  ///< by vertex

  /// On which sides of the seams at a vertex `place` lies, a bit each. Light may jump between places that
  /// differ in this.
  uint32_t sides_of(uint32_t vertex, const vec3& position, const vec3& place) const;
};

/// `normal_agreement`: cosine above which corners at one vertex share their light.
PartPoints collect_light_points(const ElementPool& pool, uint32_t part, float normal_agreement = 0.98f);

/// The lit primitive without its light: which source vertex or place each output vertex is, the faces, and in
/// `point_of_vertex` whose light point's light each vertex takes (kNoPoint: none, a vertex that no face
/// uses).
constexpr uint32_t kNoPoint = 0xffffffffu;
LitPrimitive build_output_mesh(const ElementPool& pool, uint32_t part, const PartPoints& points,
                               std::vector<uint32_t>& point_of_vertex);

}  // namespace goldthread
