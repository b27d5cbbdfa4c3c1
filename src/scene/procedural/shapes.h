// Building blocks of the procedural scenes: flat and curved pieces, tessellated at a chosen rate.
#pragma once
#include <array>
#include <functional>
#include <string>

#include "math/vec.h"
#include "scene/scene.h"

namespace goldthread::procedural {

/// Adds the flat triangle a, b, c (counter-clockwise seen from its front) cut into rate * rate similar ones.
/// Points on an edge depend on its two ends alone, whatever their order, so that pieces with a common edge
/// and rate are watertight.
void add_triangle(Primitive& out, const dvec3& a, const dvec3& b, const dvec3& c, int rate = 1);

/// Adds the quadrilateral as the triangles 0 1 2 and 0 2 3.
void add_quad(Primitive& out, const std::array<dvec3, 4>& corners, int rate = 1);

/// Adds a flat parallelogram with its corner at `corner`, cut into columns * rows cells. Its front is that of
/// cross(across, up).
void add_grid(Primitive& out, const dvec3& corner, const dvec3& across, const dvec3& up, int columns,
              int rows);

/// A flat rectangle of square cells on a lattice of `step` metres, each cell cut into rate * rate. All in
/// lattice units; the front is that of cross(across, up). Points depend on lattice coordinates alone, so that
/// rectangles of one lattice and rate are watertight where they meet.
struct LatticeRectangle {
  glm::ivec3 corner{0}, across{1, 0, 0}, up{0, 1, 0};  ///< `across` and `up` are unit steps along an axis
  int columns = 1, rows = 1;
};
void add_lattice(Primitive& out, const LatticeRectangle& rectangle, double step, int rate,
                 const std::function<bool(int column, int row)>& is_hole = {});

/// Which side of a box is its front.
enum class Facing { kOutward, kInward };

/// Adds the six sides of an axis-aligned box.
void add_box(Primitive& out, const dvec3& low, const dvec3& high, int rate = 1,
             Facing facing = Facing::kOutward);

/// A curved piece: a function of u and v in 0..1, smooth, and without poles (its two derivatives are never
/// parallel).
struct Surface {
  std::function<dvec3(double u, double v)> point;
  bool closed_u = false;  ///< point(1, v) is point(0, v): the seam is shared
  bool closed_v = false;  ///< point(u, 1) is point(u, 0)
  bool flip = false;      ///< the front is that of -cross(dp/du, dp/dv)
};

/// The unit normal of the front at u, v.
dvec3 surface_normal(const Surface& surface, double u, double v);

/// Adds the surface sampled at columns * rows cells of two triangles each, with its own normals.
void add_surface(Primitive& out, const Surface& surface, int columns, int rows);

/// The part of a disc or ring around `centre`, in the plane spanned by the orthogonal vectors `x` and `y`.
Surface ring(const dvec3& centre, const dvec3& x, const dvec3& y, double inner, double outer);
/// A tube of the given radius around the segment from a to b, without caps, front outside.
Surface tube(const dvec3& a, const dvec3& b, double radius);

/// A cushion round the segment from a to b: elliptic sections with the half axes `x` and `y` that shrink
/// towards its two open ends. Front outside.
Surface pillow(const dvec3& a, const dvec3& b, const dvec3& x, const dvec3& y);
/// A torus round `centre` in the plane of the orthogonal vectors `x` and `y`. Front outside.
Surface torus(const dvec3& centre, const dvec3& x, const dvec3& y, double radius, double thickness);

/// Adds a diffuse material (metallic 0) and returns its index. `emission` in nits.
uint32_t add_material(Scene& scene, std::string name, const vec3& reflectance,
                      const vec3& emission = vec3(0));

/// Adds a mesh of one primitive with an instance that stands where it is; returns the mesh.
uint32_t add_object(Scene& scene, std::string name, Primitive primitive, uint32_t material);
/// Adds another instance of a mesh.
void add_instance(Scene& scene, uint32_t mesh, std::string name, const mat4& transform);

/// Adds a perspective camera that looks from `position` to `target`; the field of view in degrees.
void add_camera(Scene& scene, const vec3& position, const vec3& target, float vertical_degrees, float aspect);

/// The rate at which `at_rate_one` triangles become about `wished`, at least 1; 1 for no wish.
int rate_for(uint64_t wished, uint64_t at_rate_one);

}  // namespace goldthread::procedural
