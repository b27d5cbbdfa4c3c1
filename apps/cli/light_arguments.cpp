#include "light_arguments.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <utility>

#include "values.h"

namespace goldthread::cli {
namespace {

constexpr const char* kGroup = "Light that is not in the scene";

Error usage_error(std::string message, std::string cure) {
  return Error{ErrorCode::kUsage, std::move(message), "", "", std::move(cure)};
}

void add_sky(CLI::App& verb, LightTexts& texts) {
  LightOptions& options = texts.options;
  verb.add_option("--sky", texts.sky,
                  "even sky: luminance in nits, one number or R,G,B; or 10000lux. With a model its zenith's "
                  "nits, or\n"
                  "lux on open ground")
      ->type_name("NITS")
      ->group(kGroup);
  verb.add_option("--sky-model", options.sky_model, "uniform, overcast, clear, cie1 to cie16 or preetham")
      ->type_name("NAME")
      ->group(kGroup);
  verb.add_option("--turbidity", options.turbidity, "of the air: 2 very clear, 6 hazy (3)")
      ->type_name("T")
      ->group(kGroup);
  verb.add_option("--ground-reflectance", options.ground_reflectance,
                  "of the model's ground below the horizon, 0 to 1 (0)")
      ->type_name("R")
      ->group(kGroup);
  verb.add_option("--environment", options.environment,
                  "surroundings as an equirectangular .exr or .hdr, its middle towards -Z")
      ->type_name("FILE")
      ->group(kGroup);
  verb.add_option("--environment-rotation", options.environment_rotation,
                  "degrees: 90 turns its -Z to +X (0)")
      ->type_name("DEG")
      ->check(CLI::Range(-3600.0, 3600.0).description(""))
      ->group(kGroup);
  verb.add_option("--environment-scale", options.environment_scale, "nits a unit of the picture (1)")
      ->type_name("X")
      ->check(CLI::Range(0.0, 1e9).description(""))
      ->group(kGroup);
}

void add_sun(CLI::App& verb, LightTexts& texts) {
  verb.add_option("--sun", texts.sun.illuminance,
                  "sun: illuminance in lux facing it (100000; with --place what the air leaves)")
      ->type_name("[LUX]")
      ->check(CLI::Range(0.0, 1e9).description(""))
      ->group(kGroup);
  verb.add_option("--sun-elevation", texts.sun.elevation, "degrees above the horizon (45)")
      ->type_name("DEG")
      ->check(CLI::Range(-90.0, 90.0).description(""))
      ->group(kGroup);
  verb.add_option("--sun-azimuth", texts.sun.azimuth, "degrees: 0 is -Z (north), 90 is +X (east) (135)")
      ->type_name("DEG")
      ->check(CLI::Range(-360.0, 360.0).description(""))
      ->group(kGroup);
  verb.add_option("--sun-diameter", texts.options.sun_diameter,
                  "degrees of its disc, 0 for hard shadows (0.533)")
      ->type_name("DEG")
      ->check(CLI::Range(0.0, 90.0).description(""))
      ->group(kGroup);
  verb.add_option("--lamp-radius", texts.lamp_radius,
                  "makes the scene's point and spot lights balls of M metres")
      ->type_name("M")
      ->check(CLI::Range(0.0, 1e6).description(""))
      ->group(kGroup);
  verb.add_option("--ies", texts.profiles,
                  "photometric file (LM-63) by which all point and spot lights shine, or those called\n"
                  "NAME: its candela instead of their cone and intensity; colours stay. Repeatable")
      ->type_name("[NAME=]FILE")
      ->take_all()
      ->allow_extra_args(false)
      ->group(kGroup);
  verb.add_option("--ies-scale", texts.options.profile_scale, "multiplies the candela of --ies (1)")
      ->type_name("X")
      ->check(CLI::Range(0.0, 1e9).description(""))
      ->group(kGroup);
  verb.add_option("--place", texts.place, "degrees north and east, as 59.33,18.07: places the sun")
      ->type_name("LAT,LON")
      ->group(kGroup);
  verb.add_option("--date", texts.date, "day at that place")->type_name("YYYY-MM-DD")->group(kGroup);
  verb.add_option("--time", texts.time, "time of day there")->type_name("HH:MM")->group(kGroup);
  verb.add_option("--time-zone", texts.time_zone, "hours ahead of UTC (0)")
      ->type_name("H")
      ->check(CLI::Range(-24.0, 24.0).description(""))
      ->group(kGroup);
}

// "NAME=FILE" or "FILE"; "=FILE" where the file's own name has the sign.
LightOptions::Profile profile_of(const std::string& text) {
  const size_t sign = text.find('=');
  if (sign == std::string::npos) return {text, ""};
  return {text.substr(sign + 1), text.substr(0, sign)};
}

Status finish_profiles(const CLI::App& verb, const LightTexts& texts, LightOptions& options) {
  for (const std::string& text : texts.profiles) {
    options.profiles.push_back(profile_of(text));
    if (options.profiles.back().file.empty())
      return usage_error("--ies: '" + text + "' names no file",
                         "write --ies lamp.ies or --ies NAME=lamp.ies");
  }
  if (verb.count("--ies-scale") > 0 && options.profiles.empty())
    return usage_error("--ies-scale is of the files of --ies", "add --ies FILE");
  return Nothing{};
}

Status finish_moment(const CLI::App& verb, const LightTexts& texts, LightOptions& options) {
  const bool placed = verb.count("--place") > 0, dated = verb.count("--date") > 0,
             timed = verb.count("--time") > 0;
  if (!placed && !dated && !timed && verb.count("--time-zone") == 0) return Nothing{};
  if (!placed || !dated || !timed)
    return usage_error("the sun's place needs --place, --date and --time", "give all three");
  if (verb.count("--sun-elevation") > 0 || verb.count("--sun-azimuth") > 0)
    return usage_error("--place and --sun-elevation or --sun-azimuth each say where the sun is",
                       "give one of them");
  const auto place = parse_numbers(texts.place, ',');
  if (!place || place->size() != 2)
    return usage_error("--place: '" + texts.place + "' is no latitude and longitude", "write 59.33,18.07");
  const auto date = parse_date(texts.date);
  if (!date) return usage_error("--date: '" + texts.date + "' is no date", "write 2026-06-21");
  const auto hour = parse_hour(texts.time);
  if (!hour) return usage_error("--time: '" + texts.time + "' is no time of day", "write 15:30");
  options.moment = LightOptions::Moment{(*place)[0], (*place)[1], (*date)[0],     (*date)[1],
                                        (*date)[2],  *hour,       texts.time_zone};
  return Nothing{};
}

// Whether the sky depends on where the sun is.
bool model_needs_sun(const std::string& model) {
  return !model.empty() && model != "uniform" && model != "overcast" && model != "cie1" && model != "cie5";
}

Status finish_sun(const CLI::App& verb, const LightTexts& texts, LightOptions& options) {
  const bool shines = verb.count("--sun") > 0;
  const bool placed = options.moment || verb.count("--sun-elevation") > 0 || verb.count("--sun-azimuth") > 0;
  if (!shines && placed && options.sky_model.empty())
    return usage_error("the sun has a place but does not shine", "add --sun, or a --sky-model that knows it");
  if (!shines && !placed && !model_needs_sun(options.sky_model)) return Nothing{};
  options.sun = texts.sun;
  if (!shines) options.sun->illuminance = 0;
  options.sun_through_air = shines && texts.lone_sun && options.moment;
  return Nothing{};
}

}  // namespace

bool complete_sun(std::vector<std::string>& arguments) {
  bool found = false;
  for (size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] != "--sun") continue;
    if (i + 1 < arguments.size() && is_number(arguments[i + 1])) continue;
    arguments[i] = fmt::format("--sun={}", LightOptions::Sun{}.illuminance);
    found = true;
  }
  return found;
}

void add_light(CLI::App& verb, LightTexts& texts) {
  add_sky(verb, texts);
  add_sun(verb, texts);
}

Status finish_light(const CLI::App& verb, const LightTexts& texts, LightOptions& options) {
  options = texts.options;
  if (verb.count("--sky") > 0) {
    options.sky = parse_sky(texts.sky);
    if (!options.sky)
      return usage_error("--sky: '" + texts.sky + "' is no luminance",
                         "write nits as 2000 or 2000,2200,2600, or lux as 10000lux");
    options.sky_is_illuminance = is_illuminance(texts.sky);
  }
  if (verb.count("--ground-reflectance") > 0 && options.sky_model.empty())
    return usage_error("--ground-reflectance is of a sky model's ground", "add --sky-model");
  if (options.environment.empty() &&
      (verb.count("--environment-rotation") > 0 || verb.count("--environment-scale") > 0))
    return usage_error("there is no environment to turn or scale", "add --environment FILE");
  if (verb.count("--sun-diameter") > 0 && verb.count("--sun") == 0)
    return usage_error("the sun has a size but does not shine", "add --sun");
  if (verb.count("--lamp-radius") > 0) options.lamp_radius = texts.lamp_radius;
  if (Status status = finish_profiles(verb, texts, options); !status) return status;
  if (Status status = finish_moment(verb, texts, options); !status) return status;
  return finish_sun(verb, texts, options);
}

}  // namespace goldthread::cli
