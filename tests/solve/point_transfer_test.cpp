// What the solver takes for far, against Lambert's formula in double precision.
#include "solve/hierarchical/point_transfer.h"

#include <gtest/gtest.h>

#include <map>

#include "element/small_elements.h"
#include "math/far_form_factor.h"
#include "math/polygon_exchange.h"

namespace goldthread {
namespace {

using test::Elements;
using test::Random;

/// One element's triangles, or its polygon, as they are.
double exact_factor(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n) {
  const Element& e = pool[source];
  if (e.kind == ElementKind::kTriangle || e.kind == ElementKind::kPatch) {
    std::vector<dvec3> corners;
    const ElementPolygon polygon = pool.polygon(source);
    for (const vec3& corner : polygon.span()) corners.emplace_back(corner);
    return point_form_factor(x, n, corners);
  }
  const Part& part = pool.surfaces().parts[e.part];
  const FaceClusterTree& tree = pool.surfaces().tree(part);
  const FaceCluster& node = tree.nodes[e.shape];
  double sum = 0;
  for (uint32_t t = node.first; t < node.first + node.count; ++t) {
    const UVec3& corner = tree.mesh.triangles[t];
    std::array<dvec3, 3> corners{part.positions[corner.x], part.positions[corner.y],
                                 part.positions[corner.z]};
    if ((part.winding < 0) != e.back) std::swap(corners[1], corners[2]);
    sum += point_form_factor(x, n, corners);
  }
  return sum;
}

shapes::Soup squeezed(Random& random, shapes::Soup soup) {
  const mat3 turn(test::turn(random.in(0, 6), random.direction()));
  const vec3 by(1, std::exp2(random.in(-4, 0)), std::exp2(random.in(-4, 0)));
  for (vec3& p : soup.positions) p = turn * (by * p);
  return soup;
}

/// A strip bent by up to `angle` either way.
shapes::Soup bent_strip(float angle, uint32_t pieces) {
  shapes::Soup soup = shapes::grid(pieces, [](float, float) { return 0.0f; });
  for (vec3& p : soup.positions) {
    const float a = angle * (2 * p.x - 1);
    p = {std::sin(a), p.y, std::cos(a)};
  }
  return soup;
}

shapes::Soup disc(uint32_t corners) {
  std::vector<vec3> rim;
  for (uint32_t i = 0; i < corners; ++i) {
    const float a = 2 * kPi * static_cast<float>(i) / static_cast<float>(corners);
    rim.emplace_back(std::cos(a), std::sin(a), 0);
  }
  return test::polygon(rim);
}

shapes::Soup shape_number(Random& random, uint32_t number) {
  switch (number % 8) {
    case 0:
      return test::polygon({random.point(), random.point(), random.point()});
    case 1:
      return disc(64);
    case 2:
      return shapes::cube(4);
    case 3:
      return shapes::sphere(10);
    case 4:
      return bent_strip(random.in(0.02f, 1.5f), 12);
    case 5:
      return shapes::wavy_grid(12);
    case 6:
      return shapes::flat_grid(6);
    default:
      return shapes::spiked_plate(8);
  }
}

/// Asks for transfers of elements of many shapes from everywhere; calls check(element, factor, error, bound).
template <typename Check>
void ask_everywhere(uint32_t shapes, int points, const Check& check) {
  for (uint32_t i = 0; i < shapes; ++i) {
    Random random(i);
    Scene scene;
    Material material = test::diffuse(0.5f, i % 3 == 0 ? 1.0f : 0.0f);
    material.double_sided = i % 5 == 0;
    test::add(scene, squeezed(random, shape_number(random, i)), test::add(scene, material),
              test::scale(vec3(i % 2 == 0 ? 1.0f : -1.0f, 1, 1)));
    Elements elements(std::move(scene));
    elements.expand(static_cast<int>(random.below(8)));
    const ElementPool& pool = *elements.pool;
    for (int k = 0; k < points; ++k) {
      const auto source = ElementId(random.below(uint32_t(pool.size())));
      const Element& e = pool[source];
      if (e.kind == ElementKind::kVolume || !is_surface(e.kind)) continue;
      const vec3 away = std::exp2(random.in(-1, 6)) * e.radius * random.direction();
      const vec3 x = e.centre + away;
      vec3 n = random.direction();
      if (k % 3 == 0)
        n = normalize(n - dot(n, away) / dot(away, away) * away - 0.1f * random.in(0, 1) * away);
      const double exact = exact_factor(pool, source, x, n);
      const double factor = std::max(0.0f, dot(n, point_transfer(pool, source, x, n)));
      check(e, exact, std::abs(factor - exact), point_transfer_error_bound(pool, source, x, n));
    }
  }
}

struct Errors {
  double worst = 0;
  std::vector<double> times;  // that the bound is larger
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

TEST(PointTransfer, ErrsByNoMoreThanItsBound) {
  size_t asked = 0, missed = 0;
  std::map<ElementKind, Errors> errors;
  ask_everywhere(800, 400, [&](const Element& e, double exact, double error, double bound) {
    ++asked;
    if (!(error <= bound + 1e-5 * (1 + exact))) ++missed;
    Errors& of_kind = errors[e.kind];
    of_kind.worst = std::max(of_kind.worst, error);
    if (bound > 1e-5) of_kind.times.push_back(bound / std::max(error, 1e-9));
  });
  EXPECT_GT(asked, 300000u);
  EXPECT_EQ(missed, 0u);
  // One piece each: what the header says was seen, and far less than it allows.
  EXPECT_LE(errors[ElementKind::kTriangle].worst, 3e-4);
  EXPECT_LE(errors[ElementKind::kPatch].worst, 9e-4);
  EXPECT_LE(errors[ElementKind::kCluster].worst, 0.01);  // of all its pieces
  // Measured: 6, 5 and 53.
  EXPECT_LE(median(errors[ElementKind::kTriangle].times), 9);
  EXPECT_LE(median(errors[ElementKind::kPatch].times), 8);
  EXPECT_LE(median(errors[ElementKind::kCluster].times), 80);
}

TEST(PointTransfer, ATriangleOrPatchThatIsTakenForFarErrsByNoMoreThanStated) {
  // The bounds at the limit of what is accepted, over all distances, angles and shapes.
  const auto tolerance = static_cast<double>(kPieceTolerance);
  double triangle = 0, patch = 0;
  for (double ratio = 0.01; ratio < 0.5; ratio += 0.01)
    for (double cosine = 1; cosine > 1e-3; cosine *= 0.95)
      for (double spread = 0; spread <= 1; spread += 0.05) {
        FarPiece piece;
        piece.flat = true;
        piece.radius = ratio;
        piece.to_centroid = {0, 0, 1};
        // Q cosine R^2 is the tolerance.
        piece.area = tolerance / (ratio * ratio) * std::numbers::pi / cosine;
        piece.summed_normal = piece.area * dvec3(std::sqrt(1 - cosine * cosine), 0, -cosine);
        const auto bound = [&](double largest_moment, double rho_squared) {
          piece.second_moment = largest_moment;
          piece.deviation = 0.5 * largest_moment * spread;
          const dvec3 seen_best(0, 0, 1), askew = normalize(dvec3(0.9, 0, 0.1));
          return std::max(
              flat_dipole_error_bound(piece, seen_best, rho_squared),
              std::max(flat_dipole_error_bound(piece, askew, rho_squared), dipole_error_bound(piece)));
        };
        const double squared = ratio * ratio;
        triangle = std::max(triangle, bound(0.25 * squared, 0.5 * squared));
        for (const double share : {0.0, 0.5, 1.0})
          patch = std::max(patch, bound(0.5 * squared, share * squared));
      }
  EXPECT_LE(triangle, 5.5 * tolerance);
  EXPECT_GE(triangle, 5.0 * tolerance);
  EXPECT_LE(patch, 11 * tolerance);
  EXPECT_GE(patch, 10 * tolerance);
}

TEST(PointTransfer, AWallIsExactHoweverItIsCut) {
  Random random(3);
  for (const uint32_t n : {2u, 5u, 32u}) {
    Scene scene;
    Material paint = test::diffuse(0.5f);
    paint.double_sided = true;
    test::add(scene, shapes::flat_grid(n), test::add(scene, paint),
              test::turn(1, {3, 1, 2}) * test::scale(vec3(2, -2, 2)));
    const Elements elements(std::move(scene));
    const ElementPool& pool = *elements.pool;
    for (const ElementId wall : pool.surface_roots()) {
      const Element& e = pool[wall];
      const vec3 facing = normalize(e.summed_normal);
      for (int i = 0; i < 200; ++i) {
        const vec3 x = e.centre + random.in(0.01f, 0.6f) * facing + 0.8f * random.direction();
        const vec3 n_x = random.direction();
        const double exact = exact_factor(pool, wall, x, n_x);
        ASSERT_NEAR(std::max(0.0f, dot(n_x, point_transfer(pool, wall, x, n_x))), exact, 2e-5) << n;
      }
    }
  }
}

TEST(PointTransfer, AVolumeClusterErrsByNoMoreThanItsBound) {
  Random random(3);
  Scene scene;
  const uint32_t paint = test::add(scene, test::diffuse(0.5f));
  for (int i = 0; i < 12; ++i)
    test::add(scene, shapes::cube(2), paint,
              test::move(3.0f * random.point()) * test::turn(1, random.direction()));
  const Elements elements(std::move(scene));
  const ElementPool& pool = *elements.pool;
  const Element& root = pool[pool.root()];
  ASSERT_EQ(root.kind, ElementKind::kVolume);
  for (int i = 0; i < 2000; ++i) {
    const vec3 x = root.centre + root.radius * std::exp2(random.in(0.05f, 5)) * random.direction();
    const vec3 n = random.direction();
    double exact = 0;
    for (const ElementId surface : pool.surface_roots()) exact += exact_factor(pool, surface, x, n);
    const double factor = std::max(0.0f, dot(n, point_transfer(pool, pool.root(), x, n)));
    EXPECT_LE(std::abs(factor - exact), point_transfer_error_bound(pool, pool.root(), x, n) * 1.001 + 1e-7);
  }
}

}  // namespace
}  // namespace goldthread
