// Places that nobody can see.
#pragma once
#include "solve/hierarchical/source_rays.h"

namespace goldthread {

/// Whether all but a little of what lies before `x` (unit normal `n`) is the black back of something: it lies
/// inside a solid, as the floor does beneath a box. A place in a gap, however thin, looks at fronts, and is
/// dark in earnest. Up to 32 rays, fewer where it is open.
bool is_buried(const ElementPool& pool, const Visibility& visibility, const vec3& x, const vec3& n,
               RayCount& rays);

}  // namespace goldthread
