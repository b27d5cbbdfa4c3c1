// Surfaces in one place: every place has one owner.
#include "element/overlap.h"

#include <gtest/gtest.h>

#include "element/paint.h"
#include "element/small_elements.h"

namespace goldthread {
namespace {

/// A scene of plates in z = 0, all of whose triangles are said to overlap.
struct Plates {
  Scene scene;
  SurfaceSet set;

  void add(const shapes::Soup& soup, Material material) {
    test::add(scene, soup, test::add(scene, std::move(material)));
  }
  /// The unit square, facing up.
  void add_square(Material material) {
    add(test::parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), std::move(material));
  }
  const SurfaceSet& settle() {
    set = build_surfaces(scene, CancelToken());
    std::vector<std::pair<uint32_t, uint32_t>> covered;
    for (uint32_t a = 0; a < set.triangles; ++a)
      for (uint32_t b = 0; b < set.triangles; ++b)
        if (&part_of_triangle(set, a) != &part_of_triangle(set, b) && contends_for_place(set, a) &&
            contends_for_place(set, b) && owns_place(set, b, a))
          covered.emplace_back(a, b);
    settle_overlaps(set, covered, 1e-5f);
    return set;
  }
};

Material two_sided(Material material) {
  material.double_sided = true;
  return material;
}

TEST(Overlap, TheFirstOwnsWhatBothCover) {
  Plates plates;
  plates.add_square(test::diffuse(0.8f));
  plates.add_square(test::diffuse(0.4f));
  const SurfaceSet& set = plates.settle();
  EXPECT_FLOAT_EQ(set.parts[0].coverage, 1);
  EXPECT_FLOAT_EQ(set.parts[0].reflectance.x, 0.8f);
  EXPECT_FLOAT_EQ(set.parts[1].coverage, 0);
  EXPECT_EQ(set.parts[1].reflectance, vec3(0));
  EXPECT_GT(set.overlapping, 0u);
}

TEST(Overlap, OnlyThePartThatIsCovered) {
  Plates plates;
  plates.add(test::parallelogram({0, 0, 0}, {0.25f, 0, 0}, {0, 0.5f, 0}), test::diffuse(0.2f));
  plates.add_square(test::diffuse(0.8f));
  const SurfaceSet& set = plates.settle();
  EXPECT_FLOAT_EQ(set.parts[0].coverage, 1);
  EXPECT_NEAR(set.parts[1].coverage, 1 - 0.125f, 0.01f);
  EXPECT_NEAR(set.parts[1].reflectance.x, 0.8f * (1 - 0.125f), 0.01f);
  const Part& wall = set.parts[1];
  for (uint32_t t = 0; t < 2; ++t)
    for (const vec2 w : {vec2(0.1f, 0.1f), vec2(0.1f, 0.8f), vec2(0.8f, 0.1f), vec2(0.3f, 0.3f)}) {
      const UVec3& c = set.tree(wall).mesh.triangles[t];
      const vec3 p =
          (1 - w.x - w.y) * wall.positions[c.x] + w.x * wall.positions[c.y] + w.y * wall.positions[c.z];
      const bool covered = p.x < 0.25f && p.y < 0.5f;
      EXPECT_EQ(is_covered(set, wall, t, p), covered) << p.x << " " << p.y;
      EXPECT_FLOAT_EQ(paint_at(set, wall, t, w).coverage, covered ? 0.0f : 1.0f);
      EXPECT_FLOAT_EQ(paint_at(set, wall, t, w).reflectance.x, covered ? 0.0f : 0.8f);
    }
}

TEST(Overlap, ElementsTakeTheShareThatIsTheirs) {
  // Refined below the triangle, patches are wholly covered or wholly open.
  Plates plates;
  plates.add(test::parallelogram({0, 0, 0}, {0.5f, 0, 0}, {0, 1, 0}), test::diffuse(0.2f));
  plates.add_square(test::diffuse(0.8f));
  const SurfaceSet& set = plates.settle();
  ElementPool pool(set);
  for (int round = 0; round < 10; ++round) {
    std::vector<ElementId> childless;
    for (ElementId id = 0; id < pool.size(); ++id)
      if (pool[id].first_child == kNoElement && !pool[id].indivisible) childless.push_back(id);
    pool.expand(childless);
  }
  double covered = 0, area = 0;
  for (ElementId id = 0; id < pool.size(); ++id) {
    if (pool[id].first_child != kNoElement || pool[id].part != 1) continue;
    covered += double(pool[id].area * (1 - pool[id].coverage));
    area += double(pool[id].area);
  }
  EXPECT_NEAR(area, 1, 1e-5);
  EXPECT_NEAR(covered, 0.5, 0.01);
}

TEST(Overlap, OppositeFacesAreAPlateAndKeepTheirLight) {
  Plates plates;
  plates.add_square(test::diffuse(0.8f));
  plates.add(test::turned(test::parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0})), test::diffuse(0.4f));
  const SurfaceSet& set = plates.settle();
  for (const Part& part : set.parts) EXPECT_FLOAT_EQ(part.coverage, 1);
  EXPECT_EQ(set.overlapping, 0u);
}

TEST(Overlap, AMirroredInstanceFacesTheOtherWay) {
  Plates plates;
  plates.add_square(test::diffuse(0.8f));
  test::add(plates.scene, test::turned(test::parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0})),
            test::add(plates.scene, test::diffuse(0.4f)), test::scale({1, 1, -1}));
  const SurfaceSet& set = plates.settle();
  ASSERT_EQ(set.parts[1].winding, -1);
  EXPECT_FLOAT_EQ(set.parts[1].coverage, 0);  // turned twice: it faces up as well
}

TEST(Overlap, TwoSidedOwnsBothSides) {
  Plates plates;
  plates.add_square(test::diffuse(0.8f));
  plates.add(test::turned(test::parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0})), test::diffuse(0.6f));
  plates.add_square(two_sided(test::diffuse(0.4f)));
  const SurfaceSet& set = plates.settle();
  EXPECT_FLOAT_EQ(set.parts[0].coverage, 0);
  EXPECT_FLOAT_EQ(set.parts[1].coverage, 0);
  EXPECT_FLOAT_EQ(set.parts[2].coverage, 1);
}

TEST(Overlap, ALampIsNotBuried) {
  Plates plates;
  plates.add_square(test::diffuse(0.8f));
  plates.add_square(test::diffuse(0.2f, 100));
  const SurfaceSet& set = plates.settle();
  EXPECT_FLOAT_EQ(set.parts[0].coverage, 0);
  EXPECT_FLOAT_EQ(set.parts[1].coverage, 1);
  EXPECT_NEAR(set.parts[1].exitance.x, 100, 1e-3);
}

TEST(Overlap, OfTwoLampsTheBrighterOwns) {
  Plates plates;
  plates.add_square(test::diffuse(0.8f, 1));
  plates.add_square(test::diffuse(0.2f, 100));
  const SurfaceSet& set = plates.settle();
  EXPECT_FLOAT_EQ(set.parts[0].coverage, 0);
  EXPECT_FLOAT_EQ(set.parts[1].coverage, 1);
}

TEST(Overlap, AOneSidedLampDoesNotTakeTheOtherSide) {
  Plates plates;
  plates.add_square(two_sided(test::diffuse(0.8f)));
  plates.add_square(test::diffuse(0.2f, 100));
  const SurfaceSet& set = plates.settle();
  EXPECT_FLOAT_EQ(set.parts[0].coverage, 1);
  EXPECT_FLOAT_EQ(set.parts[1].coverage, 1);
}

TEST(Overlap, ClaimsAreAStrictOrder) {
  Plates plates;
  for (const bool both : {false, true})
    for (const float light : {0.0f, 5.0f, 100.0f}) {
      Material material = test::diffuse(0.5f, light);
      material.double_sided = both;
      plates.add_square(material);
      plates.add(test::turned(test::parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0})), material);
    }
  const SurfaceSet& set = plates.settle();
  const auto n = static_cast<uint32_t>(set.triangles);
  for (uint32_t a = 0; a < n; ++a) {
    EXPECT_FALSE(owns_place(set, a, a));
    for (uint32_t b = 0; b < n; ++b) {
      EXPECT_FALSE(owns_place(set, a, b) && owns_place(set, b, a));
      for (uint32_t c = 0; c < n; ++c)
        if (owns_place(set, a, b) && owns_place(set, b, c)) {
          EXPECT_TRUE(owns_place(set, a, c)) << a << " " << b << " " << c;
        }
    }
  }
}

TEST(Overlap, AlphaAndUnlitTakeNoPart) {
  Material glass = test::diffuse(0.4f), sign = test::diffuse(0.4f);
  glass.alpha_mode = AlphaMode::kBlend;
  glass.alpha = 0.5f;
  sign.unlit = true;
  Plates plates;
  plates.add_square(glass);
  plates.add_square(sign);
  plates.add_square(test::diffuse(0.8f));
  const SurfaceSet& set = plates.settle();
  EXPECT_FLOAT_EQ(set.parts[0].coverage, 0.5f);
  EXPECT_FLOAT_EQ(set.parts[2].coverage, 1);
  EXPECT_EQ(set.overlapping, 0u);
}

TEST(LiesOnTriangle, InsideOnEdgesAndBeside) {
  const vec3 a(0, 0, 0), b(2, 0, 0), c(0, 1, 0);
  EXPECT_TRUE(lies_on_triangle({0.5f, 0.25f, 0}, a, b, c, 1e-6f));
  EXPECT_TRUE(lies_on_triangle({1, 0, 0}, a, b, c, 1e-6f));
  EXPECT_TRUE(lies_on_triangle({1, 0.5f, 0}, a, b, c, 1e-6f));
  EXPECT_TRUE(lies_on_triangle(b, a, b, c, 1e-6f));
  EXPECT_FALSE(lies_on_triangle({1.1f, 0.5f, 0}, a, b, c, 1e-6f));
  EXPECT_FALSE(lies_on_triangle({0.5f, -0.01f, 0}, a, b, c, 1e-6f));
  EXPECT_FALSE(lies_on_triangle({0.5f, 0.25f, 0.001f}, a, b, c, 1e-6f));
  EXPECT_TRUE(lies_on_triangle({0.5f, 0.25f, 0.001f}, a, b, c, 1e-2f));
  EXPECT_FALSE(lies_on_triangle(a, a, a, c, 1e-6f));  // no triangle at all
}

}  // namespace
}  // namespace goldthread
