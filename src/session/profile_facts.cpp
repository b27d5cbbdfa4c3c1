#include "session/profile_facts.h"

#include <map>

#include "math/colour.h"

namespace goldthread {

std::vector<ProfileUse> profiles_in(const Scene& scene) {
  std::vector<ProfileUse> uses;
  std::map<const LightProfile*, size_t> known;
  for (const Light& light : scene.lights) {
    if (!light.profile) continue;
    const auto [place, is_new] = known.try_emplace(light.profile.get(), uses.size());
    if (is_new) uses.push_back({light.profile->name, 0, 0});
    ProfileUse& use = uses[place->second];
    ++use.lamps;
    use.lumens += static_cast<double>(luminance(light.intensity)) * light.profile->luminous_flux();
  }
  return uses;
}

nlohmann::ordered_json to_json(const std::vector<ProfileUse>& uses) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ProfileUse& use : uses)
    list.push_back({{"name", use.name}, {"lamps", use.lamps}, {"lumens", use.lumens}});
  return list;
}

}  // namespace goldthread
