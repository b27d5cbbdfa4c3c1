#include "visibility/shaft.h"

#include <algorithm>

#include "base/check.h"

namespace goldthread {

Shaft::Shaft(std::span<const vec3> from, std::span<const vec3> to, float epsilon) : epsilon_(epsilon) {
  GOLDTHREAD_CHECK_LE(from.size(), kMostPoints);
  GOLDTHREAD_CHECK_LE(to.size(), kMostPoints);
  for (const std::span<const vec3> set : {from, to})
    for (const vec3& p : set) {
      points_[point_count_++] = p;
      box_.add(p);
    }
  add_sides(from, to);
  add_sides(to, from);
}

void Shaft::add(const vec3& normal, const vec3& through) {
  if (count_ < kMostPlanes) planes_[count_++] = {normal, dot(normal, through)};
}

void Shaft::add_cap(const vec3& point, const vec3& normal) {
  add(-normal, point);
}

bool Shaft::contains_all(const vec3& normal, float distance) const {
  for (size_t i = 0; i < point_count_; ++i)
    if (dot(normal, points_[i]) - distance > 0.5f * epsilon_) return false;
  return true;
}

// A side leads through an edge of the one and a corner of the other, with all else on one side of it.
void Shaft::add_sides(std::span<const vec3> edges, std::span<const vec3> others) {
  if (edges.size() < 2) return;
  for (size_t i = 0; i < edges.size(); ++i) {
    const vec3 &a = edges[i], &b = edges[(i + 1) % edges.size()];
    for (const vec3& c : others) {
      const vec3 across = cross(b - a, c - a);
      const float length_of = length(across), scale = length(b - a) * length(c - a);
      if (!(length_of > 1e-4f * scale)) continue;  // no plane but a line
      const vec3 n = across / length_of;
      if (contains_all(n, dot(n, a))) {
        add(n, a);
      } else if (contains_all(-n, -dot(n, a))) {
        add(-n, a);
      } else {
        continue;
      }
      break;
    }
  }
}

bool Shaft::excludes(const Box& box) const {
  if (glm::any(glm::greaterThan(box.low, box_.high - epsilon_)) ||
      glm::any(glm::lessThan(box.high, box_.low + epsilon_))) {
    // Flat shafts along an axis have no inside that a box could miss.
    const vec3 size = box_.size();
    bool outside = false;
    for (int axis = 0; axis < 3; ++axis)
      if (size[axis] > 2 * epsilon_)
        outside |= box.low[axis] > box_.high[axis] - epsilon_ || box.high[axis] < box_.low[axis] + epsilon_;
    if (outside) return true;
  }
  const vec3 centre = box.centre(), half = 0.5f * box.size();
  for (size_t i = 0; i < count_; ++i) {
    const Plane& p = planes_[i];
    const float reach = dot(glm::abs(p.normal), half);
    if (dot(p.normal, centre) - p.distance - reach > -epsilon_) return true;
  }
  return false;
}

bool Shaft::excludes(const vec3& a, const vec3& b, const vec3& c) const {
  for (size_t i = 0; i < count_; ++i) {
    const Plane& p = planes_[i];
    if (std::min({dot(p.normal, a), dot(p.normal, b), dot(p.normal, c)}) - p.distance > -epsilon_)
      return true;
  }
  Box box;
  for (const vec3& v : {a, b, c}) box.add(v);
  const vec3 size = box_.size();
  for (int axis = 0; axis < 3; ++axis)
    if (size[axis] > 2 * epsilon_ &&
        (box.low[axis] > box_.high[axis] - epsilon_ || box.high[axis] < box_.low[axis] + epsilon_))
      return true;
  // The triangle's own plane may have all of the shaft on one side.
  const vec3 across = cross(b - a, c - a);
  const float length_of = length(across);
  if (!(length_of > 0)) return false;
  const vec3 n = across / length_of;
  float low = 0, high = 0;
  for (size_t i = 0; i < point_count_; ++i) {
    const float d = dot(n, points_[i] - a);
    low = std::min(low, d);
    high = std::max(high, d);
  }
  return low >= -epsilon_ || high <= epsilon_;
}

}  // namespace goldthread
