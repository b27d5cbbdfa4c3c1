// A LightAtlas as a function: how much light falls on this point of this surface.
#pragma once
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "scene/light_atlas.h"
#include "scene/scene.h"

namespace goldthread {

/// Reads the maps as viewers do, bilinearly. Borrows the atlas, which must outlive it.
class LightAtlasLookup {
 public:
  LightAtlasLookup(const Scene& scene, const LightAtlas& atlas);

  /// Irradiance (lux, linear RGB) on one side of a source triangle, `weights` those of its corners 1 and 2.
  /// Nothing where no map has it.
  std::optional<vec3> irradiance(uint32_t instance, uint32_t primitive, uint32_t triangle, vec2 weights,
                                 bool back) const;

 private:
  struct Place {
    uint32_t mesh = kNowhere, face = 0;
  };
  static constexpr uint32_t kNowhere = 0xffffffffu;

  const LightAtlas& atlas_;
  /// By instance, primitive and side, of each source triangle.
  std::map<std::tuple<uint32_t, uint32_t, bool>, std::vector<Place>> places_;
};

/// Bilinear, texels' centres at halves; `at` is 0..1 of the page. Beyond the outermost centres their value.
vec3 sample_page(const FloatImage& page, const vec2& at);

}  // namespace goldthread
