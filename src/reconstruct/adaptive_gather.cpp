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
#include "reconstruct/triangulate.h"

namespace goldthread {
namespace {

// A point that sees less than this share of what lies before it may be inside something.
constexpr float kSuspicious = 0.08f;
// What a point may see, by the luck of its rays, of one.
constexpr float kMostSeen = 1.05f;
// What is left of the allowed error when leaves are cut for having more: so that few rounds will do.
constexpr double kLeft = 0.5;
// The share of the allowed squared error that is left to interpolation; the rest is for the links' own.
constexpr double kInterpolation = 0.4;
// The scene is tested at no fewer places than this, spread by area; a leaf at no more than the second.
constexpr double kLeastTests = 4000;
constexpr uint32_t kMostTests = 8;
// Faces of a leaf among which places are chosen.
constexpr uint32_t kMostFaces = 64;
// How often leaves that seem right are tested at other places before they are believed.
constexpr int kLooks = 3;
// A vertex is gathered again when the faces around it have become this much smaller.
constexpr float kDrawnInAgain = 0.25f;

// Points on an edge are drawn a little into their face: at the edge itself, a wall that stands on a floor is
// neither before nor behind it.
vec3 drawn_in(const LightPoint& point, const PartPoints& points, float epsilon) {
  const vec3 way = points.face_centres[point.face] - point.position;
  const float distance = length(way);
  const float step = std::min(0.5f * distance, std::max(0.03f * distance, 16 * epsilon));
  return point.position + way * (distance > 0 ? step / distance : 0.0f);
}

// A vertex normal that leans from its face looks partly below it, where nothing comes from: (1 - cos) / 2 of
// its hemisphere. What it would get of an even surrounding is restored, as far as it does see less than all
// there is. And no point sees much more than all there is. (A little more is the luck of its rays: to take
// just that away would darken all points on the average.)
float horizon_gain(float cosine, float seen) {
  const float all = kMostSeen / std::max(seen, 1e-3f);
  return all < 1 ? all : std::min(all, 2 / (1 + std::clamp(cosine, 0.0f, 1.0f)));
}

struct FaceTriangles {
  std::vector<uint32_t> corners;  // points, three a triangle
  std::vector<uint32_t> faces;    // that they are of
  std::vector<float> up_to;       // running sum of areas

  void add(const PartPoints& points, uint32_t face) {
    const uint32_t first = points.corner_first[face];
    std::vector<vec3> loop;
    for (uint32_t c = first; c < points.corner_first[face + 1]; ++c)
      loop.push_back(points.points[points.corners[c]].position);
    std::vector<UVec3> triangles;
    triangulate_face(loop, triangles);
    for (const UVec3& t : triangles) {
      for (const uint32_t k : {t.x, t.y, t.z}) corners.push_back(points.corners[first + k]);
      faces.push_back(face);
      const float before = up_to.empty() ? 0.0f : up_to.back();
      up_to.push_back(before + length(area_vector(loop[t.x], loop[t.y], loop[t.z])));
    }
  }
};

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
  const SurfaceSet& set = solver.pool().surfaces();
  parts_.resize(set.parts.size());
  for (uint32_t p = 0; p < set.parts.size(); ++p) {
    const Material& material = set.scene->materials[set.parts[p].material];
    if (!material.unlit && !set.tree(set.parts[p]).mesh.triangles.empty())
      parts_[p].sides.resize(material.double_sided ? 2 : 1);
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
    for (const Side& side : lit.sides) fit_leaves(solver_.pool(), lit.points, side.leaves, side.light, shown);
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
        while (kept != kNone && dot(side.kept[kept].normal, at.normal) < 0.9999f) kept = side.kept[kept].next;
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

// The leaves that have not been tested yet, or all, each with its faces.
std::vector<AdaptiveGather::Test> AdaptiveGather::list_tests(bool again) {
  std::vector<Test> tests;
  leaf_faces_.clear();
  std::vector<std::pair<ElementId, uint32_t>> pairs;
  for (uint32_t p = 0; p < parts_.size(); ++p) {
    for (uint32_t s = 0; s < parts_[p].sides.size(); ++s) {
      pairs.clear();
      const std::vector<ElementId>& leaves = parts_[p].sides[s].leaves;
      for (uint32_t f = 0; f < leaves.size(); ++f)
        if (leaves[f] != kNoElement && (again || errors_[leaves[f]].looks == 0))
          pairs.emplace_back(leaves[f], f);
      std::sort(pairs.begin(), pairs.end());
      for (const auto& [leaf, face] : pairs) {
        if (tests.empty() || tests.back().leaf != leaf)
          tests.push_back({p, s, static_cast<uint32_t>(leaf_faces_.size()), 0, leaf});
        ++tests.back().faces;
        leaf_faces_.push_back(face);
      }
    }
  }
  return tests;
}

// Compares what the corners say of places within a leaf with what is there.
AdaptiveGather::LeafError AdaptiveGather::test(const Test& test, double unit_area, RayCount& count) const {
  const PartLight& lit = parts_[test.part];
  const Side& side = lit.sides[test.side];
  const Element& leaf = solver_.pool()[test.leaf];
  LeafError error;
  error.area = std::max(1e-30, static_cast<double>(leaf.area * leaf.coverage));
  // Of many faces one would say little.
  const double least = test.faces > 1 ? 3 : 1;
  const auto places = static_cast<uint32_t>(
      std::clamp(std::ceil(error.area / unit_area), least, static_cast<double>(kMostTests)) /
          (errors_[test.leaf].looks == 0 ? 1 : 2) +
      0.5);
  FaceTriangles triangles;
  // Of very many faces some, another choice each time.
  const uint32_t step = 1 + test.faces / kMostFaces;
  for (uint32_t f = hash(test.leaf, errors_[test.leaf].looks) % step; f < test.faces; f += step)
    triangles.add(lit.points, leaf_faces_[test.first_face + f]);
  if (triangles.up_to.empty() || !(triangles.up_to.back() > 0)) return error;
  const uint32_t pattern = hash(test.leaf, 81 + errors_[test.leaf].looks);
  for (uint32_t i = 0; i < places; ++i) {
    const UnitSquarePoint uv = r2_point(i, pattern);
    const float target = uv.u * triangles.up_to.back();
    const size_t t = std::min<size_t>(
        static_cast<size_t>(std::upper_bound(triangles.up_to.begin(), triangles.up_to.end(), target) -
                            triangles.up_to.begin()),
        triangles.up_to.size() - 1);
    const float before = t > 0 ? triangles.up_to[t - 1] : 0.0f;
    const float along =
        std::clamp((target - before) / std::max(triangles.up_to[t] - before, 1e-30f), 0.0f, 1.0f);
    const float root = std::sqrt(along);
    const std::array<float, 3> weights{1 - root, root * (1 - uv.v), root * uv.v};
    vec3 x(0), normal(0), said(0);
    float doubt = 0;
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t p = triangles.corners[3 * t + k];
      x += weights[k] * lit.points.points[p].position;
      normal += weights[k] * lit.points.points[p].normal;
      said += weights[k] * side.light[p];
      doubt += weights[k] * weights[k] * side.variance[p];
    }
    const vec3 flat = lit.points.face_normals[triangles.faces[t]];
    normal = normalize_or(normal, flat);
    const Gathered gathered = gather_at(solver_, shown_, test.leaf, x, test.side == 1 ? -normal : normal,
                                        gather_, hash(pattern, i), count);
    if (is_hidden(gathered, x, test.side == 1 ? -normal : normal, count)) continue;
    const float gain = horizon_gain(dot(normal, flat), gathered.seen);
    const vec3 truth = gathered.irradiance * gain;
    ++error.tests;
    error.light += truth;
    // What rays' luck explains no cut would mend.
    const float off = luminance(said - truth);
    error.square += std::max(0.0, static_cast<double>(off * off - (doubt + gathered.variance * gain * gain)));
  }
  if (error.tests > 0) {
    error.light /= static_cast<float>(error.tests);
    error.square /= error.tests;
  }
  return error;
}

void AdaptiveGather::test_leaves(bool again) {
  errors_.resize(solver_.pool().size());
  const std::vector<Test> tests = list_tests(again);
  const double unit_area = solver_.pool().surfaces().area / kLeastTests;
  std::atomic<uint64_t> rays{0}, nanoseconds{0};
  parallel_for(
      tests.size(),
      [&](size_t i) {
        if (cancel_.cancelled()) return;
        RayCount count;
        errors_[tests[i].leaf].add(test(tests[i], unit_area, count));
        rays.fetch_add(count.rays, std::memory_order_relaxed);
        nanoseconds.fetch_add(count.nanoseconds, std::memory_order_relaxed);
      },
      16);
  stats_.rays += {rays.load(), nanoseconds.load()};
  for (const Test& test : tests) places_tested_ += errors_[test.leaf].tests;
}

// Cuts the leaves that are most wrong, until what is left is allowed. False when there are none.
bool AdaptiveGather::cut() {
  const ElementPool& pool = solver_.pool();
  double area = 0, light = 0, squares = 0;
  const auto is_leaf = [&](ElementId id) {
    return errors_[id].area > 0 && pool[id].first_child == kNoElement;
  };
  std::vector<double> regarded(errors_.size(), 0);
  for (ElementId id = 0; id < errors_.size(); ++id) {
    if (!is_leaf(id)) continue;
    regarded[id] = static_cast<double>(solver_.regard().of(pool[id]));
    area += regarded[id] * errors_[id].area;
    light += regarded[id] * errors_[id].area * static_cast<double>(luminance(errors_[id].light));
  }
  if (!(area > 0) || !(light > 0)) return false;
  const double mean = light / area, whole = regarded_area(pool, solver_.regard());
  // What counts of a leaf's error.
  const auto counted = [&](ElementId id) {
    const double weight = weight_of_darkness(adapted_light(pool, solver_.state(), id, whole), mean);
    return errors_[id].squares() * regarded[id] * weight * weight;
  };
  std::vector<ElementId> worst;
  const double least = options_.least_area * whole;
  for (ElementId id = 0; id < errors_.size(); ++id) {
    if (!is_leaf(id)) continue;
    regarded[id] = counted(id);
    squares += regarded[id];
    if (regarded[id] > 0 && !pool[id].indivisible && errors_[id].area > 2 * least) worst.push_back(id);
  }
  stats_.error = std::sqrt(squares / area) / mean;
  const double allowed = kInterpolation * options_.error * options_.error * mean * mean * area;
  std::sort(worst.begin(), worst.end(), [&](ElementId a, ElementId b) {
    return regarded[a] > regarded[b] || (regarded[a] == regarded[b] && a < b);
  });
  if (squares <= allowed || is_spent()) return false;
  size_t count = 0;
  while (count < worst.size() && squares > kLeft * allowed) squares -= regarded[worst[count++]];
  worst.resize(count);
  if (worst.empty()) return false;
  std::sort(worst.begin(), worst.end());
  cut_.resize(pool.size(), 0);
  for (const ElementId id : worst) {
    cut_[id] = 1;
    parts_[pool[id].part].changed = true;
  }
  solver_.cut_leaves(worst);
  return true;
}

// What leaves made here show, and what those above them therefore do.
void AdaptiveGather::show_leaves() {
  const ElementPool& pool = solver_.pool();
  const size_t before = shown_.shown.size();
  shown_.shown.resize(pool.size());
  shown_.low.resize(pool.size());
  shown_.high.resize(pool.size());
  errors_.resize(pool.size());
  cut_.resize(pool.size(), 0);
  const auto set = [&](ElementId id, const vec3& light) {
    shown_.shown[id] = pool[id].exitance + pool[id].reflectance * light;
    shown_.low[id] = shown_.high[id] = largest(shown_.shown[id]);
  };
  for (ElementId id = static_cast<ElementId>(before); id < pool.size(); ++id) {
    const ElementId parent = pool[id].parent;
    set(id, errors_[parent].light);
  }
  for (ElementId id = static_cast<ElementId>(solved_elements_); id < before; ++id)
    if (errors_[id].area > 0 && pool[id].first_child == kNoElement) set(id, errors_[id].light);
  for (ElementId id = static_cast<ElementId>(pool.size()); id-- > 0;) {
    const ElementId a = pool[id].first_child;
    if (a == kNoElement || !is_surface(pool[id].kind)) continue;
    // Of a leaf that the solver has cut at a box's foot, the mean over what lies under the box and beside it
    // is no better than its parent's by openness: only what was gathered here is worth telling apart.
    if (id < solved_elements_ && cut_[id] == 0) continue;
    shown_.low[id] = std::min(shown_.low[a], shown_.low[a + 1]);
    shown_.high[id] = std::max(shown_.high[a], shown_.high[a + 1]);
    const float total = pool[a].area + pool[a + 1].area;
    const float share = total > 0 ? pool[a].area / total : 0.5f;
    shown_.shown[id] = share * shown_.shown[a] + (1 - share) * shown_.shown[a + 1];
  }
}

}  // namespace goldthread
