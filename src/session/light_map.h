// Measured texels as light maps: which there are, what they are called, and their files.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "goldthread/error.h"
#include "session/reference_points.h"
#include "trace/texel_receivers.h"

namespace goldthread {

/// One side of one primitive of one instance: a run of an estimate's receivers.
struct LightMap {
  uint32_t instance = 0, primitive = 0;
  bool back = false;
  size_t first = 0, count = 0;  ///< of SavedEstimate::receivers, all of them texels
};

/// The maps that the estimate's receivers make up, in their order; none where they are no texels.
std::vector<LightMap> light_maps_of(const std::vector<Receiver>& receivers);

/// What to call a map: `file` itself where it is the only one; else with "-INSTANCE-PRIMITIVE" before the
/// extension, numbers from 0, and "-back" after them for the back of what is two-sided.
std::string light_map_file(const std::string& file, const LightMap& map, size_t map_count);

/// Linear irradiance R, G, B in lux; A, 1 where a triangle covers the texel's centre and else 0; `samples`;
/// and `error`, the standard error of the irradiance's luminance, lux. Uncovered texels are 0 in all.
Status write_light_map(const std::string& file, const SavedEstimate& estimate, const LightMap& map);

/// The maps as a report lists them: `instance`, its `name`, `primitive`, `back`, `texels` (covered ones).
nlohmann::ordered_json describe_light_maps(const std::vector<LightMap>& maps, const Scene& scene);

/// The problems a line each, for a person.
std::vector<std::string> texel_warnings(const TexelProblems& problems, const TexelLayout& layout);
/// Why there is not one receiver though something is lit.
Error no_texels(const TexelReceivers& texels, const TexelLayout& layout, const std::string& scene_file);

}  // namespace goldthread
