#include "reconstruct/leaf_light.h"

#include <algorithm>

namespace goldthread {
namespace {

// A plane over a leaf, of three colours at once.
class PlaneSum {
 public:
  void add(const vec3& place, const vec3& light) {
    count_ += 1;
    place_ += place;
    light_ += light;
    squares_ += glm::outerProduct(place, place);
    products_ += glm::outerProduct(light, place);
  }

  vec3 light() const { return light_ / count_; }
  vec3 place() const { return place_ / count_; }

  // Change of light a metre along `u` and `v`, unit and orthogonal; none where all places lie on a line.
  mat3 rise(const vec3& u, const vec3& v) const {
    const mat3 square = squares_ - glm::outerProduct(place_, place_) / count_;
    const mat3 product = products_ - glm::outerProduct(light_, place_) / count_;
    const float uu = dot(u, square * u), uv = dot(u, square * v), vv = dot(v, square * v);
    const float determinant = uu * vv - uv * uv;
    if (!(determinant > 1e-4f * (uu + vv) * (uu + vv))) return mat3(0);
    const vec3 along_u = product * u, along_v = product * v;
    return glm::outerProduct((vv * along_u - uv * along_v) / determinant, u) +
           glm::outerProduct((uu * along_v - uv * along_u) / determinant, v);
  }

 private:
  float count_ = 0;
  vec3 place_{0}, light_{0};
  mat3 squares_{0}, products_{0};
};

}  // namespace

void fit_leaves(const ElementPool& pool, const PartPoints& points, std::span<const ElementId> leaves,
                std::span<const vec3> light, const RadiosityState& state, ShownLight& shown) {
  shown.rise.resize(pool.size(), mat3(0));
  std::vector<std::pair<ElementId, uint32_t>> faces;
  for (uint32_t f = 0; f < leaves.size(); ++f)
    if (leaves[f] != kNoElement && pool[leaves[f]].flat) faces.emplace_back(leaves[f], f);
  std::sort(faces.begin(), faces.end());
  for (size_t first = 0, end = 0; first < faces.size(); first = end) {
    const ElementId id = faces[first].first;
    const Element& leaf = pool[id];
    PlaneSum sum;
    for (end = first; end < faces.size() && faces[end].first == id; ++end) {
      const uint32_t f = faces[end].second;
      for (uint32_t c = points.corner_first[f]; c < points.corner_first[f + 1]; ++c)
        sum.add(points.points[points.corners[c]].position - leaf.centre, light[points.corners[c]]);
    }
    const vec3 n = normalize_or(leaf.summed_normal, vec3(0, 1, 0));
    const vec3 u = normalize(std::abs(n.x) > 0.6f ? vec3(n.y, -n.x, 0) : vec3(0, n.z, -n.y));
    const mat3 rise = sum.rise(u, cross(n, u));
    const vec3 centre = glm::max(vec3(0), sum.light() - rise * sum.place());
    shown.shown[id] = leaving_light(pool, id, centre, state.irradiance);
    for (int column = 0; column < 3; ++column) shown.rise[id][column] = leaf.reflectance * rise[column];
  }
}

void range_over_leaves(const ElementPool& pool, ShownLight& shown) {
  for (ElementId id = static_cast<ElementId>(pool.size()); id-- > 0;) {
    const Element& e = pool[id];
    if (!is_surface(e.kind)) continue;
    if (e.first_child != kNoElement) {
      shown.low[id] = std::min(shown.low[e.first_child], shown.low[e.first_child + 1]);
      shown.high[id] = std::max(shown.high[e.first_child], shown.high[e.first_child + 1]);
      continue;
    }
    const float middle = largest(shown.shown[id]);
    float steepest = 0;
    if (!shown.rise.empty())
      for (int colour = 0; colour < 3; ++colour)
        steepest = std::max(steepest, length(vec3(shown.rise[id][0][colour], shown.rise[id][1][colour],
                                                  shown.rise[id][2][colour])));
    shown.low[id] = std::max(0.0f, middle - steepest * e.radius);
    shown.high[id] = std::min(2 * middle, middle + steepest * e.radius);
  }
}

}  // namespace goldthread
