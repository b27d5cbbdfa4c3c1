#include "scene/light_profile.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace goldthread {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;

// How far beyond the grid's edge a direction still belongs to it, degrees: single precision's rounding of a
// unit vector, with room.
constexpr double kEdge = 1e-4;

// A place between two angles of a grid: the share of the second.
struct Between {
  size_t first = 0, second = 0;
  double share = 0;
  bool inside = false;
};

Between find_between(const std::vector<float>& angles, double angle) {
  if (angle < double(angles.front()) - kEdge || angle > double(angles.back()) + kEdge) return {};
  const auto above = std::upper_bound(angles.begin(), angles.end(), angle,
                                      [](double value, float of_grid) { return value < double(of_grid); });
  const size_t last = angles.size() - 1;
  const size_t second = std::min(size_t(above - angles.begin()), last);
  if (second == 0 || above == angles.end()) return {second, second, 0, true};
  const double low = double(angles[second - 1]), high = double(angles[second]);
  return {second - 1, second, (angle - low) / (high - low), true};
}

// The same all round a circle, where -1 is 359.
Between find_around(const std::vector<float>& angles, double angle) {
  if (angles.size() == 1) return {0, 0, 0, true};
  const double first = double(angles.front());
  double turned = angle - first;
  turned -= 360 * std::floor(turned / 360);
  const Between found = find_between(angles, first + turned);
  return found.inside ? found : find_between(angles, first + turned - 360);  // a hair before the first
}

// What the integral of a linear function times the sine is made of, over [a, b] (radians): the shares of its
// values at either end.
dvec2 sine_weights(double a, double b) {
  const double slope = (std::sin(b) - std::sin(a)) / (b - a);
  return {std::cos(a) - slope, slope - std::cos(b)};
}

// Angles of a whole profile, each with the angle of the file that it stands for.
struct Unfolded {
  std::vector<float> angles;
  std::vector<size_t> source;
};

Unfolded as_listed(const std::vector<float>& angles) {
  Unfolded out{angles, {}};
  for (size_t i = 0; i < angles.size(); ++i) out.source.push_back(i);
  return out;
}

void mirror_at_last(Unfolded& unfolded) {
  const float last = unfolded.angles.back();
  for (size_t i = unfolded.angles.size() - 1; i-- > 0;) {
    unfolded.angles.push_back(2 * last - unfolded.angles[i]);
    unfolded.source.push_back(unfolded.source[i]);
  }
}

void mirror_at_first(Unfolded& unfolded) {
  const float first = unfolded.angles.front();
  std::reverse(unfolded.angles.begin(), unfolded.angles.end());
  std::reverse(unfolded.source.begin(), unfolded.source.end());
  mirror_at_last(unfolded);
  for (float& angle : unfolded.angles) angle = 2 * first - angle;  // turned about, they ascend again
}

Unfolded unfold_all_round(const std::vector<float>& horizontal) {
  Unfolded out = as_listed(horizontal);
  if (horizontal.size() == 1) return out;
  const float first = horizontal.front(), last = horizontal.back();
  if (first == 0 && last == 90) mirror_at_last(out);
  if (last < first + 360 && out.angles.back() == first + 180) {
    mirror_at_last(out);
  } else if (last < first + 360) {
    out.angles.push_back(first + 360);
    out.source.push_back(0);
  }
  return out;
}

Unfolded unfold_at_zero(const std::vector<float>& angles) {
  Unfolded out = as_listed(angles);
  if (angles.front() == 0) mirror_at_first(out);
  return out;
}

}  // namespace

float LightProfile::intensity(const vec3& direction) const {
  if (candela.empty()) return 0;
  const dvec3 d(direction);
  const bool down = pole == Pole::kNadir;
  const double along = down ? -d.z : d.y, ahead = down ? d.x : -d.z, aside = down ? d.y : d.x;
  const Between p = find_between(polar, std::atan2(std::hypot(ahead, aside), along) * kDegrees);
  const Between a = find_around(azimuth, std::atan2(aside, ahead) * kDegrees);
  if (!p.inside || !a.inside) return 0;
  const auto column = [&](size_t of_azimuth) {
    const float* const values = &candela[of_azimuth * polar.size()];
    return (1 - p.share) * double(values[p.first]) + p.share * double(values[p.second]);
  };
  return static_cast<float>((1 - a.share) * column(a.first) + a.share * column(a.second));
}

double LightProfile::luminous_flux() const {
  // Of each azimuth the integral over the polar angle; over azimuth these are linear.
  std::vector<double> slices(azimuth.size());
  for (size_t a = 0; a < azimuth.size(); ++a) {
    const float* const values = &candela[a * polar.size()];
    for (size_t p = 0; p + 1 < polar.size(); ++p) {
      const dvec2 weights = sine_weights(double(polar[p]) / kDegrees, double(polar[p + 1]) / kDegrees);
      slices[a] += weights.x * double(values[p]) + weights.y * double(values[p + 1]);
    }
  }
  if (slices.size() == 1) return 360 / kDegrees * slices[0];
  double flux = 0;
  for (size_t a = 0; a + 1 < slices.size(); ++a)
    flux += 0.5 * (slices[a] + slices[a + 1]) * double(azimuth[a + 1] - azimuth[a]) / kDegrees;
  return flux;
}

float LightProfile::peak() const {
  return candela.empty() ? 0 : *std::max_element(candela.begin(), candela.end());
}

SharedProfile share_profile(LightProfile profile) {
  const float peak = profile.peak();
  if (peak > 0)
    for (float& value : profile.candela) value /= peak;
  return {std::make_shared<const LightProfile>(std::move(profile)), peak};
}

LightProfile type_c_profile(const PhotometricGrid& grid) {
  LightProfile out;
  const Unfolded azimuth = unfold_all_round(grid.horizontal);
  const size_t rows = grid.vertical.size();
  out.polar = grid.vertical;
  out.azimuth = azimuth.angles;
  for (const size_t source : azimuth.source)
    for (size_t v = 0; v < rows; ++v) out.candela.push_back(grid.candela[source * rows + v]);
  return out;
}

LightProfile type_b_profile(const PhotometricGrid& grid) {
  LightProfile out;
  out.pole = LightProfile::Pole::kSide;
  const Unfolded azimuth = unfold_at_zero(grid.vertical), latitude = unfold_at_zero(grid.horizontal);
  out.azimuth = azimuth.angles;
  for (const float angle : latitude.angles) out.polar.push_back(90 + angle);
  for (const size_t v : azimuth.source)
    for (const size_t h : latitude.source) out.candela.push_back(grid.candela[h * grid.vertical.size() + v]);
  return out;
}

}  // namespace goldthread
