#include "solve/hierarchical/sight.h"

#include "visibility/shaft.h"

namespace goldthread {
namespace {

// Corners that contain an element; none where it is not flat, or too many.
struct Outline {
  std::array<vec3, Shaft::kMostPoints> corners;
  size_t count = 0;
  vec3 normal{0};

  std::span<const vec3> span() const { return {corners.data(), count}; }
  void add(const vec3& p) { corners[count++] = p; }
};

Outline outline_of(const ElementPool& pool, ElementId id, float epsilon) {
  const Element& e = pool[id];
  Outline out;
  if (!is_surface(e.kind) || e.kind == ElementKind::kVolume || !e.flat || e.thickness > epsilon) return out;
  out.normal = normalize_or(e.summed_normal, vec3(0));
  if (out.normal == vec3(0)) return out;
  if (e.kind == ElementKind::kCluster) {
    const vec3& n = out.normal;
    const vec3 u = e.radius * normalize(std::abs(n.x) > 0.6f ? vec3(n.y, -n.x, 0) : vec3(0, n.z, -n.y));
    const vec3 v = cross(n, u);
    for (const vec3& p : {-u - v, u - v, u + v, v - u}) out.add(e.centre + p);
    return out;
  }
  const ElementPolygon polygon = pool.polygon(id);
  if (polygon.count > Shaft::kMostPoints) return out;
  for (const vec3& p : polygon.span()) out.add(p);
  return out;
}

// Where a light is, seen from `from`: far ones as far as need be.
Outline outline_of_light(const ElementPool& pool, const Visibility& visibility, ElementId id,
                         const Outline& from) {
  const Element& e = pool[id];
  Outline out;
  const float far = 2 * visibility.extent;
  if (e.kind == ElementKind::kPoint && pool.light(id).has_area()) {
    const Light& light = pool.light(id);
    const vec3 across = 0.5f * light.size.x * light.across;
    const vec3 up = 0.5f * light.size.y * cross(light.direction, light.across);
    for (const vec3& p : {-across - up, across - up, across + up, up - across}) out.add(e.centre + p);
    out.normal = light.direction;
  } else if (e.kind == ElementKind::kPoint) {
    const float r = pool.light(id).radius;
    if (r <= 0) {
      out.add(e.centre);
    } else {
      for (int k = 0; k < 8; ++k)
        out.add(e.centre + r * vec3((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 1 : -1));
    }
  } else if (e.kind == ElementKind::kSun && pool.light(id).angular_diameter <= 0) {
    for (const vec3& p : from.span()) out.add(p - far * pool.light(id).direction);
  } else if (e.kind == ElementKind::kSky && 3 * from.count <= Shaft::kMostPoints) {
    for (const vec3& d : pool.sky_corners(id))
      for (const vec3& p : from.span()) out.add(p + far * d);
  }
  return out;
}

bool is_clear(const ElementPool& pool, const Visibility& visibility, const Outline& receiver,
              ElementId source) {
  const bool surface = is_surface(pool[source].kind);
  const Outline to = surface ? outline_of(pool, source, visibility.epsilon)
                             : outline_of_light(pool, visibility, source, receiver);
  if (to.count == 0) return false;
  Shaft shaft(receiver.span(), to.span(), visibility.epsilon);
  shaft.add_cap(receiver.corners[0], receiver.normal);
  if (to.normal != vec3(0)) shaft.add_cap(to.corners[0], to.normal);
  return visibility.caster->is_clear(shaft);
}

}  // namespace

Sight certain_sight(const ElementPool& pool, const Visibility& visibility, ElementId receiver,
                    ElementId source) {
  if (!visibility.shafts || receiver == source) return Sight::kSampled;
  const Outline outline = outline_of(pool, receiver, visibility.epsilon);
  return outline.count > 0 && is_clear(pool, visibility, outline, source) ? Sight::kClear : Sight::kSampled;
}

}  // namespace goldthread
