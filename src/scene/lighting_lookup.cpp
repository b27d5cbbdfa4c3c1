#include "scene/lighting_lookup.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace goldthread {
namespace {

UVec3 corners_of(const Primitive& primitive, uint32_t triangle) {
  const uint32_t* index = &primitive.indices[3 * size_t{triangle}];
  return {index[0], index[1], index[2]};
}

template <typename T>
T blend(const T& a, const T& b, const T& c, const vec2& weights) {
  const typename T::value_type u = weights.x, v = weights.y;
  return (1 - u - v) * a + u * b + v * c;
}

// In the primitive's own space: weights are the same there as in the world.
dvec3 place_of(const Primitive& primitive, uint32_t triangle, vec2 weights) {
  const UVec3 c = corners_of(primitive, triangle);
  return blend(dvec3(primitive.positions[c.x]), dvec3(primitive.positions[c.y]),
               dvec3(primitive.positions[c.z]), weights);
}

// Weights of corners 1 and 2 at the foot of p in the triangle's plane.
dvec2 weights_at(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c) {
  const dvec3 u = b - a, v = c - a, w = p - a, n = glm::cross(u, v);
  const double squared = glm::dot(n, n);
  if (squared <= 0) return dvec2(1.0 / 3);
  return {glm::dot(glm::cross(w, v), n) / squared, glm::dot(glm::cross(u, w), n) / squared};
}

}  // namespace

LightingLookup::LightingLookup(const Scene& scene, const Lighting& lighting) {
  for (const LitPrimitive& light : lighting.primitives) {
    Lit lit{&light, &scene.meshes[scene.instances[light.instance].mesh].primitives[light.primitive], {}, {}};
    if (!light.source_mesh) {
      lit.first.assign(lit.source->triangle_count() + 1, 0);
      for (const uint32_t parent : light.face_parents) ++lit.first[parent + 1];
      for (size_t t = 1; t < lit.first.size(); ++t) lit.first[t] += lit.first[t - 1];
      lit.faces.resize(light.faces.size());
      std::vector<uint32_t> next(lit.first.begin(), lit.first.end() - 1);
      for (uint32_t f = 0; f < light.faces.size(); ++f) lit.faces[next[light.face_parents[f]]++] = f;
    }
    lit_.emplace(std::pair(light.instance, light.primitive), std::move(lit));
  }
}

// The face of a source triangle that a point lies in, or nearest to: vertices on the triangle's edges may be
// a rounding off them.
std::pair<UVec3, vec2> LightingLookup::find_face(const Lit& lit, uint32_t triangle, vec2 weights) const {
  const dvec3 p = place_of(*lit.source, triangle, weights);
  const auto vertex = [&](uint32_t v) {
    return place_of(*lit.source, lit.light->origins[v].triangle, lit.light->origins[v].weights);
  };
  UVec3 best(0);
  dvec2 best_weights(0);
  double most = -std::numeric_limits<double>::infinity();
  for (uint32_t i = lit.first[triangle]; i < lit.first[triangle + 1]; ++i) {
    const UVec3& face = lit.light->faces[lit.faces[i]];
    const dvec2 at = weights_at(p, vertex(face.x), vertex(face.y), vertex(face.z));
    const double least = std::min({at.x, at.y, 1 - at.x - at.y});
    if (least <= most) continue;
    most = least;
    best = face;
    best_weights = at;
  }
  const dvec2 inside = glm::clamp(best_weights, 0.0, 1.0);
  return {best, vec2(inside / std::max(1.0, inside.x + inside.y))};
}

std::optional<vec3> LightingLookup::irradiance(uint32_t instance, uint32_t primitive, uint32_t triangle,
                                               vec2 weights, bool back) const {
  const auto found = lit_.find({instance, primitive});
  if (found == lit_.end()) return std::nullopt;
  const Lit& lit = found->second;
  const std::vector<vec3>& values = back ? lit.light->irradiance_back : lit.light->irradiance;
  if (values.empty()) return std::nullopt;
  UVec3 corners = corners_of(*lit.source, triangle);
  if (!lit.light->source_mesh) {
    // A degenerate source triangle has no faces.
    if (lit.first[triangle] == lit.first[triangle + 1]) return std::nullopt;
    std::tie(corners, weights) = find_face(lit, triangle, weights);
  }
  return blend(values[corners.x], values[corners.y], values[corners.z], weights);
}

}  // namespace goldthread
