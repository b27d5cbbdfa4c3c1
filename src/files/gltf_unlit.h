// Materials that show baked light as it is: COLOR_0 times the base-colour texture, under KHR_materials_unlit.
#pragma once
#include <map>
#include <optional>
#include <vector>

#include "files/gltf_document.h"
#include "scene/lighting.h"
#include "scene/scene.h"

namespace goldthread {

/// Takes off a material (JSON) what no unlit one has, or what would light it twice. Other extensions and
/// extras stay.
void drop_shading(Json& material);

/// One document's unlit materials. Each material in use is copied once; the originals stay.
class UnlitMaterials {
 public:
  UnlitMaterials(GltfDocument& document, const Scene& scene, float exposure)
      : document_(document), scene_(scene), exposure_(exposure) {}

  /// Gives `primitive` (JSON) its COLOR_0 and its unlit material.
  ///
  /// COLOR_0 is the outgoing radiance (emission + reflectance * irradiance / pi) * exposure, clamped to 0..1.
  /// Where a base-colour texture stays on the material, it is divided out: the irradiance term leaves it
  /// away, and emission is divided by the texture's average, which is right on average only. A two-sided
  /// surface has one COLOR_0 for both sides: at each vertex the brighter one's.
  void apply(Json& primitive, const LitPrimitive& lit);

 private:
  uint32_t material_for(const Json& primitive);
  std::vector<vec4> outgoing(const LitPrimitive& lit, bool textured);
  const vec3& average(int32_t image);

  GltfDocument& document_;
  const Scene& scene_;
  float exposure_;
  std::map<int64_t, uint32_t> copies_;  ///< by source material, -1 for none
  std::map<int32_t, vec3> averages_;    ///< by image, linear
};

}  // namespace goldthread
