// Which way shells are wound: triangles against their neighbours, and closed shells that are inside out.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "math/box.h"
#include "mesh/triangle_mesh.h"

namespace goldthread {

/// One connected component.
struct Shell {
  uint64_t triangles = 0;
  uint64_t against = 0;  ///< wound against the greater part (by area) of the shell
  bool closed = false;   ///< every edge has a triangle on both sides
  bool orientable =
      true;  ///< false when no winding suits all triangles, as on a Moebius strip; then `against` is 0
  double area = 0;
  double volume = 0;  ///< enclosed, positive when the greater part faces outwards; meaningful when closed
  Box box;

  /// Closed round a volume that is more than rounding, and facing into it. A room seen from inside is so on
  /// purpose.
  bool faces_inwards() const;
};

struct Winding {
  std::vector<Shell> shells;
  std::vector<uint32_t> shell_of_triangle;
  std::vector<uint8_t> against;  ///< per triangle, 1: wound against the greater part of its shell
};

/// Spreads one winding over each shell, from neighbour to neighbour (`twins` of find_twins()), and measures
/// the shells.
Winding find_winding(const TriangleMesh& mesh, std::span<const uint32_t> twins);

/// Per triangle 1 where it must be turned for every shell to be wound one way and for closed shells to face
/// outwards, except those with a 1 in `rooms` (per shell; empty for none), which keep facing inwards. Open
/// shells keep the winding of their greater part.
std::vector<uint8_t> triangles_to_turn(const Winding& winding, std::span<const uint8_t> rooms);

}  // namespace goldthread
