// The outside of the car. Its sides, nose and tail, and the glass house are four functions; panels are parts
// of them with gaps between, as on a real car, so that every panel is a shell of its own.
#include <algorithm>
#include <cmath>

#include "scene/procedural/car_parts.h"

namespace goldthread::procedural {
namespace {

constexpr double kSill = 0.20;  // lower edge of the doors
constexpr double kArchRadius = 0.385;
constexpr double kGap = 0.003;  // between neighbouring panels, half of it on each
constexpr double kRoofEdge = 1.36, kRoofHalfWidth = 0.57;
constexpr double kScreenFoot = 0.98, kScreenTop = 0.24;  // x of the windscreen
constexpr double kRearFoot = -1.60, kRearTop = -0.80;    // x of the rear window

double mix(double a, double b, double t) {
  return a + (b - a) * t;
}

double smooth_step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// Left side of the body.
dvec3 side(double x, double y) {
  return {x, y, body_half_width(x, y)};
}

/// Part of the side between two x, from `low` to the belt line.
Surface side_panel(double x0, double x1, const std::function<double(double)>& low) {
  const auto point = [=](double u, double v) {
    const double x = mix(x0 + kGap, x1 - kGap, u);
    return side(x, mix(low(x), belt_height(x), v));
  };
  return {point};
}

Surface side_panel(double x0, double x1, double low) {
  return side_panel(x0, x1, [low](double) { return low; });
}

/// The part of a fender above a wheel. Its lower edge runs evenly with the angle, so that the arch is round
/// at every rate, its upper edge evenly with x.
Surface arch_panel(double axle) {
  const auto point = [=](double u, double v) {
    const double angle = double(kPi) * (1 - u), radius = kArchRadius - kGap;
    const double low = kWheelRadius + kArchRadius * std::sin(angle);
    const double x = axle + radius * mix(std::cos(angle), 2 * u - 1, v);
    return side(x, mix(low, belt_height(x), v));
  };
  return {point};
}

/// The rolled edge of an arch and the liner behind it: a half cylinder from the side towards the middle.
Surface arch_liner(double axle, double from, double to) {
  const auto point = [=](double u, double v) {
    const double angle = double(kPi) * u;
    const double x = axle + kArchRadius * std::cos(angle), y = kWheelRadius + kArchRadius * std::sin(angle);
    return dvec3(x, y, body_half_width(x, y) - mix(from, to, v));
  };
  return {point};
}

/// Front end: u from -1 (right) to 1 (left), y is height.
dvec3 nose(double u, double y) {
  const double belly = std::sin(double(kPi) * std::clamp((y - 0.15) / 0.6, 0.0, 1.0));
  return {2.03 + 0.2 * (1 - u * u * u * u) + 0.04 * belly - 0.02 * u * u, y, 0.80 * u};
}

dvec3 tail(double u, double y) {
  const double belly = std::sin(double(kPi) * std::clamp((y - 0.2) / 0.75, 0.0, 1.0));
  return {-2.03 - 0.16 * (1 - u * u * u * u) - 0.04 * belly + 0.02 * u * u, y, 0.80 * u};
}

using EndShape = dvec3 (*)(double, double);

Surface end_panel(EndShape shape, double u0, double u1, double y0, double y1) {
  return {[=](double u, double v) { return shape(mix(u0, u1, u), mix(y0, y1, v)); }};
}

/// Left side of the glass house: s from the rear window (0) to the windscreen (1), t from belt to roof.
dvec3 glass_house(double s, double t) {
  const double x = mix(mix(kRearFoot, kRearTop, t), mix(kScreenFoot, kScreenTop, t), s);
  const double foot = body_half_width(x, belt_height(x)) - 0.03;
  const double y = mix(belt_height(x) + 0.004, kRoofEdge, t);
  return {x, y, mix(foot, kRoofHalfWidth, t) + 0.03 * std::sin(double(kPi) * t)};
}

Surface glass_house_panel(double s0, double s1, double t0, double t1) {
  return {[=](double u, double v) { return glass_house(mix(s0, s1, u), mix(t0, t1, v)); }};
}

/// Windscreen or rear window: u across, v up; bowed outwards by `bow`.
Surface screen(double foot, double top, double bow) {
  const auto point = [=](double u, double v) {
    const double across = 2 * u - 1;
    const double half = mix(body_half_width(foot, belt_height(foot)) - 0.07, kRoofHalfWidth - 0.02, v);
    const double x = mix(foot, top, v) + bow * (1 - across * across) * (1 - 0.7 * v);
    return dvec3(x, mix(belt_height(foot) + 0.01, kRoofEdge + 0.025 * (1 - across * across), v),
                 half * across);
  };
  return {point};
}

/// Hood or boot lid: from x0 to where `end` has its upper edge, over the whole width between the fenders.
Surface lid(double x0, double crown, EndShape end, double end_height) {
  const auto point = [=](double u, double v) {
    const double across = 2 * v - 1;
    const double x = mix(x0, end(across, end_height).x, u);
    const double half = body_half_width(x, belt_height(x)) - 0.025;
    return dvec3(x, belt_height(x) + 0.012 + crown * (1 - across * across) * (1 - u), half * across);
  };
  return {point};
}

/// The strip between hood and windscreen.
Surface cowl() {
  const auto point = [](double u, double v) {
    const double x = mix(kScreenFoot - 0.02, kScreenFoot + 0.045, u), across = 2 * v - 1;
    const double half = body_half_width(x, belt_height(x)) - 0.025;
    return dvec3(x, belt_height(x) + 0.012 + 0.05 * (1 - across * across), half * across);
  };
  return {point};
}

Surface roof() {
  const auto point = [](double u, double v) {
    const double x = mix(kRearTop + 0.01, kScreenTop - 0.01, u), across = 2 * v - 1;
    const double along = 2 * u - 1;
    const double rise = 0.03 * (1 - across * across) + 0.03 * (1 - along * along);
    return dvec3(x, kRoofEdge + 0.002 + rise, (kRoofHalfWidth - 0.004) * across);
  };
  return {point};
}

/// A strip that follows the side from x0 to x1 at height `y` above `base(x)`.
Surface side_strip(double x0, double x1, double y, double height, double proud) {
  const auto point = [=](double u, double v) {
    const double x = mix(x0, x1, u);
    dvec3 p = side(x, y + height * (v - 0.5));
    p.z += proud * std::sin(double(kPi) * (0.1 + 0.8 * v));
    return p;
  };
  return {point};
}

void add_side(PanelList& list, const CarMaterials& m) {
  const dvec3 left(0, 0, 1);
  const double front0 = kFrontAxle - kArchRadius, front1 = kFrontAxle + kArchRadius;
  const double rear0 = kRearAxle - kArchRadius, rear1 = kRearAxle + kArchRadius;
  list.add_pair("front fender fore", m.paint, side_panel(front1, 2.03, 0.30), left);
  list.add_pair("front fender", m.paint, arch_panel(kFrontAxle), left);
  list.add_pair("front fender aft", m.paint, side_panel(0.80, front0, kSill), left);
  list.add_pair("front door", m.paint, side_panel(-0.10, 0.80, kSill), left);
  list.add_pair("rear door", m.paint, side_panel(rear1, -0.10, kSill), left);
  list.add_pair("rear fender", m.paint, arch_panel(kRearAxle), left);
  list.add_pair("rear fender aft", m.paint, side_panel(-2.03, rear0, 0.30), left);
  for (const double axle : {kFrontAxle, kRearAxle}) {
    const std::string which = axle > 0 ? "front" : "rear";
    list.add_pair(which + " arch edge", m.paint, arch_liner(axle, 0.0, 0.025), dvec3(0, -1, 0));
    list.add_pair(which + " arch liner", m.trim, arch_liner(axle, 0.03, 0.34), dvec3(0, -1, 0));
  }
  list.add_pair("sill", m.trim, side_strip(rear1 + 0.02, front0 - 0.02, 0.165, 0.06, 0.01), left);
  list.add_pair("door guard front", m.trim, side_strip(-0.07, 0.77, 0.46, 0.04, 0.012), left);
  list.add_pair("door guard rear", m.trim, side_strip(rear1 + 0.02, -0.13, 0.46, 0.04, 0.012), left);
  list.add_pair("handle front", m.metal, side_strip(0.0, 0.16, 0.80, 0.025, 0.028), left);
  list.add_pair("handle rear", m.metal, side_strip(-0.86, -0.70, 0.80, 0.025, 0.028), left);
  list.add_pair("indicator", m.tail_lamp, side_strip(0.86, 0.93, 0.66, 0.03, 0.01), left);
}

/// The inner side of the glass house's frame, which shows through the windows.
Surface frame_lining(double s0, double s1, double t0, double t1) {
  const auto point = [=](double u, double v) {
    dvec3 p = glass_house(mix(s0, s1, u), mix(t0, t1, v));
    p.z -= 0.015;
    return p;
  };
  return {point};
}

/// From the foot of the side windows inwards.
Surface window_sill() {
  const auto point = [](double u, double v) {
    dvec3 p = glass_house(mix(0.02, 0.98, u), 0);
    p.y -= 0.006 + 0.01 * v * v;
    p.z += mix(0.01, -0.075, v);
    return p;
  };
  return {point};
}

void add_frame_lining(PanelList& list, const CarMaterials& m) {
  const dvec3 inwards(0, -0.3, -1);
  list.add_pair("rear pillar lining", m.lining, frame_lining(0.0, 0.078, 0, 1), inwards);
  list.add_pair("quarter post lining", m.lining, frame_lining(0.203, 0.227, 0, 0.95), inwards);
  list.add_pair("middle pillar lining", m.lining, frame_lining(0.503, 0.547, 0, 0.95), inwards);
  list.add_pair("front pillar lining", m.lining, frame_lining(0.932, 1.0, 0, 0.95), inwards);
  list.add_pair("roof rail lining", m.lining, frame_lining(0.08, 1.0, 0.945, 1.0), inwards);
  list.add_pair("window sill", m.trim, window_sill(), {0, 1, 0});
}

void add_glass_house(PanelList& list, const CarMaterials& m) {
  const dvec3 left(0, 0.3, 1);
  list.add_pair("rear pillar", m.paint, glass_house_panel(0.0, 0.075, 0, 1), left);
  list.add_pair("quarter window", m.glass, glass_house_panel(0.08, 0.20, 0.03, 0.94), left);
  list.add_pair("quarter post", m.trim, glass_house_panel(0.205, 0.225, 0, 0.95), left);
  list.add_pair("rear side window", m.glass, glass_house_panel(0.23, 0.50, 0.02, 0.94), left);
  list.add_pair("middle pillar", m.trim, glass_house_panel(0.505, 0.545, 0, 0.95), left);
  list.add_pair("front side window", m.glass, glass_house_panel(0.55, 0.93, 0.02, 0.94), left);
  list.add_pair("front pillar", m.paint, glass_house_panel(0.935, 1.0, 0, 0.95), left);
  list.add_pair("roof rail", m.paint, glass_house_panel(0.08, 1.0, 0.955, 1.0), left);
  list.add_pair("window moulding", m.metal, glass_house_panel(0.08, 0.93, 0.0, 0.018), left);
  list.add("windscreen", m.glass, screen(kScreenFoot, kScreenTop, 0.12), {1, 1, 0});
  list.add("rear window", m.glass, screen(kRearFoot, kRearTop, -0.08), {-1, 1, 0});
  list.add("roof", m.paint, roof(), {0, 1, 0});
  list.add("hood", m.paint, lid(kScreenFoot + 0.05, 0.06, nose, 0.76), {0, 1, 0});
  list.add("boot lid", m.paint, lid(kRearFoot - 0.03, 0.03, tail, 0.95), {0, 1, 0});
  list.add("cowl", m.trim, cowl(), {0, 1, 0});
  for (const double z : {-0.35, 0.15}) {
    const dvec3 foot(kScreenFoot + 0.06, belt_height(kScreenFoot) + 0.09, z);
    list.add("wiper", m.trim, tube(foot, foot + dvec3(-0.1, 0.035, 0.5), 0.006));
  }
  const dvec3 mirror(0.72, 0.99, 0.98);
  list.add_pair("mirror", m.paint,
                pillow(mirror - dvec3(0, 0, 0.10), mirror + dvec3(0, 0, 0.10), {0.05, 0, 0}, {0, 0.065, 0}));
  list.add_pair("mirror foot", m.trim,
                tube(mirror - dvec3(0, 0.05, 0.16), mirror - dvec3(0, 0.02, 0.07), 0.018));
}

/// What lies behind the gaps and the grille of an end.
Surface backing(EndShape shape, double inwards, double y0, double y1) {
  const auto point = [=](double u, double v) {
    dvec3 p = shape(0.98 * (2 * u - 1), mix(y0, y1, v));
    p.x += inwards;
    return p;
  };
  return {point};
}

void add_ends(PanelList& list, const CarMaterials& m) {
  const dvec3 front(1, 0, 0), rear(-1, 0, 0);
  list.add("front bumper", m.paint, end_panel(nose, -1, 1, 0.33, 0.52), front);
  list.add("front apron", m.trim, end_panel(nose, -0.98, 0.98, 0.17, 0.325), front);
  list.add("nose", m.paint, end_panel(nose, -0.99, 0.99, 0.67, 0.765), front);
  list.add_pair("headlamp", m.lamp, end_panel(nose, 0.55, 0.97, 0.53, 0.66), front);
  list.add_pair("lamp surround", m.metal, end_panel(nose, 0.515, 0.545, 0.525, 0.665), front);
  for (int i = 0; i < 8; ++i) {
    const double y = 0.535 + 0.0155 * i;
    list.add("grille bar " + std::to_string(i), m.metal, end_panel(nose, -0.5, 0.5, y, y + 0.009), front);
  }
  list.add("number plate front", m.lamp,
           part_of({[](double u, double v) { return dvec3(2.285, 0.37 + 0.11 * v, 0.52 * (u - 0.5)); }}, 0, 1,
                   0, 1),
           front);
  list.add("grille backing", m.trim, backing(nose, -0.03, 0.30, 0.75), front);
  list.add("tail backing", m.trim, backing(tail, 0.03, 0.32, 0.96), rear);
  list.add("rear bumper", m.paint, end_panel(tail, -1, 1, 0.30, 0.58), rear);
  list.add("tail panel", m.paint, end_panel(tail, -0.55, 0.55, 0.59, 0.972), rear);
  list.add_pair("tail lamp", m.tail_lamp, end_panel(tail, 0.56, 0.99, 0.70, 0.90), rear);
  list.add_pair("tail corner", m.paint, end_panel(tail, 0.56, 0.99, 0.585, 0.695), rear);
  list.add_pair("tail edge", m.paint, end_panel(tail, 0.56, 0.99, 0.905, 0.972), rear);
  const Surface pipe = tube({-2.0, 0.22, 0.45}, {-2.24, 0.22, 0.45}, 0.035);
  list.add_pair("exhaust", m.metal, pipe);
  Surface bore = tube({-1.9, 0.22, 0.45}, {-2.24, 0.22, 0.45}, 0.032);
  bore.flip = true;
  list.add_pair("exhaust bore", m.trim, bore);
  list.add("underbody", m.trim, {[](double u, double v) {
             return dvec3(mix(-2.0, 2.05, u), 0.16 + 0.02 * std::sin(9 * u), 0.42 * (2 * v - 1));
           }},
           {0, -1, 0});
}

}  // namespace

double belt_height(double x) {
  return 0.94 - 0.2 * smooth_step(0.7, 2.5, x) + 0.02 * smooth_step(-0.5, -2.2, x);
}

double body_half_width(double x, double y) {
  const double end = x / 2.25, lift = (y - 0.55) / 0.4;
  const double plan = 0.88 * (1 - 0.16 * std::pow(end, 6));
  return plan * (1 - 0.045 * lift * lift) + 0.007 * std::sin(14 * (y - 0.35));
}

void add_car_body(PanelList& list, const CarMaterials& materials) {
  add_side(list, materials);
  add_glass_house(list, materials);
  add_frame_lining(list, materials);
  add_ends(list, materials);
}

}  // namespace goldthread::procedural
