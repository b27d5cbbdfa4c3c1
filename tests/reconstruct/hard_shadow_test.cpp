// Shadows that end on a line: what it takes to show them, and how right they are.
#include <gtest/gtest.h>

#include "base/rng.h"
#include "reconstruct/reconstruct.h"
#include "scene/lighting_lookup.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::Solved;

/// The Cornell box, black, with a lamp without size near where its own was: all light is direct.
Scene box_with_point_light() {
  Scene scene = test::procedural("cornell-box");
  for (Material& material : scene.materials) material.base_colour = material.emission = vec3(0);
  scene.lights.push_back(test::lamp(LightKind::kPoint, 10, {0.278f, 0.5f, 0.28f}));
  return scene;
}

struct Found {
  double error = 0;     // root mean square by area over the floor's mean light
  size_t elements = 0;  // leaves of the floor
};

/// The floor's light between the vertices, held against one ray to the lamp.
Found measure_floor(bool discontinuities, double tolerance) {
  SolveOptions solve = test::quick();
  solve.discontinuities = discontinuities;
  Solved solved(box_with_point_light(), solve);
  solved.solve();
  ReconstructOptions options;
  options.error = tolerance;
  options.growth = 1000;
  ReconstructStats stats;
  const Lighting lighting = reconstruct(*solved.solver, options, CancelToken(), stats);
  const LightingLookup lookup(*solved.scene, lighting);
  uint32_t floor = 0;
  while (solved.scene->instances[solved.set->parts[floor].instance].name != "floor") ++floor;
  const Part& part = solved.set->parts[floor];
  const TriangleMesh& mesh = solved.set->tree(part).mesh;
  const Light& lamp = solved.scene->lights[0];
  double squares = 0, sum = 0;
  uint32_t count = 0;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (uint32_t i = 0; i < 4000; ++i) {
      UnitSquarePoint at = r2_point(i, hash(t, 7));
      if (at.u + at.v > 1) at = {1 - at.u, 1 - at.v};
      const UVec3& c = mesh.triangles[t];
      const vec3 p =
          (1 - at.u - at.v) * part.positions[c.x] + at.u * part.positions[c.y] + at.v * part.positions[c.z];
      // Under a block nobody looks: its top is seen from behind.
      const Hit above = solved.caster->closest({p, vec3(0, 1, 0), 1e-5f});
      if (!above.missed() && above.normal.y > 0) continue;
      const vec3 way = lamp.position - p;
      const float squared = dot(way, way);
      const double truth = double(lamp.intensity.x * way.y / (squared * std::sqrt(squared)) *
                                  solved.caster->transmittance({p, way, 1e-5f, 1}));
      const std::optional<vec3> said =
          lookup.irradiance(part.instance, part.primitive, mesh.source_triangles[t], {at.u, at.v}, false);
      if (!said) ADD_FAILURE() << "no light on the floor";
      const double off = double(said->x) - truth;
      squares += off * off;
      sum += truth;
      ++count;
    }
  }
  Found found;
  found.error = std::sqrt(squares / count) / (sum / count);
  for (const ElementId id : solved.leaves())
    if (solved.pool()[id].part == floor) ++found.elements;
  return found;
}

// A tenth of the elements at no more error. Cut regularly, with more than ten times as many the floor is
// still more than five times as wrong.
TEST(HardShadow, TakesATenthOfTheElements) {
  const Found with = measure_floor(true, 0.02), without = measure_floor(false, 0.02);
  EXPECT_LT(with.error, 0.02);
  EXPECT_LT(with.error, without.error);
  EXPECT_LE(10 * with.elements, without.elements);
}

}  // namespace
}  // namespace goldthread
