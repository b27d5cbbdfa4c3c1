// The places at which light is measured: given ones, random ones, or all vertices.
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
  vec3 origin{0};                ///< where rays start: a little above the surface, off its edges
  uint32_t triangle = kNowhere;  ///< of a random or given place: TracedScene::triangles()
  vec2 weights{0};               ///< there, of corners 1 and 2
  uint32_t instance = kNowhere;  ///< of a vertex: Scene::instances
  uint32_t primitive = 0;        ///< of a vertex: Mesh::primitives
  uint32_t vertex = 0;           ///< of a vertex: Primitive::positions
  bool back = false;             ///< the back of a two-sided surface
};

/// `count` points spread evenly by area over all sides that receive light: fronts, and backs of what is
/// two-sided. Holes of alpha masks are left out. Point i does not depend on `count`. Empty when nothing
/// receives.
std::vector<Receiver> random_receivers(const TracedScene& scene, uint64_t count, uint32_t seed);

/// All vertices that triangles use, by instance, primitive and vertex, once a side; their normals are the
/// file's, or where it has none the mean of the faces' by area.
std::vector<Receiver> vertex_receivers(const TracedScene& scene);

/// A given point on the surface nearest to it. `distance` says how far away that is, metres, infinite in an
/// empty scene; the receiver is of use only where it is within `on_surface_distance`.
struct PlacedReceiver {
  Receiver receiver;
  float distance = 0;
};
PlacedReceiver place_receiver(const TracedScene& scene, const vec3& point, const vec3& unit_normal);

/// Whether nearly all that a receiver looks at (61 of 64 directions) is the black back of something: it lies
/// inside a solid, as the floor does beneath a box, where nobody sees it.
bool is_buried(const TracedScene& scene, const Receiver& receiver);

/// Metres within which a point counts as lying on a surface: a ten-thousandth of the scene.
float on_surface_distance(const TracedScene& scene);

}  // namespace goldthread
