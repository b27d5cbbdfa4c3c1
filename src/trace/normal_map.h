// Normal textures: which way a surface faces where a picture says so.
#pragma once
#include "trace/traced_scene.h"

namespace goldthread {

/// The unit normal to which the material's normal texture (glTF 2.0, 3.9.3) bends `front`, the unit normal of
/// the triangle's front at that place, interpolated or given. Its frame is the primitive's tangents, carried
/// to the world, or without them the way in which u grows over this triangle alone (as MikkTSpace has it, but
/// not averaged at vertices), each made square to `front`; its third axis runs against v. `front` itself, to
/// the bit, where there is no such texture, no frame (no texture coordinates, or none with an area) and where
/// the texture is flat: what 8 bits cannot tell from 0, at 127 and 128 of 255, is 0. It is for places at
/// which light is measured: what a surface receives over vertices and sends on to others is taken unbent, as
/// a mean over more than its bumps.
vec3 bent_normal(const TracedScene& scene, uint32_t triangle, vec2 weights, const vec3& front);

}  // namespace goldthread
