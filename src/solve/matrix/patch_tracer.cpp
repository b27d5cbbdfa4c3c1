#include "solve/matrix/patch_tracer.h"

#include <algorithm>
#include <cmath>

#include "base/rng.h"
#include "math/form_factor.h"
#include "math/oriented_box.h"
#include "math/polygon_exchange.h"
#include "math/spherical_triangle.h"

namespace goldthread {
namespace {

// Points of Strang's 3-point rule, one nearer to each corner.
constexpr double kNear = 2.0 / 3, kBeside = 1.0 / 6;
constexpr size_t kMostRays = 64;
constexpr uint32_t kNoPatch = 0xffffffffu;
constexpr float kNearPair = 2.5f;   // in radii: nearer ones are integrated exactly
constexpr double kFarError = 2e-3;  // of the 3-point rule beyond that

void add_points(const std::array<dvec3, 3>& corners, int cuts, TracedPatch& out) {
  if (cuts > 0) {
    for (const auto& part : cut_in_four(corners)) add_points(part, cuts - 1, out);
    return;
  }
  const auto size = static_cast<float>(triangle_area(corners));
  for (size_t k = 0; k < 3; ++k) {
    out.points.emplace_back(kNear * corners[k] + kBeside * (corners[(k + 1) % 3] + corners[(k + 2) % 3]));
    out.weights.push_back(size / 3);
  }
}

RayCaster build_caster(const PatchModel& model) {
  std::vector<vec3> positions;
  std::vector<UVec3> triangles;
  for (const auto* polygons : {&model.patches, &model.occluders})
    for (const Polygon& polygon : *polygons) {
      const auto offset = static_cast<uint32_t>(positions.size());
      for (const dvec3& p : polygon) positions.emplace_back(p);
      for (const UVec3& t : triangulate(polygon)) triangles.push_back(t + offset);
    }
  return {positions, triangles};
}

std::vector<uint32_t> patches_of_triangles(const PatchModel& model) {
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < model.patches.size(); ++i) out.insert(out.end(), model.patches[i].size() - 2, i);
  for (const Polygon& polygon : model.occluders) out.insert(out.end(), polygon.size() - 2, kNoPatch);
  return out;
}

bool none_above(const TracedPatch& patch, const TracedPatch& plane, float tolerance) {
  return std::none_of(patch.corners.begin(), patch.corners.end(),
                      [&](const vec3& p) { return dot(plane.normal, p - plane.centre) > tolerance; });
}

/// One ray of a pair's exchange, and its weight in the integral of F besides what all have in common.
struct PairSample {
  vec3 target{0};
  float weight = 0;
};

/// To an even point of the other patch: cos cos / r², which hardly changes where r is many radii.
PairSample even_sample(const TracedPatch& from, const vec3& x, const TracedPatch& to, UnitSquarePoint at) {
  const vec3 y = to.sample(at.u, at.v), d = y - x;
  const float squared = dot(d, d);
  if (!(squared > 0)) return {y, 0};
  return {y, std::max(0.0f, dot(from.normal, d)) * std::max(0.0f, -dot(to.normal, d)) / (squared * squared)};
}

/// In an even direction of those that the other patch fills: cos times their solid angle, which stays small
/// where patches touch.
PairSample direction_sample(const TracedPatch& from, const vec3& x, const TracedPatch& to,
                            UnitSquarePoint at) {
  const float height = dot(to.normal, x - to.centre);
  if (!(height > 0)) return {};
  const auto towards = [&](const vec3& corner) { return normalize(corner - x); };
  float whole = 0;
  for (const auto& t : to.triangles) whole += solid_angle(towards(t[0]), towards(t[1]), towards(t[2]));
  float wanted = at.u * whole;
  for (const auto& t : to.triangles) {
    const vec3 a = towards(t[0]), b = towards(t[1]), c = towards(t[2]);
    const float angle = solid_angle(a, b, c);
    if (wanted >= angle && &t != &to.triangles.back()) {
      wanted -= angle;
      continue;
    }
    if (!(angle > 0)) return {};
    const vec3 way = sample_spherical_triangle(a, b, c, angle, std::clamp(wanted / angle, 0.0f, 1.0f), at.v);
    const float down = -dot(to.normal, way);
    if (!(down > 0)) return {};
    return {x + height / down * way, whole * std::max(0.0f, dot(from.normal, way))};
  }
  return {};
}

}  // namespace

TracedPatch::TracedPatch(const Polygon& polygon, int cuts)
    : normal(plane_of(polygon).normal),
      centre(mean_corner(polygon)),
      radius(static_cast<float>(goldthread::radius(polygon))) {
  for (const dvec3& p : polygon) corners.emplace_back(p);
  for (const UVec3& t : triangulate(polygon)) {
    const std::array<dvec3, 3> c{polygon[t.x], polygon[t.y], polygon[t.z]};
    triangles.push_back({vec3(c[0]), vec3(c[1]), vec3(c[2])});
    area_up_to.push_back(area += static_cast<float>(triangle_area(c)));
    add_points(c, cuts, *this);
  }
}

vec3 TracedPatch::sample(float u, float v) const {
  size_t t = 0;
  while (t + 1 < triangles.size() && u * area > area_up_to[t]) ++t;
  const float before = t > 0 ? area_up_to[t - 1] : 0;
  const float width = area_up_to[t] - before;
  const float within = std::sqrt(std::clamp(width > 0 ? (u * area - before) / width : 0.5f, 0.0f, 1.0f));
  const auto& c = triangles[t];
  return (1 - within) * c[0] + within * ((1 - v) * c[1] + v * c[2]);
}

PatchTracer::PatchTracer(const PatchModel& model, const MatrixOptions& options)
    : model_(model),
      options_(options),
      caster_(build_caster(model)),
      patch_of_triangle_(patches_of_triangles(model)) {
  // Few patches are mostly large ones.
  const int cuts = model.patches.size() <= kMostExact ? 1 : 0;
  for (const Polygon& polygon : model.patches) patches_.emplace_back(polygon, cuts);
  find_twins();
}

std::optional<MatrixEntry> PatchTracer::exchange(uint32_t i, uint32_t j, uint64_t& rays) const {
  const bool turn = patches_[j].points.size() > patches_[i].points.size();
  const TracedPatch &from = patches_[turn ? j : i], &to = patches_[turn ? i : j];
  const float tolerance = 1e-6f * (from.radius + to.radius);
  if (none_above(from, to, tolerance) || none_above(to, from, tolerance)) return std::nullopt;
  double open = 0;
  for (size_t k = 0; k < from.points.size(); ++k)
    open += static_cast<double>(
        from.weights[k] * dot(from.normal, polygon_form_factor(from.points[k], from.normal, to.corners)));
  const bool near = length(from.centre - to.centre) < kNearPair * (from.radius + to.radius);
  if (open <= 0 && !near) return std::nullopt;
  // From the smaller one the view of the other changes less.
  const bool turn_view = near && to.area < from.area;
  const auto [share, deviation] =
      seen(turn_view ? to : from, turn_view ? from : to, near, hash(hash(i, j), options_.seed), rays);
  double rule_error = kFarError * open;
  if (near && share > 0) {
    const Estimate exact = polygon_exchange(model_.patches[i], model_.patches[j]);
    open = exact.value;
    rule_error = exact.error;
  }
  if (open * share <= 0) return std::nullopt;
  return MatrixEntry{j, FormFactorMethod::kRays, static_cast<float>(open * 2 * deviation + rule_error),
                     open * share};
}

ScannedRow PatchTracer::scan_row(uint32_t i, const DirectionGrid& grid) const {
  const TracedPatch& patch = patches_[i];
  ScannedRow out;
  ViewOfPatch view;
  for (size_t k = 0; k < patch.points.size(); ++k) {
    ScanOptions scan;
    scan.samples_across = options_.samples_across;
    scan.seed = hash(hash(i, static_cast<uint32_t>(k)), options_.seed);
    scan.turn = 2 * kPi * unit_float(hash(scan.seed, 1));
    const HemisphereScan seen = scan_hemisphere(caster_, grid, patch.points[k], patch.normal, scan);
    out.rays += seen.rays;
    add_view(seen, static_cast<double>(patch.weights[k] / patch.area), view);
  }
  out.surroundings = {static_cast<float>(view.missed), static_cast<float>(view.behind)};
  const auto area = static_cast<double>(patch.area);
  for (const auto& [j, share] : view.shares)
    out.row.push_back(
        {j, FormFactorMethod::kHemicube, static_cast<float>(share.second * area), share.first * area});
  return out;
}

void PatchTracer::add_view(const HemisphereScan& scan, double weight, ViewOfPatch& view) const {
  view.missed += weight * (scan.environment + scan.missing);
  for (const SeenShare& share : scan.seen) {
    const uint32_t j = patch_of_triangle_[share.triangle];
    const auto add = [&](uint32_t to, double form_factor) {
      if (form_factor <= 0) return;
      auto& [front, error] = view.shares[to];
      front += weight * form_factor;
      error += weight * share.error;
    };
    if (has_twin(share.triangle)) {
      add(j, share.front);
      add(twins_[j], share.back);
    } else if (j == kNoPatch) {
      view.behind += weight * (share.back + share.front);
    } else {
      add(j, share.front);
      view.behind += weight * share.back;
    }
  }
}

Surroundings PatchTracer::look_around(uint32_t i) const {
  const TracedPatch& patch = patches_[i];
  const mat3 frame = frame_about(patch.normal);
  uint32_t missed = 0, behind = 0;
  for (uint32_t k = 0; k < options_.environment_rays; ++k) {
    const auto [place, direction] = r4_point(k, hash(i, options_.seed));
    const float r = std::sqrt(direction.u), turn = 2 * kPi * direction.v;
    Ray ray;
    ray.direction =
        frame * vec3(r * std::cos(turn), r * std::sin(turn), std::sqrt(std::max(0.0f, 1 - direction.u)));
    ray.origin = patch.sample(place.u, place.v) + caster_.epsilon() * patch.normal;
    const Hit hit = caster_.closest(ray);
    if (hit.missed()) {
      ++missed;
      continue;
    }
    // What only blocks has no front; of two opposite faces in one place the ray meets either.
    const bool only_blocks = patch_of_triangle_[hit.triangle] == kNoPatch;
    const bool from_behind = dot(hit.normal, ray.direction) > 0;
    if (only_blocks || (from_behind && !has_twin(hit.triangle))) ++behind;
  }
  const auto count = static_cast<float>(std::max(1u, options_.environment_rays));
  return {static_cast<float>(missed) / count, static_cast<float>(behind) / count};
}

// The share of the exchange that is seen, and its standard deviation.
PatchTracer::SeenFraction PatchTracer::seen(const TracedPatch& from, const TracedPatch& to, bool near,
                                            uint32_t seed, uint64_t& rays) const {
  const size_t count = std::min<size_t>(options_.rays, kMostRays);
  std::array<Ray, kMostRays> cast;
  std::array<float, kMostRays> weight, passing;
  for (size_t k = 0; k < count; ++k) {
    const auto [a, b] = r4_point(static_cast<uint32_t>(k), seed);
    const vec3 x = from.sample(a.u, a.v);
    const PairSample sample = near ? direction_sample(from, x, to, b) : even_sample(from, x, to, b);
    weight[k] = sample.weight;
    cast[k].origin = x + caster_.epsilon() * from.normal;
    cast[k].direction = sample.target + caster_.epsilon() * to.normal - cast[k].origin;
    cast[k].far = 1;
  }
  for (size_t k = 0; k < count; k += 16) {
    const size_t some = std::min<size_t>(16, count - k);
    caster_.packet_transmittance({&cast[k], some}, {&passing[k], some});
  }
  rays += count;
  double all = 0, free = 0, squares = 0;
  for (size_t k = 0; k < count; ++k) {
    const auto w = static_cast<double>(weight[k]);
    all += w;
    squares += w * w;
    free += w * static_cast<double>(passing[k]);
  }
  if (all <= 0) return {0, 0};
  const double share = free / all;
  // Of so many rays as the weights are worth. What all agree on may still be wrong once in so often.
  const double worth = all * all / squares;
  const double agreed = (share * worth + 0.5) / (worth + 1);
  return {share, std::sqrt(agreed * (1 - agreed) / (worth + 1))};
}

// Plates are modelled as two opposite patches in one place.
void PatchTracer::find_twins() {
  twins_.assign(patches_.size(), kNoPatch);
  const auto rounded = [&](const vec3& p) {
    return std::array<int64_t, 3>{std::llround(p.x / (4 * caster_.epsilon())),
                                  std::llround(p.y / (4 * caster_.epsilon())),
                                  std::llround(p.z / (4 * caster_.epsilon()))};
  };
  std::map<std::array<int64_t, 3>, std::vector<uint32_t>> at;
  for (uint32_t i = 0; i < patches_.size(); ++i) {
    std::vector<uint32_t>& here = at[rounded(patches_[i].centre)];
    for (const uint32_t j : here)
      if (dot(patches_[i].normal, patches_[j].normal) < -0.999f &&
          std::abs(patches_[i].area - patches_[j].area) < 1e-4f * patches_[i].area) {
        twins_[i] = j;
        twins_[j] = i;
      }
    here.push_back(i);
  }
}

bool PatchTracer::has_twin(uint32_t triangle) const {
  const uint32_t patch = patch_of_triangle_[triangle];
  return patch != kNoPatch && twins_[patch] != kNoPatch;
}

}  // namespace goldthread
