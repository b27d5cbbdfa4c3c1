#include "visibility/triangle_tree.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "base/parallel.h"

namespace goldthread {
namespace {

constexpr uint32_t kLeaf = 4;
constexpr uint32_t kTask = 20000;

// Nodes of a tree over `count` triangles that is halved until four are left: known beforehand, so that halves
// can be built side by side.
size_t nodes_over(uint32_t count) {
  if (count <= kLeaf) return 1;
  return 1 + nodes_over(count / 2) + nodes_over(count - count / 2);
}

}  // namespace

TriangleTree::TriangleTree(std::span<const vec3> positions, std::span<const UVec3> triangles)
    : positions_(positions), triangles_(triangles) {
  if (triangles.empty()) return;
  std::vector<vec3> centres(triangles.size());
  parallel_for(
      triangles.size(),
      [&](size_t t) {
        const UVec3& c = triangles[t];
        centres[t] = (positions[c.x] + positions[c.y] + positions[c.z]) / 3.0f;
        if (!is_finite(centres[t])) centres[t] = vec3(0);
      },
      4096);
  order_.resize(triangles.size());
  std::iota(order_.begin(), order_.end(), 0u);
  nodes_.resize(nodes_over(static_cast<uint32_t>(triangles.size())));
  build(0, 0, static_cast<uint32_t>(triangles.size()), centres);
}

void TriangleTree::build(size_t node, uint32_t begin, uint32_t end, std::span<const vec3> centres) {
  const uint32_t count = end - begin;
  if (count <= kLeaf) {
    for (uint32_t i = begin; i < end; ++i) {
      const UVec3& c = triangles_[order_[i]];
      for (const uint32_t k : {c.x, c.y, c.z})
        if (is_finite(positions_[k])) nodes_[node].box.add(positions_[k]);
    }
    nodes_[node].first = begin;
    nodes_[node].count = count;
    return;
  }
  Box spread;
  for (uint32_t i = begin; i < end; ++i) spread.add(centres[order_[i]]);
  const vec3 size = spread.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const uint32_t middle = begin + count / 2;
  std::nth_element(
      order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](uint32_t a, uint32_t b) {
        return centres[a][axis] < centres[b][axis] || (centres[a][axis] == centres[b][axis] && a < b);
      });
  const size_t left = node + 1, right = left + nodes_over(count / 2);
  const auto build_left = [&] { build(left, begin, middle, centres); };
  const auto build_right = [&] { build(right, middle, end, centres); };
  if (count > kTask) {
    parallel_invoke(build_left, build_right);
  } else {
    build_left();
    build_right();
  }
  nodes_[node].first = static_cast<uint32_t>(right);
  nodes_[node].box.add(nodes_[left].box);
  nodes_[node].box.add(nodes_[right].box);
}

// Visits triangles in nodes that `excluded` does not rule out, until `visit` says no; whether it never did.
template <typename Excluded, typename Visit>
bool TriangleTree::walk(const Excluded& excluded, const Visit& visit) const {
  if (nodes_.empty()) return true;
  std::array<uint32_t, 64> stack;  // depth is the logarithm of a 32-bit number
  size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const uint32_t at = stack[--depth];
    const Node& node = nodes_[at];
    if (node.box.empty() || excluded(node.box)) continue;
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = at + 1;
      continue;
    }
    for (uint32_t i = node.first; i < node.first + node.count; ++i)
      if (!visit(order_[i])) return false;
  }
  return true;
}

bool TriangleTree::is_clear(const Shaft& shaft) const {
  return walk([&](const Box& box) { return shaft.excludes(box); },
              [&](uint32_t triangle) {
                const UVec3& c = triangles_[triangle];
                return shaft.excludes(positions_[c.x], positions_[c.y], positions_[c.z]);
              });
}

void TriangleTree::visit_near(const Box& box, const vec3& normal, float offset, float slack,
                              const std::function<void(uint32_t triangle)>& visit) const {
  const auto apart = [&](const Box& other) {
    for (int k = 0; k < 3; ++k)
      if (other.low[k] > box.high[k] + slack || other.high[k] < box.low[k] - slack) return true;
    const vec3 half = 0.5f * other.size();
    return std::abs(dot(normal, other.centre()) - offset) > dot(glm::abs(normal), half) + slack;
  };
  walk(apart, [&](uint32_t triangle) {
    visit(triangle);
    return true;
  });
}

}  // namespace goldthread
