// The procedural scenes, one function and one file each. `triangles` is the wish, 0 for the scene's own
// number.
#pragma once
#include <cstdint>

#include "scene/scene.h"

namespace goldthread::procedural {

/// The Cornell box as measured (Cornell University Program of Computer Graphics, "The Cornell Box", data
/// page), in metres, front open, with the red, green and white of common use in linear RGB.
Scene cornell_box(uint64_t triangles);

/// Closed unit cube seen from inside: every face emits 1/pi nits (exitance E = 1 lm/m2) and reflects 0.5, so
/// that the irradiance is E / (1 - 0.5) = 2 lux everywhere.
Scene furnace(uint64_t triangles);

/// The same light in a closed sphere of radius 1 m.
Scene sphere(uint64_t triangles);

/// Two office cubicles in a closed room, after the model of Cohen, Chen, Wallace and Greenberg (SIGGRAPH
/// 1988).
Scene office(uint64_t triangles);

/// A car of curved, separate panels with long thin triangles, in a studio. The shape and the studio are the
/// same at every count; only the car's tessellation grows.
Scene car(uint64_t triangles);

/// Two closed rooms joined by a corridor, with ceiling lights of different colour.
Scene two_rooms(uint64_t triangles);

}  // namespace goldthread::procedural
