// Light maps as files of their own, for engines that have no word for them in glTF.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "files/light_map_encode.h"
#include "goldthread/bake.h"
#include "goldthread/error.h"
#include "scene/light_atlas.h"
#include "scene/scene.h"

namespace goldthread {

/// What the pages beside `file` and the list of them are called: room.exr stands for room-0.exr, room-1.exr
/// ... and room.json.
std::string light_map_page_file(const std::string& file, size_t page);
std::string light_map_list_file(const std::string& file);

/// What a file of `extension` (with its dot) may be encoded as, the usual one first. None: no such files.
std::span<const MapEncoding> encodings_of(const std::string& extension);

/// Writes each page, irradiance in lux, in `encoding`, which is one of those of the file's extension: .exr
/// (a layer A has 1 where a triangle covers the texel), .hdr or .png (PackedLight); and a JSON list of them:
/// `encoding`, `unit`, `texels_per_metre`, `pages` (file, size, least and greatest irradiance, and of .png
/// `scale`) and `objects` (instance and its name, primitive, side, page, the box of its coordinates).
/// `encoded` has one a page. Returns the files written.
Result<std::vector<std::string>> write_light_map_files(const std::string& file, MapEncoding encoding,
                                                       const Scene& scene, const LightAtlas& atlas,
                                                       std::span<const EncodedPage> encoded);

}  // namespace goldthread
