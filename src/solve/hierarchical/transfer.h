// How much of an element's radiosity arrives at a point, and between two elements.
#pragma once
#include <cstdint>

#include "element/element_pool.h"
#include "visibility/ray_caster.h"

namespace goldthread {

/// Vector form factor m of `source` at `x`, without occlusion: dot(n, m) times the source's radiosity is the
/// irradiance on a receiver of unit normal `n`. Equation 4.19 where the source is far; near, face clusters
/// are descended until each piece is small for its distance, and triangles and patches are exact (Lambert's
/// contour formula), so that shared edges and closed sources need no special care. Zero below the receiver's
/// horizon and behind the source. For lights the "radiosity" is what Element::exitance says: candela, lux, or
/// the sky's lm/m^2.
vec3 point_transfer(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n);

/// Share of a point or spot light's intensity that goes in unit direction `d` (KHR_lights_punctual's cone
/// falloff).
float light_distribution(const Light& light, const vec3& d);
/// Share that is left at `distance` metres of a light with a range (KHR_lights_punctual), besides the inverse
/// square.
float light_range_factor(const Light& light, float distance);

/// Rays cast, and the time that took, summed over threads.
struct RayCount {
  uint64_t rays = 0;
  uint64_t nanoseconds = 0;
  void operator+=(const RayCount& other) {
    rays += other.rays;
    nanoseconds += other.nanoseconds;
  }
};

/// Rays between points and elements.
struct Visibility {
  const RayCaster* caster = nullptr;  ///< borrowed
  float epsilon = 1e-5f;              ///< metres by which ray ends leave their surfaces

  /// Share of `source` seen from `x`, from `rays` (1..64) rays to points on its real triangles, each weighted
  /// by what it would bring. `seed` turns the pattern. 0 when no point of it faces `x`. Adds the rays cast to
  /// `count`.
  float fraction(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n, uint32_t rays,
                 uint32_t seed, RayCount& count) const;
};

/// The light path between two elements (sections 4.2.3 and 4.5.3).
struct Link {
  ElementId receiver = kNoElement, source = kNoElement;
  /// What a piece of the receiver with normal n gets per unit radiosity, visibility included: dot(n,
  /// transfer) + ambient. The vector (equation 4.19) is right for a source that all of the receiver sees in
  /// one direction; a source that surrounds it, as the rest of a hollow sphere does, brings the same to every
  /// normal. The mix is fitted to samples. On a flat receiver there is one normal, and the place takes its
  /// part: p gets ambient + dot(p - centre, transfer), transfer being the gradient.
  vec3 transfer{0};
  float ambient = 0;
  float mean = 0;        ///< mean over the receiver's real triangles: irradiance per unit radiosity
  float spread = 0;      ///< largest deviation of a sample from what transfer and ambient say of it
  float unoccluded = 0;  ///< mean, were everything visible
  float front_share =
      -1;  ///< of mean, what comes from the source's first child; negative while that is not known
  uint8_t visibility = 0;  ///< share of sample rays that got through, of 255
  uint8_t rays = 0;        ///< how many there were
  bool alive = true;
};

/// Measures a kept link's mean and visibility anew, with other points and rays. A link is kept because its
/// samples agree, and where little is seen through clutter they agree best when they miss it all: used as
/// they are, they would lose light.
void resample_link(const ElementPool& pool, const Visibility& visibility, Link& link, RayCount& ray_count);

/// Measures `front_share` of a link whose source has children. Light is brighter where it comes nearer, so
/// taking a source as evenly bright would lose light for every receiver; with the two halves weighed apart
/// most of that is kept.
void split_source(const ElementPool& pool, Link& link);

/// The radiosity that a link's source shows to its receiver; `shown` is RadiosityState's.
inline vec3 seen_radiosity(const ElementPool& pool, const Link& link, std::span<const vec3> shown) {
  if (link.front_share < 0) return shown[link.source];
  const ElementId child = pool[link.source].first_child;
  return link.front_share * shown[child] + (1 - link.front_share) * shown[child + 1];
}

/// Samples the transfer with `points` (4 or 8) receiver points of
/// `rays_per_point` rays each.
Link make_link(const ElementPool& pool, const Visibility& visibility, ElementId receiver, ElementId source,
               uint32_t points, uint32_t rays_per_point, RayCount& ray_count);

}  // namespace goldthread
