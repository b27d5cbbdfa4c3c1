#include "trace/receivers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/rng.h"
#include "math/oriented_box.h"
#include "trace/normal_map.h"
#include "trace/scrambled_sobol.h"

namespace goldthread {
namespace {

// Cosine to its face below which a vertex normal is an exporter's mistake, and above which it is the face's.
constexpr float kMistaken = 0.3f, kSame = 0.999999f;

/// The point of a triangle nearest to p, in double precision (the plane's where it is inside, else an
/// edge's).
dvec3 nearest_on_triangle(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c) {
  const dvec3 u = b - a, v = c - a, w = p - a, n = cross(u, v);
  const double squared = dot(n, n), s = dot(cross(w, v), n) / squared, t = dot(cross(u, w), n) / squared;
  if (s >= 0 && t >= 0 && s + t <= 1) return a + s * u + t * v;
  dvec3 best = a;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    const dvec3 edge = to - from;
    const dvec3 q = from + std::clamp(dot(p - from, edge) / dot(edge, edge), 0.0, 1.0) * edge;
    if (dot(q - p, q - p) >= least) continue;
    least = dot(q - p, q - p);
    best = q;
  }
  return best;
}

/// Barycentric weights of corners 1 and 2 of a point in the triangle's plane.
vec2 weights_of(const TracedScene& scene, uint32_t triangle, const vec3& p) {
  const dvec3 a(scene.corner(triangle, 0)), u = dvec3(scene.corner(triangle, 1)) - a,
                                            v = dvec3(scene.corner(triangle, 2)) - a, w = dvec3(p) - a,
                                            n = cross(u, v);
  const double squared = dot(n, n);
  return vec2(dvec2(dot(cross(w, v), n), dot(cross(u, w), n)) / squared);
}

/// Whether anything but the triangle's own plane comes within `distance` of p.
bool meets_another_plane(const TracedScene& scene, uint32_t triangle, const vec3& p, float distance) {
  bool meets = false;
  scene.caster().near(p, distance, [&](uint32_t t) {
    if (meets || std::abs(dot(scene.triangles()[t].normal, scene.triangles()[triangle].normal)) > 0.99999f)
      return;
    const dvec3 q = nearest_on_triangle(dvec3(p), dvec3(scene.corner(t, 0)), dvec3(scene.corner(t, 1)),
                                        dvec3(scene.corner(t, 2)));
    meets = glm::distance(q, dvec3(p)) <= static_cast<double>(distance);
  });
  return meets;
}

/// Rays from an edge would start in the plane of whatever meets the surface there: a few epsilons towards the
/// middle of the triangle take them off it.
vec3 off_the_edge(const TracedScene& scene, uint32_t triangle, const vec3& p, const vec3& outward) {
  const float wanted = 4 * scene.epsilon();
  const vec3 lifted = p + scene.epsilon() * outward;
  const vec3 inward = scene.point(triangle, vec2(1 / 3.0f)) - p;
  const float distance = length(inward), step = std::min(wanted, 0.5f * distance);
  return distance > 0 ? lifted + inward * (step / distance) : lifted;
}

/// What an area-weighted draw chooses from.
struct Sides {
  std::vector<uint32_t> triangles;
  std::vector<double> up_to;
};

Sides receiving_sides(const TracedScene& scene) {
  Sides sides;
  double sum = 0;
  for (uint32_t t = 0; t < scene.triangles().size(); ++t) {
    const Material& m = scene.material(t);
    if (m.unlit) continue;
    sum += static_cast<double>(scene.area(t)) * (m.lit_behind() ? 2 : 1);
    sides.triangles.push_back(t);
    sides.up_to.push_back(sum);
  }
  return sides;
}

Receiver random_receiver(const TracedScene& scene, const Sides& sides, uint32_t seed) {
  Receiver r;
  // A hole is no place for light; a scene of nothing but holes must end all the same.
  for (uint32_t attempt = 0; attempt < 1000; ++attempt) {
    const uint32_t draw = hash(seed, attempt);
    const double at = unit_double(hash(draw, 1)) * sides.up_to.back();
    const auto found = std::upper_bound(sides.up_to.begin(), sides.up_to.end(), at);
    const size_t i = std::min(static_cast<size_t>(found - sides.up_to.begin()), sides.up_to.size() - 1);
    const uint32_t t = sides.triangles[i];
    const auto root = static_cast<float>(std::sqrt(unit_double(hash(draw, 2))));
    const auto share = static_cast<float>(unit_double(hash(draw, 3)));
    const vec2 weights(root * (1 - share), root * share);
    r.point = scene.point(t, weights);
    const bool back = scene.material(t).lit_behind() && hash(draw, 4) % 2 == 1;
    r.normal = back ? -scene.triangles()[t].normal : scene.triangles()[t].normal;
    r.origin = r.point + scene.epsilon() * r.normal;
    r.triangle = t;
    r.weights = weights;
    r.back = back;
    if (scene.coverage(t, weights) > 0) break;
  }
  return r;
}

/// Per vertex of a part: the sum of its faces' area vectors, and the face that speaks for it best.
struct VertexFaces {
  vec3 normal{0};
  uint32_t triangle = Receiver::kNowhere;
  float claim = -1;
};

std::vector<VertexFaces> gather_faces(const TracedScene& scene, const TracedPart& part) {
  std::vector<VertexFaces> vertices(part.source->positions.size());
  for (uint32_t t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t) {
    const uint32_t* index = &part.source->indices[3 * size_t{scene.triangles()[t].source}];
    const float area = scene.area(t);
    for (int k = 0; k < 3; ++k) {
      VertexFaces& v = vertices[index[k]];
      v.normal += area * scene.triangles()[t].normal;
      if (area <= v.claim) continue;
      v.claim = area;
      v.triangle = t;
    }
  }
  return vertices;
}

void add_vertices(const TracedScene& scene, const TracedPart& part, std::vector<Receiver>& out) {
  const mat4& transform = scene.scene().instances[part.instance].transform;
  const mat3 normal_map = normal_transform(transform);
  const std::vector<VertexFaces> faces = gather_faces(scene, part);
  for (uint32_t v = 0; v < faces.size(); ++v) {
    if (faces[v].triangle == Receiver::kNowhere) continue;
    const vec3 front = scene.triangles()[faces[v].triangle].normal;
    vec3 normal = normalize_or(faces[v].normal, front);
    if (!part.source->normals.empty()) normal = normalize_or(normal_map * part.source->normals[v], normal);
    for (const bool back : {false, true}) {
      if (back && !part.material->lit_behind()) continue;
      Receiver r;
      r.point = vec3(transform * vec4(part.source->positions[v], 1));
      r.normal = back ? -normal : normal;
      r.origin = off_the_edge(scene, faces[v].triangle, r.point, back ? -front : front);
      r.instance = part.instance;
      r.primitive = part.primitive;
      r.vertex = v;
      r.back = back;
      out.push_back(r);
    }
  }
}

}  // namespace

std::vector<Receiver> random_receivers(const TracedScene& scene, uint64_t count, uint32_t seed) {
  const Sides sides = receiving_sides(scene);
  std::vector<Receiver> receivers;
  if (sides.triangles.empty()) return receivers;
  receivers.reserve(count);
  for (uint64_t i = 0; i < count; ++i)
    receivers.push_back(random_receiver(scene, sides, hash(hash(seed, 0x7265u), static_cast<uint32_t>(i))));
  return receivers;
}

std::vector<Receiver> vertex_receivers(const TracedScene& scene) {
  std::vector<Receiver> receivers;
  for (const TracedPart& part : scene.parts())
    if (!part.material->unlit) add_vertices(scene, part, receivers);
  return receivers;
}

vec3 ray_origin(const TracedScene& scene, uint32_t triangle, const vec3& p, const vec3& outward) {
  // In the middle of a surface it stays where it is, even between two triangles.
  return meets_another_plane(scene, triangle, p, 4 * scene.epsilon())
             ? off_the_edge(scene, triangle, p, outward)
             : p + scene.epsilon() * outward;
}

mat3 normal_transform(const mat4& instance_transform) {
  const mat3 linear(instance_transform);
  return (glm::determinant(linear) < 0 ? -1.0f : 1.0f) * area_vector_transform(linear);
}

vec3 shading_normal(const TracedScene& scene, uint32_t triangle, vec2 weights) {
  const TracedTriangle& face = scene.triangles()[triangle];
  const TracedPart& part = scene.parts()[face.part];
  const std::vector<vec3>& normals = part.source->normals;
  if (normals.empty()) return face.normal;
  const mat3 to_world = normal_transform(scene.scene().instances[part.instance].transform);
  const uint32_t* index = &part.source->indices[3 * size_t{face.source}];
  // Each is made unit in the world before they are mixed: as vertices have them, and as shaders do.
  const auto at = [&](int k) { return normalize_or(to_world * normals[index[k]], face.normal); };
  return normalize_or((1 - weights.x - weights.y) * at(0) + weights.x * at(1) + weights.y * at(2),
                      face.normal);
}

void turn_to_shading_normal(const TracedScene& scene, Receiver& receiver) {
  const vec3& flat = scene.triangles()[receiver.triangle].normal;
  const vec3 normal = shading_normal(scene, receiver.triangle, receiver.weights);
  const float cosine = dot(normal, flat);
  if (!(cosine > kMistaken) || cosine > kSame) return;
  receiver.normal = receiver.back ? -normal : normal;
  receiver.surface = receiver.back ? -flat : flat;
}

bool is_buried(const TracedScene& scene, const Receiver& receiver) {
  constexpr uint32_t kLooks = 64, kFew = 3;
  const mat3 frame = frame_about(receiver.surface == vec3(0) ? receiver.normal : receiver.surface);
  uint32_t others = 0;
  for (uint32_t i = 0; i < kLooks && others <= kFew; ++i) {
    const UnitSquarePoint p = r2_point(i, 17);
    const float r = std::sqrt(p.u), turn = 2 * kPi * p.v;
    Ray ray;
    ray.origin = receiver.origin;
    ray.direction = frame * vec3(r * std::cos(turn), r * std::sin(turn), std::sqrt(std::max(0.0f, 1 - p.u)));
    const Meeting met = scene.closest(ray);
    if (met.missed() || met.live) ++others;
  }
  return others <= kFew;
}

float on_surface_distance(const TracedScene& scene) {
  return std::max(20 * scene.epsilon(), 1e-4f * scene.scene().bounds().diagonal());
}

PlacedReceiver place_receiver(const TracedScene& scene, const vec3& point, const vec3& unit_normal) {
  PlacedReceiver placed;
  placed.receiver.point = point;
  placed.receiver.normal = unit_normal;
  placed.distance = std::numeric_limits<float>::infinity();
  const Box box = scene.scene().bounds();
  const float enough = box.empty() ? 0 : box.diagonal() + length(point - box.centre());
  float best = placed.distance;
  uint32_t on = Receiver::kNowhere;
  vec3 foot(0), up(0);
  // Of the surfaces about as near, the one that faces as the normal does.
  const float tolerance = on_surface_distance(scene);
  for (float radius = tolerance; std::isinf(best) && radius < 8 * enough; radius *= 4) {
    scene.caster().near(point, radius, [&](uint32_t t) {
      const vec3 q(nearest_on_triangle(dvec3(point), dvec3(scene.corner(t, 0)), dvec3(scene.corner(t, 1)),
                                       dvec3(scene.corner(t, 2))));
      const float distance = length(q - point), facing = dot(scene.triangles()[t].normal, unit_normal);
      const bool fits = facing > 0 || scene.material(t).lit_behind();
      const float claim = distance + tolerance * (fits ? 1 - std::abs(facing) : 2.0f);
      if (distance > radius || claim >= best) return;
      best = claim;
      placed.distance = distance;
      const vec3 outward = facing < 0 ? -scene.triangles()[t].normal : scene.triangles()[t].normal;
      on = t;
      foot = q;
      up = outward;
    });
  }
  if (on == Receiver::kNowhere) return placed;
  placed.receiver.triangle = on;
  placed.receiver.back = dot(up, scene.triangles()[on].normal) < 0;
  placed.receiver.origin = ray_origin(scene, on, foot, up);
  placed.receiver.weights = weights_of(scene, on, foot);
  bend(scene, placed.receiver.back ? -unit_normal : unit_normal, placed.receiver);
  return placed;
}

void bend(const TracedScene& scene, const vec3& front, Receiver& receiver) {
  const vec3 bent = bent_normal(scene, receiver.triangle, receiver.weights, front);
  if (bent == front) return;
  const vec3& face = scene.triangles()[receiver.triangle].normal;
  receiver.normal = receiver.back ? -bent : bent;
  receiver.surface = receiver.back ? -face : face;
}

}  // namespace goldthread
