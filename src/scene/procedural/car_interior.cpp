#include <cmath>

#include "scene/procedural/car_parts.h"

namespace goldthread::procedural {
namespace {

double mix(double a, double b, double t) {
  return a + (b - a) * t;
}

void add_seat(PanelList& list, const CarMaterials& m, const std::string& name, double x, double z) {
  const dvec3 across(0, 0, 1);
  const dvec3 hip(x - 0.22, 0.50, z), shoulder(x - 0.42, 1.02, z);
  const dvec3 up = normalize(shoulder - hip), thick = cross(across, up);
  list.add(name + " cushion", m.leather,
           pillow({x - 0.25, 0.46, z}, {x + 0.27, 0.50, z}, {0, 0.075, 0}, 0.24 * across));
  list.add(name + " back", m.leather, pillow(hip, shoulder, 0.07 * thick, 0.23 * across));
  list.add(name + " headrest", m.leather,
           pillow(shoulder + 0.06 * up, shoulder + 0.22 * up, 0.05 * thick, 0.13 * across));
  for (const double side : {-1.0, 1.0}) {
    const std::string which = name + (side < 0 ? " inner" : " outer");
    const dvec3 shift(0, 0, 0.23 * side);
    list.add(which + " bolster", m.leather,
             pillow(hip + shift - 0.05 * thick, 0.85 * (shoulder - hip) + hip + shift - 0.05 * thick,
                    0.05 * thick, 0.035 * across));
    list.add(which + " rail", m.metal,
             tube({x - 0.25, 0.36, z + 0.18 * side}, {x + 0.25, 0.36, z + 0.18 * side}, 0.015));
    const dvec3 post = shoulder + dvec3(0, 0, 0.05 * side);
    list.add(which + " post", m.metal, tube(post - 0.04 * up, post + 0.09 * up, 0.006));
  }
}

void add_rear_bench(PanelList& list, const CarMaterials& m) {
  const dvec3 across(0, 0, 1);
  const dvec3 hip(-1.18, 0.50, 0), shoulder(-1.42, 0.98, 0);
  const dvec3 up = normalize(shoulder - hip), thick = cross(across, up);
  list.add("bench cushion", m.leather,
           pillow({-1.15, 0.45, 0}, {-0.68, 0.48, 0}, {0, 0.085, 0}, 0.62 * across));
  list.add("bench back", m.leather, pillow(hip, shoulder, 0.08 * thick, 0.60 * across));
  for (const double z : {-0.35, 0.35}) {
    const dvec3 foot = shoulder + dvec3(0, 0, z);
    list.add("bench headrest", m.leather,
             pillow(foot + 0.02 * up, foot + 0.16 * up, 0.045 * thick, 0.12 * across));
  }
}

void add_dashboard(PanelList& list, const CarMaterials& m) {
  list.add("dashboard top", m.trim, {[](double u, double v) {
             const double across = 2 * u - 1;
             return dvec3(mix(0.98, 0.52, v) + 0.06 * (1 - across * across), 0.93 - 0.03 * v * v,
                          0.68 * across);
           }},
           {0, 1, 0});
  list.add("dashboard face", m.lining, {[](double u, double v) {
             const double across = 2 * u - 1;
             return dvec3(0.52 + 0.06 * (1 - across * across) + 0.1 * v * v, 0.895 - 0.33 * v, 0.68 * across);
           }},
           {-1, 0, 0});
  list.add("instrument hood", m.trim, {[](double u, double v) {
             const double angle = double(kPi) * u;
             return dvec3(mix(0.62, 0.46, v), 0.88 + 0.11 * std::sin(angle), 0.36 + 0.17 * std::cos(angle));
           }},
           {0, 1, 0});
  list.add("console", m.trim, {[](double u, double v) {
             const double angle = double(kPi) * v;
             return dvec3(mix(0.55, -0.45, u), 0.34 + (0.14 + 0.1 * u * u) * std::sin(angle),
                          -0.11 * std::cos(angle));
           }},
           {0, 1, 0});
  list.add("gear lever", m.metal, tube({0.12, 0.5, 0}, {0.08, 0.66, 0}, 0.009));
  list.add("gear knob", m.leather, pillow({0.083, 0.645, 0}, {0.07, 0.70, 0}, {0.025, 0, 0}, {0, 0, 0.025}));
}

void add_steering(PanelList& list, const CarMaterials& m) {
  const dvec3 centre(0.32, 0.80, 0.36), axis = normalize(dvec3(-0.9, 0.42, 0));
  const dvec3 x(0, 0, 1), y = cross(axis, x);
  list.add("steering wheel", m.leather, torus(centre, x, y, 0.18, 0.015));
  list.add("horn", m.trim, pillow(centre - 0.05 * axis, centre + 0.02 * axis, 0.06 * x, 0.05 * y));
  for (int i = 0; i < 3; ++i) {
    const double angle = double(kPi) * (0.5 + 0.75 * (i - 1));
    const dvec3 outward = std::cos(angle) * x - std::sin(angle) * y;
    list.add("steering spoke", m.metal, tube(centre + 0.05 * outward, centre + 0.17 * outward, 0.011));
  }
  list.add("steering column", m.trim, tube(centre - 0.05 * axis, centre - 0.40 * axis, 0.03));
  for (int i = 0; i < 3; ++i) {
    const double z = 0.26 + 0.1 * i;
    list.add("pedal", m.metal, {[z](double u, double v) {
               return dvec3(0.72 + 0.05 * v + 0.01 * v * v, 0.34 + 0.12 * v, z + 0.06 * (u - 0.5));
             }},
             {-1, 0.3, 0});
  }
}

/// The inner skin: what one sees of doors, roof and floor through the windows. Fronts face the cabin.
void add_lining(PanelList& list, const CarMaterials& m) {
  const auto trim = [](double x0, double x1, double low) {
    return Surface{[=](double u, double v) {
      const double x = mix(x0, x1, u), y = mix(low, belt_height(x) - 0.005, v);
      return dvec3(x, y, body_half_width(x, y) - 0.07 - 0.02 * std::sin(double(kPi) * v));
    }};
  };
  list.add_pair("door lining front", m.lining, trim(-0.08, 0.93, 0.32), {0, 0, -1});
  list.add_pair("door lining rear", m.lining, trim(-0.95, -0.10, 0.32), {0, 0, -1});
  list.add_pair("rear corner lining", m.lining, trim(-1.6, -0.97, 0.72), {0, 0, -1});
  const auto armrest = [](double x) {
    const double z = body_half_width(x, 0.66) - 0.11;
    return pillow({x - 0.2, 0.66, z}, {x + 0.2, 0.68, z}, {0, 0.03, 0}, {0, 0, 0.035});
  };
  list.add_pair("armrest front", m.leather, armrest(0.25));
  list.add_pair("armrest rear", m.leather, armrest(-0.55));
  list.add("headliner", m.lining, {[](double u, double v) {
             const double across = 2 * v - 1, along = 2 * u - 1;
             const double rise = 0.03 * (1 - across * across) + 0.03 * (1 - along * along);
             return dvec3(mix(-0.78, 0.22, u), 1.335 + rise, 0.55 * across);
           }},
           {0, -1, 0});
  list.add("cabin floor", m.lining, {[](double u, double v) {
             const double across = 2 * v - 1;
             return dvec3(mix(-1.2, 0.95, u), 0.26 + 0.05 * std::exp(-30 * across * across), 0.72 * across);
           }},
           {0, 1, 0});
  list.add("firewall", m.lining, {[](double u, double v) {
             return dvec3(0.95 + 0.04 * std::sin(double(kPi) * u), mix(0.28, 0.90, v), 0.70 * (2 * u - 1));
           }},
           {-1, 0, 0});
  list.add("parcel shelf", m.lining, {[](double u, double v) {
             const double across = 2 * v - 1;
             return dvec3(mix(-1.58, -1.40, u), 0.945 + 0.01 * (1 - across * across), 0.62 * across);
           }},
           {0, 1, 0});
  list.add("inner mirror", m.trim,
           pillow({0.33, 1.27, -0.11}, {0.33, 1.27, 0.11}, {0.012, 0, 0}, {0, 0.035, 0}));
}

}  // namespace

void add_car_interior(PanelList& list, const CarMaterials& materials) {
  add_dashboard(list, materials);
  add_steering(list, materials);
  add_seat(list, materials, "driver seat", 0.0, 0.36);
  add_seat(list, materials, "passenger seat", 0.0, -0.36);
  add_rear_bench(list, materials);
  add_lining(list, materials);
}

}  // namespace goldthread::procedural
