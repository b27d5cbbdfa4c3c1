// Surfaces that are more or less than their polygons.
#pragma once
#include <vector>

#include "scene/polygon_model.h"
#include "solve/matrix/form_factor_matrix.h"

namespace goldthread {

/// What View3D calls subsurfaces, combined surfaces, masks and null surfaces; each list empty or one a patch.
struct SurfaceRoles {
  static constexpr uint32_t kNone = PolygonModel::kNone;
  std::vector<uint32_t> base;      ///< patch s lies within the outline of base[s], which is less by it
  std::vector<uint32_t> combined;  ///< patch p is counted as part of combined[p]
  std::vector<Cover> cover;  ///< patch m is the part of base[m] that such a surface covers, facing as it does

  bool any() const;
  Cover cover_of(uint32_t patch) const { return cover.empty() ? Cover::kNothing : cover[patch]; }
};

/// The matrix of the surfaces that remain, `kept` their numbers as patches: form factors are linear in both
/// areas, so that rows and columns are added and taken away, G' = L G L^T. Exchange within a combined
/// surface, between parts that see each other, stays as its own diagonal entry. A mask exchanges all of its
/// area with its base, whose own area stays whole; a null surface is not kept, and its base's area is less by
/// it. What others send to where a mask or null surface lies counts as met by backs.
FormFactorMatrix fold_surfaces(const FormFactorMatrix& matrix, const SurfaceRoles& roles,
                               std::vector<uint32_t>& kept);

}  // namespace goldthread
