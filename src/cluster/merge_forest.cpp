#include "cluster/merge_forest.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "cluster/regions.h"
#include "math/box.h"
#include "mesh/components.h"
#include "mesh/dual_graph.h"

namespace goldthread {
namespace {

/// A smaller k would be lost in the rounding of E_fit: on planes, where E_fit is 0, clusters would grow by
/// number alone.
constexpr float kLeastBalance = 1e-6f;

constexpr uint32_t kNone = 0xffffffffu;

/// Mesh space moved and scaled to a box of about unit size, by a power of two: the tree of a mesh scaled by a
/// power of two is the same to the bit, and costs neither overflow nor underflow.
struct UnitFrame {
  vec3 origin{0};
  float scale = 1;

  explicit UnitFrame(std::span<const vec3> positions) {
    Box box;
    for (const vec3& p : positions) box.add(p);
    if (box.empty()) return;
    origin = 0.5f * box.low + 0.5f * box.high;
    const vec3 half = glm::max(box.high - origin, origin - box.low);
    const float extent = std::max({half.x, half.y, half.z});
    if (extent > 0) scale = std::ldexp(1.0f, std::clamp(-std::ilogb(extent), -126, 126));
  }
  vec3 operator()(const vec3& p) const { return (p - origin) * scale; }
};

/// A boundary between two clusters that regions have left, numbered within their component.
struct Boundary {
  uint32_t a, b;
  float length;
};

/// What a region leaves for the final pass of its component.
struct Remainder {
  std::vector<uint32_t> names, counts;
  std::vector<ClusterShape> shapes;
  std::vector<Boundary> boundaries;
};

class Builder {
 public:
  Builder(const TriangleMesh& mesh, const FaceClusterOptions& options)
      : mesh_(mesh),
        options_(options),
        balance_(std::max(options.balance, kLeastBalance)),
        frame_(mesh.positions) {}

  MergeForest build() {
    twins_ = find_twins(mesh_);
    make_regions(mesh_, find_components(twins_), options_.region_triangles, forest_);
    number_slots();
    forest_.merges.resize(forest_.slots());
    costs_computed_.resize(forest_.regions.size(), 0);
    remainder_of_slot_.resize(many_regions_ ? forest_.slots() : 0, kNone);
    remainders_.resize(many_regions_ ? forest_.regions.size() : 0);
    parallel_for(forest_.components.size(), [&](size_t c) { collapse_component(forest_.components[c]); });
    for (const uint64_t n : costs_computed_) forest_.costs_computed += n;
    return std::move(forest_);
  }

 private:
  struct Scratch {
    DualMerger merger;
    std::vector<Merge> merges;
  };

  void number_slots() {
    slot_of_.resize(forest_.slots());
    parallel_for(
        slot_of_.size(), [&](size_t slot) { slot_of_[forest_.triangle_at[slot]] = uint32_t(slot); }, 16384);
    for (const auto& c : forest_.components) many_regions_ |= c.region_end - c.first_region > 1;
  }

  void collapse_component(MergeForest::Component& component) {
    if (component.region_end - component.first_region == 1)
      return collapse_region(component.first_region, true);
    parallel_for(component.region_end - component.first_region,
                 [&](size_t r) { collapse_region(uint32_t(component.first_region + r), false); });
    final_pass(component);
  }

  vec3 corner(uint32_t triangle, uint32_t k) const {
    return frame_(mesh_.positions[mesh_.triangles[triangle][int(k)]]);
  }

  float edge_length(uint32_t half_edge) const {
    return length(corner(half_edge / 3, (half_edge + 1) % 3) - corner(half_edge / 3, half_edge % 3));
  }

  void collapse_region(uint32_t number, bool whole) {
    MergeForest::Region& region = forest_.regions[number];
    if (whole && region.end - region.begin == 1) return;
    Scratch& scratch = scratch_.local();
    add_triangles(region, scratch.merger);
    const uint32_t reduction = std::max(options_.region_reduction, 1u);
    scratch.merges.clear();
    scratch.merger.run(balance_, whole ? 1 : std::max((region.end - region.begin) / reduction, 1u),
                       region.begin, scratch.merges);
    region.merges = uint32_t(scratch.merges.size());
    std::copy(scratch.merges.begin(), scratch.merges.end(), forest_.merges.begin() + region.begin);
    costs_computed_[number] = scratch.merger.costs_computed();
    if (!whole) leave_remainder(region, scratch.merger, remainders_[number]);
  }

  void add_triangles(const MergeForest::Region& region, DualMerger& merger) const {
    merger.clear();
    for (uint32_t slot = region.begin; slot < region.end; ++slot) {
      const uint32_t t = forest_.triangle_at[slot];
      merger.add_cluster(shape_of_triangle(corner(t, 0), corner(t, 1), corner(t, 2)), slot | kTriangleBit, 1);
    }
    for (uint32_t slot = region.begin; slot < region.end; ++slot) {
      for (uint32_t k = 0; k < 3; ++k) {
        const uint32_t half_edge = 3 * forest_.triangle_at[slot] + k, twin = twins_[half_edge];
        if (twin == kNoTwin) continue;
        const uint32_t other = slot_of_[twin / 3];
        if (other > slot && other < region.end)
          merger.add_boundary(slot - region.begin, other - region.begin, edge_length(half_edge));
      }
    }
  }

  void leave_remainder(const MergeForest::Region& region, DualMerger& merger, Remainder& remainder) {
    std::vector<uint32_t> number(merger.cluster_count(), kNone);
    for (uint32_t c = 0; c < merger.cluster_count(); ++c) {
      if (!merger.alive(c)) continue;
      number[c] = uint32_t(remainder.names.size());
      remainder.names.push_back(merger.name(c));
      remainder.counts.push_back(merger.count(c));
      remainder.shapes.push_back(merger.shape(c));
    }
    for (uint32_t c = 0; c < merger.cluster_count(); ++c)
      remainder_of_slot_[region.begin + c] = number[merger.survivor(c)];
    merger.for_edges([&](uint32_t a, uint32_t b, float shared) {
      remainder.boundaries.push_back({number[a], number[b], shared});
    });
  }

  /// Collapses what the regions of a component have left, with the boundaries within and between them.
  void final_pass(MergeForest::Component& component) {
    DualMerger merger;
    std::vector<uint32_t> base(component.region_end - component.first_region);
    std::vector<Boundary> boundaries;
    for (uint32_t r = component.first_region; r < component.region_end; ++r) {
      const uint32_t first = base[r - component.first_region] = uint32_t(merger.cluster_count());
      const Remainder& left = remainders_[r];
      for (size_t i = 0; i < left.names.size(); ++i)
        merger.add_cluster(left.shapes[i], left.names[i], left.counts[i]);
      for (const Boundary& b : left.boundaries) boundaries.push_back({first + b.a, first + b.b, b.length});
    }
    add_crossings(component, base, boundaries);
    for (uint32_t r = component.first_region; r < component.region_end; ++r) remainders_[r] = {};
    add_summed(boundaries, merger);
    merger.run(balance_, 1, forest_.slots(), component.final_merges);
    costs_computed_[component.first_region] += merger.costs_computed();
  }

  /// Edges whose two triangles lie in different regions.
  void add_crossings(const MergeForest::Component& component, std::span<const uint32_t> base,
                     std::vector<Boundary>& boundaries) const {
    const auto first_region = forest_.regions.begin() + component.first_region;
    const auto region_of = [&](uint32_t slot) {
      const auto after =
          std::upper_bound(first_region, forest_.regions.begin() + component.region_end, slot,
                           [](uint32_t s, const MergeForest::Region& r) { return s < r.begin; });
      return size_t(after - first_region) - 1;
    };
    std::vector<std::vector<Boundary>> crossings(base.size());
    parallel_for(base.size(), [&](size_t r) {
      const MergeForest::Region& region = first_region[ptrdiff_t(r)];
      for (uint32_t slot = region.begin; slot < region.end; ++slot)
        for (uint32_t k = 0; k < 3; ++k) {
          const uint32_t half_edge = 3 * forest_.triangle_at[slot] + k;
          if (twins_[half_edge] == kNoTwin) continue;
          const uint32_t other = slot_of_[twins_[half_edge] / 3];
          if (other < region.end) continue;  // seen from the lower slot only
          crossings[r].push_back({base[r] + remainder_of_slot_[slot],
                                  base[region_of(other)] + remainder_of_slot_[other],
                                  edge_length(half_edge)});
        }
    });
    for (const auto& list : crossings) boundaries.insert(boundaries.end(), list.begin(), list.end());
  }

  static void add_summed(std::vector<Boundary>& boundaries, DualMerger& merger) {
    for (Boundary& b : boundaries)
      if (b.a > b.b) std::swap(b.a, b.b);
    const auto before = [](const Boundary& x, const Boundary& y) {
      return x.a != y.a ? x.a < y.a : x.b < y.b;
    };
    std::stable_sort(boundaries.begin(), boundaries.end(), before);
    for (size_t i = 0; i < boundaries.size();) {
      Boundary sum = boundaries[i++];
      for (; i < boundaries.size() && !before(sum, boundaries[i]); ++i) sum.length += boundaries[i].length;
      merger.add_edge(sum.a, sum.b, sum.length);
    }
  }

  const TriangleMesh& mesh_;
  const FaceClusterOptions& options_;
  float balance_;
  UnitFrame frame_;
  MergeForest forest_;
  bool many_regions_ = false;
  std::vector<uint32_t> twins_, slot_of_;
  std::vector<uint32_t> remainder_of_slot_;  ///< number of the cluster in its region's remainder
  std::vector<Remainder> remainders_;        ///< by region
  std::vector<uint64_t> costs_computed_;     ///< by region
  tbb::enumerable_thread_specific<Scratch> scratch_;
};

}  // namespace

MergeForest merge_triangles(const TriangleMesh& mesh, const FaceClusterOptions& options) {
  return Builder(mesh, options).build();
}

}  // namespace goldthread
