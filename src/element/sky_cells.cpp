#include "element/sky_cells.h"

#include <algorithm>
#include <cmath>

#include "math/colour.h"
#include "math/form_factor.h"
#include "math/spherical_triangle.h"

namespace goldthread {
namespace {

// A cell with fewer samples has its own cut up: what lies on its rim, and is counted to one side of it, would
// count too much. Of octants it would be moved farthest.
constexpr uint32_t kFewestSamples = 256, kFewestInOctant = 16384;
// A tenth of the sun's disc; smaller differences in direction no link can tell.
constexpr float kLeastSolidAngle = 6e-6f;
constexpr float kFirstUnevenness = 0.05f;
constexpr size_t kMostFirst = 64;

float largest(const vec3& v) {
  return std::max(v.x, std::max(v.y, v.z));
}

float solid_angle_of(const std::array<vec3, 3>& c) {
  return solid_angle(c[0], c[1], c[2]);
}

// Of the whole cell, were it even: nothing is cut off by a horizon that faces its middle.
vec3 even_transfer(const std::array<vec3, 3>& corners) {
  return sky_form_factor(normalize(corners[0] + corners[1] + corners[2]), corners);
}

uint32_t octant_of(const vec3& d) {
  return (d.x < 0 ? 1u : 0u) | (d.y < 0 ? 2u : 0u) | (d.z < 0 ? 4u : 0u);
}

}  // namespace

SkyCells::SkyCells(const Sky& sky) : sky_(&sky) {
  if (!sky.present()) return;
  add_octants();
  if (!sky.is_uniform()) take_samples();
}

void SkyCells::add_octants() {
  const vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  for (int octant = 0; octant < 8; ++octant) {
    const vec3 a = (octant & 1) != 0 ? -x : x, b = (octant & 2) != 0 ? -y : y, c = (octant & 4) != 0 ? -z : z;
    SkyCell cell;
    cell.corners = {a, b, c};
    if (dot(cross(a, b), c) > 0)
      std::swap(cell.corners[1], cell.corners[2]);  // counter-clockwise from inside
    cell.solid_angle = kPi / 2;
    cell.nits = sky_->radiance;
    cells_.push_back(cell);
  }
}

void SkyCells::take_samples() {
  grid_ = grid_of(*sky_);
  std::array<std::vector<Sample>, 8> octants;
  for (uint32_t row = 0; row < grid_.height; ++row)
    for (uint32_t column = 0; column < grid_.width; ++column) {
      const SkyPiece piece = grid_.piece(column, row);
      octants[octant_of(piece.direction())].push_back(
          {piece, grid_.nits[size_t{row} * grid_.width + column]});
    }
  for (size_t o = 0; o < octants.size(); ++o) {
    SkyCell& cell = cells_[o];
    cell.first = static_cast<uint32_t>(samples_.size());
    cell.count = static_cast<uint32_t>(octants[o].size());
    samples_.insert(samples_.end(), octants[o].begin(), octants[o].end());
    octants[o] = {};
    refine_samples(cell, kFewestInOctant);
    measure(cell);
  }
}

// Gives a cell of few samples finer ones, at the end of the list.
void SkyCells::refine_samples(SkyCell& cell, uint32_t fewest) {
  while (cell.count > 0 && cell.count < fewest) {
    const auto first = static_cast<uint32_t>(samples_.size());
    for (uint32_t i = cell.first; i < cell.first + cell.count; ++i)
      for (int quarter = 0; quarter < 4; ++quarter) {
        SkyPiece piece = samples_[i].piece;
        piece.azimuth_size /= 2;
        piece.elevation_size /= 2;
        piece.azimuth += ((quarter & 1) != 0 ? 0.5f : -0.5f) * piece.azimuth_size;
        piece.elevation += ((quarter & 2) != 0 ? 0.5f : -0.5f) * piece.elevation_size;
        samples_.push_back({piece, sky_->radiance_towards(piece.direction())});
      }
    cell.first = first;
    cell.count *= 4;
  }
}

void SkyCells::measure(SkyCell& cell) const {
  const std::span<const Sample> samples(samples_.data() + cell.first, cell.count);
  dvec3 sum(0);
  double weights = 0;
  for (const Sample& s : samples) {
    const auto weight = static_cast<double>(s.piece.solid_angle());
    sum += weight * dvec3(s.nits);
    weights += weight;
  }
  if (weights > 0) cell.nits = vec3(sum / weights);
  // What an even cell sends is known exactly; the samples say how the light is shifted within it.
  const float mean = luminance(cell.nits);
  dvec3 shift(0);
  double apart = 0;
  for (const Sample& s : samples) {
    const auto weight = static_cast<double>(s.piece.solid_angle());
    apart += weight * static_cast<double>(largest(glm::abs(s.nits - cell.nits)));
    if (mean > 0)
      shift += weight * static_cast<double>(luminance(s.nits) / mean - 1) * dvec3(s.piece.direction());
  }
  cell.transfer = even_transfer(cell.corners);
  if (!(weights > 0)) return;
  cell.unevenness = static_cast<float>(apart / weights);
  cell.transfer += vec3(shift / weights) * (cell.solid_angle / kPi);
}

float SkyCells::relative_luminance(uint32_t cell, const vec3& direction) const {
  const float mean = luminance(cells_[cell].nits);
  if (cells_[cell].unevenness <= 0 || mean <= 0) return 1;
  return luminance(grid_.nits[grid_.index_towards(direction)]) / mean;
}

bool SkyCells::divisible(uint32_t cell) const {
  return sky_->is_uniform() || cells_[cell].solid_angle > kLeastSolidAngle;
}

uint32_t SkyCells::split(uint32_t number) {
  if (!sky_->is_uniform()) refine_samples(cells_[number], kFewestSamples);
  const SkyCell parent = cells_[number];
  const std::array<vec3, 3>& c = parent.corners;
  size_t longest = 0;  // halved, so that cells stay near equilateral
  for (size_t k = 1; k < 3; ++k)
    if (dot(c[k], c[(k + 1) % 3]) < dot(c[longest], c[(longest + 1) % 3])) longest = k;
  const vec3 a = c[longest], b = c[(longest + 1) % 3], apex = c[(longest + 2) % 3], middle = normalize(a + b);
  std::array<SkyCell, 2> halves{parent, parent};
  halves[0].corners = {a, middle, apex};
  halves[1].corners = {middle, b, apex};
  const auto first = static_cast<uint32_t>(cells_.size());
  if (!sky_->is_uniform()) {
    const vec3 between = cross(middle, apex);
    const bool turned = dot(between, a) < 0;
    const auto begin = samples_.begin() + parent.first;
    const auto cut = std::stable_partition(begin, begin + parent.count, [&](const Sample& s) {
      return (dot(between, s.piece.direction()) < 0) == turned;
    });
    halves[0].count = static_cast<uint32_t>(cut - begin);
    halves[1].first = parent.first + halves[0].count;
    halves[1].count = parent.count - halves[0].count;
  }
  vec3 sent(0);
  for (SkyCell& half : halves) {
    half.solid_angle = solid_angle_of(half.corners);
    if (sky_->is_uniform()) continue;
    refine_samples(half, kFewestSamples);
    measure(half);
    sent += half.solid_angle * half.nits;
  }
  // The halves' rims do not go between samples; together they send what the whole did.
  for (int k = 0; k < 3 && !sky_->is_uniform(); ++k)
    if (sent[k] > 0)
      for (SkyCell& half : halves) half.nits[k] *= parent.solid_angle * parent.nits[k] / sent[k];
  cells_.insert(cells_.end(), halves.begin(), halves.end());
  return first;
}

std::vector<uint32_t> SkyCells::make_first() {
  std::vector<uint32_t> cells;
  float all = 0;
  for (uint32_t c = 0; c < cells_.size(); ++c) {
    cells.push_back(c);
    all += cells_[c].solid_angle * largest(cells_[c].nits);
  }
  const auto error = [&](uint32_t c) { return cells_[c].solid_angle * cells_[c].unevenness / 2; };
  while (!cells.empty() && cells.size() < kMostFirst) {
    const auto worst = std::max_element(cells.begin(), cells.end(), [&](uint32_t a, uint32_t b) {
      return error(a) * (divisible(a) ? 1.0f : 0.0f) < error(b) * (divisible(b) ? 1.0f : 0.0f);
    });
    if (!divisible(*worst) || error(*worst) <= kFirstUnevenness * all) break;
    const uint32_t half = split(*worst);
    *worst = half;
    cells.push_back(half + 1);
  }
  return cells;
}

}  // namespace goldthread
