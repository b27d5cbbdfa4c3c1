// Points on elements: by area, by what they send to a place, and as quadrature.
#include <algorithm>
#include <bit>

#include "base/rng.h"
#include "element/element_pool.h"
#include "math/spherical_triangle.h"

namespace goldthread {
namespace {

// Steradians below which a piece of sky is sampled as if it were flat.
constexpr float kSmallSolidAngle = 0.05f;

// Descends a binary tree by chance: one number in [0, 1) makes all the choices, and what it has left serves
// within the leaf. Twenty choices use up nearly all bits of a float: those that are gone are made up in the
// end, or a million triangles would be sampled along a few lines each, some of them edges.
class Descent {
 public:
  explicit Descent(float u) : u_(u) {}

  // Whether the first of two children, whose chance is `share`, is taken.
  bool first(float share) {
    const bool taken = u_ < share || share >= 1;
    const float of = taken ? share : 1 - share;
    u_ = std::clamp((taken ? u_ : u_ - share) / std::max(of, 1e-20f), 0.0f, kBelowOne);
    step_ /= std::max(of, 1e-20f);
    return taken;
  }
  float rest(float v) const {
    const uint32_t key = hash(std::bit_cast<uint32_t>(u_), std::bit_cast<uint32_t>(v));
    const float whole = u_ + std::min(step_, 1.0f) * unit_float(key);
    return std::min(whole < 1 ? whole : whole - 1, kBelowOne);  // round, or the end would get too much
  }

 private:
  static constexpr float kBelowOne = 0.99999994f;
  float u_, step_ = 0x1p-24f;
};

}  // namespace

SurfacePoint ElementPool::sample_at(ElementId id, float u, float v) const {
  // Down the volume clusters by area.
  Descent descent(u);
  while (elements_[id].kind == ElementKind::kVolume) {
    const ElementId child = elements_[id].first_child;
    const float share = elements_[id].area > 0 ? elements_[child].area / elements_[id].area : 0.5f;
    id = descent.first(share) ? child : child + 1;
  }
  const Element& element = elements_[id];
  if (element.kind == ElementKind::kPatch)
    return PolygonSampler(patch_polygon(element), normalize_or(element.summed_normal, vec3(0, 1, 0)), 0)
        .sample(descent.rest(v), v);
  if (element.kind == ElementKind::kTriangle)
    return sample_triangle(element, element.shape, descent.rest(v), v);
  const FaceClusterTree& tree = set_->tree(set_->parts[element.part]);
  const auto area_of = [&](ClusterRef r) {
    if (!is_triangle(r)) return tree.nodes[r].area;
    const UVec3& c = tree.mesh.triangles[triangle_of(r)];
    return length(area_vector(tree.mesh.positions[c.x], tree.mesh.positions[c.y], tree.mesh.positions[c.z]));
  };
  ClusterRef ref = element.shape;
  while (!is_triangle(ref)) {
    if (!tree.outlines.of(ref).empty()) {
      const ElementPolygon polygon = outline(element, ref);
      return PolygonSampler(polygon, polygon.normal(), kSomeTriangle).sample(descent.rest(v), v);
    }
    const FaceCluster& node = tree.nodes[ref];
    const float share = node.area > 0 ? std::clamp(area_of(node.child[0]) / node.area, 0.0f, 1.0f) : 0.5f;
    ref = node.child[descent.first(share) ? 0 : 1];
  }
  return sample_triangle(element, triangle_of(ref), descent.rest(v), v);
}

SurfacePoint ElementPool::sample_triangle(const Element& element, uint32_t triangle, float u, float v) const {
  const ElementPolygon polygon = triangle_polygon(element, triangle);
  return PolygonSampler(polygon, polygon.normal(), triangle).sample(u, v);
}

std::optional<PolygonSampler> ElementPool::one_polygon(ElementId id) const {
  const Element& element = elements_[id];
  if (element.kind == ElementKind::kPatch)
    return PolygonSampler(patch_polygon(element), normalize_or(element.summed_normal, vec3(0, 1, 0)), 0);
  if (element.kind == ElementKind::kTriangle) {
    const ElementPolygon polygon = triangle_polygon(element, element.shape);
    return PolygonSampler(polygon, polygon.normal(), element.shape);
  }
  if (element.kind != ElementKind::kCluster ||
      set_->tree(set_->parts[element.part]).outlines.of(element.shape).empty())
    return std::nullopt;
  const ElementPolygon polygon = outline(element, element.shape);
  return PolygonSampler(polygon, polygon.normal(), kSomeTriangle);
}

SurfacePoint ElementPool::sample_towards(ElementId id, const vec3& x, const vec3& n, float u, float v,
                                         float& weight) const {
  if (const std::optional<PolygonSampler> whole = one_polygon(id))
    return PolygonView(*whole, x).sample(n, u, v, weight);
  const Element& element = elements_[id];
  float chance = 1;
  const Part& part = set_->parts[element.part];
  const FaceClusterTree& tree = set_->tree(part);
  // By area over squared distance, as far as that can be told from centres. In the tree's own space, which
  // is similar to the world: only ratios count.
  const mat3 linear(part.to_world);
  const vec3 local = (x - vec3(part.to_world[3])) * linear / dot(linear[0], linear[0]);
  const auto pull = [&](ClusterRef ref) {
    if (is_triangle(ref)) {
      const UVec3& c = tree.mesh.triangles[triangle_of(ref)];
      const vec3 &p = tree.mesh.positions[c.x], &q = tree.mesh.positions[c.y], &r = tree.mesh.positions[c.z];
      const vec3 d = (p + q + r) / 3.0f - local;
      return 0.5f * length(cross(q - p, r - p)) / (dot(d, d) + 0.25f * dot(q - p, q - p));
    }
    const FaceCluster& node = tree.nodes[ref];
    const vec3 d = node.centre - local;
    return node.area / (dot(d, d) + 0.25f * node.radius * node.radius);
  };
  ClusterRef ref = element.shape;
  Descent descent(u);
  while (!is_triangle(ref)) {
    if (!tree.outlines.of(ref).empty()) break;
    const FaceCluster& node = tree.nodes[ref];
    const float a = pull(node.child[0]), b = pull(node.child[1]);
    const float share = std::clamp(a / std::max(a + b, 1e-30f), 0.0f, 1.0f);
    const bool first = descent.first(share);
    ref = node.child[first ? 0 : 1];
    chance *= first ? share : 1 - share;
  }
  u = descent.rest(v);
  const uint32_t triangle = is_triangle(ref) ? triangle_of(ref) : kSomeTriangle;
  const ElementPolygon polygon =
      is_triangle(ref) ? triangle_polygon(element, triangle) : outline(element, ref);
  const SurfacePoint point =
      PolygonView(PolygonSampler(polygon, polygon.normal(), triangle), x).sample(n, u, v, weight);
  weight /= chance;
  return point;
}

vec3 ElementPool::sky_direction(ElementId id, float u, float v) const {
  const std::array<vec3, 3>& c = sky_corners(id);
  const float angle = solid_angle(c[0], c[1], c[2]);
  if (angle >= kSmallSolidAngle) return sample_spherical_triangle(c[0], c[1], c[2], angle, u, v);
  const float s = std::sqrt(u);
  return normalize((1 - s) * c[0] + s * ((1 - v) * c[1] + v * c[2]));
}

void ElementPool::fill_samples(ElementId id) {
  const Element& element = elements_[id];
  if (element.kind != ElementKind::kVolume && element.kind != ElementKind::kCluster) return;
  for (uint32_t i = 0; i < kStoredSamples; ++i) {
    const float jitter = unit_float(hash(id, i));
    const float u = (static_cast<float>(i) + jitter) / static_cast<float>(kStoredSamples);
    samples_[element.samples + i] = sample_at(id, u, unit_float(hash(id, i + 64)));
  }
}

void ElementPool::quadrature(ElementId id, std::span<SurfacePoint> points, bool second) const {
  const Element& element = elements_[id];
  if (element.kind == ElementKind::kVolume || element.kind == ElementKind::kCluster) {
    const size_t stride = kStoredSamples / points.size();
    for (size_t i = 0; i < points.size(); ++i)
      points[i] = samples_[element.samples + i * stride + (second ? stride / 2 : 0)];
    return;
  }
  polygon_quadrature(polygon(id), normalize_or(element.summed_normal, vec3(0, 1, 0)), points, second);
}

// Points whose mean and covariance are the polygon's own, so that any quadratic is integrated exactly. Form
// factors are convex towards a shared edge: random points would be noisy, and the midpoint rule would lose
// light everywhere.
void ElementPool::polygon_quadrature(const ElementPolygon& polygon, const vec3& normal,
                                     std::span<SurfacePoint> points, bool second) const {
  const vec3& a = polygon.corners[0];
  const vec3 u = normalize_or(polygon.corners[1] - a, vec3(1, 0, 0)), v = cross(normal, u);
  vec2 mean(0);
  double xx = 0, xy = 0, yy = 0, area = 0;
  for (size_t i = 1; i + 1 < polygon.count; ++i) {
    const vec3 d1 = polygon.corners[i] - a, d2 = polygon.corners[i + 1] - a;
    const dvec2 p(dot(d1, u), dot(d1, v)), q(dot(d2, u), dot(d2, v));
    const double w = std::abs(p.x * q.y - p.y * q.x) / 2;
    // Second moments of a triangle with a corner at the origin.
    xx += w * (p.x * p.x + p.x * q.x + q.x * q.x) / 6;
    yy += w * (p.y * p.y + p.y * q.y + q.y * q.y) / 6;
    xy += w * (2 * p.x * p.y + p.x * q.y + q.x * p.y + 2 * q.x * q.y) / 12;
    mean += vec2(w * (p + q) / 3.0);
    area += w;
  }
  if (!(area > 0)) {
    for (SurfacePoint& point : points) point = {a, normal};
    return;
  }
  mean /= static_cast<float>(area);
  const double cxx = std::max(0.0, xx / area - double(mean.x) * double(mean.x)),
               cyy = std::max(0.0, yy / area - double(mean.y) * double(mean.y)),
               cxy = xy / area - double(mean.x) * double(mean.y);
  const double angle = 0.5 * std::atan2(2 * cxy, cxx - cyy),
               half = std::sqrt((cxx - cyy) * (cxx - cyy) / 4 + cxy * cxy);
  const auto s1 = static_cast<float>(std::sqrt((cxx + cyy) / 2 + half));
  const auto s2 = static_cast<float>(std::sqrt(std::max(0.0, (cxx + cyy) / 2 - half)));
  const vec2 e1(std::cos(angle), std::sin(angle)), e2(-e1.y, e1.x);
  // Rings of four: at the corners of the standard deviations' rectangle, and on their axes, root two further
  // out. A corner of the first may touch a triangle's edge; a hair's breadth keeps it inside.
  for (size_t i = 0; i < points.size(); ++i) {
    const float f = 0.995f, x = (i & 1) != 0 ? f : -f, y = (i & 2) != 0 ? f : -f;
    vec2 offset;
    if (((i & 4) == 0) != second) {
      offset = x * s1 * e1 + y * s2 * e2;
    } else {
      offset = (i & 2) != 0 ? 1.41421356f * x * s1 * e1 : 1.41421356f * x * s2 * e2;
    }
    const vec2 p = mean + offset;
    points[i] = {a + p.x * u + p.y * v, normal};
  }
}

}  // namespace goldthread
