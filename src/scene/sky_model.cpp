#include "scene/sky_model.h"

#include <fmt/format.h>

#include <array>
#include <numbers>
#include <optional>

#include "math/quadrature.h"

namespace goldthread {
namespace {

// ISO 15469:2004, table 1: a and b of six gradations, c, d and e of six indicatrices, fifteen pairs of them.
SkyDistribution standard_distribution(int type) {
  constexpr std::array<std::array<double, 2>, 6> kGradations{
      {{4, -0.7}, {1.1, -0.8}, {0, -1}, {-1, -0.55}, {-1, -0.32}, {-1, -0.15}}};
  constexpr std::array<std::array<double, 3>, 6> kIndicatrices{
      {{0, -1, 0}, {2, -1.5, 0.15}, {5, -2.5, 0.30}, {10, -3, 0.45}, {16, -3, 0.30}, {24, -2.8, 0.15}}};
  constexpr std::array<size_t, 15> kGradation{0, 0, 1, 1, 2, 2, 2, 2, 3, 3, 3, 4, 4, 5, 5};
  constexpr std::array<size_t, 15> kIndicatrix{0, 1, 0, 1, 0, 1, 2, 3, 1, 2, 3, 3, 4, 4, 5};
  const auto [a, b] = kGradations[kGradation[static_cast<size_t>(type - 1)]];
  const auto [c, d, e] = kIndicatrices[kIndicatrix[static_cast<size_t>(type - 1)]];
  return {a, b, c, d, e, 1 - c * std::exp(d * std::numbers::pi / 2)};
}

// The sun's direction as the models take it: of length 1, not below the horizon. Nothing where it has none.
std::optional<dvec3> sun_above_horizon(const vec3& direction) {
  if (!is_finite(direction) || direction == vec3(0)) return std::nullopt;
  dvec3 sun(direction);
  sun.y = std::max(sun.y, 0.0);
  const double size = glm::length(sun);
  return size > 0 ? sun / size : dvec3(0, 0, 1);  // straight below: any way is as right
}

bool is_light(const vec3& value) {
  return is_finite(value) && !glm::any(glm::lessThan(value, vec3(0)));
}

Error no_sun_direction() {
  return {ErrorCode::kUsage, "the sun has no direction", "", "", "give three finite numbers, not all 0"};
}

}  // namespace

dvec3 SkyModel::CieGeneral::radiance(const dvec3& direction) const {
  return dvec3(distribution.value(direction.y, angle_between(direction, sun)));
}

SkyModel::SkyModel(const SkyDescription& description, const Shape& shape, const dvec3& scale)
    : description_(description), shape_(shape), scale_(scale) {
  illuminance_ = scale_ * shape_illuminance();
}

SkyModel SkyModel::uniform(const vec3& nits) {
  SkyDescription description;
  description.level = SkyLevel::zenith_luminance(nits);
  return SkyModel(description, Uniform{}, dvec3(nits));
}

Result<SkyModel> SkyModel::scaled(const SkyDescription& description, const Shape& shape) {
  const SkyLevel& level = description.level;
  if (!is_light(level.value))
    return Error{ErrorCode::kUsage, "the sky's brightness is negative or not finite", "", "", ""};
  SkyModel sky(description, shape, dvec3(1));
  const dvec3 unit = level.measure == SkyLevel::Measure::kHorizontalIlluminance
                         ? sky.illuminance_
                         : sky.sky_radiance(dvec3(0, 1, 0));
  sky.scale_ = dvec3(level.value) / unit;
  sky.illuminance_ *= sky.scale_;
  return sky;
}

Result<SkyModel> SkyModel::cie_general(int type, const vec3& sun_direction, const SkyLevel& level) {
  if (type < 1 || type > 15)
    return Error{ErrorCode::kUsage, fmt::format("there is no CIE sky {}", type), "", "",
                 "types are 1 (overcast) to 15, 5 uniform, 12 clear"};
  const std::optional<dvec3> sun = sun_above_horizon(sun_direction);
  if (!sun) return no_sun_direction();
  SkyDescription description;
  description.kind = SkyDescription::Kind::kCieGeneral;
  description.cie_type = type;
  description.sun_direction = sun_direction;
  description.level = level;
  return scaled(description, CieGeneral{standard_distribution(type), *sun});
}

Result<SkyModel> SkyModel::overcast(const SkyLevel& level) {
  return cie_general(1, vec3(0, 1, 0), level);
}

Result<SkyModel> SkyModel::clear(const vec3& sun_direction, const SkyLevel& level) {
  return cie_general(12, sun_direction, level);
}

Result<SkyModel> SkyModel::traditional_overcast(const SkyLevel& level) {
  SkyDescription description;
  description.kind = SkyDescription::Kind::kTraditionalOvercast;
  description.level = level;
  return scaled(description, TraditionalOvercast{});
}

Result<SkyModel> SkyModel::preetham(const vec3& sun_direction, float turbidity) {
  if (const Status status = check_turbidity(turbidity); !status) return status.error();
  const std::optional<dvec3> sun = sun_above_horizon(sun_direction);
  if (!sun) return no_sun_direction();
  SkyDescription description;
  description.kind = SkyDescription::Kind::kPreetham;
  description.sun_direction = sun_direction;
  description.turbidity = turbidity;
  return SkyModel(description, PreethamSky(*sun, double{turbidity}), dvec3(1));
}

Result<SkyModel> SkyModel::make(const SkyDescription& description) {
  if (!is_light(description.ground_reflectance) || !is_light(description.sunlight))
    return Error{ErrorCode::kUsage, "the ground's light is negative or not finite", "", "", ""};
  const auto above_ground = [&](const Result<SkyModel>& sky) -> Result<SkyModel> {
    if (!sky) return sky.error();
    return sky->with_ground(description.ground_reflectance, description.sunlight);
  };
  switch (description.kind) {
    case SkyDescription::Kind::kUniform:
      if (!is_light(description.level.value))
        return Error{ErrorCode::kUsage, "the sky's brightness is negative or not finite", "", "", ""};
      return above_ground(uniform(description.level.value));
    case SkyDescription::Kind::kCieGeneral:
      return above_ground(cie_general(description.cie_type, description.sun_direction, description.level));
    case SkyDescription::Kind::kTraditionalOvercast:
      return above_ground(traditional_overcast(description.level));
    case SkyDescription::Kind::kPreetham:
      return above_ground(preetham(description.sun_direction, description.turbidity));
  }
  return Error{ErrorCode::kUsage, "there is no such sky model", "", "", ""};
}

SkyModel SkyModel::with_ground(const vec3& reflectance, const vec3& sunlight) const {
  SkyModel sky = *this;
  sky.description_.ground_reflectance = reflectance;
  sky.description_.sunlight = sunlight;
  sky.ground_ = dvec3(reflectance) * (illuminance_ + dvec3(sunlight)) / std::numbers::pi;
  return sky;
}

vec3 SkyModel::radiance(const vec3& direction) const {
  if (direction.y < 0) return vec3(ground_);
  return vec3(sky_radiance(glm::normalize(dvec3(direction))));
}

dvec3 SkyModel::sky_radiance(const dvec3& direction) const {
  return scale_ * shape_radiance(direction);
}

dvec3 SkyModel::shape_radiance(const dvec3& direction) const {
  return std::visit([&](const auto& shape) { return shape.radiance(direction); }, shape_);
}

// Over u = cos² Z, whose measure is half that of cosine-weighted solid angle, and azimuth from the sun's,
// half of it by symmetry. Cut at the sun, where the indicatrix has a cusp.
dvec3 SkyModel::shape_illuminance() const {
  const dvec3 sun = std::visit([](const auto& shape) { return shape.sun; }, shape_);
  const dvec3 level(sun.x, 0, sun.z);
  const dvec3 ahead = glm::length(level) > 0 ? glm::normalize(level) : dvec3(0, 0, 1);
  const dvec3 aside = glm::cross(dvec3(0, 1, 0), ahead);
  const auto channel = [&](int k) {
    const double size = std::max(shape_radiance(dvec3(0, 1, 0))[k], shape_radiance(ahead)[k]);
    const double tolerance = 1e-6 * size;
    const auto ring = [&](double u) {
      const double height = std::sqrt(u), flat = std::sqrt(1 - u);
      const auto at = [&](double azimuth) {
        return shape_radiance(height * dvec3(0, 1, 0) +
                              flat * (std::cos(azimuth) * ahead + std::sin(azimuth) * aside))[k];
      };
      return integrate(at, 0, std::numbers::pi, tolerance, 20).value;
    };
    const double split = sun.y * sun.y;
    return integrate(ring, 0, split, tolerance, 20).value + integrate(ring, split, 1, tolerance, 20).value;
  };
  return {channel(0), channel(1), channel(2)};
}

}  // namespace goldthread
