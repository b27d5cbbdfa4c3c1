// Where the sun stands, and how much light it sends.
#pragma once
#include "goldthread/error.h"
#include "math/vec.h"

namespace goldthread {

/// A place on Earth in degrees.
struct EarthPlace {
  double latitude = 0;   ///< north is positive, -90..90
  double longitude = 0;  ///< east is positive, -180..180
};

/// A moment by the Gregorian calendar.
struct CalendarTime {
  int year = 2000;
  int month = 1;         ///< 1..12
  int day = 1;           ///< 1..31
  double hour = 12;      ///< with its fraction, 0..24
  double time_zone = 0;  ///< hours ahead of UTC: 1 in Stockholm's winter, 2 in its summer
};

/// The unit direction towards the sun's centre, world: Y up, east +X, north -Z. By the Astronomical Almanac's
/// low-precision formulas as in J. Michalsky, The Astronomical Almanac's Algorithm for Approximate Solar
/// Position, 1988: within 0.01 degrees from 1950 to 2050. Geometric: the air lifts the sun by up to 0.6
/// degrees at the horizon, which is not included. Error: no such date, hour or place, or a year out of
/// 1950..2050.
Result<vec3> sun_direction(const EarthPlace& place, const CalendarTime& time);

/// Lux at normal incidence, linear Rec.709, of the sun at `sun_direction` (unit, Y up) through air of that
/// turbidity; 0 below the horizon. Preetham, Shirley, Smits 1999, appendix A.1: Rayleigh, aerosol and ozone;
/// mixed gas and water vapour absorb from 690 nm on only, where the eye sees less than 0.1% of sunlight.
/// Above the air the light is a black body's of 5778 K with 133.3 klx (Darula, Kittler and Gueymard 2005, the
/// mean of a year, which does by 3.4% more in January and less in July).
/// Error: a turbidity out of PreethamSky's limits, a direction that is not finite or zero.
Result<vec3> sun_illuminance(const vec3& sun_direction, float turbidity);

}  // namespace goldthread
