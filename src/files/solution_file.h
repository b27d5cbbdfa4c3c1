// The .gold file: a solution kept for later commands. Format in docs/solution_file.md.
#pragma once
#include <optional>
#include <string>

#include "goldthread/error.h"
#include "scene/light_atlas.h"
#include "scene/lighting.h"
#include "scene/scene.h"

namespace goldthread {

struct Solution {
  std::string report_json;
  Scene scene;  ///< everything needed to look at the light: geometry, materials, textures, cameras, lights
  Lighting lighting;
  std::optional<LightAtlas> atlas;  ///< where the light was put on textures, too
};

/// Versioned and checksummed, on SQLite. Written under a temporary name and renamed.
Status write_solution(const std::string& file, const Solution& solution);
/// A wrong version, checksum or count is an Error that names it.
Result<Solution> read_solution(const std::string& file);

}  // namespace goldthread
