// The main job: a scene file in, a lit scene out. Also what `info` and `make` answer.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "goldthread/error.h"
#include "goldthread/light.h"

namespace goldthread {

enum class Quality { kDraft, kMedium, kHigh, kFinal };

/// How an output scene carries the light.
enum class OutputMode {
  kUnlit,        ///< COLOR_0 = linear outgoing light, KHR_materials_unlit
  kVertexLight,  ///< float attribute _IRRADIANCE (lux) beside untouched materials; _IRRADIANCE_BACK on
                 ///< two-sided ones
  kLightmap,     ///< textures under MOZ_lightmap beside materials that are else as they were
  kBaked,        ///< colour and light in one texture, KHR_materials_unlit: any viewer shows it
  kOcclusion,    ///< luminance as the materials' occlusion texture: viewers that know no light maps darken
                 ///< their own ambient light by it
};

/// How light-map files of their own hold lux.
enum class MapEncoding {
  kFloat,  ///< .exr: 32-bit floats
  kHalf,   ///< .exr: 16-bit floats, to 65504 lx
  kRgbe,   ///< .hdr, and .png with the exponent as alpha
  kRgbm,   ///< .png: alpha multiplies
  kRgbd,   ///< .png: alpha divides
  kSrgb,   ///< .png: eight bits as screens have them; the brightest texels are clipped
};

/// How light maps are laid out, for kLightmap, kBaked and kOcclusion.
struct LightmapOptions {
  uint32_t page_size = 1024;  ///< texels aside, 4 to 16384
  uint32_t pages = 1;         ///< at most, 1 to 256
  uint32_t padding = 2;       ///< free texels between charts, 0 to 64
  /// Pages as files of their own besides, irradiance in lux, .exr, .hdr or .png: room.exr stands for
  /// room-0.exr, room-1.exr ... and room.json, which lists them. Empty for none.
  std::string files;
  std::optional<MapEncoding> encoding;  ///< of `files`; none: kFloat, kRgbe or kRgbm, by extension
  double texel_density = 0;  ///< texels a metre, lowered where the pages cannot hold it; 0: what they hold
};

struct BakeOptions : LightOptions {
  std::string input;  ///< .gltf .glb .obj .ply .stl .fbx .dae
  std::vector<std::string>
      outputs;  ///< by extension: .glb .gltf (scene), .gold (solution), .png .exr (preview)
  /// Where to tell the light besides, as the reference does: JSON, a list of {"point": [x, y, z],
  /// "normal": [x, y, z]}, metres, on surfaces of the scene. It is gathered at each place, not interpolated
  /// between vertices, on the given plane as the surface's normal map bends it.
  std::string points_file;
  std::string json_file;  ///< the light at the points, lux; empty for none, "-" for standard output
  OutputMode mode = OutputMode::kVertexLight;
  LightmapOptions lightmap;
  Quality quality = Quality::kMedium;
  /// Root mean square error that is tolerated, over the mean of the light, 0.003 to 0.5: in the place of
  /// `quality`, whose presets are 0.15, 0.06, 0.03 and 0.015. What was reached is estimated and reported; a
  /// warning says when it is more.
  std::optional<double> error;
  std::optional<double> time_limit;    ///< seconds for the whole run
  std::optional<uint64_t> max_memory;  ///< bytes of resident memory
  int threads = 0;                     ///< 0: all
  uint64_t seed = 0;
  // What saves rays, each to be left out to learn what it is worth: certainty that nothing stands between two
  // elements, and no more rays than what they decide is worth.
  bool shafts = true, adaptive_sampling = true;
  bool discontinuities =
      true;                  ///< cut surfaces along the edges of shadows and the feet of what stands on them
  bool fix_normals = false;  ///< turn shells that are wound inside out
  int picture_width = 960, picture_height = 0;  ///< preview size; height 0 follows the camera's aspect
  std::string report_file;                      ///< JSON report, empty for none
  double exposure = 0;  ///< unlit and preview: multiplies light before tone mapping; 0 chooses
};

/// Where a bake is. Sent at least once a second while it runs.
struct BakeEvent {
  std::string stage;  ///< "load", "preprocess", "solve", "reconstruct", "represent", "write"
  double share = 0;   ///< of the whole run done, 0..1, an estimate
  double rays_per_second = 0;
  double error_estimate = 0;  ///< of the links together, as a share of the light: `link_error` of the report
  double seconds = 0;         ///< since the start
  double remaining_seconds = 0;  ///< an estimate, negative when unknown
};

/// The two hooks a caller has into a running bake. Both are called from the thread that called `bake`.
struct BakeListener {
  std::function<void(const BakeEvent&)> on_progress;  ///< may be empty
  std::function<bool()> cancelled;  ///< polled often; true stops the solve and writes what there is
};

/// What the report says (design.md section 9). `json` is the whole object, `line()` one sentence for a
/// person.
struct BakeResult {
  std::string json;
  std::string summary;
  std::string points_json;  ///< what `json_file` holds; empty without `points_file`
  std::vector<std::string> warnings;
  std::vector<std::string> written;  ///< files
  bool cancelled = false;
};

/// Reads, solves, reconstructs, writes. Outputs are written under a temporary name and renamed. On
/// cancellation the best solution so far is written and `cancelled` is set.
Result<BakeResult> bake(const BakeOptions& options, const BakeListener& listener = {});

/// What is in a scene file and what is wrong with it, as lines for a person and as JSON.
struct SceneInfo {
  std::string text;
  std::string json;
};
Result<SceneInfo> inspect(const std::string& file);

struct MakeOptions {
  std::string name;        ///< cornell-box, furnace, sphere, office, car, two-rooms
  uint64_t triangles = 0;  ///< wanted count, 0 for the scene's own
  std::string output;      ///< .glb or .gltf
};
/// Writes a procedural scene; returns the number of triangles made.
Result<uint64_t> make_scene(const MakeOptions& options);
/// The names `make_scene` knows, with a sentence each.
std::vector<std::pair<std::string, std::string>> scene_names();

}  // namespace goldthread
