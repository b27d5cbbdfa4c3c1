// What children owe their parents, and which side of things elements are on.
#include "element/element_pool.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <set>

#include "base/rng.h"
#include "element/small_elements.h"

namespace goldthread {
namespace {

using test::Elements;
using test::Random;

/// Solid angle of a spherical triangle (Van Oosterom and Strackee 1983).
double solid_angle(const std::array<vec3, 3>& c) {
  const dvec3 a(c[0]), b(c[1]), d(c[2]);
  return 2 * std::atan2(std::abs(dot(a, cross(b, d))), 1 + dot(a, b) + dot(b, d) + dot(d, a));
}

void expect_partition(const ElementPool& pool, ElementId id) {
  const Element& parent = pool[id];
  const Element &a = pool[parent.first_child], &b = pool[parent.first_child + 1];
  SCOPED_TRACE("element " + std::to_string(id) + " of kind " + std::to_string(int(parent.kind)));
  for (const Element* child : {&a, &b}) {
    ASSERT_EQ(child->parent, id);
    // Children of surfaces lie within their parent.
    if (parent.kind != ElementKind::kSky) {
      ASSERT_LE(length(child->centre - parent.centre), 1.001f * parent.radius + 1e-5f);
    }
  }
  if (parent.kind == ElementKind::kSky) {
    ASSERT_NEAR(solid_angle(pool.sky_corners(parent.first_child)) +
                    solid_angle(pool.sky_corners(parent.first_child + 1)),
                solid_angle(pool.sky_corners(id)), 1e-6);
    ASSERT_EQ(a.exitance, parent.exitance);
    return;
  }
  // Rounding of coordinates moves the rim of a small element.
  const float tolerance = 1e-4f * parent.area + 1e-6f * parent.radius;
  ASSERT_NEAR(a.area + b.area, parent.area, tolerance);
  ASSERT_LE(length(a.summed_normal + b.summed_normal - parent.summed_normal), tolerance);
  if (parent.kind == ElementKind::kVolume) return;
  ASSERT_EQ(a.depth, std::min(parent.depth + 1, 255));
  ASSERT_EQ(a.back, parent.back);
  ASSERT_EQ(a.part, parent.part);
  ASSERT_LE(length(a.area * a.centre + b.area * b.centre - parent.area * parent.centre),
            tolerance * (parent.radius + length(parent.centre)));
}

void expect_partition_everywhere(const ElementPool& pool) {
  size_t inner = 0;
  for (ElementId id = 0; id < pool.size(); ++id) {
    if (pool[id].first_child == kNoElement) continue;
    ++inner;
    expect_partition(pool, id);
    if (::testing::Test::HasFatalFailure()) return;
  }
  EXPECT_GT(inner, 0u);
}

/// A closed box, once as it is, once mirrored, once turned and scaled evenly, once stretched.
Scene four_boxes(bool double_sided) {
  Scene scene;
  Material paint = test::diffuse(0.5f, 1);
  paint.double_sided = double_sided;
  const uint32_t material = test::add(scene, paint);
  const uint32_t mesh = test::add(scene, shapes::cube(2), material);
  scene.instances.push_back({mesh, test::move({-3, 0, 0}) * test::scale({-1, 1, 1}), 0, {}});
  scene.instances.push_back(
      {mesh, test::move({0, 4, 0}) * test::turn(1, {1, 2, 3}) * test::scale(vec3(2)), 0, {}});
  scene.instances.push_back({mesh, test::move({0, -4, 0}) * test::scale({1, -2, 0.5f}), 0, {}});
  return scene;
}

TEST(ElementPool, ChildrenPartitionTheirParents) {
  Scene scene = four_boxes(true);
  test::add(scene, shapes::sphere(6), 0, test::move({5, 0, 0}));
  test::add(scene, shapes::wavy_grid(9), 0, test::move({5, 5, 0}));
  scene.sky.radiance = vec3(1);
  Elements elements(std::move(scene));
  elements.expand(9);
  expect_partition_everywhere(*elements.pool);
  const auto counts = elements.pool->count_by_kind();
  EXPECT_EQ(counts[0] + counts[1] + counts[2] + counts[3], elements.pool->size());
  EXPECT_GT(counts[2], 0u);
}

RC_GTEST_PROP(ElementPool, ChildrenPartitionTheirParentsInAnyOrder, (uint32_t seed)) {
  Random random(seed);
  Scene scene = four_boxes(seed % 2 == 0);
  shapes::Soup soup;
  for (int i = 0; i < 10; ++i) soup.positions.push_back(random.point());
  for (int t = 0; t < 12; ++t) soup.triangle(random.below(10), random.below(10), random.below(10));
  test::add(scene, soup, 0, test::move({9, 0, 0}));
  Elements elements(std::move(scene));
  elements.expand_some(random, 12, 0.6f);
  expect_partition_everywhere(*elements.pool);
  RC_ASSERT(!::testing::Test::HasFatalFailure());
  for (uint32_t part = 0; part < elements.set->parts.size(); ++part)
    if (elements.pool->leaf_mesh(part) != nullptr) validate(*elements.pool->leaf_mesh(part));
}

TEST(ElementPool, SkyOctantsCoverTheSphere) {
  Scene scene;
  test::add(scene, shapes::cube(), test::add(scene, test::diffuse(0.5f)));
  scene.sky.radiance = vec3(100, 200, 300);
  Elements elements(std::move(scene));
  ASSERT_EQ(elements.pool->lights().size(), 8u);
  elements.expand(7);
  double sum = 0;
  for (const ElementId id : elements.leaves()) {
    if ((*elements.pool)[id].kind != ElementKind::kSky) continue;
    sum += solid_angle(elements.pool->sky_corners(id));
    EXPECT_NEAR((*elements.pool)[id].exitance.y, 200 * kPi, 1e-2f);
    // Directions drawn from a cell lie in it.
    const auto& c = elements.pool->sky_corners(id);
    const vec3 d = elements.pool->sky_direction(id, 0.3f, 0.7f);
    EXPECT_NEAR(length(d), 1, 1e-5f);
    for (int k = 0; k < 3; ++k) EXPECT_LE(dot(d, cross(c[k], c[(k + 1) % 3])), 1e-6f);
  }
  EXPECT_NEAR(sum, 4 * double(kPi), 1e-5);
}

TEST(ElementPool, SkyDirectionsAreSpreadEvenly) {
  // The mean of all directions of an octant is half a unit along each axis.
  Scene scene;
  test::add(scene, shapes::cube(), test::add(scene, test::diffuse(0.5f)));
  scene.sky.radiance = vec3(1);
  const Elements elements(std::move(scene));
  for (const ElementId octant : elements.pool->lights()) {
    vec3 mean(0);
    for (int i = 0; i < 64; ++i)
      for (int j = 0; j < 64; ++j)
        mean +=
            elements.pool->sky_direction(octant, (float(i) + 0.5f) / 64, (float(j) + 0.5f) / 64) / 4096.0f;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(std::abs(mean[k]), 0.5f, 1e-3f);
  }
}

/// Every way to get a point or a normal from an element agrees on the side: away from the box's middle on the
/// front, towards it on the back.
TEST(ElementPool, MirroredAndTwoSidedInstancesFaceTheRightWay) {
  Elements elements(four_boxes(true));
  elements.expand(8);
  const ElementPool& pool = *elements.pool;
  std::vector<vec3> middle;
  for (const Part& part : elements.set->parts) {
    Box box;
    for (const vec3& p : part.positions) box.add(p);
    middle.push_back(box.centre());
  }
  std::array<SurfacePoint, 16> points;
  size_t backs = 0;
  for (ElementId id = 0; id < pool.size(); ++id) {
    const Element& e = pool[id];
    if (e.kind == ElementKind::kVolume) continue;
    const float side = e.back ? -1.0f : 1.0f;
    backs += e.back;
    const auto expect_side = [&](const SurfacePoint& point) {
      ASSERT_NEAR(length(point.normal), 1, 1e-5f);
      ASSERT_GT(side * dot(point.normal, point.position - middle[e.part]), 0)
          << id << " kind " << int(e.kind);
    };
    expect_side(pool.sample_at(id, 0.37f, 0.61f));
    pool.quadrature(id, points);
    for (const SurfacePoint& point : points) expect_side(point);
    if (e.kind == ElementKind::kCluster) continue;
    ASSERT_GT(side * dot(e.summed_normal, e.centre - middle[e.part]), 0);
    const ElementPolygon polygon = pool.polygon(id);
    const vec3 turn = cross(polygon.corners[1] - polygon.corners[0], polygon.corners[2] - polygon.corners[1]);
    ASSERT_GT(dot(turn, e.summed_normal), 0) << id;
  }
  EXPECT_GT(backs, 100u);
}

TEST(ElementPool, SamplesAreEvenByArea) {
  Scene scene;
  const uint32_t material = test::add(scene, test::diffuse(0.5f));
  test::add(scene, shapes::cube(3), material, test::scale({1, 2, 4}));
  test::add(scene, shapes::cube(1), material, test::move({9, 0, 0}));
  const Elements elements(std::move(scene));
  const ElementPool& pool = *elements.pool;
  constexpr int kRoot = 400, kSamples = kRoot * kRoot;
  std::array<double, 7> count{};
  for (int i = 0; i < kRoot; ++i)
    for (int j = 0; j < kRoot; ++j) {
      const SurfacePoint p =
          pool.sample_at(pool.root(), (float(i) + 0.5f) / kRoot, (float(j) + 0.5f) / kRoot);
      if (p.position.x > 5) {
        ++count[6];
        continue;
      }
      const int axis = std::abs(p.normal.x) > 0.9f ? 0 : std::abs(p.normal.y) > 0.9f ? 1 : 2;
      ++count[size_t(2 * axis) + (p.normal[axis] > 0 ? 1 : 0)];
    }
  const double total = 2 * (8 + 4 + 2) + 6;
  const std::array<double, 7> area{8, 8, 4, 4, 2, 2, 6};
  // u is spread in 400 steps, each chooses one place; 2 of them may err at every border between faces.
  for (size_t k = 0; k < 7; ++k) EXPECT_NEAR(count[k] / kSamples, area[k] / total, 2.0 / kRoot) << k;
}

TEST(ElementPool, SamplesKeepOffTheEdges) {
  // On an edge a point is in the next wall as much as before it. These would come out there by rounding.
  Scene scene;
  test::add(scene, shapes::cube(64), test::add(scene, test::diffuse(0.5f)));
  const Elements elements(std::move(scene));
  for (const float u : {0.0f, 1e-7f, 0.3f, 0.99999994f})
    for (const float v : {0.0f, 1e-7f, 0.6f, 0.99999994f}) {
      const SurfacePoint p = elements.pool->sample_at(elements.pool->root(), u, v);
      for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(p.normal[axis]) > 0.5f) continue;
        EXPECT_GT(p.position[axis], 3e-6f) << u << " " << v;
        EXPECT_LT(p.position[axis], 1 - 3e-6f) << u << " " << v;
      }
    }
  // And of triangles of which no two make a polygon.
  Random random(6);
  const auto rough = [&](float, float) { return random.in(0, 0.01f); };
  Scene uneven;
  test::add(uneven, shapes::grid(64, rough), test::add(uneven, test::diffuse(0.5f)));
  const Elements small(std::move(uneven));
  for (const float u : {0.0f, 1e-7f, 0.3f, 0.99999994f})
    for (const float v : {0.0f, 1e-7f, 0.6f, 0.99999994f}) {
      const SurfacePoint p = small.pool->sample_at(small.pool->root(), u, v);
      for (int axis = 0; axis < 2; ++axis) {
        EXPECT_GT(p.position[axis], 3e-6f) << u << " " << v;
        EXPECT_LT(p.position[axis], 1 - 3e-6f) << u << " " << v;
      }
    }
}

TEST(ElementPool, SamplesTowardsAPlaceKeepOffTheEdges) {
  // Seen at a grazing angle, a direction's rounding is far along the plane.
  Scene scene;
  test::add(scene, test::parallelogram({0, 0, 0}, {0, 0, 8}, {4, 0, 0}),
            test::add(scene, test::diffuse(0.5f)));
  const Elements elements(std::move(scene));
  const ElementPool& pool = *elements.pool;
  const ElementId floor = pool.surface_roots()[0];
  Random random(8);
  int drawn = 0;
  for (int k = 0; k < 200000; ++k) {
    const vec3 x(-random.in(0.1f, 3), random.in(0.05f, 0.5f), random.in(1, 7));
    float weight = 0;
    const SurfacePoint y = pool.sample_towards(floor, x, {1, 0, 0}, random.in(0, 1), random.in(0, 1), weight);
    if (!(weight > 0)) continue;
    ++drawn;
    ASSERT_GT(y.position.x, 0) << x.x << " " << x.y << " " << x.z;
    ASSERT_LT(y.position.x, 4) << x.x << " " << x.y << " " << x.z;
    ASSERT_GT(y.position.z, 0) << x.x << " " << x.y << " " << x.z;
    ASSERT_LT(y.position.z, 8) << x.x << " " << x.y << " " << x.z;
  }
  EXPECT_GT(drawn, 100000);
}

TEST(ElementPool, SamplesFillTheTrianglesOfALargeCluster) {
  // Some 330,000 triangles take 18 of the 24 bits of u: the other six would be 64 places in each.
  Scene scene;
  // Rough: hardly any two lie in a plane, of which a place within would be drawn instead.
  Random random(5);
  const auto rough = [&](float, float) { return random.in(0, 0.001f); };
  test::add(scene, shapes::grid(405, rough), test::add(scene, test::diffuse(0.5f)));
  const Elements elements(std::move(scene));
  const ElementPool& pool = *elements.pool;
  const Part& part = elements.set->parts[0];
  const TriangleMesh& mesh = elements.set->tree(part).mesh;
  // Distance of samples from corner 0, as the square root map makes it: squared it is even over 0..1.
  std::set<int> places;
  for (uint32_t i = 0; i < 4096; ++i) {
    const UnitSquarePoint uv = r2_point(i, 7);
    const SurfacePoint p = pool.sample_at(pool.root(), uv.u, uv.v);
    if (p.triangle == kSomeTriangle) continue;
    const UVec3& t = mesh.triangles[p.triangle];
    const vec3 &a = part.positions[t.x], &b = part.positions[t.y], &c = part.positions[t.z];
    const float height = length(area_vector(p.position, b, c)) / length(area_vector(a, b, c));
    places.insert(int((1 - height) * (1 - height) * 2000));
  }
  EXPECT_GT(places.size(), 1500u);
}

TEST(ElementPool, APointOfAFlatClusterIsFoundInTheLeafThatHoldsIt) {
  // Walls are sampled as the polygons that they are, whatever their triangles.
  Elements elements(four_boxes(true));
  elements.expand(9);
  const ElementPool& pool = *elements.pool;
  uint32_t tried = 0, of_some_triangle = 0;
  const auto expect_found = [&](ElementId id, const SurfacePoint& p) {
    const Element& leaf = pool[pool.deepest(id, p)];
    ASSERT_EQ(leaf.first_child, kNoElement);
    const ElementPolygon outline = pool.polygon(pool.deepest(id, p));
    for (size_t k = 0; k < outline.count; ++k) {
      const vec3 &a = outline.corners[k], &b = outline.corners[(k + 1) % outline.count];
      const vec3 inward = cross(normalize(leaf.summed_normal), b - a);
      ASSERT_GE(dot(p.position - a, inward), -1e-5f * length(inward)) << id;
    }
    ASSERT_GT(dot(p.normal, normalize(leaf.summed_normal)), 0.999f);
    ++tried;
    of_some_triangle += p.triangle == kSomeTriangle;
  };
  for (ElementId id = 0; id < pool.size(); ++id) {
    const Element& e = pool[id];
    if (e.kind != ElementKind::kCluster || e.first_child == kNoElement) continue;
    const vec3 before = e.centre + 0.7f * e.radius * normalize_or(e.summed_normal, vec3(0, 0, 1));
    for (uint32_t i = 0; i < 16; ++i) {
      const UnitSquarePoint uv = r2_point(i, id);
      expect_found(id, pool.sample_at(id, uv.u, uv.v));
      float weight = 0;
      const SurfacePoint towards = pool.sample_towards(id, before, vec3(0, 0, 1), uv.u, uv.v, weight);
      if (weight > 0) expect_found(id, towards);
    }
  }
  EXPECT_GT(tried, 1000u);
  EXPECT_GT(of_some_triangle, tried / 2);
}

TEST(ElementPool, StoredSamplesStandForEqualAreas) {
  Scene scene;
  test::add(scene, shapes::flat_grid(16), test::add(scene, test::diffuse(0.5f)), test::scale({3, 1, 1}));
  const Elements elements(std::move(scene));
  const ElementPool& pool = *elements.pool;
  vec3 mean(0);
  for (uint32_t i = 0; i < kStoredSamples; ++i)
    mean += pool.stored_sample(pool.root(), i).position / float(kStoredSamples);
  // Random points would scatter by (0.22, 0.07); stratified ones stay well within that.
  EXPECT_NEAR(mean.x, 1.5f, 0.22f);
  EXPECT_NEAR(mean.y, 0.5f, 0.15f);
}

TEST(ElementPool, LeafElementsCoverEveryFaceOnBothSides) {
  Random random(11);
  Elements elements(four_boxes(true));
  elements.expand_some(random, 10, 0.5f);
  const ElementPool& pool = *elements.pool;
  for (uint32_t part = 0; part < elements.set->parts.size(); ++part)
    for (const bool back : {false, true}) {
      const std::vector<ElementId> leaf = pool.leaf_elements(part, back);
      const LeafMesh* mesh = pool.leaf_mesh(part);
      ASSERT_EQ(leaf.size(), mesh != nullptr
                                 ? mesh->face_count()
                                 : elements.set->tree(elements.set->parts[part]).mesh.triangles.size());
      for (const ElementId id : leaf) {
        ASSERT_NE(id, kNoElement);
        EXPECT_EQ(pool[id].first_child, kNoElement);
        EXPECT_EQ(pool[id].part, part);
        EXPECT_EQ(pool[id].back, back);
      }
    }
}

TEST(ElementPool, ExpandIsForTheChildlessOnly) {
  Elements elements(four_boxes(false));
  elements.expand(3);
  const size_t size = elements.pool->size();
  std::vector<ElementId> inner;
  for (ElementId id = 0; id < size; ++id)
    if ((*elements.pool)[id].first_child != kNoElement) inner.push_back(id);
  elements.pool->expand(inner);
  EXPECT_EQ(elements.pool->size(), size);
}

TEST(ElementPool, NoSurfaceNoRoot) {
  Scene scene;
  test::add(scene, test::diffuse(0.5f));
  scene.sky.radiance = vec3(1);
  const Elements elements(std::move(scene));
  EXPECT_EQ(elements.pool->root(), kNoElement);
}

/// A square of two triangles, both cut along x = 0.3.
struct CutSquare : Elements {
  std::vector<ElementId> triangles;

  explicit CutSquare(bool seam) : Elements(square()) {
    while (triangles.size() < 2) {
      triangles.clear();
      for (const ElementId id : leaves())
        if ((*pool)[id].kind == ElementKind::kTriangle) triangles.push_back(id);
      if (triangles.size() < 2) expand(1);
    }
    const CutPlane plane{{1, 0, 0}, 0.3f, seam ? Seam::kGap : Seam::kNone};
    pool->expand(triangles, std::vector<CutPlane>(2, plane));
  }
  static Scene square() {
    Scene scene;
    test::add(scene, test::square(1, 0, true), test::diffuse(0.5f));
    return scene;
  }
};

TEST(ElementPool, CutsAlongAPlaneWhereAsked) {
  const CutSquare square(true);
  for (const ElementId id : square.triangles) {
    const ElementId child = (*square.pool)[id].first_child;
    ASSERT_NE(child, kNoElement);
    for (uint32_t c = 0; c < 2; ++c) {
      const ElementPolygon polygon = square.pool->polygon(child + c);
      float least = 2, most = -2;
      for (const vec3& p : polygon.span()) {
        least = std::min(least, p.x);
        most = std::max(most, p.x);
      }
      EXPECT_TRUE(std::abs(most - 0.3f) < 1e-6f || std::abs(least - 0.3f) < 1e-6f) << least << " " << most;
    }
  }
  // The second triangle meets the vertex that the first cut made on their common edge: three new ones in all.
  const LeafMesh* mesh = square.pool->leaf_mesh(0);
  ASSERT_NE(mesh, nullptr);
  EXPECT_EQ(mesh->positions().size(), 4u + 3);
  EXPECT_EQ(mesh->face_count(), 4u);
  validate(*mesh);
}

TEST(ElementPool, APlaneThatMissesGivesTheRegularCut) {
  Elements elements(CutSquare::square());
  elements.expand(1);
  std::vector<ElementId> triangles;
  for (const ElementId id : elements.leaves())
    if (elements.pool->operator[](id).kind == ElementKind::kTriangle) triangles.push_back(id);
  ASSERT_FALSE(triangles.empty());
  elements.pool->expand(triangles,
                        std::vector<CutPlane>(triangles.size(), CutPlane{{1, 0, 0}, 7, Seam::kSharp}));
  for (const ElementId id : triangles) EXPECT_NE((*elements.pool)[id].first_child, kNoElement);
  EXPECT_FALSE(elements.pool->leaf_mesh(0)->has_seams());
}

TEST(ElementPool, CutsOfASeamStaySeams) {
  CutSquare square(true);
  square.expand(5);
  const LeafMesh& mesh = *square.pool->leaf_mesh(0);
  double seam = 0;
  for (uint32_t f = 0; f < mesh.face_count(); ++f) {
    uint32_t edge = mesh.first_edge(f);
    do {
      const vec3 a = mesh.positions()[mesh.origin(edge)], b = mesh.positions()[mesh.origin(mesh.next(edge))];
      const bool on_line = std::abs(a.x - 0.3f) < 1e-6f && std::abs(b.x - 0.3f) < 1e-6f;
      EXPECT_EQ(mesh.seam(edge) != Seam::kNone, on_line);
      if (mesh.seam(edge) != Seam::kNone) seam += double(length(b - a));
      edge = mesh.next(edge);
    } while (edge != mesh.first_edge(f));
  }
  EXPECT_NEAR(seam, 2 * 2, 1e-5);  // two metres, from both sides
  EXPECT_FALSE(CutSquare(false).pool->leaf_mesh(0)->has_seams());
}

}  // namespace
}  // namespace goldthread
