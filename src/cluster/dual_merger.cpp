#include "cluster/dual_merger.h"

#include <algorithm>

namespace goldthread {
namespace {

constexpr float kLeastFacing = 1e-3f;  ///< |S| / A below which a cluster counts as facing everywhere

uint64_t pair_key(uint32_t a, uint32_t b) {
  return uint64_t(std::min(a, b)) << 32 | std::max(a, b);
}

float merged_perimeter(const ClusterShape& a, const ClusterShape& b, float shared) {
  return std::max(0.0f, a.perimeter + b.perimeter - 2 * shared);
}

/// Equation 4.8 with E_fit given. Rises with it, also as rounded.
float cost_of_fit(const ClusterShape& a, const ClusterShape& b, float shared, float balance, float fit) {
  const float area = a.area + b.area, perimeter = merged_perimeter(a, b, shared);
  const float facing = std::max(length(a.summed_normal + b.summed_normal), kLeastFacing * area);
  // The smallest normal float keeps a division of nothing by nothing, far below any real area, from making
  // NaN.
  const float cost =
      (fit + balance * area) * (perimeter * perimeter) / std::max(facing, std::numeric_limits<float>::min());
  // Overflow is still a cost: an infinite one would forbid the merge.
  return cost < std::numeric_limits<float>::max() ? cost : std::numeric_limits<float>::max();
}

}  // namespace

ClusterShape shape_of_triangle(const vec3& a, const vec3& b, const vec3& c) {
  ClusterShape shape;
  shape.fit = FaceQuadric::of_triangle(a, b, c);
  shape.summed_normal = area_vector(a, b, c);
  shape.area = length(shape.summed_normal);
  shape.perimeter = length(b - a) + length(c - b) + length(a - c);
  return shape;
}

ClusterShape merged(const ClusterShape& a, const ClusterShape& b, float shared) {
  ClusterShape shape;
  shape.fit = merged(a.fit, b.fit);
  shape.summed_normal = a.summed_normal + b.summed_normal;
  shape.area = a.area + b.area;
  shape.perimeter = merged_perimeter(a, b, shared);
  return shape;
}

float merge_cost(const ClusterShape& a, const ClusterShape& b, float shared, float balance) {
  return cost_of_fit(a, b, shared, balance, fit_error(merged(a.fit, b.fit)));
}

float least_merge_cost(const ClusterShape& a, const ClusterShape& b, float shared, float balance) {
  return cost_of_fit(a, b, shared, balance, 0);
}

void DualMerger::clear() {
  shapes_.clear();
  clusters_.clear();
  edges_.clear();
  hub_edges_.clear();
  hub_sizes_.clear();
}

uint32_t DualMerger::add_cluster(const ClusterShape& shape, ClusterRef name, uint32_t count) {
  shapes_.push_back(shape);
  Cluster& cluster = clusters_.emplace_back();
  cluster.name = name;
  cluster.count = count;
  return uint32_t(clusters_.size() - 1);
}

void DualMerger::add_boundary(uint32_t a, uint32_t b, float length) {
  if (const uint32_t edge = find_edge(a, b); edge != kNone)
    edges_[edge].shared += length;
  else
    add_edge(a, b, length);
}

void DualMerger::add_edge(uint32_t a, uint32_t b, float length) {
  const uint32_t edge = uint32_t(edges_.size());
  edges_.push_back({{a, b}, {kNone, kNone}, {kNone, kNone}, length, kNone});
  push_link(a, 2 * edge);
  push_link(b, 2 * edge + 1);
}

uint32_t DualMerger::find_edge(uint32_t a, uint32_t b) const {
  if (clusters_[a].degree > clusters_[b].degree) std::swap(a, b);
  for (uint32_t link = clusters_[a].first_link; link != kNone; link = next_of(link))
    if (other_end(link) == b) return link / 2;
  return kNone;
}

void DualMerger::push_link(uint32_t cluster, uint32_t link) {
  Cluster& c = clusters_[cluster];
  Edge& edge = edges_[link / 2];
  edge.end[link % 2] = cluster;
  edge.next[link % 2] = c.first_link;
  edge.previous[link % 2] = kNone;
  if (c.first_link != kNone) edges_[c.first_link / 2].previous[c.first_link % 2] = link;
  c.first_link = link;
  ++c.degree;
}

void DualMerger::drop_link(uint32_t cluster, uint32_t link) {
  const uint32_t next = edges_[link / 2].next[link % 2], previous = edges_[link / 2].previous[link % 2];
  if (previous == kNone)
    clusters_[cluster].first_link = next;
  else
    edges_[previous / 2].next[previous % 2] = next;
  if (next != kNone) edges_[next / 2].previous[next % 2] = previous;
  --clusters_[cluster].degree;
}

void DualMerger::remove_edge(uint32_t edge) {
  costs_.set(edge, CostTournament::kOut);
  drop_link(edges_[edge].end[0], 2 * edge);
  drop_link(edges_[edge].end[1], 2 * edge + 1);
}

uint32_t DualMerger::version_of(const Edge& edge) const {
  if (hub_sizes_.empty()) return 0;  // only hubs have versions
  return clusters_[edge.end[0]].version + clusters_[edge.end[1]].version;
}

/// Sets the least that edges can cost.
void DualMerger::bound_costs(std::span<const uint32_t> edges) {
  for (const uint32_t edge : edges) {
    Edge& e = edges_[edge];
    e.stamp = kNone;
    costs_.set(edge, least_merge_cost(shapes_[e.end[0]], shapes_[e.end[1]], e.shared, balance_));
  }
  costs_computed_ += edges.size();
}

void DualMerger::compute_cost(uint32_t edge) {
  Edge& e = edges_[edge];
  e.stamp = version_of(e);
  costs_.set(edge, merge_cost(shapes_[e.end[0]], shapes_[e.end[1]], e.shared, balance_));
  ++costs_computed_;
}

void DualMerger::run(float balance, size_t target, ClusterRef first_name, std::vector<Merge>& merges) {
  balance_ = balance;
  costs_computed_ = edges_.size();
  edge_to_.assign(clusters_.size(), kNone);
  costs_.reset(edges_.size());
  for (uint32_t e = 0; e < edges_.size(); ++e) {
    const auto [a, b] = edges_[e].end;
    costs_.prepare(e, least_merge_cost(shapes_[a], shapes_[b], edges_[e].shared, balance_));
  }
  costs_.build();
  for (uint32_t c = 0; c < clusters_.size(); ++c)
    if (clusters_[c].degree > kHubDegree) become_hub(c);
  size_t left = clusters_.size();
  while (left > target) {
    const uint32_t edge = costs_.least();
    if (costs_.cost(edge) == CostTournament::kOut) break;
    const Edge& e = edges_[edge];
    if (e.stamp != version_of(e)) {
      compute_cost(edge);
      continue;
    }
    const Cluster &a = clusters_[e.end[0]], &b = clusters_[e.end[1]];
    merges.push_back({{a.name, b.name}, a.count + b.count});
    clusters_[collapse(edge)].name = first_name++;
    --left;
  }
}

uint32_t DualMerger::collapse(uint32_t edge) {
  const float shared = edges_[edge].shared;
  uint32_t into = edges_[edge].end[0], from = edges_[edge].end[1];
  if (clusters_[into].degree < clusters_[from].degree) std::swap(into, from);
  remove_edge(edge);
  absorb(into, from, shared);
  if (clusters_[into].hub) {
    move_edges_to_hub(into, from);
  } else {
    move_edges(into, from);
    if (clusters_[into].degree > kHubDegree) become_hub(into);
  }
  return into;
}

void DualMerger::absorb(uint32_t into, uint32_t from, float shared) {
  shapes_[into] = merged(shapes_[into], shapes_[from], shared);
  clusters_[into].count += clusters_[from].count;
  clusters_[from].parent = into;
}

/// Hangs the edges of `from` on `into`, adds up double ones, and computes all costs of `into`.
void DualMerger::move_edges(uint32_t into, uint32_t from) {
  for (uint32_t link = clusters_[into].first_link; link != kNone; link = next_of(link))
    edge_to_[other_end(link)] = link / 2;
  for (uint32_t link = clusters_[from].first_link, next; link != kNone; link = next) {
    next = next_of(link);
    const uint32_t neighbour = other_end(link), twin = edge_to_[neighbour];
    if (twin == kNone) {
      push_link(into, link);
      continue;
    }
    edges_[twin].shared += edges_[link / 2].shared;
    costs_.set(link / 2, CostTournament::kOut);
    drop_link(neighbour, link ^ 1);
  }
  touched_.clear();
  for (uint32_t link = clusters_[into].first_link; link != kNone; link = next_of(link)) {
    edge_to_[other_end(link)] = kNone;
    touched_.push_back(link / 2);
  }
  bound_costs(touched_);
}

/// The same for a hub, without a walk along its own edges: double ones are found from the neighbour's side,
/// or among hubs in a map, and only the edges that change are computed.
void DualMerger::move_edges_to_hub(uint32_t into, uint32_t from) {
  raise_version_when_grown(into);
  touched_.clear();
  for (uint32_t link = clusters_[from].first_link, next; link != kNone; link = next) {
    next = next_of(link);
    const uint32_t neighbour = other_end(link);
    uint32_t twin = kNone;
    if (!clusters_[neighbour].hub) {
      twin = find_edge(neighbour, into);
    } else {
      const auto [place, is_new] = hub_edges_.try_emplace(pair_key(neighbour, into), link / 2);
      if (!is_new) twin = place->second;
    }
    if (twin == kNone) {
      push_link(into, link);
      touched_.push_back(link / 2);
      continue;
    }
    edges_[twin].shared += edges_[link / 2].shared;
    costs_.set(link / 2, CostTournament::kOut);
    drop_link(neighbour, link ^ 1);
    touched_.push_back(twin);
  }
  bound_costs(touched_);
}

/// Entries of clusters that have been absorbed stay in the map: nobody asks for them again.
void DualMerger::become_hub(uint32_t cluster) {
  clusters_[cluster].hub = true;
  hub_sizes_[cluster] = {clusters_[cluster].count, shapes_[cluster].area};
  for (uint32_t link = clusters_[cluster].first_link; link != kNone; link = next_of(link))
    if (clusters_[other_end(link)].hub) hub_edges_.emplace(pair_key(cluster, other_end(link)), link / 2);
}

void DualMerger::raise_version_when_grown(uint32_t hub) {
  HubSize& size = hub_sizes_[hub];
  const Cluster& c = clusters_[hub];
  if (c.count <= size.count + size.count / 16 && shapes_[hub].area <= size.area * (17.0f / 16)) return;
  size = {c.count, shapes_[hub].area};
  ++clusters_[hub].version;
}

uint32_t DualMerger::survivor(uint32_t c) {
  while (clusters_[c].parent != kNone) {
    const uint32_t parent = clusters_[c].parent, grand = clusters_[parent].parent;
    if (grand != kNone) clusters_[c].parent = grand;  // path halving
    c = parent;
  }
  return c;
}

}  // namespace goldthread
