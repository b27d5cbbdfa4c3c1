// Where on which page the light of each triangle goes (thesis 5.2).
#pragma once
#include <optional>
#include <span>

#include "represent/atlas/chart.h"
#include "represent/atlas/pack.h"
#include "scene/light_atlas.h"
#include "scene/scene.h"

namespace goldthread {

/// A lit primitive of an instance, and the clusters of its triangles.
struct AtlasPart {
  uint32_t instance = 0, primitive = 0;
  const FaceClusterTree* tree = nullptr;  ///< borrowed; shared where instances share it
  float scale = 1;                        ///< metres a unit of the tree's positions
};

/// The area of a tree's triangles, in its own units.
double surface_of(const FaceClusterTree& tree);

/// Of all surfaces' area: what a chart may leave free of its box (ChartOptions::most_waste).
constexpr double kMostWaste = 0.01;

struct AtlasOptions {
  ChartOptions charts;
  PackOptions pages;
};

struct AtlasStats {
  ChartStats charts;    ///< each tree's once, however often it is placed
  uint64_t placed = 0;  ///< charts on pages: instances and sides have their own
  double use = 0;       ///< Packing::use
};

/// Every side that viewers show of every primitive in `lighting` gets its charts on pages that hold no light
/// yet. `parts` are those of the lighting and may be more. What has no area is left out: it cannot be seen.
/// Triangles that lie in a primitive twice share a place. Nothing when it does not fit whatever the density,
/// or when cancelled.
std::optional<LightAtlas> lay_out_atlas(const Scene& scene, const Lighting& lighting,
                                        std::span<const AtlasPart> parts, const AtlasOptions& options,
                                        const CancelToken& cancel, AtlasStats& stats);

}  // namespace goldthread
