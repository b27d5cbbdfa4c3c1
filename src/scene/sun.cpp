#include "scene/sun.h"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "math/chromaticity.h"
#include "scene/preetham_sky.h"

namespace goldthread {
namespace {

constexpr double kRadians = std::numbers::pi / 180;

std::chrono::year_month_day date_of(const CalendarTime& time) {
  return {std::chrono::year(time.year), std::chrono::month(static_cast<unsigned>(time.month)),
          std::chrono::day(static_cast<unsigned>(time.day))};
}

Status check_moment(const EarthPlace& place, const CalendarTime& time) {
  const auto bad = [](std::string what, std::string cure) {
    return Error{ErrorCode::kUsage, std::move(what), "", "", std::move(cure)};
  };
  if (time.year < 1950 || time.year > 2050)
    return bad(fmt::format("the sun of the year {} is not known", time.year), "years are 1950 to 2050");
  // The calendar's own types take a month of 257 for the first.
  const bool in_range = time.month >= 1 && time.month <= 12 && time.day >= 1 && time.day <= 31;
  if (!in_range || !date_of(time).ok())
    return bad(fmt::format("there is no date {}-{}-{}", time.year, time.month, time.day), "");
  if (!(time.hour >= 0 && time.hour <= 24 && std::abs(time.time_zone) <= 24))
    return bad(fmt::format("there is no hour {} in zone {}", time.hour, time.time_zone),
               "hours are 0 to 24, zones hours ahead of UTC");
  if (!(std::abs(place.latitude) <= 90 && std::abs(place.longitude) <= 180))
    return bad(fmt::format("there is no latitude {}, longitude {}", place.latitude, place.longitude),
               "degrees, at most 90 and 180");
  return Nothing{};
}

// Days since noon of 1 January 2000, UTC.
double days_since_2000(const CalendarTime& time, double hour) {
  const std::chrono::sys_days day = date_of(time);
  const std::chrono::sys_days start = std::chrono::year(2000) / 1 / 1;
  return static_cast<double>((day - start).count()) - 0.5 + hour / 24;
}

// The sun among the stars, radians.
struct Equatorial {
  double right_ascension, declination;
};

Equatorial solar_position(double days) {
  const double anomaly = (357.528 + 0.9856003 * days) * kRadians;
  const double mean_longitude = 280.460 + 0.9856474 * days;
  const double longitude =
      (mean_longitude + 1.915 * std::sin(anomaly) + 0.020 * std::sin(2 * anomaly)) * kRadians;
  const double obliquity = (23.439 - 0.0000004 * days) * kRadians;
  return {std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude)),
          std::asin(std::sin(obliquity) * std::sin(longitude))};
}

// C. Wyman, P.-P. Sloan, P. Shirley, Simple Analytic Approximations to the CIE XYZ Color Matching Functions,
// 2013, table 1; of the observer of 1931, to about 1% of each peak.
dvec3 colour_matching(double nanometres) {
  const auto lobe = [&](double height, double peak, double below, double above) {
    const double t = (nanometres - peak) / (nanometres < peak ? below : above);
    return height * std::exp(-0.5 * t * t);
  };
  return {lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2),
          lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
          lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8)};
}

// Planck's law at 5778 K, without unit.
double sunlight(double nanometres) {
  const double metres = nanometres * 1e-9;
  return 1e-32 / (std::pow(metres, 5) * std::expm1(0.01438777 / (metres * 5778)));
}

constexpr double kFirstWavelength = 380, kWavelengthStep = 10;  // nm
// Absorption of ozone, 1/m, from 380 nm to 780 nm: Preetham, table 2.
constexpr std::array<double, 41> kOzone{0,    0,    0,    0,   0,   0,   0,   0.3,  0.6,  0.9,  1.4,
                                        2.1,  3.0,  4.0,  4.8, 6.3, 7.5, 8.5, 10.3, 12.0, 12.0, 11.5,
                                        12.5, 12.0, 10.5, 9.0, 7.9, 6.7, 5.7, 4.8,  3.6,  2.8,  2.3,
                                        1.8,  1.4,  1.1,  1.0, 0.9, 0.7, 0.4, 0};
constexpr double kOzoneColumn = 0.0035;  // metres

// Relative optical mass of air (Kasten 1966); the angle in degrees, at most 90.
double air_mass(double zenith_degrees) {
  return 1 / (std::cos(zenith_degrees * kRadians) + 0.15 * std::pow(93.885 - zenith_degrees, -1.253));
}

double transmittance(size_t wavelength, double mass, double turbidity) {
  const double micrometres = 1e-3 * (kFirstWavelength + kWavelengthStep * static_cast<double>(wavelength));
  const double rayleigh = 0.008735 * std::pow(micrometres, -4.08);
  const double aerosol = (0.04608 * turbidity - 0.04586) * std::pow(micrometres, -1.3);
  return std::exp(-mass * (rayleigh + aerosol + kOzone[wavelength] * kOzoneColumn));
}

}  // namespace

Result<vec3> sun_direction(const EarthPlace& place, const CalendarTime& time) {
  if (const Status status = check_moment(place, time); !status) return status.error();
  const double hour = time.hour - time.time_zone, days = days_since_2000(time, hour);
  const Equatorial sun = solar_position(days);
  const double sidereal_hours = 6.697375 + 0.0657098242 * days + hour;  // Greenwich mean
  const double hour_angle = (15 * sidereal_hours + place.longitude) * kRadians - sun.right_ascension;
  const double sin_declination = std::sin(sun.declination), cos_declination = std::cos(sun.declination);
  const double sin_latitude = std::sin(place.latitude * kRadians);
  const double cos_latitude = std::cos(place.latitude * kRadians);
  const double towards_equator = cos_declination * std::cos(hour_angle);
  const double east = -cos_declination * std::sin(hour_angle);
  const double up = sin_latitude * sin_declination + cos_latitude * towards_equator;
  const double north = cos_latitude * sin_declination - sin_latitude * towards_equator;
  return vec3(glm::normalize(dvec3(east, up, -north)));
}

Result<vec3> sun_illuminance(const vec3& sun_direction, float turbidity) {
  if (const Status status = check_turbidity(turbidity); !status) return status.error();
  if (!is_finite(sun_direction) || sun_direction == vec3(0))
    return Error{ErrorCode::kUsage, "the sun has no direction", "", "",
                 "give three finite numbers, not all 0"};
  if (sun_direction.y < 0) return vec3(0);
  const double mass = air_mass(angle_between(dvec3(sun_direction), dvec3(0, 1, 0)) / kRadians);
  dvec3 outside(0), inside(0);
  for (size_t i = 0; i < kOzone.size(); ++i) {
    const double nanometres = kFirstWavelength + kWavelengthStep * static_cast<double>(i);
    const dvec3 light = sunlight(nanometres) * colour_matching(nanometres);
    outside += light;
    inside += transmittance(i, mass, double{turbidity}) * light;
  }
  constexpr double kSolarIlluminance = 133300;  // lux above the air
  return vec3(rec709_in_gamut(inside * (kSolarIlluminance / outside.y)));
}

}  // namespace goldthread
