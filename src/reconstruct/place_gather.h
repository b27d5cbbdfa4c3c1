// Light at any place of any surface, gathered there: no interpolation between vertices.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "reconstruct/final_gather.h"
#include "reconstruct/reconstruct.h"

namespace goldthread {

/// A place on one side of a source triangle.
struct SurfacePlace {
  uint32_t instance = 0, primitive = 0;  ///< Scene::instances, Mesh::primitives
  uint32_t triangle = 0;                 ///< of the source primitive
  bool back = false;                     ///< the back of a two-sided surface
  vec3 position{0};                      ///< world, metres, on the triangle
  vec3 normal{0};                        ///< unit: of the plane that light falls on
  vec3 surface{0};                       ///< unit: of the surface, where `normal` is bent from it; else 0
};

/// Finds the leaf elements of places. Borrows the pool, whose elements may grow meanwhile.
class PlaceFinder {
 public:
  explicit PlaceFinder(const ElementPool& pool);

  /// Nothing where the triangle receives no light: unlit, without area, or of one side only.
  std::optional<ElementId> leaf(const SurfacePlace& place) const;

 private:
  struct PartPlaces {
    uint32_t part = 0;
    std::vector<uint32_t> tree_triangle;  ///< by source triangle
    /// Surfaces' first triangles, ascending, and their elements, by side.
    std::vector<std::pair<uint32_t, ElementId>> roots[2];
  };
  const PartPlaces* find(uint32_t instance, uint32_t primitive) const;

  const ElementPool& pool_;
  std::vector<PartPlaces> parts_;  ///< by instance and primitive
};

/// Irradiance (lux, linear RGB) at every place: all links into its leaf and into what that is part of,
/// evaluated there (gather_at), with sources as bright as `shown` says, within their leaves, too. Nothing
/// where none is received. A bent normal may look below its surface, whence nothing comes. When cancelled,
/// the rest is the leaf's mean.
std::vector<std::optional<vec3>> gather_places(const HierarchicalSolver& solver, const ShownLight& shown,
                                               std::span<const SurfacePlace> places,
                                               const ReconstructOptions& options, const CancelToken& cancel,
                                               ReconstructStats& stats);

}  // namespace goldthread
