// The shared collection's rooms of known light (accuracy/gi_scenes.json) as scenes.
#pragma once
#include <string>
#include <vector>

#include "math/shared_cases.h"
#include "scene/small_scenes.h"

namespace goldthread::test {

inline Json shared_room(const std::string& id) {
  return shared_case("gi_scenes.json", id);
}

/// The material of a surface, a primitive or a zone: reflectance `rho`, exitance `emit` in lm/m².
inline Material material_of(const Json& part) {
  return diffuse(vector_of<vec3>(part["rho"]), vector_of<vec3>(part["emit"]));
}

/// Each of the room's polygons as a mesh with a material of its own, in the order of surface_names.
inline void add_surfaces(Scene& scene, const Json& room) {
  if (!room.contains("surfaces")) return;
  for (const Json& surface : room["surfaces"])
    add(scene, polygon(corners_of<vec3>(surface)), material_of(surface));
}

inline std::vector<std::string> surface_names(const Json& room) {
  std::vector<std::string> names;
  for (const Json& surface : room["surfaces"]) names.push_back(surface["name"]);
  return names;
}

}  // namespace goldthread::test
