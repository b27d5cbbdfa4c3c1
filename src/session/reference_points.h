// Lists of points in and out: what is to be measured, what was, and all that is needed to go on.
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "goldthread/error.h"
#include "trace/irradiance_estimate.h"
#include "trace/texel_receivers.h"

namespace goldthread {

/// Reads [{"point": [x, y, z], "normal": [x, y, z]}, ...], in metres; normals need not be unit. Every point
/// must lie on a surface of the scene, whose normal texture bends the normal (place_receiver). Errors name
/// the file and the record, as "point 3", counted from 0.
Result<std::vector<Receiver>> read_points(const std::string& file, const TracedScene& scene);

/// Light at the same places by other means: [{"point", "normal", "irradiance"}, ...] under "points" in
/// `figures`, a point a line; irradiance in lux, null where `light` has none.
std::string write_light(nlohmann::ordered_json figures, const std::vector<Receiver>& receivers,
                        const std::vector<std::optional<vec3>>& light);

/// An estimate that was written.
struct SavedEstimate {
  uint64_t seed = 0, fingerprint = 0;
  uint64_t rays = 0;
  double seconds = 0, ray_time_share = 0;
  TexelLayout layout;  ///< width 0 where the receivers are no texels
  std::vector<Receiver> receivers;
  std::vector<IrradianceSums> sums;
};

/// `figures` as a JSON object with all that `read_estimate` needs besides, a point a line: its place (with
/// `instance`, `primitive`, `back`, and `vertex` or `texel` [x, y] of what is one; with `surface`, the
/// surface's own normal, where a normal map bends it), its irradiance (lux), standard error and samples, and
/// its batches' sums, whose doubles survive the text exactly. Points without samples have null for irradiance
/// and error.
std::string write_estimate(nlohmann::ordered_json figures, const SavedEstimate& estimate);
Result<SavedEstimate> read_estimate(const std::string& file);

}  // namespace goldthread
