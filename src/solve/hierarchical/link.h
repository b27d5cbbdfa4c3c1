// The light path between two elements, and how it is measured.
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "solve/hierarchical/source_rays.h"

namespace goldthread {

/// What a link's receiver sees of its source: elements, each for an equal share of the light. A lamp's lit
/// shade, the sunny side of a tree: what is seen is not as bright as the mean, and light itself decides what
/// is bright where; so the link keeps the places, and any solution may be looked up in them.
struct SourceView {
  std::array<ElementId, 8> elements;
};
constexpr uint32_t kNoView = 0xffffffffu;

/// What coloured glass leaves of the light of a link, relative to its mean, which is that of each ray's best
/// channel: ten bits a channel, of the square root, so that dark channels keep their share. All ones is
/// white.
class Tint {
 public:
  Tint() = default;
  explicit Tint(const vec3& colour);
  bool is_white() const { return bits_ == kWhite; }
  vec3 colour() const;

 private:
  static constexpr uint32_t kWhite = 0x3fffffffu;
  uint32_t bits_ = kWhite;
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
  float mean = 0;           ///< mean over the receiver's surface: irradiance per unit radiosity
  float spread = 0;         ///< largest deviation of a sample from what transfer and ambient say of it
  float unoccluded = 0;     ///< mean, were everything visible
  uint32_t view = kNoView;  ///< LinkPool::views, for sources that are unevenly bright
  Tint tint;                ///< of what gets through
  uint8_t visibility = 0;   ///< share of sample rays that got through, of 255
  uint8_t rays = 0;         ///< how many there were, or would have been were the sight not clear
  Sight sight = Sight::kSampled;
  bool alive = true;
};

/// Measures a kept link's mean and visibility anew, with other points and rays, and `view` if given. A link
/// is kept because its samples agree, and where little is seen through clutter they agree best when they miss
/// it all: used as they are, they would lose light. So many points are taken, up to a limit, that by what the
/// link knows so far the standard error of its mean should be `tolerance`.
void measure_link(const ElementPool& pool, const Visibility& visibility, Link& link, float tolerance,
                  SourceView* view, RayCount& ray_count);

/// The radiosity that a link's source shows to its receiver, were there nothing in between; `shown` is
/// RadiosityState's.
inline vec3 source_radiosity(const Link& link, std::span<const SourceView> views,
                             std::span<const vec3> shown) {
  if (link.view == kNoView) return shown[link.source];
  vec3 sum(0);
  for (const ElementId id : views[link.view].elements) sum += shown[id];
  return sum / static_cast<float>(views[link.view].elements.size());
}

/// The same in the colour in which it arrives.
inline vec3 seen_radiosity(const Link& link, std::span<const SourceView> views, std::span<const vec3> shown) {
  const vec3 b = source_radiosity(link, views, shown);
  return link.tint.is_white() ? b : b * link.tint.colour();
}

/// Samples the transfer with `points` (4 or 8) receiver points of `rays_per_point` rays each; without rays
/// where `sight` is known to be clear. Where the rays all agree it is found out whether that is certain.
Link make_link(const ElementPool& pool, const Visibility& visibility, ElementId receiver, ElementId source,
               uint32_t points, uint32_t rays_per_point, RayCount& ray_count, Sight sight = Sight::kSampled);

}  // namespace goldthread
