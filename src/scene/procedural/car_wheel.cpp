#include <cmath>

#include "scene/procedural/car_parts.h"

namespace goldthread::procedural {
namespace {

constexpr double kTau = 2 * double(kPi);
constexpr double kRimRadius = 0.222;

dvec3 round(double radius, double angle, double z) {
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

Surface tyre() {
  const auto point = [](double u, double v) {
    constexpr double kBeadAngle = 2.2;  // where the section meets the rim
    const double section = kBeadAngle * (2 * v - 1);
    return round(0.265 + (kWheelRadius - 0.265) * std::cos(section), kTau * u, 0.105 * std::sin(section));
  };
  return {point, true, false, false};
}

Surface rim_barrel() {
  const auto point = [](double u, double v) {
    return round(kRimRadius - 0.018 * std::sin(double(kPi) * v), kTau * u, 0.085 * (2 * v - 1));
  };
  return {point, true, false, false};
}

Surface spoke(double angle) {
  const auto point = [angle](double u, double v) {
    const double radius = 0.045 + (kRimRadius - 0.014 - 0.045) * u;
    const double half_width = 0.017 - 0.006 * std::sin(double(kPi) * u), side = 2 * v - 1;
    const dvec3 along = round(1, angle, 0), across = round(1, angle + kTau / 4, 0);
    const double height = 0.062 + 0.02 * std::sin(double(kPi) * u) - 0.014 * side * side;
    return radius * along + half_width * side * across + dvec3(0, 0, height);
  };
  return {point, false, false, false};
}

Surface hub_cap() {
  const auto point = [](double u, double v) {
    const double radius = 0.05 - 0.046 * v;  // a small hole stays: no pole
    return round(radius, kTau * u, 0.07 + 0.02 * std::cos(radius / 0.05 * kTau / 4));
  };
  return {point, true, false, false};
}

Surface caliper() {
  const auto point = [](double u, double v) {
    const double section = double(kPi) * (v - 0.5);
    return round(0.13 + 0.05 * std::sin(section), 2.2 + 0.9 * u, 0.03 + 0.03 * std::cos(section));
  };
  return {point, false, false, false};
}

}  // namespace

void add_car_wheel(PanelList& list, const CarMaterials& materials) {
  const dvec3 outside(0, 0, 1), x(1, 0, 0), y(0, 1, 0);
  list.add("tyre", materials.rubber, tyre(), round(1, kTau / 2, 0));
  list.add("rim barrel", materials.metal, rim_barrel(), -round(1, kTau / 2, 0));
  list.add("rim lip", materials.metal, ring({0, 0, 0.087}, x, y, kRimRadius - 0.016, kRimRadius + 0.004),
           outside);
  for (int i = 0; i < 10; ++i)
    list.add("spoke " + std::to_string(i), materials.metal, spoke(kTau * i / 10), outside);
  list.add("hub cap", materials.metal, hub_cap(), outside);
  list.add("brake disc", materials.metal, ring({0, 0, 0.025}, x, y, 0.07, 0.175), outside);
  list.add("caliper", materials.trim, caliper(), outside);
  for (int i = 0; i < 5; ++i) {
    const dvec3 foot = round(0.032, kTau * (i + 0.5) / 5, 0.08);
    list.add("nut " + std::to_string(i), materials.metal,
             pillow(foot, foot + dvec3(0, 0, 0.018), {0.007, 0, 0}, {0, 0.007, 0}));
  }
}

}  // namespace goldthread::procedural
