#include "scene/procedural/panels.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace goldthread::procedural {
namespace {

constexpr int kProbes = 16;            // samples along a line when a panel is measured
constexpr double kCoarsestTurn = 0.7;  // radians that neighbouring faces may differ in at the least rates

/// Length of a line across the surface and the angle through which the normal turns along it.
struct LineMeasure {
  double length = 0, turn = 0;
};

LineMeasure measure_line(const Surface& surface, bool along_u, double other) {
  const auto place = [&](int i) {
    const double t = double(i) / kProbes;
    return along_u ? dvec2(t, other) : dvec2(other, t);
  };
  LineMeasure measure;
  for (int i = 0; i < kProbes; ++i) {
    const dvec2 a = place(i), b = place(i + 1);
    measure.length += length(surface.point(b.x, b.y) - surface.point(a.x, a.y));
    const double cosine = dot(surface_normal(surface, a.x, a.y), surface_normal(surface, b.x, b.y));
    measure.turn += std::acos(std::clamp(cosine, -1.0, 1.0));
  }
  return measure;
}

LineMeasure measure_lines(const Surface& surface, bool along_u) {
  LineMeasure sum;
  for (double other : {0.1, 0.5, 0.9}) {
    const LineMeasure line = measure_line(surface, along_u, other);
    sum.length += line.length / 3;
    sum.turn = std::max(sum.turn, line.turn);
  }
  return sum;
}

/// Elongation of the n-th panel's cells: 5 to 45, spread evenly over the logarithm by the golden ratio.
double elongation(size_t n) {
  double whole = 0;
  const double spread = std::modf(double(n) * 0.6180339887498949, &whole);
  return 5 * std::pow(9.0, spread);
}

int least_rate(double turn, bool closed) {
  return std::max(closed ? 8 : 1, static_cast<int>(std::ceil(turn / kCoarsestTurn)));
}

void measure(Panel& panel, size_t number) {
  const LineMeasure u = measure_lines(panel.surface, true), v = measure_lines(panel.surface, false);
  panel.length_u = u.length;
  panel.length_v = v.length;
  panel.least_u = least_rate(u.turn, panel.surface.closed_u);
  panel.least_v = least_rate(v.turn, panel.surface.closed_v);
  // As CAD tessellators do it: long along the direction that bends less per metre.
  const bool long_u = u.turn * v.length < v.turn * u.length;
  panel.aspect = long_u ? elongation(number) : 1 / elongation(number);
}

uint64_t set_rates(std::vector<Panel*>& panels, double cell_side) {
  uint64_t count = 0;
  for (Panel* panel : panels) {
    const double stretch = std::sqrt(panel->aspect);
    panel->rate_u =
        std::max(panel->least_u, static_cast<int>(std::lround(panel->length_u / (cell_side * stretch))));
    panel->rate_v =
        std::max(panel->least_v, static_cast<int>(std::lround(panel->length_v * stretch / cell_side)));
    count += panel->triangle_count();
  }
  return count;
}

}  // namespace

void PanelList::add(std::string name, uint32_t material, Surface surface) {
  Panel panel;
  panel.name = std::move(name);
  panel.material = material;
  panel.surface = std::move(surface);
  measure(panel, panels_.size());
  panels_.push_back(std::move(panel));
}

void PanelList::add(std::string name, uint32_t material, Surface surface, const dvec3& front) {
  if (dot(surface_normal(surface, 0.5, 0.5), front) < 0) surface.flip = !surface.flip;
  add(std::move(name), material, std::move(surface));
}

void PanelList::add_pair(const std::string& name, uint32_t material, const Surface& surface,
                         const dvec3& front) {
  add(name + " left", material, surface, front);
  add(name + " right", material, mirrored(surface), dvec3(front.x, front.y, -front.z));
}

void PanelList::add_pair(const std::string& name, uint32_t material, const Surface& surface) {
  add(name + " left", material, surface);
  add(name + " right", material, mirrored(surface));
}

void choose_rates(std::vector<Panel*>& panels, uint64_t triangles) {
  double fine = 1e-5, coarse = 10;  // metres: more and fewer triangles than anyone asks for
  for (int step = 0; step < 60; ++step) {
    const double middle = std::sqrt(fine * coarse);
    (set_rates(panels, middle) > triangles ? fine : coarse) = middle;
  }
  set_rates(panels, coarse);
}

Surface part_of(const Surface& surface, double u0, double u1, double v0, double v1) {
  const auto point = [whole = surface.point, u0, u1, v0, v1](double u, double v) {
    return whole(u0 + (u1 - u0) * u, v0 + (v1 - v0) * v);
  };
  return {point, false, false, surface.flip};
}

Surface mirrored(const Surface& surface) {
  const auto point = [original = surface.point](double u, double v) {
    const dvec3 p = original(u, v);
    return dvec3(p.x, p.y, -p.z);
  };
  return {point, surface.closed_u, surface.closed_v, !surface.flip};
}

}  // namespace goldthread::procedural
