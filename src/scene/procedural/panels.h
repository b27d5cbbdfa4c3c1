// A tessellated assembly: curved panels, each cut into long thin triangles, their rates chosen together for a
// wished total.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "scene/procedural/shapes.h"

namespace goldthread::procedural {

/// One open or closed shell.
struct Panel {
  std::string name;
  uint32_t material = 0;
  Surface surface;
  int copies = 1;                     ///< how many instances there are of it
  double length_u = 0, length_v = 0;  ///< metres along u and along v, on average
  double aspect = 1;                  ///< wanted cell length along u over that along v
  int least_u = 1, least_v = 1;       ///< rates below which the shape would suffer
  int rate_u = 1, rate_v = 1;         ///< cells along u and along v

  uint64_t triangle_count() const { return 2 * uint64_t(rate_u) * uint64_t(rate_v) * uint64_t(copies); }
};

/// Collects panels; measures each when it is added.
class PanelList {
 public:
  /// `front` is a direction: the panel is turned so that its normal in the middle points that way.
  void add(std::string name, uint32_t material, Surface surface, const dvec3& front);
  /// Adds a surface whose front is right as it is (`tube`, `ring`, `pillow`).
  void add(std::string name, uint32_t material, Surface surface);
  /// The same panel on the left and, mirrored in z, on the right. `front` is that of the left one, at +z.
  void add_pair(const std::string& name, uint32_t material, const Surface& surface, const dvec3& front);
  void add_pair(const std::string& name, uint32_t material, const Surface& surface);

  std::vector<Panel>& panels() { return panels_; }

 private:
  std::vector<Panel> panels_;
};

/// Chooses rate_u and rate_v of every panel so that all copies together have about `triangles`: cells of one
/// area everywhere, drawn out by each panel's aspect, but never below the least rates.
void choose_rates(std::vector<Panel*>& panels, uint64_t triangles);

/// The part of a surface between two values of u and of v.
Surface part_of(const Surface& surface, double u0, double u1, double v0, double v1);
/// The surface mirrored in z.
Surface mirrored(const Surface& surface);

}  // namespace goldthread::procedural
