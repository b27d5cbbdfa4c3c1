// Which light points are gathered, and how the rest are filled in between (thesis 4.5.5).
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "reconstruct/light_points.h"
#include "solve/hierarchical/solver.h"

namespace goldthread {

/// Light points of one side of a part, by the leaf elements that they belong to. A face cluster that the
/// solver never had to open is evenly lit but for its curvature; gathering at each of its many vertices would
/// only repeat that. So light is gathered at a few key points: where three leaves meet, and enough others to
/// span the cluster.
class KeyPoints {
 public:
  /// `leaves`: the leaf element of every face (kNoElement for none). All are borrowed.
  KeyPoints(const HierarchicalSolver& solver, const PartPoints& points, const std::vector<ElementId>& leaves,
            bool back);

  /// Points to gather at, ascending.
  const std::vector<uint32_t>& keys() const { return keys_; }

  /// Fills every point that is no key. `light` holds the gathered irradiance at the keys. Within a leaf, what
  /// the keys have beyond the leaf's own irradiance vector turned to their normals is interpolated by inverse
  /// distance and added to that vector turned to the point's normal; keys that face away from the point tell
  /// it nothing, unless all do. A point of several leaves takes their mean, so that no seam shows.
  void interpolate(std::vector<vec3>& light) const;

 private:
  struct Leaf {
    ElementId id = kNoElement;
    uint32_t first = 0, count = 0;          // its points, in leaf_points_
    uint32_t first_key = 0, key_count = 0;  // in leaf_keys_
  };

  void group_points(const std::vector<ElementId>& leaves);
  void choose_keys();
  void spread_keys(const Leaf& leaf, std::vector<uint8_t>& is_key) const;
  vec3 modelled(const Leaf& leaf, uint32_t point) const;
  vec3 normal(uint32_t point) const;
  vec3 within(const Leaf& leaf, uint32_t point, const std::vector<vec3>& light) const;

  const HierarchicalSolver& solver_;
  const PartPoints& points_;
  const bool back_;
  std::vector<Leaf> leaves_;
  std::vector<uint32_t> leaf_points_;               // by leaf
  std::vector<uint32_t> leaf_keys_;                 // by leaf
  std::vector<uint32_t> point_first_, point_leaf_;  // leaves of each point
  std::vector<uint32_t> keys_;
  std::vector<uint8_t> is_key_;
};

}  // namespace goldthread
