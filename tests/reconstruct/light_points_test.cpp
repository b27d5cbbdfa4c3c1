// Light points and the meshes that are written: creases, seams, T-vertices, areas.
#include "reconstruct/light_points.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>
#include <set>

#include "element/small_elements.h"

namespace goldthread {
namespace {

using test::Elements;
using test::Random;

Primitive& first_primitive(Scene& scene) {
  return scene.meshes[0].primitives[0];
}

Scene scene_of(const shapes::Soup& soup, const mat4& transform = mat4(1)) {
  Scene scene;
  test::add(scene, soup, test::add(scene, test::diffuse(0.5f)), transform);
  return scene;
}

Scene smooth_sphere(uint32_t rings) {
  Scene scene = scene_of(shapes::sphere(rings));
  first_primitive(scene).normals = first_primitive(scene).positions;
  return scene;
}

/// World positions of an output mesh's vertices, from their origins.
std::vector<vec3> positions_of(const Elements& elements, uint32_t part, const LitPrimitive& lit) {
  const Part& placed = elements.set->parts[part];
  const Instance& instance = elements.scene->instances[placed.instance];
  const Primitive& primitive = elements.scene->meshes[instance.mesh].primitives[placed.primitive];
  std::vector<vec3> local;
  if (lit.source_mesh) {
    local = primitive.positions;
  } else {
    for (const VertexOrigin& o : lit.origins) {
      const uint32_t* c = &primitive.indices[3 * size_t{o.triangle}];
      local.push_back((1 - o.weights.x - o.weights.y) * primitive.positions[c[0]] +
                      o.weights.x * primitive.positions[c[1]] + o.weights.y * primitive.positions[c[2]]);
    }
  }
  for (vec3& p : local) p = vec3(instance.transform * vec4(p, 1));
  return local;
}

std::vector<UVec3> faces_of(const Elements& elements, uint32_t part, const LitPrimitive& lit) {
  if (!lit.source_mesh) return lit.faces;
  const Part& placed = elements.set->parts[part];
  const Primitive& p =
      elements.scene->meshes[elements.scene->instances[placed.instance].mesh].primitives[placed.primitive];
  std::vector<UVec3> faces;
  for (size_t i = 0; i < p.indices.size(); i += 3)
    faces.push_back({p.indices[i], p.indices[i + 1], p.indices[i + 2]});
  return faces;
}

struct Output {
  PartPoints points;
  std::vector<uint32_t> point_of_vertex;
  LitPrimitive lit;
  std::vector<vec3> positions;
  std::vector<UVec3> faces;

  Output(const Elements& elements, uint32_t part) : points(collect_light_points(*elements.pool, part)) {
    lit = build_output_mesh(*elements.pool, part, points, point_of_vertex);
    positions = positions_of(elements, part, lit);
    faces = faces_of(elements, part, lit);
  }
};

TEST(LightPoints, ACreaseHasOnePointASide) {
  const Elements elements(scene_of(shapes::cube(1)));
  const PartPoints points = collect_light_points(*elements.pool, 0);
  EXPECT_EQ(points.points.size(), 24u);  // eight corners, three faces each
  ASSERT_EQ(points.corner_first.size(), 13u);
  for (size_t f = 0; f < 12; ++f)
    for (uint32_t i = points.corner_first[f]; i < points.corner_first[f + 1]; ++i) {
      const LightPoint& p = points.points[points.corners[i]];
      // On the unit cube the normal's axis is that of a coordinate which is 0 or 1 with its sign.
      const int axis = std::abs(p.normal.x) > 0.9f ? 0 : std::abs(p.normal.y) > 0.9f ? 1 : 2;
      EXPECT_NEAR(p.position[axis], p.normal[axis] > 0 ? 1 : 0, 1e-6f);
    }
}

TEST(LightPoints, SmoothNormalsShareOnePoint) {
  const Elements elements(smooth_sphere(8));
  const PartPoints points = collect_light_points(*elements.pool, 0);
  EXPECT_EQ(points.points.size(), 7u * 16 + 2);
  for (const LightPoint& p : points.points) EXPECT_GT(dot(p.normal, normalize(p.position)), 0.999f);
}

TEST(LightPoints, FlatFacesMeetInOnePoint) {
  const Elements elements(scene_of(shapes::flat_grid(5)));
  EXPECT_EQ(collect_light_points(*elements.pool, 0).points.size(), 36u);
}

TEST(LightPoints, NormalsThatLeanAgainstTheirFaceAreLeftAlone) {
  Scene scene = scene_of(shapes::flat_grid(2));
  first_primitive(scene).normals.assign(9, vec3(0, 0, -1));
  const Elements elements(std::move(scene));
  for (const LightPoint& p : collect_light_points(*elements.pool, 0).points) EXPECT_GT(p.normal.z, 0.99f);
}

TEST(LightPoints, MirroredInstancesKeepTheirFront) {
  const Elements elements(scene_of(shapes::cube(2), test::scale({-1, 2, 1})));
  for (const LightPoint& p : collect_light_points(*elements.pool, 0).points)
    EXPECT_GT(dot(p.normal, p.position - vec3(-0.5f, 1, 0.5f)), 0);
}

TEST(OutputMesh, UncutAndSmoothIsTheSource) {
  const Elements elements(smooth_sphere(6));
  const Output out(elements, 0);
  EXPECT_TRUE(out.lit.source_mesh);
  EXPECT_TRUE(out.lit.faces.empty());
  ASSERT_EQ(out.point_of_vertex.size(), elements.scene->meshes[0].primitives[0].positions.size());
  for (size_t v = 0; v < out.point_of_vertex.size(); ++v) {
    if (out.point_of_vertex[v] == kNoPoint) continue;  // the poles' doubles
    EXPECT_NEAR(length(out.points.points[out.point_of_vertex[v]].position - out.positions[v]), 0, 1e-6f);
  }
}

TEST(OutputMesh, ASharedVertexAtACreaseIsSplit) {
  shapes::Soup roof;
  roof.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 1}, {0, -1, 1}};
  roof.indices = {0, 1, 2, 1, 0, 3};
  const Elements elements(scene_of(roof));
  const Output out(elements, 0);
  EXPECT_FALSE(out.lit.source_mesh);
  EXPECT_EQ(out.lit.faces.size(), 2u);
  EXPECT_EQ(out.lit.origins.size(), 6u);
}

/// Every edge is shared by two faces, or is open and has no vertex on it. Vertices are told apart by
/// position, since attributes split them.
void expect_no_t_vertices(const Output& out) {
  std::map<std::array<float, 3>, uint32_t> number;
  std::vector<vec3> places;
  std::vector<uint32_t> place(out.positions.size());
  for (size_t v = 0; v < out.positions.size(); ++v) {
    // Weights are rounded, each triangle of a shared edge in its own way; the light point is where it was
    // cut.
    const vec3 p = out.points.points[out.point_of_vertex[v]].position;
    const auto [entry, added] = number.try_emplace({p.x, p.y, p.z}, uint32_t(places.size()));
    if (added) places.push_back(p);
    place[v] = entry->second;
    ASSERT_LT(length(p - out.positions[v]), 1e-4f);
  }
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const UVec3& f : out.faces)
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = place[f[k]], b = place[f[(k + 1) % 3]];
      ++edges[{std::min(a, b), std::max(a, b)}];
    }
  for (const auto& [edge, count] : edges) {
    if (count == 2) continue;
    ASSERT_EQ(count, 1);
    const vec3 a = places[edge.first], d = places[edge.second] - a;
    for (uint32_t v = 0; v < places.size(); ++v) {
      if (v == edge.first || v == edge.second) continue;
      const float t = dot(places[v] - a, d) / dot(d, d);
      if (t < 1e-4f || t > 1 - 1e-4f) continue;
      ASSERT_GT(length(places[v] - a - t * d), 1e-4f * length(d)) << "vertex " << v << " on an open edge";
    }
  }
}

double total_area(const Output& out, double& backwards, const std::vector<vec3>& source_normals) {
  double sum = 0;
  backwards = 0;
  for (size_t f = 0; f < out.faces.size(); ++f) {
    const UVec3& t = out.faces[f];
    const vec3 area = area_vector(out.positions[t.x], out.positions[t.y], out.positions[t.z]);
    sum += double(length(area));
    const uint32_t parent = out.lit.source_mesh ? uint32_t(f) : out.lit.face_parents[f];
    if (dot(area, source_normals[parent]) < 0) backwards += double(length(area));
  }
  return sum;
}

void expect_sound(const Elements& elements, uint32_t part) {
  const Output out(elements, part);
  const Part& placed = elements.set->parts[part];
  const Instance& instance = elements.scene->instances[placed.instance];
  const Primitive& p = elements.scene->meshes[instance.mesh].primitives[placed.primitive];
  std::vector<vec3> normals;
  double source = 0;
  for (size_t i = 0; i < p.indices.size(); i += 3) {
    std::array<vec3, 3> c;
    for (size_t k = 0; k < 3; ++k) c[k] = vec3(instance.transform * vec4(p.positions[p.indices[i + k]], 1));
    normals.push_back(area_vector(c[0], c[1], c[2]));
    source += double(length(normals.back()));
  }
  double backwards = 0;
  EXPECT_NEAR(total_area(out, backwards, normals) / source, 1, 1e-4);
  EXPECT_LT(backwards, 1e-6 * source);  // wound as the source
  for (const VertexOrigin& o : out.lit.origins) {
    ASSERT_GE(o.weights.x, 0);
    ASSERT_GE(o.weights.y, 0);
    ASSERT_LE(o.weights.x + o.weights.y, 1.00001f);
  }
  expect_no_t_vertices(out);
}

TEST(OutputMesh, CutsEverywhere) {
  Elements elements(scene_of(shapes::cube(2)));
  elements.expand(9);
  expect_sound(elements, 0);
}

RC_GTEST_PROP(OutputMesh, AnyCutsLeaveNoTVertexAndKeepArea, (uint32_t seed)) {
  Random random(seed);
  const mat4 place =
      seed % 3 == 0 ? test::scale({-1, 1, 1}) : test::turn(random.in(0, 6), random.direction());
  const shapes::Soup soup = seed % 2 == 0 ? shapes::wavy_grid(4) : shapes::cube(2);
  Elements elements(scene_of(soup, place));
  elements.expand_some(random, 14, 0.6f);
  expect_sound(elements, 0);
  RC_ASSERT(!::testing::Test::HasFailure());
}

TEST(OutputMesh, SourceCornersStayExactCorners) {
  Elements elements(scene_of(shapes::wavy_grid(3)));
  elements.expand(8);
  const Output out(elements, 0);
  ASSERT_FALSE(out.lit.source_mesh);
  const Primitive& p = elements.scene->meshes[0].primitives[0];
  std::set<uint32_t> corners;
  for (const VertexOrigin& o : out.lit.origins) {
    const bool corner = o.weights == vec2(0, 0) || o.weights == vec2(1, 0) || o.weights == vec2(0, 1);
    if (!corner) continue;
    const uint32_t k = o.weights.x == 1 ? 1 : o.weights.y == 1 ? 2 : 0;
    corners.insert(p.indices[3 * size_t{o.triangle} + k]);
  }
  EXPECT_EQ(corners.size(), p.positions.size());
}

/// A square whose triangles are cut along x = 0.3, cut on regularly `times` over on one side of it.
Elements square_with_seam(bool seam, int times) {
  Elements elements(scene_of(test::square(1, 0, true)));
  elements.expand(1);
  std::vector<ElementId> triangles;
  for (const ElementId id : elements.leaves())
    if ((*elements.pool)[id].kind == ElementKind::kTriangle) triangles.push_back(id);
  elements.pool->expand(
      triangles,
      std::vector<CutPlane>(triangles.size(), CutPlane{{1, 0, 0}, 0.3f, seam ? Seam::kSharp : Seam::kNone}));
  for (int i = 0; i < times; ++i) {
    std::vector<ElementId> beyond;
    for (const ElementId id : elements.leaves())
      if ((*elements.pool)[id].centre.x > 0.3f) beyond.push_back(id);
    elements.pool->expand(beyond);
  }
  return elements;
}

// Two lights at every vertex of the seam, one for the faces on either side; nothing else changes.
TEST(LightPoints, ASeamPartsTheLightOfItsSides) {
  for (const int times : {0, 4}) {
    const Elements with = square_with_seam(true, times), without = square_with_seam(false, times);
    const PartPoints parted = collect_light_points(*with.pool, 0),
                     joined = collect_light_points(*without.pool, 0);
    std::set<uint32_t> on_seam;
    for (const LightPoint& p : joined.points)
      if (std::abs(p.position.x - 0.3f) < 1e-6f) on_seam.insert(p.vertex);
    EXPECT_GE(on_seam.size(), 3u);
    EXPECT_EQ(parted.points.size(), joined.points.size() + on_seam.size());
    for (uint32_t f = 0; f + 1 < parted.corner_first.size(); ++f)
      for (uint32_t c = parted.corner_first[f]; c < parted.corner_first[f + 1]; ++c) {
        const LightPoint& p = parted.points[parted.corners[c]];
        if (std::abs(p.position.x - 0.3f) > 1e-6f) continue;
        const bool beyond = parted.face_centres[f].x > 0.3f;
        EXPECT_EQ(parted.face_centres[p.face].x > 0.3f, beyond);
        EXPECT_EQ(parted.sides_of(p.vertex, p.position, parted.face_centres[f]), p.sides);
      }
    expect_sound(with, 0);
  }
}

}  // namespace
}  // namespace goldthread
