// What `formfactors` is asked about: pairs of shapes, or models of polygons.
#pragma once
#include <string>
#include <vector>

#include "math/shape.h"

namespace goldthread {

/// One form factor, with what may stand in between.
struct ShapePair {
  std::string id;
  Shape from, to;
  std::vector<Polygon> occluders;
};

/// What a surface that lies on its base, face to face, does to it (View3D's user manual, "Surface Types").
enum class Cover : uint8_t {
  kNothing,  ///< it is no such surface
  kMask,     ///< covers that part of the base, which sees nothing but the mask, and the mask nothing but it
  kNull,     ///< takes that part of the base away, and is none of the model's surfaces itself
};

/// Polygons that exchange with their fronts and block with both sides. `base`, `combined`: numbers of
/// surfaces as View3D has them, kNone for most; `cover`: what each does to its base. Masks and null surfaces
/// are held as the part of the base that they cover: they face as it does, and not as in the file. All three
/// are empty for none at all.
struct PolygonModel {
  static constexpr uint32_t kNone = 0xffffffffu;

  std::string id;
  std::vector<std::string> names;  ///< one a surface
  std::vector<Polygon> surfaces;
  std::vector<Polygon> occluders;  ///< only block
  std::vector<uint32_t> base, combined;
  std::vector<Cover> cover;
  bool on_occluders = false;  ///< some surface lies on an occluder, which takes nothing from it
};

struct FormFactorInput {
  std::vector<ShapePair> pairs;
  std::vector<PolygonModel> models;
  std::vector<std::string> warnings;
};

}  // namespace goldthread
