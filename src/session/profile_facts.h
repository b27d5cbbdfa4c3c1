// Which light profiles a scene's lamps shine by.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace goldthread {

struct ProfileUse {
  std::string name;   ///< of the file it was read from
  size_t lamps = 0;   ///< how many lights share it
  double lumens = 0;  ///< of all of them
};

/// In the order of the lights.
std::vector<ProfileUse> profiles_in(const Scene& scene);

/// The same as `info` and the report tell it: [{name, lamps, lumens}].
nlohmann::ordered_json to_json(const std::vector<ProfileUse>& uses);

}  // namespace goldthread
