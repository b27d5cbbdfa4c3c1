// Lamps that light nothing because of where they stand.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "visibility/ray_caster.h"

namespace goldthread {

/// A warning for each point or spot light that lies inside a closed solid: all of 64 rays in even directions,
/// or all but two, which may slip through seams, end on black backs. `ends_on_back(ray)` says whether one
/// does.
std::vector<std::string> describe_buried_lamps(const Scene& scene,
                                               const std::function<bool(const Ray&)>& ends_on_back);

}  // namespace goldthread
