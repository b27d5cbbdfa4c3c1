#include "solve/hierarchical/regard.h"

#include <algorithm>
#include <cmath>

namespace goldthread {
namespace {

float quantile(std::vector<float> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// What is looked at as one, of the scene's area.
constexpr double kLookedAt = 0.005;

// What sees less than this share of what it faces is looked at by nobody.
constexpr float kOpen = 0.1f;

// Down to this share of the mean the eye is as well adapted as in the rest; below this share of that, nobody
// sees anything.
constexpr double kSameRoom = 0.2, kBlack = 0.1;

// Within this many of the detail's own radii everything counts in full.
constexpr float kAround = 2;

// The detail is what so much of the triangles lies within; what the second share needs beyond so many times
// the first's distance is a landscape of a few large triangles.
constexpr double kMost = 0.75, kNearlyAll = 0.9;
constexpr float kStretch = 2;

glm::dvec3 power_below(const ElementPool& pool, const RadiosityState& state, const Regard& regard,
                       ElementId id) {
  const Element& e = pool[id];
  if (e.first_child != kNoElement)
    return power_below(pool, state, regard, e.first_child) +
           power_below(pool, state, regard, e.first_child + 1);
  return glm::dvec3(state.irradiance[id]) * static_cast<double>(e.area * e.coverage * regard.of(e));
}

}  // namespace

Regard::Regard(const SurfaceSet& surfaces) {
  std::vector<vec3> corners;
  for (const Part& part : surfaces.parts)
    for (const UVec3& t : surfaces.tree(part).mesh.triangles)
      if (is_finite(part.positions[t.x])) corners.push_back(part.positions[t.x]);
  if (corners.empty()) return;
  for (int k = 0; k < 3; ++k) {
    std::vector<float> along;
    for (const vec3& c : corners) along.push_back(c[k]);
    centre_[k] = quantile(std::move(along), 0.5);
  }
  std::vector<float> distance;
  for (const vec3& c : corners) distance.push_back(length(c - centre_));
  const float most = quantile(distance, kMost), nearly_all = quantile(std::move(distance), kNearlyAll);
  const float reach = kAround * std::min(nearly_all, kStretch * most);
  if (reach > 0) radius_ = reach;
}

float Regard::of(const Element& e) const {
  if (std::isinf(radius_)) return 1;
  const float apart = std::max(length(e.centre - centre_) - e.radius, 0.0f);
  // A plain's solid angle falls with the cube of its distance.
  const float share = apart > radius_ ? radius_ / apart : 1.0f;
  const float near = share * share * share;
  // What reaches from here far out: the disc within the radius, and the ring around it by 1 / r^3.
  const float disc = kPi * radius_ * radius_;
  const float all = disc * (3 - 2 * std::sqrt(std::min(1.0f, disc / e.area)));
  return std::min({1.0f, near, all / std::max(e.area, 1e-30f)});
}

vec3 regarded_power(const ElementPool& pool, const RadiosityState& state, const Regard& regard) {
  return pool.root() == kNoElement ? vec3(0) : vec3(power_below(pool, state, regard, pool.root()));
}

double regarded_area(const ElementPool& pool, const Regard& regard) {
  double area = 0;
  for (const ElementId id : pool.surface_roots())
    area += static_cast<double>(pool[id].area * pool[id].coverage * regard.of(pool[id]));
  return area;
}

double adapted_light(const ElementPool& pool, const RadiosityState& state, ElementId id, double area) {
  if (state.openness[id] < kOpen * pool[id].area) return std::numeric_limits<double>::infinity();
  while (pool[id].parent != kNoElement && static_cast<double>(pool[id].area) < kLookedAt * area)
    id = pool[id].parent;
  return static_cast<double>(largest(state.irradiance[id]));
}

double weight_of_masking(double contrast) {
  constexpr double kSeen = 0.05, kSlope = 0.62, kLeast = 0.5;
  return contrast > kSeen ? std::max(kLeast, std::pow(contrast / kSeen, -kSlope)) : 1.0;
}

double weight_of_darkness(double adapted, double mean) {
  const double dark = kSameRoom * mean;
  if (!(adapted < dark)) return 1;
  return dark / std::max(adapted, kBlack * dark);
}

}  // namespace goldthread
