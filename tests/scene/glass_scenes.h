// Panes of glass in places where the light is known.
#pragma once
#include "scene/small_scenes.h"

namespace goldthread::test {

/// A two-sided pane that lets `transmission` of the light straight on in its `colour` and reflects the rest.
inline Material glass(const vec3& colour, float transmission) {
  Material pane = diffuse(colour);
  pane.transmission = transmission;
  pane.double_sided = true;
  return pane;
}

/// A black floor of 2 by 2 that faces up, with `panes` of 40 by 40 above it, from half a metre on.
inline Scene under_panes(const Material& pane, int panes) {
  Scene scene;
  add(scene, square(1, 0, true), diffuse(0));
  for (int i = 0; i < panes; ++i) add(scene, square(20, 0.5f + 0.1f * float(i), true), pane);
  return scene;
}

/// A closed room in which every surface gives off `b` lm/m2, and so receives as much: of what comes to the
/// pane across its middle a part is reflected, a part goes on, and what is lost it emits.
inline Scene glazed_furnace(const vec3& b, const vec3& colour, float transmission) {
  Scene scene;
  const vec3 x(4, 0, 0), y(0, 3, 0), z(0, 0, 2), o(0);
  const float rho[6] = {0.8f, 0.1f, 0.5f, 0.3f, 0.7f, 0.6f};
  const shapes::Soup walls[6] = {parallelogram(o, x, y), parallelogram(z, y, x), parallelogram(o, y, z),
                                 parallelogram(x, z, y), parallelogram(o, z, x), parallelogram(y, x, z)};
  for (int i = 0; i < 6; ++i) add(scene, walls[i], diffuse(vec3(rho[i]), b * (1 - rho[i])));
  Material pane = glass(colour, transmission);
  pane.emission = b * (1.0f - colour) / kPi;
  add(scene, parallelogram({2, 0.5f, 0.5f}, {0, 2, 0}, {0.5f, 0, 1}), pane);
  return scene;
}

}  // namespace goldthread::test
