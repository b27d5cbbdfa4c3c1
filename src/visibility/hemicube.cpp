#include "visibility/hemicube.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "base/rng.h"
#include "math/oriented_box.h"

namespace goldthread {
namespace {

constexpr size_t kMaxSamples = size_t{ScanOptions::kMaxSamplesAcross} * ScanOptions::kMaxSamplesAcross;

// The shares by triangle: a hash table with open addressing, because most rays meet one of few triangles and
// an allocation for each would cost more than the ray. Kept at most half full.
class ShareTable {
 public:
  ShareTable() : slots_(64, kEmpty) {}

  SeenShare& operator[](uint32_t triangle) {
    // Neighbouring rays mostly meet the same triangle.
    if (last_ < shares_.size() && shares_[last_].triangle == triangle) return shares_[last_];
    size_t slot = find(triangle);
    if (slots_[slot] == kEmpty) {
      if (2 * (shares_.size() + 1) > slots_.size()) {
        grow();
        slot = find(triangle);
      }
      slots_[slot] = static_cast<uint32_t>(shares_.size());
      shares_.push_back({triangle});
    }
    last_ = slots_[slot];
    return shares_[last_];
  }

  std::vector<SeenShare> take() { return std::move(shares_); }

 private:
  static constexpr uint32_t kEmpty = 0xffffffffu;

  size_t find(uint32_t triangle) const {
    size_t slot = hash(triangle) & (slots_.size() - 1);
    while (slots_[slot] != kEmpty && shares_[slots_[slot]].triangle != triangle)
      slot = (slot + 1) & (slots_.size() - 1);
    return slot;
  }

  void grow() {
    slots_.assign(2 * slots_.size(), kEmpty);
    for (size_t i = 0; i < shares_.size(); ++i) slots_[find(shares_[i].triangle)] = static_cast<uint32_t>(i);
  }

  std::vector<uint32_t> slots_;  // a power of two of them: indices into shares_
  std::vector<SeenShare> shares_;
  size_t last_ = 0;
};

bool from_behind(const Hit& hit, const Ray& ray) {
  return !hit.missed() && dot(hit.normal, ray.direction) > 0;
}

// The grid in its place in the world.
class Stand {
 public:
  Stand(const RayCaster& caster, const vec3& position, const vec3& normal, float turn)
      : caster_(caster), normal_(normal), origin_(position + caster.epsilon() * normal) {
    const mat3 straight = frame_about(normal);
    const float c = std::cos(turn), s = std::sin(turn);
    frame_ = mat3(c * straight[0] + s * straight[1], c * straight[1] - s * straight[0], normal);
  }

  struct Meeting {
    uint32_t triangle;
    bool behind;
  };

  // What lies in a unit direction of the grid. At the foot of a wall rounding decides on which side of it a
  // receiver is. So rays begin a little back from where they go, always as high over the receiver: those
  // towards the wall's front meet it, and those that come out of its back take a step before it.
  Meeting meet(const vec3& direction) const {
    const float epsilon = caster_.epsilon();
    Ray ray{origin_ - epsilon * (frame_ * vec3(direction.x, direction.y, 0)), frame_ * direction};
    Hit hit = caster_.closest(ray);
    const auto leaves_wall = [&] { return hit.distance < 2 * epsilon && from_behind(hit, ray); };
    for (int walls = 0; walls < 2 && leaves_wall(); ++walls) {  // there are two in a corner
      const vec3 facing = normalize_or(hit.normal, vec3(0));
      ray.origin += 2 * epsilon * (facing - dot(facing, normal_) * normal_);
      hit = caster_.closest(ray);
    }
    if (leaves_wall()) {  // it lies too flat to step before it
      ray.near = 2 * epsilon;
      hit = caster_.closest(ray);
    }
    return {hit.triangle, from_behind(hit, ray)};
  }

 private:
  const RayCaster& caster_;
  vec3 normal_, origin_;
  mat3 frame_{1};
};

void add(SeenShare& share, double form_factor, bool behind) {
  (behind ? share.back : share.front) += form_factor;
}

// One ray a cell; returns what each met.
std::vector<uint32_t> scan_middles(const DirectionGrid& grid, const Stand& stand, ShareTable& shares) {
  std::vector<uint32_t> met(grid.size());
  for (uint32_t cell = 0; cell < grid.size(); ++cell) {
    const Stand::Meeting hit = stand.meet(grid.directions()[cell]);
    met[cell] = hit.triangle;
    add(shares[hit.triangle], grid.delta_form_factors()[cell], hit.behind);
  }
  return met;
}

// A quarter of every cell on an outline goes to the error of the triangle it met and of each that its
// neighbours met, once.
void bound_outlines(const DirectionGrid& grid, const std::vector<uint32_t>& met, ShareTable& shares) {
  for (uint32_t cell = 0; cell < grid.size(); ++cell) {
    std::array<uint32_t, 5> involved{met[cell]};
    size_t count = 1;
    for (const uint32_t neighbour : grid.neighbours(cell)) {
      if (neighbour == DirectionGrid::kNone) continue;
      const auto end = involved.begin() + static_cast<ptrdiff_t>(count);
      if (std::find(involved.begin(), end, met[neighbour]) == end) involved[count++] = met[neighbour];
    }
    if (count == 1) continue;
    for (size_t i = 0; i < count; ++i) shares[involved[i]].error += 0.25 * grid.delta_form_factors()[cell];
  }
}

// What the rays of one cell met: few different triangles, so that a list is quickest.
class CellHits {
 public:
  void add(uint32_t triangle, double weight, bool behind) {
    size_t i = 0;
    while (i < count_ && hits_[i].triangle != triangle) ++i;
    if (i == count_) hits_[count_++] = {triangle};
    goldthread::add(hits_[i], weight, behind);
    total_ += weight;
  }

  // Shares out the cell's form factor; until the end SeenShare::error holds a variance.
  void share_out(double form_factor, size_t rays, ShareTable& shares) const {
    const double scale = form_factor / total_;
    for (size_t i = 0; i < count_; ++i) {
      const double part = (hits_[i].front + hits_[i].back) / total_;
      SeenShare& share = shares[hits_[i].triangle];
      share.front += scale * hits_[i].front;
      share.back += scale * hits_[i].back;
      share.error += form_factor * form_factor * std::max(0.0, part * (1 - part)) / double(rays - 1);
    }
  }

  void clear() {
    count_ = 0;
    total_ = 0;
  }

 private:
  std::array<SeenShare, kMaxSamples> hits_;
  size_t count_ = 0;
  double total_ = 0;
};

// Rays are weighted by the integrand z / r^4 where they pass: over a large cell it varies, and the brighter
// half of one must not count as the darker.
void scan_jittered(const DirectionGrid& grid, const Stand& stand, const ScanOptions& options,
                   ShareTable& shares) {
  const uint32_t across = options.samples_across;
  CellHits hits;
  for (uint32_t cell = 0; cell < grid.size(); ++cell) {
    hits.clear();
    const uint32_t seed = hash(cell, options.seed);
    for (uint32_t i = 0; i < across * across; ++i) {
      const double u = (i % across + double(unit_float(hash(seed, 2 * i)))) / across;
      const double v = (i / across + double(unit_float(hash(seed, 2 * i + 1)))) / across;
      const dvec3 point = grid.point(cell, u, v);
      const double squared = glm::dot(point, point);
      const Stand::Meeting hit = stand.meet(vec3(point / std::sqrt(squared)));
      hits.add(hit.triangle, point.z / (squared * squared), hit.behind);
    }
    hits.share_out(grid.delta_form_factors()[cell], size_t{across} * across, shares);
  }
}

}  // namespace

HemisphereScan scan_hemisphere(const RayCaster& caster, const DirectionGrid& grid, const vec3& position,
                               const vec3& normal, const ScanOptions& options) {
  GOLDTHREAD_CHECK_LE(1u, options.samples_across);
  GOLDTHREAD_CHECK_LE(options.samples_across, ScanOptions::kMaxSamplesAcross);
  const Stand stand(caster, position, normal, options.turn);
  ShareTable shares;
  HemisphereScan scan;
  scan.missing = grid.missing();
  scan.rays = uint64_t{grid.size()} * options.samples_across * options.samples_across;
  if (options.samples_across == 1) {
    bound_outlines(grid, scan_middles(grid, stand, shares), shares);
    scan.seen = shares.take();
  } else {
    scan_jittered(grid, stand, options, shares);
    scan.seen = shares.take();
    for (SeenShare& share : scan.seen) share.error = 2 * std::sqrt(share.error);
  }
  // kMiss is the highest index: the environment comes last.
  std::sort(scan.seen.begin(), scan.seen.end(),
            [](const SeenShare& a, const SeenShare& b) { return a.triangle < b.triangle; });
  if (!scan.seen.empty() && scan.seen.back().triangle == Hit::kMiss) {
    scan.environment = scan.seen.back().front;
    scan.environment_error = scan.seen.back().error;
    scan.seen.pop_back();
  }
  return scan;
}

}  // namespace goldthread
