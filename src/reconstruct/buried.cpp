#include "reconstruct/buried.h"

#include "base/rng.h"
#include "math/oriented_box.h"

namespace goldthread {
namespace {

constexpr uint32_t kLooks = 32, kFew = 2;

// Whether the side of a triangle that a ray meets neither reflects nor emits.
bool is_black_back(const SurfaceSet& set, const Hit& hit, const vec3& direction) {
  const Part& part = part_of_triangle(set, hit.triangle);
  return !set.scene->materials[part.material].lit_behind() && part.winding * dot(hit.normal, direction) > 0;
}

}  // namespace

bool is_buried(const ElementPool& pool, const Visibility& visibility, const vec3& x, const vec3& n,
               RayCount& rays) {
  const mat3 frame = frame_about(n);
  uint32_t others = 0;
  for (uint32_t i = 0; i < kLooks && others <= kFew; ++i) {
    const UnitSquarePoint p = r2_point(i, 17);
    const float r = std::sqrt(p.u), turn = 2 * kPi * p.v;
    const Ray ray{x + visibility.epsilon * n,
                  frame * vec3(r * std::cos(turn), r * std::sin(turn), std::sqrt(std::max(0.0f, 1 - p.u)))};
    const Hit hit = visibility.caster->closest(ray);
    ++rays.rays;
    if (hit.missed() || !is_black_back(pool.surfaces(), hit, ray.direction)) ++others;
  }
  return others <= kFew;
}

}  // namespace goldthread
