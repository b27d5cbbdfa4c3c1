// The places at which light is measured: given ones, random ones, all vertices; texels are in
// texel_receivers.h.
#pragma once
#include <cstdint>
#include <vector>

#include "trace/traced_scene.h"

namespace goldthread {

/// One place and the side that light falls on.
struct Receiver {
  static constexpr uint32_t kNowhere = 0xffffffffu;
  vec3 point{0};
  vec3 normal{0};                ///< unit: of the plane that light is measured on
  vec3 surface{0};               ///< unit: of the surface, where `normal` is bent from it; else 0
  vec3 origin{0};                ///< where rays start: a little above the surface, off its edges
  uint32_t triangle = kNowhere;  ///< of a random or given place: TracedScene::triangles()
  vec2 weights{0};               ///< there, of corners 1 and 2
  uint32_t instance = kNowhere;  ///< of a vertex or texel: Scene::instances
  uint32_t primitive = 0;        ///< of a vertex or texel: Mesh::primitives
  uint32_t vertex = kNowhere;    ///< of a vertex: Primitive::positions
  uint32_t texel_x = kNowhere;   ///< of a texel: its column, from u = 0
  uint32_t texel_y = 0;          ///< of a texel: its row, from v = 0
  bool back = false;             ///< the back of a two-sided surface

  bool is_texel() const { return texel_x != kNowhere; }
};

/// `count` points spread evenly by area over all sides that receive light: fronts, and backs of what is
/// two-sided. Holes of alpha masks are left out. Point i does not depend on `count`. Empty when nothing
/// receives. Their normals are the faces' own.
std::vector<Receiver> random_receivers(const TracedScene& scene, uint64_t count, uint32_t seed);

/// All vertices that triangles use, by instance, primitive and vertex, once a side; their normals are the
/// file's, or where it has none the mean of the faces' by area. Normal textures do not bend them: vertices
/// are too far apart to hold a texture's detail, and the viewer bends their light itself.
std::vector<Receiver> vertex_receivers(const TracedScene& scene);

/// A given point on the surface nearest to it. `distance` says how far away that is, metres, infinite in an
/// empty scene; the receiver is of use only where it is within `on_surface_distance`.
/// The normal is the given one, bent by the material's normal texture if it has one there (bent_normal, about
/// the given normal as that of the front or back). Directions below the surface itself bring nothing.
struct PlacedReceiver {
  Receiver receiver;
  float distance = 0;
};
PlacedReceiver place_receiver(const TracedScene& scene, const vec3& point, const vec3& unit_normal);

/// What lies between the file's vertex normals at a place, unit, of the front; the face's own where there are
/// none.
vec3 shading_normal(const TracedScene& scene, uint32_t triangle, vec2 weights);

/// Turns a receiver on a triangle to the shading normal: the light of smooth surfaces is told for that, as
/// viewers shade them. Not where it leans so far from the face that it is a mistake. Normal textures do not
/// bend it: what is interpolated from vertices the viewer bends itself.
void turn_to_shading_normal(const TracedScene& scene, Receiver& receiver);

/// Bends the receiver's normal by the normal texture at its triangle and weights: `front` is the unit normal
/// of the front there, and the receiver may be on either side. Sets `surface` where it does.
void bend(const TracedScene& scene, const vec3& front, Receiver& receiver);

/// Where rays of point p of a triangle start: an epsilon above it on the side of `outward` (unit), and where
/// another surface meets the triangle there, off that.
vec3 ray_origin(const TracedScene& scene, uint32_t triangle, const vec3& p, const vec3& outward);

/// What carries a mesh's normals to the world, not unit; mirrors turn the winding, and with it the front.
mat3 normal_transform(const mat4& instance_transform);

/// Whether nearly all that a receiver looks at (61 of 64 directions) is the black back of something: it lies
/// inside a solid, as the floor does beneath a box, where nobody sees it.
bool is_buried(const TracedScene& scene, const Receiver& receiver);

/// Metres within which a point counts as lying on a surface: a ten-thousandth of the scene.
float on_surface_distance(const TracedScene& scene);

}  // namespace goldthread
