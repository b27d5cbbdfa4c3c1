// Surfaces that are more or less than their polygons.
#pragma once
#include <vector>

#include "solve/matrix/form_factor_matrix.h"

namespace goldthread {

/// What View3D calls subsurfaces and combined surfaces.
struct SurfaceRoles {
  static constexpr uint32_t kNone = 0xffffffffu;
  std::vector<uint32_t> base;      ///< patch s lies within the outline of base[s], which is less by it
  std::vector<uint32_t> combined;  ///< patch p is counted as part of combined[p]

  bool any() const;
};

/// The matrix of the surfaces that remain, `kept` their numbers as patches: form factors are linear in both
/// areas, so that rows and columns are added and taken away, G' = L G L^T. Exchange within a combined
/// surface, between parts that see each other, stays as its own diagonal entry.
FormFactorMatrix fold_surfaces(const FormFactorMatrix& matrix, const SurfaceRoles& roles,
                               std::vector<uint32_t>& kept);

}  // namespace goldthread
