#include "reconstruct/adaptive_gather.h"

#include <algorithm>
#include <atomic>

#include "base/parallel.h"
#include "base/rng.h"
#include "math/colour.h"
#include "reconstruct/average.h"
#include "reconstruct/buried.h"
#include "reconstruct/interpolate.h"
#include "reconstruct/leaf_light.h"
#include "reconstruct/outliers.h"

namespace goldthread {
namespace {

// A point that sees less than this share of what lies before it may be inside something.
constexpr float kSuspicious = 0.08f;
// How often leaves that seem right are tested at other places before they are believed.
constexpr int kLooks = 3;
// A vertex is gathered again when the faces around it have become this much smaller.
constexpr float kDrawnInAgain = 0.25f;

// How far light points are drawn into their face, as a share of the way to its middle; at a gap past where
// light gets under.
constexpr float kInward = 0.03f, kPastGap = 0.2f;

// Points on an edge are drawn a little into their face: at the edge itself, a wall that stands on a floor is
// neither before nor behind it.
vec3 drawn_in(const LightPoint& point, const PartPoints& points, float epsilon) {
  const vec3 way = points.face_centres[point.face] - point.position;
  const float distance = length(way);
  const auto seams = points.seams.find(point.vertex);
  const float share = seams != points.seams.end() && seams->second.gap ? kPastGap : kInward;
  const float step = std::min(0.5f * distance, std::max(share * distance, 16 * epsilon));
  return point.position + way * (distance > 0 ? step / distance : 0.0f);
}

}  // namespace

AdaptiveGather::AdaptiveGather(HierarchicalSolver& solver, const ReconstructOptions& options,
                               const CancelToken& cancel, ReconstructStats& stats)
    : solver_(solver),
      options_(options),
      cancel_(cancel),
      stats_(stats),
      gather_{options.light_rays, options.ray_share},
      shown_(settle_outliers(solver, options, cancel, stats)),
      solved_elements_(solver.pool().size()) {
  for (size_t id = 0; id < shown_.shown.size(); ++id)
    shown_.low[id] = shown_.high[id] = largest(shown_.shown[id]);
  const vec3 power = regarded_power(solver.pool(), solver.state(), solver.regard());
  mean_light_ = std::max(1e-30, static_cast<double>(luminance(power)) /
                                    std::max(1e-30, regarded_area(solver.pool(), solver.regard())));
  const SurfaceSet& set = solver.pool().surfaces();
  parts_.resize(set.parts.size());
  for (uint32_t p = 0; p < set.parts.size(); ++p) {
    const Material& material = set.scene->materials[set.parts[p].material];
    if (!material.unlit && !set.tree(set.parts[p]).mesh.triangles.empty())
      parts_[p].sides.resize(material.lit_behind() ? 2 : 1);
  }
}

void AdaptiveGather::run() {
  for (int looks = 1;;) {
    update_points();
    if (cancel_.cancelled()) return;
    test_leaves(false);
    if (cancel_.cancelled()) return;
    // What is left are the leaves whose places happened to agree with their corners: other places tell.
    if (first_gathers_ == 0) first_gathers_ = gathers();
    if (!cut()) {
      if (is_spent() || looks++ == kLooks) return;
      test_leaves(true);
      if (cancel_.cancelled() || !cut()) return;
    }
    show_leaves();
  }
}

ShownLight AdaptiveGather::shown_light() const {
  ShownLight shown = shown_;
  for (const PartLight& lit : parts_)
    for (const Side& side : lit.sides)
      fit_leaves(solver_.pool(), lit.points, side.leaves, side.light, solver_.state(), shown);
  range_over_leaves(solver_.pool(), shown);
  return shown;
}

void AdaptiveGather::LeafError::add(const LeafError& more) {
  area = more.area;
  ++looks;
  if (more.tests == 0) return;
  const double share = static_cast<double>(more.tests) / (tests + more.tests);
  square += share * (more.square - square);
  light += static_cast<float>(share) * (more.light - light);
  tests += more.tests;
}

// The light points of a part as its mesh now is, with the light of those that were there before.
void AdaptiveGather::collect(uint32_t part) {
  PartLight& lit = parts_[part];
  lit.points = collect_light_points(solver_.pool(), part);
  const size_t count = lit.points.points.size();
  for (size_t s = 0; s < lit.sides.size(); ++s) {
    Side& side = lit.sides[s];
    side.leaves = solver_.pool().leaf_elements(part, s == 1);
    side.light = average_side(solver_, lit.points, side.leaves, s == 1);
    side.variance.assign(count, 0);
    side.buried.assign(count, 0);
  }
}

void AdaptiveGather::update_points() {
  std::vector<Job> jobs;
  std::vector<uint32_t> changed;
  for (uint32_t p = 0; p < parts_.size(); ++p)
    if (parts_[p].changed && !parts_[p].sides.empty()) changed.push_back(p);
  parallel_for(changed.size(), [&](size_t i) { collect(changed[i]); });
  std::vector<std::vector<KeyPoints>> keys(changed.size());
  for (size_t c = 0; c < changed.size(); ++c) {
    PartLight& lit = parts_[changed[c]];
    for (uint32_t s = 0; s < lit.sides.size(); ++s) {
      Side& side = lit.sides[s];
      keys[c].emplace_back(solver_, lit.points, side.leaves, s == 1);
      for (const uint32_t point : keys[c].back().keys()) {
        const LightPoint& at = lit.points.points[point];
        if (side.leaves[at.face] == kNoElement) continue;
        if (at.vertex >= side.first_kept.size()) side.first_kept.resize(at.vertex + 1, kNone);
        uint32_t kept = side.first_kept[at.vertex];
        while (kept != kNone &&
               (dot(side.kept[kept].normal, at.normal) < 0.9999f ||
                lit.points.sides_of(at.vertex, at.position, side.kept[kept].place) != at.sides))
          kept = side.kept[kept].next;
        const float reach = length(lit.points.face_centres[at.face] - at.position);
        if (kept == kNone || reach < kDrawnInAgain * side.kept[kept].reach ||
            (side.kept[kept].near_leaf != kNoElement &&
             solver_.pool()[side.kept[kept].near_leaf].first_child != kNoElement)) {
          jobs.push_back({changed[c], s, point, kept});
          continue;
        }
        side.light[point] = side.kept[kept].light;
        side.variance[point] = side.kept[kept].variance;
        side.buried[point] = side.kept[kept].buried ? 1 : 0;
      }
    }
  }
  gather(jobs);
  for (size_t c = 0; c < changed.size(); ++c) {
    PartLight& lit = parts_[changed[c]];
    for (size_t s = 0; s < lit.sides.size(); ++s) {
      if (!cancel_.cancelled()) keys[c][s].interpolate(lit.sides[s].light);
      fill_buried(lit.points, lit.sides[s].buried, lit.sides[s].light);
    }
    lit.changed = false;
  }
}

bool AdaptiveGather::is_hidden(const Gathered& gathered, const vec3& x, const vec3& n,
                               RayCount& count) const {
  return gathered.openness < kSuspicious && is_buried(solver_.pool(), solver_.visibility(), x, n, count);
}

void AdaptiveGather::gather(const std::vector<Job>& jobs) {
  std::vector<Kept> found(jobs.size());
  std::vector<uint8_t> done(jobs.size(), 0);
  std::atomic<uint64_t> rays{0}, nanoseconds{0};
  parallel_for(
      jobs.size(),
      [&](size_t i) {
        if (cancel_.cancelled()) return;
        const auto& [part, s, p, old] = jobs[i];
        const PartPoints& points = parts_[part].points;
        const LightPoint& point = points.points[p];
        const vec3 n = s == 1 ? -point.normal : point.normal;
        RayCount count;
        const vec3 x = drawn_in(point, points, solver_.visibility().epsilon);
        const Gathered gathered = gather_at(solver_, shown_, parts_[part].sides[s].leaves[point.face], x, n,
                                            gather_, hash(hash(part, s), point.vertex), count);
        const float gain = horizon_gain(dot(point.normal, points.face_normals[point.face]), gathered.seen);
        found[i] = {point.normal,
                    gathered.irradiance * gain,
                    x,
                    gathered.variance * gain * gain,
                    length(points.face_centres[point.face] - point.position),
                    is_hidden(gathered, x, n, count),
                    gathered.nearest_leaf,
                    kNone};
        done[i] = 1;
        rays.fetch_add(count.rays, std::memory_order_relaxed);
        nanoseconds.fetch_add(count.nanoseconds, std::memory_order_relaxed);
      },
      32);
  stats_.rays += {rays.load(), nanoseconds.load()};
  for (size_t i = 0; i < jobs.size(); ++i) {
    if (done[i] == 0) continue;
    ++stats_.points;
    Side& side = parts_[jobs[i].part].sides[jobs[i].side];
    const uint32_t vertex = parts_[jobs[i].part].points.points[jobs[i].point].vertex;
    if (jobs[i].kept != kNone) {
      found[i].next = side.kept[jobs[i].kept].next;
      side.kept[jobs[i].kept] = found[i];
    } else {
      found[i].next = side.first_kept[vertex];
      side.first_kept[vertex] = static_cast<uint32_t>(side.kept.size());
      side.kept.push_back(found[i]);
    }
    side.light[jobs[i].point] = found[i].light;
    side.variance[jobs[i].point] = found[i].variance;
    side.buried[jobs[i].point] = found[i].buried ? 1 : 0;
  }
}

// Gives points that lie buried (a ceiling's behind the lamp that hangs on it) the light of their open
// neighbours. Nobody sees the points themselves, but the faces that reach out from under cover would darken
// towards them.
void AdaptiveGather::fill_buried(const PartPoints& points, std::vector<uint8_t> buried,
                                 std::vector<vec3>& light) const {
  for (int ring = 0; ring < 2; ++ring) {
    std::vector<vec3> sum(light.size(), vec3(0));
    std::vector<float> weight(light.size(), 0);
    for (uint32_t f = 0; f + 1 < points.corner_first.size(); ++f) {
      for (uint32_t a = points.corner_first[f]; a < points.corner_first[f + 1]; ++a) {
        const uint32_t p = points.corners[a];
        if (buried[p] == 0) continue;
        for (uint32_t b = points.corner_first[f]; b < points.corner_first[f + 1]; ++b) {
          const uint32_t q = points.corners[b];
          if (buried[q] != 0) continue;
          const float w = 1 / (length(points.points[p].position - points.points[q].position) + 1e-20f);
          sum[p] += w * light[q];
          weight[p] += w;
        }
      }
    }
    for (size_t p = 0; p < light.size(); ++p) {
      if (weight[p] <= 0) continue;
      light[p] = sum[p] / weight[p];
      buried[p] = 0;
    }
  }
}

}  // namespace goldthread
