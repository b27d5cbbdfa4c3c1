#include "session/requested_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "files/file_name.h"
#include "files/image_read.h"
#include "scene/sun.h"
#include "session/requested_profiles.h"

namespace goldthread {
namespace {

Error usage(std::string message, std::string cure) {
  return Error{ErrorCode::kUsage, std::move(message), "", "", std::move(cure)};
}

vec3 vector_of(const std::array<float, 3>& rgb) {
  return {rgb[0], rgb[1], rgb[2]};
}

vec3 direction_by_angles(const LightOptions::Sun& sun) {
  const float elevation = sun.elevation * kPi / 180, azimuth = sun.azimuth * kPi / 180;
  return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
          -std::cos(elevation) * std::cos(azimuth)};
}

Result<vec3> direction_to_sun(const LightOptions& options) {
  if (!options.moment) return direction_by_angles(options.sun.value_or(LightOptions::Sun{}));
  const LightOptions::Moment& m = *options.moment;
  return sun_direction({m.latitude, m.longitude}, {m.year, m.month, m.day, m.hour, m.time_zone});
}

/// Lux facing the sun.
Result<vec3> light_of_sun(const LightOptions& options, const vec3& direction) {
  if (!options.sun) return vec3(0);
  if (options.sun_through_air) return sun_illuminance(direction, options.turbidity);
  return vec3(options.sun->illuminance);
}

/// The traditional overcast sky is the sixteenth in the CIE's tables.
constexpr int kTraditional = 16;

/// 1 to 16 for the standard skies by name, 0 for others.
int cie_type(const std::string& name) {
  if (name == "overcast") return 1;
  if (name == "clear") return 12;
  int type = 0;
  if (name.substr(0, 3) != "cie") return 0;
  const auto [end, error] = std::from_chars(name.data() + 3, name.data() + name.size(), type);
  return error == std::errc() && end == name.data() + name.size() && type <= kTraditional ? type : 0;
}

/// Horizontal illuminance by the sky alone, lux, of clear, partly cloudy and overcast skies (IES, Recommended
/// Practice for the Calculation of Daylight Availability, 1984; Gillette and Treado 1983). The standard's
/// types 11 to 15 are clear, 7 to 10 in between.
float usual_illuminance(int type, const vec3& to_sun) {
  const float height = std::clamp(to_sun.y, 0.0f, 1.0f);
  if (type >= 11 && type != kTraditional) return 800 + 15500 * std::sqrt(height);
  return 300 + (type >= 7 && type != kTraditional ? 45000 : 21000) * height;
}

SkyLevel level_of(const LightOptions& options, int type, const vec3& to_sun) {
  if (!options.sky) return SkyLevel::horizontal_illuminance(vec3(usual_illuminance(type, to_sun)));
  const vec3 nits = vector_of(*options.sky);
  return options.sky_is_illuminance ? SkyLevel::horizontal_illuminance(kPi * nits)
                                    : SkyLevel::zenith_luminance(nits);
}

Result<SkyModel> requested_model(const LightOptions& options, const vec3& to_sun, const vec3& sunlight) {
  const std::string& name = options.sky_model;
  const int type = cie_type(name);
  if (!(options.ground_reflectance >= 0 && options.ground_reflectance <= 1))
    return usage("the ground's reflectance is not within 0 to 1", "soil and grass reflect about 0.2");
  SkyDescription description;
  description.sun_direction = to_sun;
  description.ground_reflectance = vec3(options.ground_reflectance);
  description.sunlight = sunlight * std::max(0.0f, to_sun.y);
  description.turbidity = options.turbidity;
  if (name == "preetham") {
    if (options.sky)
      return usage("the preetham sky is as bright as its turbidity makes it",
                   "leave --sky out, or take a CIE sky");
    description.kind = SkyDescription::Kind::kPreetham;
    return SkyModel::make(description);
  }
  description.level = level_of(options, type, to_sun);
  if (name == "uniform") {
    if (description.level.measure == SkyLevel::Measure::kHorizontalIlluminance)
      description.level.value /= kPi;
    return SkyModel::make(description);
  }
  if (type == 0)
    return usage("there is no sky model '" + name + "'",
                 "choose uniform, overcast, clear, cie1 to cie16 or preetham");
  description.kind =
      type == kTraditional ? SkyDescription::Kind::kTraditionalOvercast : SkyDescription::Kind::kCieGeneral;
  if (type != kTraditional) description.cie_type = type;
  return SkyModel::make(description);
}

Result<EnvironmentMap> requested_map(const LightOptions& options, Scene& scene) {
  const std::string& file = options.environment;
  const std::string extension = file_extension(file);
  if (extension != ".exr" && extension != ".hdr")
    return Error{ErrorCode::kUsage, "cannot be an environment: it holds no luminance", file, "",
                 "give .exr or .hdr"};
  Result<FloatImage> picture = read_picture(file);
  if (!picture) return picture.error();
  EnvironmentMap::Repairs repairs;
  Result<EnvironmentMap> map = EnvironmentMap::make(*std::move(picture), options.environment_scale,
                                                    options.environment_rotation * kPi / 180, &repairs);
  if (!map) {
    Error error = map.error();
    error.file = file;
    return error;
  }
  if (repairs.pixels > 0)
    scene.warnings.push_back(
        fmt::format("{}: {} pixels are negative, infinite, not numbers or above {:g} nits; taken as 0 there",
                    file, repairs.pixels, static_cast<double>(EnvironmentMap::kMostNits)));
  return map;
}

Status check_one_sky(const LightOptions& options) {
  if (options.environment.empty()) return Nothing{};
  if (!options.sky_model.empty() || options.sky)
    return usage("--environment is a sky already", "leave --sky and --sky-model out");
  return Nothing{};
}

/// Says that the sky of the file gives way to the one that is asked for.
void warn_of_two_skies(Scene& scene, const LightOptions& options) {
  const bool asked = !options.environment.empty() || !options.sky_model.empty() || options.sky;
  if (asked && scene.sky.present())
    scene.warnings.emplace_back("the file's own surroundings give way to the sky that was asked for");
}

/// Gives lamps the radius that is asked for.
Status set_sizes(Scene& scene, const LightOptions& options) {
  if (!(options.sun_diameter >= 0 && options.sun_diameter <= 90))
    return usage("the sun's diameter is not within 0 to 90 degrees", "it is 0.53 seen from Earth");
  if (!options.lamp_radius) return Nothing{};
  if (!(*options.lamp_radius >= 0 && *options.lamp_radius <= 1e6f))
    return usage("the lamps' radius is no length", "give metres, 0 for points");
  for (Light& light : scene.lights)
    if (light.kind == LightKind::kPoint || light.kind == LightKind::kSpot)
      light.radius = *options.lamp_radius;
  return Nothing{};
}

}  // namespace

Status add_requested_lights(Scene& scene, const LightOptions& options) {
  if (Status status = check_one_sky(options); !status) return status;
  if (Status status = set_sizes(scene, options); !status) return status;
  if (Status status = set_requested_profiles(scene, options); !status) return status;
  warn_of_tilted_lamps(scene);
  const Result<vec3> to_sun = direction_to_sun(options);
  if (!to_sun) return to_sun.error();
  if (!is_finite(*to_sun) ||
      (options.sun && !(options.sun->illuminance >= 0 && options.sun->illuminance <= 1e12f)))
    return usage("the sun's place or illuminance is no number", "give finite degrees, and lux of 0 or more");
  const Result<vec3> sunlight = light_of_sun(options, *to_sun);
  if (!sunlight) return sunlight.error();
  warn_of_two_skies(scene, options);
  if (!options.environment.empty()) {
    const Result<EnvironmentMap> map = requested_map(options, scene);
    if (!map) return map.error();
    scene.sky = Sky{vec3(0), std::nullopt, *map};
  } else if (!options.sky_model.empty()) {
    const Result<SkyModel> model = requested_model(options, *to_sun, *sunlight);
    if (!model) return model.error();
    scene.sky = Sky{vec3(0), *model, std::nullopt};
  } else if (options.sky) {
    scene.sky = Sky{vector_of(*options.sky), std::nullopt, std::nullopt};
  }
  const bool by_moment = options.moment.has_value();
  if (by_moment && to_sun->y < 0)
    scene.warnings.emplace_back("the sun is below the horizon at that place and time");
  if (*sunlight == vec3(0)) return Nothing{};
  Light light;
  light.name = "sun";
  light.kind = LightKind::kDirectional;
  light.intensity = *sunlight;
  light.direction = -*to_sun;
  light.angular_diameter = options.sun_diameter * kPi / 180;
  scene.lights.push_back(light);
  return Nothing{};
}

}  // namespace goldthread
