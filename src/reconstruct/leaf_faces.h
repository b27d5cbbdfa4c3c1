// The faces of a leaf as triangles, among which places are chosen evenly by area.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "reconstruct/light_points.h"

namespace goldthread {

/// A place on a face, between three light points.
struct FacePlace {
  std::array<uint32_t, 3> corners{};  ///< PartPoints::points
  std::array<float, 3> weights{};     ///< that add up to one
  uint32_t face = 0;
};

class LeafFaces {
 public:
  /// Triangulates a face as it will be in the output.
  void add(const PartPoints& points, uint32_t face);

  bool has_area() const { return !up_to_.empty() && up_to_.back() > 0; }
  /// Light points, three a triangle.
  std::span<const uint32_t> corners() const { return corners_; }
  /// Numbers within 0..1 to places, evenly by area; has_area() must hold.
  FacePlace place(float u, float v) const;

 private:
  std::vector<uint32_t> corners_;  // points, three a triangle
  std::vector<uint32_t> faces_;    // that they are of
  std::vector<float> up_to_;       // running sum of areas
};

}  // namespace goldthread
