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

/// Polygons that exchange with their fronts and block with both sides. `base`, `combined`: numbers of
/// surfaces as View3D has them, kNone for most; empty for none at all.
struct PolygonModel {
  static constexpr uint32_t kNone = 0xffffffffu;

  std::string id;
  std::vector<std::string> names;  ///< one a surface
  std::vector<Polygon> surfaces;
  std::vector<Polygon> occluders;  ///< only block
  std::vector<uint32_t> base, combined;
};

struct FormFactorInput {
  std::vector<ShapePair> pairs;
  std::vector<PolygonModel> models;
  std::vector<std::string> warnings;
};

}  // namespace goldthread
