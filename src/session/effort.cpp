#include "session/effort.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace goldthread {
namespace {

// A preset: its tolerated error, and what it takes, by experience, to keep it.
struct Preset {
  double error;
  double link_error, solve_area;  // SolveOptions::last_error, least_area
  double light_rays, ray_share;
  double growth;  // ReconstructOptions::growth
};

constexpr std::array<Preset, 4> kPresets{{{0.15, 5e-5, 1e-4, 32, 0.03, 4},
                                          {0.06, 1e-5, 1.2e-5, 128, 0.01, 4},
                                          {0.03, 3e-6, 6e-6, 256, 0.005, 4},
                                          {0.015, 1e-6, 1.5e-6, 512, 0.002, 5}}};

double between(double a, double b, double share) {
  // Exact at both ends: a preset is what the table says.
  if (share == 0) return a;
  if (share == 1) return b;
  return a * std::pow(b / a, share);
}

}  // namespace

double tolerated_error(Quality quality) {
  return kPresets[static_cast<size_t>(quality)].error;
}

Effort effort_for(double error) {
  size_t i = 0;
  while (i + 2 < kPresets.size() && error < kPresets[i + 1].error) ++i;
  const Preset &a = kPresets[i], &b = kPresets[i + 1];
  double share = std::log(error / a.error) / std::log(b.error / a.error);
  if (error == a.error) share = 0;
  if (error == b.error) share = 1;
  Effort effort;
  effort.solve.last_error = between(a.link_error, b.link_error, share);
  effort.solve.least_area = between(a.solve_area, b.solve_area, share);
  effort.reconstruct.light_rays =
      static_cast<uint32_t>(std::max(4.0, std::round(between(a.light_rays, b.light_rays, share))));
  effort.reconstruct.ray_share = static_cast<float>(std::min(0.2, between(a.ray_share, b.ray_share, share)));
  effort.reconstruct.error = error;
  effort.reconstruct.growth = std::max(1.5, between(a.growth, b.growth, share));
  return effort;
}

std::string missed_error(double asked, std::optional<double> estimate) {
  if (!estimate)
    return fmt::format("stopped before it was known whether the light is within {:.2g}%", 100 * asked);
  if (*estimate <= asked) return {};
  return fmt::format(
      "the light is about {:.2g}% off where {:.2g}% were asked for: the work for that is done (--error "
      "{:.2g}% does "
      "more)",
      100 * *estimate, 100 * asked, 50 * asked);
}

}  // namespace goldthread
