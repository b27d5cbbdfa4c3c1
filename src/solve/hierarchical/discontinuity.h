// Where light jumps within a triangle or patch, so that it can be cut there (discontinuity meshing: Heckbert,
// *Discontinuity Meshing for Radiosity*, 1992; thesis 9.2.1).
#pragma once
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "solve/hierarchical/link.h"
#include "solve/hierarchical/radiosity_state.h"

namespace goldthread {

/// The links whose shadows may have edges worth a cut, by receiver: from lamps, suns and shining surfaces
/// that are small for their distance, of which some of the receiver sees something and some does not.
class LampLinks {
 public:
  /// `pool` is borrowed.
  LampLinks(const ElementPool& pool, const RadiosityState& state, std::span<const Link> links);

  /// Sources of those into an element and all above it, the strongest first.
  std::vector<ElementId> lamps_of(ElementId id) const;

 private:
  struct Entry {
    ElementId receiver = kNoElement, lamp = kNoElement;
    float strength = 0;  // lux, were nothing in the way
  };
  const ElementPool& pool_;
  std::vector<Entry> links_;
};

/// What feet are looked for among.
struct FeetWorld {
  std::vector<float> sizes;  ///< by the world's triangles: metres across the connected surface it belongs to
  std::vector<std::vector<uint32_t>> twins;  ///< by tree: find_twins of its mesh
};

/// Where something stands on a triangle or patch, hovers close above it or passes through it, or where a lamp
/// close above it ends, along at least a quarter of a cut: its foot.
class Feet {
 public:
  /// Looks for the feet of elements that are new since the last call. In parallel. Finds none where
  /// Visibility::discontinuities is off.
  void grow_to(const ElementPool& pool, const Visibility& visibility);

  /// Whether what stands there is as large as a wall and leaves no gap, along half of a cut or, of large
  /// pieces, along all lines together for a quarter of the radius: on the far side there may be another room.
  /// Of a cluster of few triangles: whether that is so of any.
  bool part(ElementId id) const { return parted_.contains(id); }
  /// Absent where there is none, and for clusters.
  CutPlane of(ElementId id) const;
  /// Whether it runs along at least half of the cut.
  bool is_long(ElementId id) const { return long_.contains(id); }

 private:
  std::unordered_map<ElementId, CutPlane> cuts_;
  std::unordered_set<ElementId> long_, parted_;
  FeetWorld world_;
  size_t known_ = 0;
};

/// Pieces that a foot parts are cut along it down to this share of the least area of other cuts.
constexpr float kLeastAtFoot = 1.0f / 64;

/// For each of `ids` the plane along which light jumps most, or an absent one; for what is neither triangle
/// nor patch always that. A foot that runs along at least half of the cut, if there is one. Else the edge of
/// a shadow: of the edges that hide a lamp, the one whose shadow best parts the places that see the lamp from
/// those that do not. Else a shorter foot. Absent throughout where Visibility::discontinuities is off. In
/// parallel; adds the rays cast to `rays`.
std::vector<CutPlane> find_discontinuities(const ElementPool& pool, const Visibility& visibility,
                                           std::span<const ElementId> ids, const Feet& feet,
                                           const LampLinks& lamps, RayCount& rays);

}  // namespace goldthread
