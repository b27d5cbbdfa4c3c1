// Greedy collapse of dual edges (thesis 4.2.2) on one connected or unconnected set of clusters.
#pragma once
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "cluster/cost_tournament.h"
#include "cluster/face_cluster_tree.h"
#include "cluster/face_quadric.h"

namespace goldthread {

/// All that the cost of a merge depends on. One cache line.
struct alignas(64) ClusterShape {
  FaceQuadric fit;
  vec3 summed_normal{0};
  float area = 0;
  float perimeter = 0;  ///< border of the mesh included
};

ClusterShape shape_of_triangle(const vec3& a, const vec3& b, const vec3& c);

/// The cluster of both, `shared` being the length of their common boundary.
ClusterShape merged(const ClusterShape& a, const ClusterShape& b, float shared);

/// Equation 4.8 for the merger of a and b. E_fit and A are both squared lengths and p^2 / |S| is a plain
/// number, so k as the thesis writes it has no unit: all costs of a mesh scaled by s are scaled by s^2 and
/// keep their order. |S| counts as at least 1/1000 of the area, so that closed shapes get a large cost and
/// not an infinite one.
float merge_cost(const ClusterShape& a, const ClusterShape& b, float shared, float balance);

/// What merge_cost() is with E_fit = 0: never more, and most of it for flat clusters, at a quarter of the
/// work.
float least_merge_cost(const ClusterShape& a, const ClusterShape& b, float shared, float balance);

/// A step of the collapse: two clusters, named by what the caller called them, became one of `count`
/// triangles.
struct Merge {
  ClusterRef child[2];
  uint32_t count;
};

/// Add clusters and dual edges, then run(). Reused for many sets, it keeps its memory.
///
/// Edges of a merged cluster are entered with the least that they can cost, and that only is corrected when
/// they come up for collapse: the order is the same as if all were computed at once, and most never come up.
///
/// All edges of a merged cluster are entered anew, except at hubs: a cluster of more than
/// kHubDegree neighbours (a plate with a hundred thousand rivets) would make that quadratic. Its edges are
/// recomputed when they come up for collapse and the hub has grown by a sixteenth since, which is at most
/// logarithmically often.
class DualMerger {
 public:
  static constexpr uint32_t kHubDegree = 64;

  void clear();
  /// Returns the cluster's number: they count from 0.
  uint32_t add_cluster(const ClusterShape& shape, ClusterRef name, uint32_t count);
  /// Adds to the boundary that a and b share, making their edge when it is the first of it. Walks the shorter
  /// of their lists of neighbours.
  void add_boundary(uint32_t a, uint32_t b, float length);
  /// The same for the only boundary of a and b.
  void add_edge(uint32_t a, uint32_t b, float length);

  /// Collapses the cheapest edge until `target` clusters or no edges are left; merge number i is named
  /// first_name + i.
  void run(float balance, size_t target, ClusterRef first_name, std::vector<Merge>& merges);

  size_t cluster_count() const { return shapes_.size(); }
  /// The cluster that c has become part of (c itself while it lives).
  uint32_t survivor(uint32_t c);
  const ClusterShape& shape(uint32_t c) const { return shapes_[c]; }
  ClusterRef name(uint32_t c) const { return clusters_[c].name; }
  uint32_t count(uint32_t c) const { return clusters_[c].count; }
  bool alive(uint32_t c) const { return clusters_[c].parent == kNone; }
  /// Calls body(a, b, shared) for each edge that is left.
  template <typename Body>
  void for_edges(const Body& body) const {
    for (uint32_t e = 0; e < edges_.size(); ++e)
      if (costs_.cost(e) != CostTournament::kOut) body(edges_[e].end[0], edges_[e].end[1], edges_[e].shared);
  }
  /// Costs computed by the last run(): a measure of work for tests.
  uint64_t costs_computed() const { return costs_computed_; }

 private:
  static constexpr uint32_t kNone = 0xffffffffu;

  struct Cluster {
    uint32_t first_link = kNone;  ///< a link is edge * 2 + end
    uint32_t degree = 0;
    uint32_t parent = kNone;  ///< the cluster it was merged into
    uint32_t version = 0;     ///< of a hub: raised when it has outgrown the costs of its edges
    ClusterRef name = 0;
    uint32_t count = 0;
    bool hub = false;
  };
  struct Edge {
    uint32_t end[2];
    uint32_t next[2], previous[2];
    float shared;
    uint32_t
        stamp;  ///< sum of its ends' versions when its cost was computed; kNone while that is a least cost
  };
  struct HubSize {
    uint32_t count;
    float area;
  };

  uint32_t other_end(uint32_t link) const { return edges_[link / 2].end[1 - link % 2]; }
  uint32_t next_of(uint32_t link) const { return edges_[link / 2].next[link % 2]; }
  uint32_t find_edge(uint32_t a, uint32_t b) const;
  void push_link(uint32_t cluster, uint32_t link);
  void drop_link(uint32_t cluster, uint32_t link);
  void remove_edge(uint32_t edge);
  uint32_t version_of(const Edge& edge) const;
  void bound_costs(std::span<const uint32_t> edges);
  void compute_cost(uint32_t edge);
  uint32_t collapse(uint32_t edge);
  void absorb(uint32_t into, uint32_t from, float shared);
  void move_edges(uint32_t into, uint32_t from);
  void move_edges_to_hub(uint32_t into, uint32_t from);
  void become_hub(uint32_t cluster);
  void raise_version_when_grown(uint32_t hub);

  std::vector<ClusterShape> shapes_;
  std::vector<Cluster> clusters_;
  std::vector<Edge> edges_;
  CostTournament costs_;
  std::vector<uint32_t> edge_to_;  ///< per cluster: scratch of move_edges()
  std::vector<uint32_t> touched_;  ///< scratch: edges whose cost has changed
  std::unordered_map<uint64_t, uint32_t> hub_edges_;
  std::unordered_map<uint32_t, HubSize> hub_sizes_;  ///< as of their version
  float balance_ = 0;
  uint64_t costs_computed_ = 0;
};

}  // namespace goldthread
