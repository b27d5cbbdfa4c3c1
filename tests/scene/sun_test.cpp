#include "scene/sun.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/colour.h"

namespace goldthread {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

double altitude(const vec3& direction) {
  return std::asin(double{direction.y}) / kDegree;
}

// Degrees from north by east.
double azimuth(const vec3& direction) {
  const double angle = std::atan2(double{direction.x}, -double{direction.z}) / kDegree;
  return angle < 0 ? angle + 360 : angle;
}

vec3 sun_at(double latitude, double longitude, const CalendarTime& time) {
  const Result<vec3> sun = sun_direction({latitude, longitude}, time);
  EXPECT_TRUE(sun) << sun.error().line();
  return sun ? *sun : vec3(0);
}

// Toward the south (north of the tropics) the sun crosses the meridian at that hour of Greenwich.
double transit_hour(CalendarTime day) {
  double low = 11, high = 13;
  while (high - low > 1e-5) {
    day.hour = 0.5 * (low + high);
    (sun_at(51.48, 0, day).x > 0 ? low : high) = day.hour;
  }
  return low;
}

double highest_altitude(double latitude, CalendarTime day) {
  double highest = -90;
  for (int minute = 0; minute <= 24 * 60; ++minute) {
    day.hour = minute / 60.0;
    highest = std::max(highest, altitude(sun_at(latitude, 0, day)));
  }
  return highest;
}

TEST(SunDirection, AgreesWithTheSolarPositionAlgorithmsExample) {
  // I. Reda, A. Andreas, Solar Position Algorithm for Solar Radiation Applications, NREL 2008, appendix A.5:
  // seen from the place, before refraction.
  const vec3 sun = sun_at(39.742476, -105.1786, {2003, 10, 17, 12 + 30.5 / 60, -7});
  EXPECT_NEAR(altitude(sun), 39.872046, 0.01);
  EXPECT_NEAR(azimuth(sun), 194.340241, 0.015);
}

TEST(SunDirection, NoonAtTheSolsticesIsTheObliquityOffTheEquator) {
  for (const double latitude : {66.0, 59.3, 45.0, 30.0}) {
    EXPECT_NEAR(highest_altitude(latitude, {2024, 6, 20}), 90 - latitude + 23.44, 0.01) << latitude;
    EXPECT_NEAR(highest_altitude(latitude, {2024, 12, 21}), 90 - latitude - 23.44, 0.01) << latitude;
  }
}

TEST(SunDirection, AtTheEquinoxItRisesInTheEast) {
  // 20 March 2024, 3:06 UTC: there the sun is in the plane of the equator, and rises where it is six hours
  // before noon by the true sun, which is 7.4 minutes behind the clock.
  const double longitude = 15 * (6 - (3.1 - 7.4 / 60));
  for (const double latitude : {-60.0, 0.0, 40.0, 65.0}) {
    const vec3 sun = sun_at(latitude, longitude, {2024, 3, 20, 3.1});
    EXPECT_NEAR(altitude(sun), 0, 0.06) << latitude;
    EXPECT_NEAR(azimuth(sun), 90, 0.06) << latitude;
  }
}

TEST(SunDirection, EquationOfTimeHasItsKnownExtremes) {
  double earliest = 24, latest = 0;
  for (int month = 1; month <= 12; ++month)
    for (int day = 1; day <= 28; ++day) {
      const double hour = transit_hour({2023, month, day});
      earliest = std::min(earliest, hour);
      latest = std::max(latest, hour);
    }
  EXPECT_NEAR((12 - earliest) * 60, 16.45, 0.06);  // 3 November
  EXPECT_NEAR((latest - 12) * 60, 14.23, 0.06);    // 11 February
}

TEST(SunDirection, NoonIsSouthInTheNorthAndNorthInTheSouth) {
  EXPECT_GT(sun_at(50, 0, {2024, 5, 1, 12}).z, 0.5f);
  EXPECT_LT(sun_at(-35, 0, {2024, 5, 1, 12}).z, -0.5f);
  EXPECT_GT(sun_at(50, 0, {2024, 5, 1, 8}).x, 0.5f) << "morning is east";
}

TEST(SunDirection, ZonesAndMidnightAreOneTime) {
  const vec3 here = sun_at(59.3, 18.1, {2024, 7, 1, 1, 2});
  EXPECT_LT(length(here - sun_at(59.3, 18.1, {2024, 6, 30, 23})), 1e-6f);
  EXPECT_LT(length(here - sun_at(59.3, 18.1, {2024, 7, 1, 0, 1})), 1e-6f);
}

TEST(SunDirection, AtThePoleItStaysAtItsDeclination) {
  const double start = altitude(sun_at(90, 0, {2024, 6, 20, 0}));
  for (const double hour : {6.0, 12.0, 18.0})
    EXPECT_NEAR(altitude(sun_at(90, 0, {2024, 6, 20, hour})), start, 0.01);
}

TEST(SunDirection, WhatDoesNotExistIsAnError) {
  EXPECT_FALSE(sun_direction({0, 0}, {2023, 2, 29}));
  EXPECT_FALSE(sun_direction({0, 0}, {2023, 257, 1}));
  EXPECT_FALSE(sun_direction({0, 0}, {2023, 1, 257}));
  EXPECT_FALSE(sun_direction({0, 0}, {1492, 1, 1}));
  EXPECT_FALSE(sun_direction({0, 0}, {2023, 1, 1, 25}));
  EXPECT_FALSE(sun_direction({91, 0}, {}));
  EXPECT_FALSE(sun_direction({0, 181}, {}));
  EXPECT_FALSE(sun_direction({std::numeric_limits<double>::quiet_NaN(), 0}, {}));
}

vec3 towards(double degrees) {
  return vec3(dvec3(std::cos(degrees * kDegree), std::sin(degrees * kDegree), 0));
}

float lux(double degrees, float turbidity) {
  return luminance(*sun_illuminance(towards(degrees), turbidity));
}

TEST(SunIlluminance, IsThatOfTheIlluminatingEngineersClearSky) {
  // IES Calculation Procedures Committee, Recommended Practice for the Calculation of Daylight Availability,
  // 1984: 127.5 klx exp(-0.21 m) under a clear sky. It does not say how clear: turbidity 2 is that of the
  // clearest days.
  for (const double degrees : {20.0, 30.0, 45.0, 60.0, 90.0}) {
    const double measured = 127500 * std::exp(-0.21 / std::sin(degrees * kDegree));
    EXPECT_NEAR(lux(degrees, 2) / measured, 1, 0.04) << degrees;
  }
}

TEST(SunIlluminance, FallsAndReddensWithAirAndHaze) {
  for (const float turbidity : {1.7f, 3.0f, 6.0f, 10.0f})
    for (double degrees = 5; degrees < 90; degrees += 5) {
      EXPECT_LT(lux(degrees, turbidity), lux(degrees + 5, turbidity));
      const vec3 low = *sun_illuminance(towards(degrees), turbidity);
      const vec3 high = *sun_illuminance(towards(degrees + 5), turbidity);
      EXPECT_LE(low.z / low.x, high.z / high.x);
    }
  EXPECT_GT(lux(40, 2), lux(40, 3));
  EXPECT_GT(lux(40, 3), lux(40, 9));
}

TEST(SunIlluminance, EndsAtTheHorizon) {
  EXPECT_LT(lux(0, 2), 1500);
  EXPECT_GE(lux(0, 2), 0);
  EXPECT_EQ(*sun_illuminance(towards(-0.1), 2), vec3(0));
  EXPECT_EQ(*sun_illuminance(vec3(0, -1, 0), 2), vec3(0));
}

TEST(SunIlluminance, IsFiniteAndNotNegative) {
  for (const float turbidity : {1.7f, 10.0f})
    for (double degrees = 0; degrees <= 90; degrees += 1) {
      const vec3 sun = *sun_illuminance(towards(degrees), turbidity);
      EXPECT_TRUE(is_finite(sun) && std::min({sun.x, sun.y, sun.z}) >= 0) << degrees;
    }
  EXPECT_FALSE(sun_illuminance(vec3(0), 2));
  EXPECT_FALSE(sun_illuminance(vec3(0, 1, 0), 1));
  EXPECT_FALSE(sun_illuminance(vec3(0, 1, 0), 11));
}

}  // namespace
}  // namespace goldthread
