#include "reconstruct/interpolate.h"

#include <algorithm>

#include "base/parallel.h"

namespace goldthread {
namespace {

// Leaves with no more points than this are gathered at all of them.
constexpr uint32_t kFewPoints = 12;
// A leaf that bends round a crease is no smooth piece to interpolate over; only where there are very many
// points must it do.
constexpr float kCreaseCosine = 0.5f;
constexpr uint32_t kFewOnCreases = 64;
// Keys that a larger leaf is given at least.
constexpr uint32_t kLeastKeys = 6;
// And how far its other points may be from one: squared distance over squared radius, plus that of the unit
// normals.
constexpr float kFarthest = 0.5f;

}  // namespace

KeyPoints::KeyPoints(const HierarchicalSolver& solver, const PartPoints& points,
                     const std::vector<ElementId>& leaves, bool back)
    : solver_(solver), points_(points), back_(back) {
  group_points(leaves);
  choose_keys();
}

void KeyPoints::group_points(const std::vector<ElementId>& leaves) {
  std::vector<ElementId> ids(leaves);
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::erase(ids, kNoElement);
  leaves_.resize(ids.size());
  for (size_t i = 0; i < ids.size(); ++i) leaves_[i].id = ids[i];

  std::vector<uint64_t> pairs;  // (leaf, point), each once
  pairs.reserve(points_.corners.size());
  for (uint32_t f = 0; f < leaves.size(); ++f) {
    if (leaves[f] == kNoElement) continue;
    const auto leaf =
        static_cast<uint64_t>(std::lower_bound(ids.begin(), ids.end(), leaves[f]) - ids.begin());
    for (uint32_t c = points_.corner_first[f]; c < points_.corner_first[f + 1]; ++c)
      pairs.push_back(leaf << 32 | points_.corners[c]);
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());

  point_first_.assign(points_.points.size() + 1, 0);
  for (const uint64_t pair : pairs) {
    Leaf& leaf = leaves_[pair >> 32];
    if (leaf.count == 0) leaf.first = static_cast<uint32_t>(leaf_points_.size());
    ++leaf.count;
    leaf_points_.push_back(static_cast<uint32_t>(pair));
    ++point_first_[static_cast<uint32_t>(pair) + 1];
  }
  for (size_t p = 1; p < point_first_.size(); ++p) point_first_[p] += point_first_[p - 1];
  point_leaf_.resize(pairs.size());
  std::vector<uint32_t> cursor(point_first_.begin(), point_first_.end() - 1);
  for (const uint64_t pair : pairs)
    point_leaf_[cursor[static_cast<uint32_t>(pair)]++] = static_cast<uint32_t>(pair >> 32);
}

void KeyPoints::choose_keys() {
  is_key_.assign(points_.points.size(), 0);
  const auto large = [&](uint32_t leaf) {
    const Element& element = solver_.pool()[leaves_[leaf].id];
    const uint32_t few = element.cone_cosine < kCreaseCosine ? kFewOnCreases : kFewPoints;
    return leaves_[leaf].count > few && element.kind == ElementKind::kCluster;
  };
  for (uint32_t p = 0; p < is_key_.size(); ++p) {
    const uint32_t first = point_first_[p], end = point_first_[p + 1];
    bool key = end - first >= 3;
    for (uint32_t i = first; i < end; ++i) key |= !large(point_leaf_[i]);
    is_key_[p] = key ? 1 : 0;
  }
  for (const Leaf& leaf : leaves_) spread_keys(leaf, is_key_);
  for (Leaf& leaf : leaves_) {
    leaf.first_key = static_cast<uint32_t>(leaf_keys_.size());
    for (uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i)
      if (is_key_[leaf_points_[i]] != 0) leaf_keys_.push_back(leaf_points_[i]);
    leaf.key_count = static_cast<uint32_t>(leaf_keys_.size()) - leaf.first_key;
  }
  for (uint32_t p = 0; p < is_key_.size(); ++p)
    if (is_key_[p] != 0) keys_.push_back(p);
}

// Adds the point farthest from all keys, in place and in normal, until there are enough.
void KeyPoints::spread_keys(const Leaf& leaf, std::vector<uint8_t>& is_key) const {
  if (leaf.count <= kFewPoints) return;
  const Element& element = solver_.pool()[leaf.id];
  const float radius = std::max(element.radius, 1e-20f);
  const auto distance = [&](uint32_t p, const vec3& position, const vec3& n) {
    const vec3 d = (points_.points[p].position - position) / radius, turn = points_.points[p].normal - n;
    return dot(d, d) + dot(turn, turn);
  };
  std::vector<float> nearest(leaf.count, std::numeric_limits<float>::max());
  uint32_t keys = 0;
  const auto take = [&](uint32_t p) {
    ++keys;
    for (uint32_t i = 0; i < leaf.count; ++i)
      nearest[i] = std::min(nearest[i], distance(leaf_points_[leaf.first + i], points_.points[p].position,
                                                 points_.points[p].normal));
  };
  for (uint32_t i = 0; i < leaf.count; ++i)
    if (is_key[leaf_points_[leaf.first + i]] != 0) take(leaf_points_[leaf.first + i]);
  while (keys < leaf.count) {
    uint32_t best = 0;
    if (keys == 0) {
      const vec3 n = points_.points[leaf_points_[leaf.first]].normal;
      for (uint32_t i = 1; i < leaf.count; ++i)
        if (distance(leaf_points_[leaf.first + i], element.centre, n) <
            distance(leaf_points_[leaf.first + best], element.centre, n))
          best = i;
    } else {
      best = static_cast<uint32_t>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
      if (keys >= kLeastKeys && nearest[best] < kFarthest) break;
    }
    const uint32_t p = leaf_points_[leaf.first + best];
    is_key[p] = 1;
    take(p);
  }
}

vec3 KeyPoints::normal(uint32_t point) const {
  return back_ ? -points_.points[point].normal : points_.points[point].normal;
}

vec3 KeyPoints::modelled(const Leaf& leaf, uint32_t point) const {
  const RadiosityState& state = solver_.state();
  // On a flat leaf the keys alone tell how light varies: its gradient comes of fewer samples than they are.
  if (solver_.pool()[leaf.id].flat) return state.irradiance[leaf.id];
  return glm::max(normal(point) * state.vector[leaf.id], vec3(0)) + state.ambient[leaf.id];
}

vec3 KeyPoints::within(const Leaf& leaf, uint32_t point, const std::vector<vec3>& light) const {
  const float radius = std::max(solver_.pool()[leaf.id].radius, 1e-20f);
  const auto key_at = [&](uint32_t k) { return leaf_keys_[leaf.first_key + k]; };
  // The two sides of a door are a cluster, too: what falls on the one says nothing of the other. Few leaves
  // have a point that all keys are turned away from.
  const auto turned_away = [&](uint32_t key) {
    return dot(points_.points[key].normal, points_.points[point].normal) <= 0;
  };
  bool all_turned = true;
  for (uint32_t k = 0; k < leaf.key_count && all_turned; ++k) all_turned = turned_away(key_at(k));
  vec3 sum(0);
  float total = 0;
  for (uint32_t k = 0; k < leaf.key_count; ++k) {
    const uint32_t key = key_at(k);
    if (!all_turned && turned_away(key)) continue;
    const vec3 d = (points_.points[key].position - points_.points[point].position) / radius;
    // Two points of a crease share their place; what keeps them apart is that they face different ways.
    const vec3 turn = points_.points[key].normal - points_.points[point].normal;
    const float closeness = 1 / (dot(d, d) + 2 * dot(turn, turn) + 1e-4f);
    const float weight = closeness * closeness;
    sum += weight * (light[key] - modelled(leaf, key));
    total += weight;
  }
  const vec3 correction = total > 0 ? sum / total : vec3(0);
  return glm::max(modelled(leaf, point) + correction, vec3(0));
}

void KeyPoints::interpolate(std::vector<vec3>& light) const {
  parallel_for(
      light.size(),
      [&](size_t p) {
        const uint32_t first = point_first_[p], end = point_first_[p + 1];
        if (is_key_[p] != 0 || first == end) return;
        vec3 sum(0);
        for (uint32_t i = first; i < end; ++i)
          sum += within(leaves_[point_leaf_[i]], static_cast<uint32_t>(p), light);
        light[p] = sum / static_cast<float>(end - first);
      },
      256);
}

}  // namespace goldthread
