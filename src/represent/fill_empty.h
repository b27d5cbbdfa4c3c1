// What lies on a page beside its charts: filters and coarser levels read it, too.
#pragma once
#include <cstdint>
#include <vector>

#include "scene/image.h"

namespace goldthread {

/// Gives every texel that is not `covered` (by row and column, not 0) a value. The next `rings` texels round
/// what is covered take the mean of their neighbours in the ring before them, so that a texture filter on a
/// chart's edge reads the chart's own light; all others are filled by pull-push (Gortler et al. 1996; thesis
/// 5.2.6), so that coarse levels of detail hold what is near. Covered texels stay. All 0 where nothing is
/// covered.
void fill_empty(FloatImage& page, const std::vector<uint8_t>& covered, uint32_t rings);

}  // namespace goldthread
