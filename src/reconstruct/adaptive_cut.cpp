// The tests of AdaptiveGather: which leaves are wrong, and their cuts.
#include <algorithm>
#include <atomic>

#include "base/parallel.h"
#include "base/rng.h"
#include "math/colour.h"
#include "reconstruct/adaptive_gather.h"

namespace goldthread {
namespace {

// The scene is tested at no fewer places than this, spread by the area that counts; a leaf at no more than
// the second.
constexpr double kLeastTests = 4000;
constexpr uint32_t kMostTests = 8;
// The share of all error there was before a cut of which a leaf must be likely to hold as much to be tested
// at all of them.
constexpr double kWorthAll = 1e-3;
// How many times as many places later looks go to, for leaves that seem right.
constexpr double kMoreLater = 4;
// What is left of the allowed error when leaves are cut for having more: so that few rounds will do.
constexpr double kLeft = 0.5;
// And how much of the squared error that there is a round leaves for later ones: what holds the most of it is
// to be cut again before the rest is cut at all.
constexpr double kLeftByRound = 0.25;
// A leaf that holds no more than this of the allowed squared error is left alone, however many there are:
// what tests find of it is mostly chance.
constexpr double kNothing = 1e-5;
// A child with more of its parent's area than this.
constexpr float kNearlyWhole = 0.75f;
// The share of the allowed squared error that interpolation may be found to have. Some of the rest is the
// links' own; and where a hundredth of all places hold most of an error, few tests find about half of it.
constexpr double kInterpolation = 0.2;
// Faces of a leaf among which places are chosen.
constexpr uint32_t kMostFaces = 64;
// How many times the rays of a light point a place has at which the error is measured in the end.
constexpr uint32_t kCheckRays = 4;

}  // namespace

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

// A place within a leaf: what its corners say of it, and where to look.
AdaptiveGather::TestPlace AdaptiveGather::test_place(const Test& test, const FacePlace& at) const {
  const PartLight& lit = parts_[test.part];
  const Side& side = lit.sides[test.side];
  TestPlace place;
  vec3 normal(0);
  for (size_t k = 0; k < 3; ++k) {
    const LightPoint& corner = lit.points.points[at.corners[k]];
    place.position += at.weights[k] * corner.position;
    normal += at.weights[k] * corner.normal;
    place.said += at.weights[k] * side.light[at.corners[k]];
    place.doubt += at.weights[k] * at.weights[k] * side.variance[at.corners[k]];
  }
  const vec3 flat = lit.points.face_normals[at.face];
  normal = normalize_or(normal, flat);
  place.cosine = dot(normal, flat);
  place.normal = test.side == 1 ? -normal : normal;
  return place;
}

LeafFaces AdaptiveGather::faces_of(const Test& test) const {
  LeafFaces faces;
  // Of very many faces some, another choice each time.
  const uint32_t step = 1 + test.faces / kMostFaces;
  for (uint32_t f = hash(test.leaf, errors_[test.leaf].looks) % step; f < test.faces; f += step)
    faces.add(parts_[test.part].points, leaf_faces_[test.first_face + f]);
  return faces;
}

// At how many places a leaf of so many unit areas is looked at. What may be missed there is as large as its
// light, so that bright ones count by its square. The first look is at all leaves; later ones take their
// chance.
uint32_t AdaptiveGather::places_to_test(const Test& test, const LeafFaces& faces, double unit_areas) const {
  const std::vector<vec3>& light = parts_[test.part].sides[test.side].light;
  float brightest = 0;
  for (const uint32_t point : faces.corners()) brightest = std::max(brightest, luminance(light[point]));
  const double brightness = static_cast<double>(brightest) / mean_light_;
  const double counts = unit_areas * static_cast<double>(solver_.regard().of(solver_.pool()[test.leaf])) *
                        std::max(1.0, brightness * brightness);
  const uint32_t looks = errors_[test.leaf].looks;
  double wanted = std::min((looks > 0 ? kMoreLater : 1) * counts, static_cast<double>(kMostTests));
  if (looks > 0)
    return static_cast<uint32_t>(wanted + static_cast<double>(unit_float(hash(test.leaf, looks))));
  // What was cut for being wrong is known to hold so much error.
  const ElementId parent = solver_.pool()[test.leaf].parent;
  if (parent != kNoElement && errors_[parent].tests > 0)
    wanted = std::min(wanted, kMostTests * 0.5 * errors_[parent].counted / (kWorthAll * at_stake_));
  // Of many faces one would say little.
  return std::max(test.faces > 1 ? 3u : 1u, static_cast<uint32_t>(std::ceil(wanted)));
}

// Compares what the corners say of places within a leaf with what is there.
AdaptiveGather::LeafError AdaptiveGather::test(const Test& test, double unit_area, RayCount& count) const {
  const Element& leaf = solver_.pool()[test.leaf];
  LeafError error;
  error.area = std::max(1e-30, static_cast<double>(leaf.area * leaf.coverage));
  const LeafFaces faces = faces_of(test);
  if (!faces.has_area()) return error;
  const uint32_t places = places_to_test(test, faces, error.area / unit_area);
  const uint32_t pattern = hash(test.leaf, 81 + errors_[test.leaf].looks);
  for (uint32_t i = 0; i < places; ++i) {
    const UnitSquarePoint uv = r2_point(i, pattern);
    const TestPlace place = test_place(test, faces.place(uv.u, uv.v));
    const Gathered gathered =
        gather_at(solver_, shown_, test.leaf, place.position, place.normal, gather_, hash(pattern, i), count);
    if (is_hidden(gathered, place.position, place.normal, count)) continue;
    const float gain = horizon_gain(place.cosine, gathered.seen);
    const vec3 truth = gathered.irradiance * gain;
    ++error.tests;
    error.light += truth;
    // What rays' luck explains no cut would mend.
    const float off = luminance(place.said - truth), luck = place.doubt + gathered.variance * gain * gain;
    error.square += std::max(0.0, static_cast<double>(off * off - luck));
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
  const double unit_area = regarded_area(solver_.pool(), solver_.regard()) / kLeastTests;
  std::atomic<uint64_t> rays{0}, nanoseconds{0}, places{0};
  parallel_for(
      tests.size(),
      [&](size_t i) {
        if (cancel_.cancelled()) return;
        RayCount count;
        const LeafError found = test(tests[i], unit_area, count);
        errors_[tests[i].leaf].add(found);
        places.fetch_add(found.tests, std::memory_order_relaxed);
        rays.fetch_add(count.rays, std::memory_order_relaxed);
        nanoseconds.fetch_add(count.nanoseconds, std::memory_order_relaxed);
      },
      16);
  stats_.rays += {rays.load(), nanoseconds.load()};
  stats_.places += places.load();
}

void AdaptiveGather::cut_now(std::vector<ElementId> leaves) {
  const ElementPool& pool = solver_.pool();
  std::sort(leaves.begin(), leaves.end());
  cut_.resize(pool.size(), 0);
  for (const ElementId id : leaves) {
    cut_[id] = 1;
    parts_[pool[id].part].changed = true;
  }
  solver_.cut_leaves(leaves);
}

// The children that are nearly all of their parents: clusters lose faces one by one where their tree is
// lopsided, and a round for each would be one for nothing.
std::vector<ElementId> AdaptiveGather::nearly_whole(std::span<const ElementId> parents) const {
  const ElementPool& pool = solver_.pool();
  std::vector<ElementId> children;
  for (const ElementId id : parents) {
    const ElementId first = pool[id].first_child;
    if (first == kNoElement) continue;
    for (const ElementId child : {first, first + 1})
      if (pool[child].kind == ElementKind::kCluster && !pool[child].indivisible &&
          pool[child].area > kNearlyWhole * pool[id].area)
        children.push_back(child);
  }
  return children;
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
    if (!(errors_[id].squares() > 0)) return 0.0;
    const double weight = weight_of_darkness(adapted_light(pool, solver_.state(), id, whole), mean) *
                          weight_of_masking(static_cast<double>(pool.texture_contrast(id)));
    return errors_[id].squares() * regarded[id] * weight * weight;
  };
  const double allowed = kInterpolation * options_.error * options_.error * mean * mean * area;
  std::vector<ElementId> worst;
  double mendable = 0;
  for (ElementId id = 0; id < errors_.size(); ++id) {
    if (!is_leaf(id)) continue;
    regarded[id] = errors_[id].counted = counted(id);
    squares += regarded[id];
    if (!(regarded[id] > 0) || pool[id].indivisible) continue;
    if (regarded[id] <= kNothing * allowed) continue;
    worst.push_back(id);
    mendable += regarded[id];
  }
  stats_.error = std::sqrt(squares / area) / mean;
  std::sort(worst.begin(), worst.end(), [&](ElementId a, ElementId b) {
    return regarded[a] > regarded[b] || (regarded[a] == regarded[b] && a < b);
  });
  at_stake_ = std::max(allowed, mendable);
  if (mendable <= allowed || is_spent()) return false;
  const double left = std::max(kLeft * allowed, kLeftByRound * mendable);
  size_t count = 0;
  while (count < worst.size() && mendable > left) mendable -= regarded[worst[count++]];
  worst.resize(count);
  if (worst.empty()) return false;
  for (; !worst.empty(); worst = nearly_whole(worst)) cut_now(worst);
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
    shown_.shown[id] = leaving_light(pool, id, light, solver_.state().irradiance);
    shown_.low[id] = shown_.high[id] = largest(shown_.shown[id]);
  };
  std::vector<vec3> made(pool.size() - before);
  for (ElementId id = static_cast<ElementId>(before); id < pool.size(); ++id) {
    // Of several cuts in one round only the first was of a leaf that has been tested.
    vec3& light = made[id - before];
    const ElementId parent = pool[id].parent;
    light = parent < before ? errors_[parent].light : made[parent - before];
    set(id, light);
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

// Places evenly by area, each in its leaf.
std::vector<std::pair<uint32_t, uint32_t>> AdaptiveGather::spread_places(const std::vector<Test>& tests,
                                                                         uint32_t places) const {
  double area = 0;
  for (const Test& t : tests) area += static_cast<double>(solver_.pool()[t.leaf].area);
  std::vector<std::pair<uint32_t, uint32_t>> chosen;  // test, number of places
  double up_to = 0, next = 0.5;
  for (uint32_t t = 0; t < tests.size(); ++t) {
    up_to += static_cast<double>(solver_.pool()[tests[t].leaf].area) / std::max(area, 1e-300) * places;
    uint32_t here = 0;
    for (; next < up_to; next += 1) ++here;
    if (here > 0) chosen.emplace_back(t, here);
  }
  return chosen;
}

void AdaptiveGather::measure_error(uint32_t places) {
  const std::vector<Test> tests = list_tests(true);
  const std::vector<std::pair<uint32_t, uint32_t>> chosen = spread_places(tests, places);
  const ShownLight shown = shown_light();
  // Other rays than those that made the light, more of them, and sources read within their leaves.
  const GatherOptions gather{kCheckRays * gather_.light_rays, gather_.ray_share / kCheckRays, false};
  struct Sum {
    double square = 0, light = 0;
    uint32_t places = 0;
  };
  std::vector<Sum> sums(chosen.size());
  std::atomic<uint64_t> rays{0}, nanoseconds{0};
  parallel_for(
      chosen.size(),
      [&](size_t i) {
        if (cancel_.cancelled()) return;
        const Test& test = tests[chosen[i].first];
        const LeafFaces faces = faces_of(test);
        if (!faces.has_area()) return;
        const uint32_t pattern = hash(test.leaf, 83);
        RayCount count;
        for (uint32_t k = 0; k < chosen[i].second; ++k) {
          const UnitSquarePoint uv = r2_point(k, pattern);
          const TestPlace place = test_place(test, faces.place(uv.u, uv.v));
          const Gathered gathered = gather_at(solver_, shown, test.leaf, place.position, place.normal, gather,
                                              hash(pattern, k), count);
          if (is_hidden(gathered, place.position, place.normal, count)) continue;
          const float gain = horizon_gain(place.cosine, gathered.seen);
          const vec3 truth = gathered.irradiance * gain;
          const auto off = static_cast<double>(luminance(place.said - truth));
          sums[i].square += off * off;
          sums[i].light += static_cast<double>(luminance(truth));
          ++sums[i].places;
        }
        rays.fetch_add(count.rays, std::memory_order_relaxed);
        nanoseconds.fetch_add(count.nanoseconds, std::memory_order_relaxed);
      },
      4);
  stats_.rays += {rays.load(), nanoseconds.load()};
  Sum all;
  for (const Sum& sum : sums) {
    all.square += sum.square;
    all.light += sum.light;
    all.places += sum.places;
  }
  if (cancel_.cancelled() || all.places == 0 || !(all.light > 0)) return;
  stats_.estimate = std::sqrt(all.square / all.places) / (all.light / all.places);
}

}  // namespace goldthread
