// Sheets that light comes through, in places where it is known.
#pragma once
#include "scene/small_scenes.h"

namespace goldthread::test {

/// Diffuse on both sides: of what lands, `reflected` goes back and `through` leaves on the other side.
inline Material translucent(const vec3& reflected, const vec3& through) {
  constexpr float kShare = 0.5f;
  Material sheet = diffuse(reflected / (1 - kShare));
  sheet.diffuse_transmission = kShare;
  sheet.diffuse_transmission_colour = through / kShare;
  return sheet;
}

/// The walls of a closed room 2 by 3 by 2 from `corner` on, without the one at its greatest x, or at its
/// least. All that leaves and lands anywhere in it is `b`, in lm/m2 and lux.
inline void add_half_room(Scene& scene, const vec3& corner, bool open_above, const vec3& b) {
  const vec3 x(2, 0, 0), y(0, 3, 0), z(0, 0, 2);
  const float rho[5] = {0.8f, 0.1f, 0.5f, 0.3f, 0.7f};
  const shapes::Soup walls[5] = {parallelogram(corner, x, y), parallelogram(corner + z, y, x),
                                 parallelogram(corner, z, x), parallelogram(corner + y, x, z),
                                 open_above ? parallelogram(corner, y, z) : parallelogram(corner + x, z, y)};
  for (int i = 0; i < 5; ++i) add(scene, walls[i], diffuse(vec3(rho[i]), b * (1 - rho[i])));
}

/// Light in the two rooms below, by channel.
inline const vec3 kBehindSheet(1, 0.75f, 0.2f), kBeforeSheet(2);

/// Two rooms parted by a sheet of one side that gives off light on that side, towards greater x, alone: there
/// b = e + rho b + tau b', behind it b' = rho b' + tau b.
inline Scene parted_rooms() {
  const vec3 reflected(0.4f, 0.2f, 0.45f);
  const vec3 through = (1.0f - reflected) * kBehindSheet / kBeforeSheet;
  Scene scene;
  add_half_room(scene, vec3(0), true, kBehindSheet);
  add_half_room(scene, vec3(2, 0, 0), false, kBeforeSheet);
  Material sheet = translucent(reflected, through);
  sheet.emission = (kBeforeSheet * (1.0f - reflected) - through * kBehindSheet) / kPi;
  add(scene, parallelogram({2, 0, 0}, {0, 3, 0}, {0, 0, 2}), sheet);
  return scene;
}

/// What is known of a place in them, which may be of the sheet's either side.
inline vec3 parted_light(const vec3& position, const vec3& normal) {
  return position.x + 1e-3f * normal.x > 2 ? kBeforeSheet : kBehindSheet;
}

}  // namespace goldthread::test
