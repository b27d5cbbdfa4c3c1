#include "reconstruct/leaf_faces.h"

#include <algorithm>

#include "reconstruct/triangulate.h"

namespace goldthread {

void LeafFaces::add(const PartPoints& points, uint32_t face) {
  const uint32_t first = points.corner_first[face];
  std::vector<vec3> loop;
  for (uint32_t c = first; c < points.corner_first[face + 1]; ++c)
    loop.push_back(points.points[points.corners[c]].position);
  std::vector<UVec3> triangles;
  triangulate_face(loop, triangles);
  for (const UVec3& t : triangles) {
    for (const uint32_t k : {t.x, t.y, t.z}) corners_.push_back(points.corners[first + k]);
    faces_.push_back(face);
    const float before = up_to_.empty() ? 0.0f : up_to_.back();
    up_to_.push_back(before + length(area_vector(loop[t.x], loop[t.y], loop[t.z])));
  }
}

FacePlace LeafFaces::place(float u, float v) const {
  const float target = u * up_to_.back();
  const auto found = std::upper_bound(up_to_.begin(), up_to_.end(), target);
  const size_t t = std::min<size_t>(static_cast<size_t>(found - up_to_.begin()), up_to_.size() - 1);
  const float before = t > 0 ? up_to_[t - 1] : 0.0f;
  const float along = std::clamp((target - before) / std::max(up_to_[t] - before, 1e-30f), 0.0f, 1.0f);
  const float root = std::sqrt(along);
  return {{corners_[3 * t], corners_[3 * t + 1], corners_[3 * t + 2]},
          {1 - root, root * (1 - v), root * v},
          faces_[t]};
}

}  // namespace goldthread
