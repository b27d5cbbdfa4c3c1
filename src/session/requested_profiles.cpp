#include "session/requested_profiles.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "files/ies_read.h"
#include "math/colour.h"

namespace goldthread {
namespace {

Error usage(std::string message, std::string cure) {
  return Error{ErrorCode::kUsage, std::move(message), "", "", std::move(cure)};
}

bool takes_profiles(const Light& light) {
  return light.kind == LightKind::kPoint || light.kind == LightKind::kSpot;
}

// The names that could have been meant.
std::string lamp_names(const Scene& scene) {
  constexpr size_t kMost = 8;
  std::string names;
  size_t count = 0;
  for (const Light& light : scene.lights) {
    if (!takes_profiles(light) || light.name.empty() || ++count > kMost) continue;
    names += (names.empty() ? "" : ", ") + light.name;
  }
  return count > kMost ? names + ", ..." : names;
}

Status set_profile(Scene& scene, const LightOptions::Profile& wish, float scale) {
  Result<LightProfile> read = read_ies(wish.file);
  if (!read) return read.error();
  read->name = std::filesystem::path(wish.file).filename().string();
  const SharedProfile profile = share_profile(*std::move(read));
  size_t lit = 0;
  for (Light& light : scene.lights) {
    if (!takes_profiles(light) || (!wish.lamp.empty() && light.name != wish.lamp)) continue;
    ++lit;
    const float brightness = luminance(light.intensity);
    // Candela are what the eye sees of the light: its colour has no part in them.
    light.intensity = brightness > 0 ? light.intensity * (scale * profile.peak / brightness) : vec3(0);
    light.profile = profile.shares;
    aim(light, light.direction, light.across);
  }
  if (lit > 0) return Nothing{};
  const std::string names = lamp_names(scene);
  if (wish.lamp.empty() || names.empty())
    return usage("--ies: the scene has no point or spot light that could shine by " + wish.file,
                 "leave --ies out, or place lights");
  return usage("--ies: no point or spot light is called '" + wish.lamp + "'", "there are " + names);
}

}  // namespace

Status set_requested_profiles(Scene& scene, const LightOptions& options) {
  if (!(options.profile_scale >= 0) || !std::isfinite(options.profile_scale))
    return usage("the scale of light profiles is no number of 0 or more", "1 takes the files' candela");
  for (const LightOptions::Profile& wish : options.profiles)
    if (Status status = set_profile(scene, wish, options.profile_scale); !status) return status;
  return Nothing{};
}

void warn_of_tilted_lamps(Scene& scene) {
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    if (!light.profile || !light.profile->changes_with_tilt || light.direction.y < -0.999f) continue;
    scene.warnings.push_back(
        fmt::format("light {} \"{}\": {} says that tilting changes its light; taken as if it were not tilted",
                    i, light.name, light.profile->name));
  }
}

}  // namespace goldthread
