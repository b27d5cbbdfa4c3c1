// A box hierarchy over triangles, for questions that no ray can ask.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "math/box.h"
#include "visibility/shaft.h"

namespace goldthread {

/// 32 bytes a node, a node for every two triangles about. Borrows positions and triangles.
class TriangleTree {
 public:
  TriangleTree(std::span<const vec3> positions, std::span<const UVec3> triangles);

  /// Whether no triangle reaches into the shaft. "No" may be wrong where "yes" is never (Shaft::excludes).
  bool is_clear(const Shaft& shaft) const;

  /// Calls `visit` for each triangle that may come within `slack` metres of the plane
  /// dot(normal, p) = offset (normal unit) inside `box`; and of some others.
  void visit_near(const Box& box, const vec3& normal, float offset, float slack,
                  const std::function<void(uint32_t triangle)>& visit) const;

  uint64_t memory_bytes() const {
    return nodes_.capacity() * sizeof(Node) + order_.capacity() * sizeof(uint32_t);
  }

 private:
  struct Node {
    Box box;
    uint32_t first = 0;  // of order_, or the second child; the first follows its parent
    uint32_t count = 0;  // of a leaf; 0 of an inner node
  };
  template <typename Excluded, typename Visit>
  bool walk(const Excluded& excluded, const Visit& visit) const;
  void build(size_t node, uint32_t begin, uint32_t end, std::span<const vec3> centres);

  std::span<const vec3> positions_;
  std::span<const UVec3> triangles_;
  std::vector<Node> nodes_;
  std::vector<uint32_t> order_;
};

}  // namespace goldthread
