#include "scene/preetham_sky.h"

#include <fmt/format.h>

#include <numbers>

#include "math/chromaticity.h"

namespace goldthread {
namespace {

// Coefficients of a SkyDistribution: `slope` times turbidity plus `constant`.
SkyDistribution linear_in(double turbidity, const SkyDistribution& slope, const SkyDistribution& constant) {
  const auto at = [&](double s, double c) { return s * turbidity + c; };
  return {at(slope.a, constant.a), at(slope.b, constant.b), at(slope.c, constant.c),
          at(slope.d, constant.d), at(slope.e, constant.e), 1};
}

// Zenith luminance, kcd/m² (A.2).
double zenith_luminance(double turbidity, double sun_zenith) {
  const double chi = (4.0 / 9 - turbidity / 120) * (std::numbers::pi - 2 * sun_zenith);
  return (4.0453 * turbidity - 4.9710) * std::tan(chi) - 0.2155 * turbidity + 2.4192;
}

double cubic(double t, double third, double second, double first, double constant) {
  return ((third * t + second) * t + first) * t + constant;
}

double zenith_x(double turbidity, double t) {
  return (cubic(t, 0.00166, -0.00375, 0.00209, 0) * turbidity +
          cubic(t, -0.02903, 0.06377, -0.03202, 0.00394)) *
             turbidity +
         cubic(t, 0.11693, -0.21196, 0.06052, 0.25886);
}

double zenith_y(double turbidity, double t) {
  return (cubic(t, 0.00275, -0.00610, 0.00317, 0) * turbidity +
          cubic(t, -0.04214, 0.08970, -0.04153, 0.00516)) *
             turbidity +
         cubic(t, 0.15346, -0.26756, 0.06670, 0.26688);
}

}  // namespace

PreethamSky::PreethamSky(const dvec3& sun_direction, double turbidity)
    : sun(sun_direction),
      sun_zenith_(angle_between(sun_direction, dvec3(0, 1, 0))),
      luminance_(linear_in(turbidity, {0.1787, -0.3554, -0.0227, 0.1206, -0.0670},
                           {-1.4630, 0.4275, 5.3251, -2.5771, 0.3703})),
      x_(linear_in(turbidity, {-0.0193, -0.0665, -0.0004, -0.0641, -0.0033},
                   {-0.2592, 0.0008, 0.2125, -0.8989, 0.0452})),
      y_(linear_in(turbidity, {-0.0167, -0.0950, -0.0079, -0.0441, -0.0109},
                   {-0.2608, 0.0092, 0.2102, -1.6537, 0.0529})),
      zenith_(zenith_luminance(turbidity, sun_zenith_), zenith_x(turbidity, sun_zenith_),
              zenith_y(turbidity, sun_zenith_)) {}

dvec3 PreethamSky::radiance(const dvec3& direction) const {
  const double chi = angle_between(direction, sun), height = direction.y;
  const double nits = 1000 * zenith_.x * luminance_.of_zenith(height, chi, sun_zenith_);
  return rec709_in_gamut(xyz_from_chromaticity(zenith_.y * x_.of_zenith(height, chi, sun_zenith_),
                                               zenith_.z * y_.of_zenith(height, chi, sun_zenith_), nits));
}

Status check_turbidity(float turbidity) {
  if (turbidity >= PreethamSky::kLeastTurbidity && turbidity <= PreethamSky::kGreatestTurbidity)
    return Nothing{};
  return Error{ErrorCode::kUsage,
               fmt::format("turbidity {} is out of {} to {}", turbidity, PreethamSky::kLeastTurbidity,
                           PreethamSky::kGreatestTurbidity),
               "", "", "2 is very clear air, 3 clear, 6 hazy"};
}

}  // namespace goldthread
