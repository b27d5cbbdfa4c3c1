// Maps of a piece of surface to the plane.
#pragma once
#include <optional>
#include <vector>

#include "represent/atlas/piece.h"

namespace goldthread {

using PlaneImage = std::vector<dvec2>;  ///< where each corner of a piece lies in the plane

/// Straight down on the plane across the piece's mean normal. Nothing when it has none.
std::optional<PlaneImage> project(const Piece& piece);

/// The map that keeps angles best (Levy et al. 2002), as large as the surface. Nothing when the system cannot
/// be solved or its image has no area. Triangles may be turned over.
std::optional<PlaneImage> map_conformally(const Piece& piece);

/// By area: the root mean square of the larger singular value of the map from the surface, or of the larger
/// one of its inverse, whichever is more (Sander et al. 2001). Infinite where a triangle has no image.
double stretch_of(const Piece& piece, const PlaneImage& image);

}  // namespace goldthread
