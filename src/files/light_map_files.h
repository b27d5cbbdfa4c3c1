// Light maps as files of their own, for engines that have no word for them in glTF.
#pragma once
#include <string>
#include <vector>

#include "goldthread/error.h"
#include "scene/light_atlas.h"
#include "scene/scene.h"

namespace goldthread {

/// What the pages beside `file` and the list of them are called: room.exr stands for room-0.exr, room-1.exr
/// ... and room.json.
std::string light_map_page_file(const std::string& file, size_t page);
std::string light_map_list_file(const std::string& file);

/// Writes each page, linear irradiance in lux, as `file` ends: .exr (32-bit floats; a layer A has 1 where a
/// triangle covers the texel) or .hdr; and a JSON list of them: `encoding`, `unit`, `texels_per_metre`,
/// `pages` (file, size, least and greatest irradiance) and `objects` (instance and its name, primitive, side,
/// page, the box of its coordinates). Returns the files written.
Result<std::vector<std::string>> write_light_map_files(const std::string& file, const Scene& scene,
                                                       const LightAtlas& atlas);

}  // namespace goldthread
