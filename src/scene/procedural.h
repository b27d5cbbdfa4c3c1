// Scenes of our own, made from nothing.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "goldthread/error.h"
#include "scene/scene.h"

namespace goldthread {

/// Builds the scene called `name` with about `triangles` triangles (0: its own number). Unknown names are an
/// Error that lists the known ones.
Result<Scene> build_procedural(std::string_view name, uint64_t triangles);

/// The known names with a sentence each.
std::vector<std::pair<std::string, std::string>> procedural_names();

}  // namespace goldthread
