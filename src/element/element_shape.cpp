// The geometry and paint of single elements.
#include <algorithm>

#include "base/rng.h"
#include "element/element_pool.h"
#include "element/paint.h"
#include "math/colour.h"
#include "math/spherical_triangle.h"

namespace goldthread {
namespace {

// Normals within two degrees of their mean are as good as one.
constexpr float kFlatCosine = 0.9994f;

// +1 when the element's side is the one from which the tree's corners run counter-clockwise.
float orientation(const Part& part, const Element& element) {
  return element.back ? -part.winding : part.winding;
}

// How far the vertices of a range of triangles lie from the plane through `centre`.
float greatest_height(const Part& part, const TriangleMesh& mesh, uint32_t first, uint32_t count,
                      const vec3& centre, const vec3& normal) {
  float height = 0;
  for (uint32_t t = first; t < first + count; ++t)
    for (int k = 0; k < 3; ++k)
      height = std::max(height, std::abs(dot(part.positions[mesh.triangles[t][k]] - centre, normal)));
  return height;
}

vec3 side_normal(const Part& part, const Element& element, const vec3& tree_area_vector) {
  const vec3 front = part.area_map * tree_area_vector;
  return element.back ? -front : front;
}

}  // namespace

Element ElementPool::make_surface_element(const Surface& surface) const {
  Element element;
  element.part = surface.part;
  element.back = surface.back;
  element.shape = surface.root;
  if (is_triangle(surface.root)) {
    element.shape = triangle_of(surface.root);
    fill_triangle(element, element.shape);
  } else {
    fill_cluster(element, surface.root);
  }
  return element;
}

void ElementPool::fill_cluster(Element& element, ClusterRef ref) const {
  const Part& part = set_->parts[element.part];
  const FaceCluster& node = set_->tree(part).nodes[ref];
  element.kind = ElementKind::kCluster;
  element.shape = ref;
  element.summed_normal = side_normal(part, element, node.summed_normal);
  element.area = node.area * part.scale * part.scale;
  element.centre = vec3(part.to_world * vec4(node.centre, 1));
  element.radius = node.radius * part.scale;
  element.cone_cosine = node.cone_cosine;
  element.flat =
      node.cone_cosine > kFlatCosine || (element.parent != kNoElement && elements_[element.parent].flat);
  element.thickness = element.radius;
  if (element.flat)
    element.thickness = greatest_height(part, set_->tree(part).mesh, node.first, node.count, element.centre,
                                        normalize_or(element.summed_normal, vec3(0, 1, 0)));
  fill_paint(element, node.first, node.count);
}

void ElementPool::fill_triangle(Element& element, uint32_t triangle) const {
  const Part& part = set_->parts[element.part];
  const UVec3& corner = set_->tree(part).mesh.triangles[triangle];
  const vec3 &a = part.positions[corner.x], &b = part.positions[corner.y], &c = part.positions[corner.z];
  element.kind = ElementKind::kTriangle;
  element.shape = triangle;
  element.summed_normal = orientation(part, element) * area_vector(a, b, c);
  element.area = length(element.summed_normal);
  element.centre = (a + b + c) / 3.0f;
  element.radius = std::sqrt(
      std::max({dot(a - element.centre, a - element.centre), dot(b - element.centre, b - element.centre),
                dot(c - element.centre, c - element.centre)}));
  element.cone_cosine = 1;
  element.flat = true;
  fill_paint(element, triangle, 1);
}

// The back of what is lit behind only because it is translucent gives off no light of its own.
bool ElementPool::emits_here(const Element& element) const {
  return !element.back || set_->scene->materials[set_->parts[element.part].material].double_sided;
}

void ElementPool::fill_paint(Element& element, uint32_t first, uint32_t count) const {
  const Part& part = set_->parts[element.part];
  element.reflectance = part.reflectance;
  element.exitance = emits_here(element) ? part.exitance : vec3(0);
  element.coverage = part.coverage;
  if (part.triangle_reflectance.empty()) return;
  const TriangleMesh& mesh = set_->tree(part).mesh;
  vec3 reflectance(0), exitance(0);
  float coverage = 0, area = 0;
  for (uint32_t t = first; t < first + count; ++t) {
    const UVec3& c = mesh.triangles[t];
    const float a = length(area_vector(mesh.positions[c.x], mesh.positions[c.y], mesh.positions[c.z]));
    area += a;
    reflectance += a * part.triangle_reflectance[t];
    exitance += a * part.triangle_exitance[t];
    coverage += a * part.triangle_coverage[t];
  }
  if (area <= 0) return;
  element.reflectance = reflectance / area;
  element.exitance = emits_here(element) ? exitance / area : vec3(0);
  element.coverage = coverage / area;
}

void ElementPool::fill_patch(Element& element, uint32_t number) const {
  const Patch& patch = patches_[number];
  element.kind = ElementKind::kPatch;
  element.shape = number;
  const std::span<const vec3> corners(&corners_[patch.first_corner], patch.corners);
  vec3 sum(0), moment(0);
  float total = 0;
  const Part& part = set_->parts[element.part];
  for (size_t i = 1; i + 1 < corners.size(); ++i) {
    const vec3 piece = area_vector(corners[0], corners[i], corners[i + 1]);
    const float area = length(piece);
    sum += piece;
    total += area;
    moment += area * (corners[0] + corners[i] + corners[i + 1]) / 3.0f;
  }
  element.summed_normal = orientation(part, element) * sum;
  element.area = length(sum);
  element.centre = total > 0 ? moment / total : corners[0];
  float squared = 0;
  for (const vec3& c : corners) squared = std::max(squared, dot(c - element.centre, c - element.centre));
  element.radius = std::sqrt(squared);
  element.cone_cosine = 1;
  element.flat = true;
  fill_paint(element, patch.triangle, 1);
  if (part.triangle_reflectance.empty()) return;
  const Paint paint = patch_paint(number);
  element.reflectance = paint.reflectance;
  element.exitance = emits_here(element) ? paint.exitance : vec3(0);
  element.coverage = paint.coverage;
}

// The average of a textured patch, from points on it.
Paint ElementPool::patch_paint(uint32_t number) const {
  const Patch& patch = patches_[number];
  const Part& part = set_->parts[patch.part];
  const std::span<const vec3> corners(&corners_[patch.first_corner], patch.corners);
  Paint paint{vec3(0), vec3(0), 0, vec3(0), vec3(0)};
  constexpr uint32_t kPoints = 16;
  ElementPolygon polygon;
  polygon.count = patch.corners;
  std::copy(corners.begin(), corners.end(), polygon.corners.begin());
  const PolygonSampler places(polygon, vec3(0), patch.triangle);
  for (uint32_t i = 0; i < kPoints; ++i) {
    const UnitSquarePoint uv = r2_point(i, number);
    const Paint one = paint_of(part, patch.triangle, places.sample(uv.u, uv.v).position);
    paint.reflectance += one.reflectance / static_cast<float>(kPoints);
    paint.exitance += one.exitance / static_cast<float>(kPoints);
    paint.coverage += one.coverage / static_cast<float>(kPoints);
    paint.stopped += one.stopped / static_cast<float>(kPoints);
    paint.transmittance += one.transmittance / static_cast<float>(kPoints);
  }
  return paint;
}

// The paint of a triangle at a place on it.
Paint ElementPool::paint_of(const Part& part, uint32_t triangle, const vec3& place) const {
  const UVec3& c = set_->tree(part).mesh.triangles[triangle];
  const vec3 &a = part.positions[c.x], &b = part.positions[c.y], &d = part.positions[c.z];
  const vec3 e1 = b - a, e2 = d - a, n = cross(e1, e2), p = place - a;
  const float scale = 1 / std::max(dot(n, n), 1e-30f);
  const vec2 weights = glm::clamp(vec2(dot(cross(p, e2), n), dot(cross(e1, p), n)) * scale, vec2(0), vec2(1));
  return paint_at(*set_, part, triangle, weights);
}

float ElementPool::texture_contrast(ElementId id) const {
  const Element& element = elements_[id];
  const Part& part = set_->parts[element.part];
  if (part.triangle_reflectance.empty()) return 0;
  constexpr uint32_t kPlaces = 16;
  float sum = 0, squares = 0;
  for (uint32_t i = 0; i < kPlaces; ++i) {
    const UnitSquarePoint uv = r2_point(i, id);
    const SurfacePoint point = sample_at(id, uv.u, uv.v);
    const uint32_t triangle = element.kind == ElementKind::kPatch ? patches_[element.shape].triangle
                              : point.triangle == kSomeTriangle   ? find_triangle(element, point)
                                                                  : point.triangle;
    const float value = luminance(paint_of(part, triangle, point.position).reflectance);
    sum += value;
    squares += value * value;
  }
  const float mean = sum / kPlaces;
  return mean > 0 ? std::sqrt(std::max(0.0f, squares / kPlaces - mean * mean)) / mean : 0.0f;
}

// What fill_paint is to an element, for its passage.
void ElementPool::fill_passage(ElementId id) {
  const Element& element = elements_[id];
  if (!is_surface(element.kind) || element.kind == ElementKind::kVolume) return;
  const Part& part = set_->parts[element.part];
  ElementPassage& passage = passages_[id];
  passage.stopped = part.triangle_coverage.empty() ? part.stopped : vec3(element.coverage);
  passage.transmittance = part.transmittance;
  if (part.triangle_stopped.empty() && part.triangle_transmittance.empty()) return;
  if (element.kind == ElementKind::kPatch) {
    const Paint paint = patch_paint(element.shape);
    passage.stopped = paint.stopped;
    passage.transmittance = paint.transmittance;
    return;
  }
  const FaceClusterTree& tree = set_->tree(part);
  uint32_t first = element.shape, count = 1;
  if (element.kind == ElementKind::kCluster) {
    first = tree.nodes[element.shape].first;
    count = tree.nodes[element.shape].count;
  }
  vec3 stopped(0), transmittance(0);
  float area = 0;
  for (uint32_t t = first; t < first + count; ++t) {
    const UVec3& c = tree.mesh.triangles[t];
    const float a =
        length(area_vector(tree.mesh.positions[c.x], tree.mesh.positions[c.y], tree.mesh.positions[c.z]));
    area += a;
    if (!part.triangle_stopped.empty()) stopped += a * part.triangle_stopped[t];
    if (!part.triangle_transmittance.empty()) transmittance += a * part.triangle_transmittance[t];
  }
  if (!(area > 0)) return;
  if (!part.triangle_stopped.empty()) passage.stopped = stopped / area;
  if (!part.triangle_transmittance.empty()) passage.transmittance = transmittance / area;
}

void ElementPool::fill_volume(ElementId id) {
  Element& element = elements_[id];
  const Element &a = elements_[element.first_child], &b = elements_[element.first_child + 1];
  element.area = a.area + b.area;
  const float share = element.area > 0 ? a.area / element.area : 0.5f;
  element.centre = share * a.centre + (1 - share) * b.centre;
  element.radius =
      std::max(length(a.centre - element.centre) + a.radius, length(b.centre - element.centre) + b.radius);
  element.thickness = element.radius;
  element.summed_normal = a.summed_normal + b.summed_normal;
  element.cone_cosine = -1;
  element.reflectance = share * a.reflectance + (1 - share) * b.reflectance;
  element.exitance = share * a.exitance + (1 - share) * b.exitance;
  element.coverage = share * a.coverage + (1 - share) * b.coverage;
}

void ElementPool::fill_child(ElementId id) {
  Element& element = elements_[id];
  switch (elements_[element.parent].kind) {
    case ElementKind::kCluster:
      if (is_triangle(element.shape)) {
        fill_triangle(element, triangle_of(element.shape));
      } else {
        fill_cluster(element, element.shape);
        fill_samples(id);
      }
      break;
    case ElementKind::kTriangle:
    case ElementKind::kPatch:
      fill_patch(element, element.shape);
      break;
    default:
      break;
  }
}

namespace {

// Whether `p` lies within a convex polygon of normal `n`.
bool is_within(const ElementPolygon& polygon, const vec3& n, const vec3& p) {
  for (size_t i = 0; i < polygon.count; ++i) {
    const vec3 &a = polygon.corners[i], &b = polygon.corners[i + 1 < polygon.count ? i + 1 : 0];
    if (dot(cross(n, b - a), p - a) < 0) return false;
  }
  return true;
}

// How far `p` lies within a convex polygon of unit normal `n`; negative outside.
float depth_within(const ElementPolygon& polygon, const vec3& n, const vec3& p) {
  float least = std::numeric_limits<float>::max();
  for (size_t i = 0; i < polygon.count; ++i) {
    const vec3 &a = polygon.corners[i], &b = polygon.corners[(i + 1) % polygon.count];
    least = std::min(least, dot(cross(n, normalize_or(b - a, vec3(0))), p - a));
  }
  return least;
}

}  // namespace

ElementId ElementPool::deepest(ElementId id, const SurfacePoint& at) const {
  SurfacePoint point = at;
  if (point.triangle == kSomeTriangle && elements_[id].kind == ElementKind::kCluster &&
      elements_[id].first_child != kNoElement)
    point.triangle = find_triangle(elements_[id], point);
  while (elements_[id].first_child != kNoElement) {
    const Element& e = elements_[id];
    const ElementId child = e.first_child;
    bool first = true;
    if (e.kind == ElementKind::kCluster) {
      const Element& c = elements_[child];
      if (c.kind == ElementKind::kTriangle) {
        first = c.shape == point.triangle;
      } else {
        const FaceCluster& node = set_->tree(set_->parts[e.part]).nodes[c.shape];
        first = point.triangle - node.first < node.count;
      }
    } else if (e.kind == ElementKind::kTriangle || e.kind == ElementKind::kPatch) {
      const ElementPolygon a = polygon(child);
      first = is_within(a, point.normal, point.position);
      if (!first) {
        // By rounding a point may lie in neither: then the one is taken that it is nearer to.
        const ElementPolygon b = polygon(child + 1);
        first =
            !is_within(b, point.normal, point.position) &&
            depth_within(a, point.normal, point.position) >= depth_within(b, point.normal, point.position);
      }
    } else {
      return id;
    }
    id = first ? child : child + 1;
  }
  return id;
}

// The triangle of a cluster that holds a point, or comes nearest to: of rounding's making there may be none.
// The child in whose sphere the point lies deeper is looked into first: mostly the way leads straight down.
uint32_t ElementPool::find_triangle(const Element& cluster, const SurfacePoint& point) const {
  const Part& part = set_->parts[cluster.part];
  const FaceClusterTree& tree = set_->tree(part);
  // Parts are scaled evenly: the transposed is the inverse but for the scale, which the distances keep.
  const vec3 local =
      transpose(mat3(part.to_world)) * (point.position - vec3(part.to_world[3])) / (part.scale * part.scale);
  struct Waiting {
    ClusterRef ref;
    float distance, radius;  ///< from the point to the sphere's centre, and the sphere's
  };
  constexpr size_t kStack = 256;
  std::array<Waiting, kStack> stack;
  size_t depth = 0;
  uint32_t found = tree.nodes[cluster.shape].first;
  float best = std::numeric_limits<float>::lowest();
  const auto add = [&](ClusterRef ref) {
    if (is_triangle(ref)) {
      const ElementPolygon triangle = triangle_polygon(cluster, triangle_of(ref));
      const float within = is_within(triangle, point.normal, point.position)
                               ? 0
                               : depth_within(triangle, point.normal, point.position);
      if (within <= best) return;
      best = within;
      found = triangle_of(ref);
    } else if (depth < kStack) {
      const FaceCluster& node = tree.nodes[ref];
      stack[depth++] = {ref, part.scale * length(node.centre - local), 1.001f * part.scale * node.radius};
    }
  };
  add(cluster.shape);
  while (depth > 0 && best < 0) {
    const Waiting at = stack[--depth];
    if (at.radius - at.distance < best) continue;  // all triangles in there are farther away
    const size_t first = depth;
    const FaceCluster& node = tree.nodes[at.ref];
    add(node.child[0]);
    add(node.child[1]);
    if (depth == first + 2 &&
        stack[first].distance * stack[first + 1].radius < stack[first + 1].distance * stack[first].radius)
      std::swap(stack[first], stack[first + 1]);
  }
  return found;
}

ElementPolygon ElementPool::outline(ElementId cluster, ClusterRef node) const {
  return outline(elements_[cluster], node);
}

ElementPolygon ElementPool::outline(const Element& element, ClusterRef node) const {
  const Part& part = set_->parts[element.part];
  ElementPolygon polygon;
  for (const vec3& corner : set_->tree(part).outlines.of(node))
    polygon.corners[polygon.count++] = vec3(part.to_world * vec4(corner, 1));
  if (orientation(part, element) < 0)
    std::reverse(polygon.corners.data(), polygon.corners.data() + polygon.count);
  return polygon;
}

ElementPolygon ElementPool::triangle_polygon(const Element& element, uint32_t triangle) const {
  const Part& part = set_->parts[element.part];
  const UVec3& c = set_->tree(part).mesh.triangles[triangle];
  ElementPolygon polygon;
  polygon.count = 3;
  polygon.corners[0] = part.positions[c.x];
  polygon.corners[1] = part.positions[c.y];
  polygon.corners[2] = part.positions[c.z];
  if (orientation(part, element) < 0) std::swap(polygon.corners[1], polygon.corners[2]);
  return polygon;
}

ElementPolygon ElementPool::patch_polygon(const Element& element) const {
  const Patch& patch = patches_[element.shape];
  ElementPolygon polygon;
  polygon.count = patch.corners;
  std::copy_n(&corners_[patch.first_corner], patch.corners, polygon.corners.begin());
  if (orientation(set_->parts[element.part], element) < 0)
    std::reverse(polygon.corners.begin(),
                 polygon.corners.begin() + static_cast<std::ptrdiff_t>(polygon.count));
  return polygon;
}

ElementPolygon ElementPool::polygon(ElementId id) const {
  const Element& element = elements_[id];
  return element.kind == ElementKind::kPatch ? patch_polygon(element)
                                             : triangle_polygon(element, element.shape);
}

void ElementPool::fill_sky(Element& element, uint32_t cell) const {
  element.kind = ElementKind::kSky;
  element.shape = cell;
  element.exitance = kPi * sky_[cell].nits;
}

}  // namespace goldthread
