// The yardstick: irradiance and pictures by unbiased path tracing, with their standard errors.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "goldthread/bake.h"
#include "goldthread/error.h"

namespace goldthread {

/// What to measure is one of: `points_file`, `random_points`, `vertices`, `texels`, `resume_file`,
/// `pictures`. `resume_file` and `pictures` together go on with a picture, or with light maps; `texels` and
/// `pictures` together write light maps.
struct ReferenceOptions : LightOptions {
  std::string input;  ///< scene, as in BakeOptions

  /// JSON: [{"point": [x, y, z], "normal": [x, y, z]}, ...], metres. Where the surface has a normal map, that
  /// bends the normal; the results have the bent one. Random points and vertices are not bent.
  std::string points_file;
  uint64_t random_points = 0;  ///< spread over all lit sides by area
  bool vertices = false;       ///< all vertices of all instances

  /// The texels of a light map for each lit primitive of each instance, laid out by its texture coordinates:
  /// irradiance where a texel's centre, u = (x + 1/2) / width and v = (y + 1/2) / height, falls on a
  /// triangle, by the file's interpolated normal, or the flat face's where the file has none, bent by the
  /// normal map if there is one. Two-sided
  /// primitives have a map a side. Texels that no triangle covers have no value; of overlapping triangles
  /// the first in the file has the texel. That, primitives without coordinates, and triangles beyond 0..1 or
  /// without area there, are counted in warnings; ErrorCode::kBadInput where no texel is left.
  struct Texels {
    int width = 0, height = 0;  ///< 1..16384
    std::optional<int> uv;      ///< TEXCOORD_0 or 1; absent: 1 where a primitive has it, else 0
  };
  std::optional<Texels> texels;

  /// Go on from an earlier `json_file` of the same scene and light, or, for `pictures`, from an .exr.
  std::string resume_file;
  /// .png .exr: radiance through the scene's camera; an .exr also holds each pixel's samples and standard
  /// error. Of texels, .exr: irradiance in lux (R, G, B), A (1 where a triangle covers the texel's centre,
  /// else 0 in all channels), `samples`, and `error`, the standard error of its luminance, lux; row 0 is
  /// v = 0. One map alone takes the name as it is; of several, map.exr becomes map-INSTANCE-PRIMITIVE.exr,
  /// numbered from 0 as in `json`, with -back for the backs of what is two-sided.
  std::vector<std::string> pictures;

  std::string json_file;    ///< results of points; empty for none, "-" for standard output
  std::string report_file;  ///< figures of the run as JSON, empty for none

  /// When to stop; the first that is reached. With none of the three: 1024 samples a point, 64 a pixel.
  std::optional<uint64_t> samples;     ///< a point or pixel, rounded up to a multiple of 16
  std::optional<double> time_limit;    ///< seconds for the whole run
  std::optional<double> target_error;  ///< mean over points of standard error over mean, as 0.01

  int threads = 0;               ///< 0: all
  std::optional<uint64_t> seed;  ///< 0 when absent; when resuming, the file's
  int picture_width = 960, picture_height = 0;
  double exposure = 0;  ///< of a .png; 0 chooses
};

struct ReferenceResult {
  /// Figures of the run: `scene`, `samples` (least and most), `mean_relative_error`, `irradiance_lx` (least,
  /// mean, most), `rays`, `seconds`, `mrays_per_second`, `ray_time_share`, `seed`, `threads`, `stopped_by`,
  /// `warnings`; of texels, `light_maps`, a list of `instance`, `name`, `primitive`, `back`, `texels`.
  std::string report;
  std::string summary;  ///< the same for a person, some lines
  std::string json;     ///< `report` with `points`, of which each has its `irradiance`; empty for pictures
  std::vector<std::string> warnings;
  std::vector<std::string> written;  ///< files
  bool cancelled = false;
};

/// Path traces the scene with next-event estimation, multiple importance sampling and Russian roulette. The
/// same seed gives the same numbers for any number of threads, and continued runs give the same as
/// uninterrupted ones; of pictures, to single precision. On cancellation, within a second, what there is is
/// written and `cancelled` is set.
Result<ReferenceResult> reference(const ReferenceOptions& options, const BakeListener& listener = {});

}  // namespace goldthread
