#include "reconstruct/final_gather.h"

#include <algorithm>
#include <limits>

#include "base/rng.h"
#include "math/colour.h"
#include "solve/hierarchical/point_transfer.h"

namespace goldthread {
namespace {

// Rays worth casting for a link that would bring `share` of a point's light if it were all visible.
uint32_t rays_for(float share, const Link& link, ElementKind source, const GatherOptions& options) {
  if (share < options.ray_share) return 0;
  if (source == ElementKind::kPoint || source == ElementKind::kSun) return 1;
  // A source that would outshine all else is asked thoroughly, though the link's few rays all met the same:
  // they know nothing of a sliver, such as a window that a point far inside sees the sky through.
  const bool outshines = !options.trust_hidden && share > 0.5f;
  const bool mixed = outshines || (link.visibility > 0 && link.visibility < 255);
  const float wanted = share * static_cast<float>(options.light_rays) * (mixed ? 2.0f : 0.5f);
  return static_cast<uint32_t>(
      std::clamp(std::ceil(wanted), mixed ? 2.0f : 1.0f, 2.0f * static_cast<float>(options.light_rays)));
}

// What a source could bring at most to a point, by its size and distance alone: a link may be weak on the
// whole and yet all that a point next to the source gets.
float most_at(const ElementPool& pool, ElementId id, const vec3& x) {
  const Element& source = pool[id];
  const bool lamp = source.kind == ElementKind::kPoint;
  const float reach = !lamp ? source.radius : pool.light(id).has_area() ? pool.light(id).reach() : 0.0f;
  const float apart = length(source.centre - x) - reach;
  // Of a lamp its intensity counts.
  if (lamp) return apart > 0 ? 1 / (apart * apart) : std::numeric_limits<float>::infinity();
  if (!is_surface(source.kind)) return 0;
  return apart > 0 ? std::min(1.0f, source.area / (kPi * apart * apart)) : 1.0f;
}

bool has_solid_angle(ElementKind kind) {
  return kind != ElementKind::kPoint && kind != ElementKind::kSun;
}

// Rays to a source that is not even, at the least.
constexpr uint32_t kFewPlaces = 4;

// A source within this many of its radii is near.
constexpr float kNear = 2;
// A cluster whose normals lie within this cosine (45 degrees) of their mean has no faces turned away from
// each other.
constexpr float kTurned = 0.7071f;
// What a source's unevenness may amount to, as a share of the receiver's light.
constexpr float kUneven = 0.02f;

// What a point may see, by the luck of its rays, of one.
constexpr float kMostSeen = 1.05f;

// Light, and the form factors that it comes by.
struct Seen {
  vec3 light{0};       // lux
  float factor = 0;    // what is seen
  float variance = 0;  // of the light's luminance
};

// Adds up what comes to one point.
class PointGather {
 public:
  PointGather(const HierarchicalSolver& solver, const ShownLight& light, ElementId leaf, const vec3& x,
              const vec3& n, const GatherOptions& options, uint32_t seed, RayCount& rays)
      : solver_(solver),
        pool_(solver.pool()),
        light_(light),
        x_(x),
        n_(n),
        options_(options),
        seed_(seed),
        rays_(rays),
        // What the leaf has in all, against which single links are weighed; its own value may be nought in a
        // shadow.
        whole_(largest(solver.state().irradiance[leaf]) + 1e-20f) {}

  void add(const Link& link, ElementId receiver) {
    const vec3 b = source_radiosity(link, solver_.links().views(), light_.shown);
    const float most = largest(b);
    if (most <= 0 || is_below_horizon(pool_[link.source])) return;
    const float little = 0.1f * options_.ray_share * whole_, weak = (link.mean + link.spread) * most;
    // What is weak because it is hidden stays so; what is weak on the whole may be strong at one spot.
    if (!options_.bent && weak < little && is_weak_here(link, most, little))
      return add_modelled(link, pool_[receiver], b);
    add_source(link, link.source, b);
  }

  // Form factors of what is flat are nearly exact. Those of clusters that surround a point may add up to far
  // more than there is: they are cut back, and a lamp in plain view keeps its light.
  Gathered result() const {
    const float seen = sure_.factor + guessed_.factor;
    float kept = 1;
    if (seen > kMostSeen && guessed_.factor > 0)
      kept = std::max((kMostSeen - sure_.factor) / guessed_.factor, 0.0f);
    return {sure_.light + kept * guessed_.light, faced_ > 0 ? seen / faced_ : 1.0f,
            sure_.factor + kept * guessed_.factor, sure_.variance + kept * kept * guessed_.variance,
            nearest_leaf_};
  }

 private:
  bool is_weak_here(const Link& link, float most, float little) const {
    if (link.visibility > 0) return most_at(pool_, link.source, x_) * most < 10 * little;
    return options_.trust_hidden || link.unoccluded * most < little;
  }

  // What glows is never cut back for others' sake.
  Seen& group_of(const Element& source) {
    return !is_surface(source.kind) || source.flat || largest(source.exitance) > 0 ? sure_ : guessed_;
  }

  void see(ElementId source, const vec3& light, float factor) {
    const Element& s = pool_[source];
    Seen& seen = group_of(s);
    seen.light += light;
    if (has_solid_angle(s.kind)) seen.factor += factor;
  }

  static vec3 tint_of(const Link& link) { return link.tint.is_white() ? vec3(1) : link.tint.colour(); }

  void add_modelled(const Link& link, const Element& r, const vec3& b) {
    const float modelled = std::max(0.0f, r.flat ? link.ambient + dot(x_ - r.centre, link.transfer)
                                                 : std::max(0.0f, dot(n_, link.transfer)) + link.ambient);
    // As much as is counted as light is counted as seen: of the ledge beneath a parapet the link's mean has
    // what the wall sees, and the top, which sees the sky alone, would seem to see more than there is.
    see(link.source, modelled * b * tint_of(link), modelled);
    if (has_solid_angle(pool_[link.source].kind)) faced_ += link.unoccluded;
  }

  // Whether all of a surface lies behind the plane on which light is gathered: it is as high over its centre
  // as a disc of its radius and thickness is that stands as it does, a ledge beneath a parapet hardly at all.
  bool is_below_horizon(const Element& source) const {
    if (!is_surface(source.kind)) return false;
    const float height = dot(source.centre - x_, n_);
    if (height >= 0) return false;
    if (height < -source.radius) return true;
    const float size = length(source.summed_normal);
    if (source.kind == ElementKind::kVolume || !(size > 0)) return false;
    const float cosine = std::min(1.0f, std::abs(dot(source.summed_normal, n_)) / size);
    return height < -(source.radius * std::sqrt(1 - cosine * cosine) + source.thickness * cosine);
  }

  void add_source(const Link& link, ElementId source, const vec3& b) {
    const Element& s = pool_[source];
    const vec3 m = point_transfer(pool_, source, x_, n_);
    const float factor = dot(m, n_);
    if (factor <= 0) return;
    const float brings = factor * largest(b);
    if (is_near(s) && brings > kUneven * whole_ && light_.rise.empty()) {
      if (s.first_child == kNoElement) {
        if (brings > nearest_brings_) nearest_leaf_ = source;
        nearest_brings_ = std::max(nearest_brings_, brings);
      } else if ((light_.high[source] - light_.low[source]) * factor > kUneven * whole_) {
        for (uint32_t c = 0; c < 2; ++c) add_source(link, s.first_child + c, light_.shown[s.first_child + c]);
        return;
      }
    }
    const uint32_t count = solver_.visibility().adaptive
                               ? rays_for(brings / (whole_ + brings), link, s.kind, options_)
                           : has_solid_angle(s.kind) ? options_.light_rays
                                                     : 1;
    const bool uneven = is_surface(s.kind) && s.kind != ElementKind::kVolume &&
                        (s.first_child != kNoElement || !light_.rise.empty()) &&
                        (light_.high[source] - light_.low[source]) * factor > uneven_share() * whole_;
    // A source that outshines all that the leaf has is not what the leaf sees of it: from a dark room, of a
    // floor that goes on outside, the inner part.
    const bool unlike = (brings > whole_ || has_unlike_sides(s)) && is_unlike(s, source, factor);
    if (count > 0 && (uneven || unlike))
      return add_seen_places(link, source, factor, std::max(count, kFewPlaces));
    float visible = static_cast<float>(link.visibility) / 255.0f;
    vec3 tint = tint_of(link);
    if (sight_of(link) == Sight::kClear) {
      visible = 1;
    } else if (count > 0) {
      visible = solver_.visibility().fraction(pool_, source, x_, n_, count, seed_, rays_, visible, &tint);
    }
    if (sight_of(link) == Sight::kSampled) add_doubt(s, factor * luminance(b), visible, count);
    if (is_surface(s.kind)) visible = std::min(visible, 1 / factor);
    see(source, visible * factor * b * tint, visible * factor);
    if (has_solid_angle(s.kind)) faced_ += factor;
  }

  Sight sight_of(const Link& link) const { return options_.bent ? Sight::kSampled : link.sight; }

  // By what the rays meet: of a floor, what is seen from the ceiling is not what lies in the shade of the
  // desks.
  void add_seen_places(const Link& link, ElementId source, float factor, uint32_t count) {
    SeenShare share;
    vec3 sum(0);
    float squares = 0;
    for (uint32_t first = 0; first < count; first += SeenPoints::kMost) {
      SeenPoints places;
      const uint32_t batch = std::min(SeenPoints::kMost, count - first);
      const SeenShare part =
          solver_.visibility().look(pool_, source, x_, n_, batch, first == 0 ? seed_ : hash(seed_, first),
                                    rays_, &places, sight_of(link));
      const float weight = static_cast<float>(batch) / static_cast<float>(count);
      share.seen += weight * part.seen;
      share.hidden += weight * part.hidden;
      for (uint32_t k = 0; k < places.count; ++k) {
        const ElementId seen = pool_.deepest(source, places.points[k]);
        const vec3 b = places.tints[k] * light_.at(seen, places.points[k].position - pool_[seen].centre);
        sum += weight * places.weights[k] * b;
        squares += weight * weight * places.weights[k] * places.weights[k] * luminance(b) * luminance(b);
      }
    }
    const float all = share.seen + share.hidden;
    if (!(all > 0)) {  // all places happen to be turned away: of a wall's far side its mean would tell
      const ElementId child = pool_[source].first_child;
      if (child != kNoElement) {
        for (uint32_t c = 0; c < 2; ++c) add_source(link, child + c, light_.shown[child + c]);
      } else {  // a silhouette: as the link has it
        const float visible = static_cast<float>(link.visibility) / 255.0f;
        see(source, factor * visible * light_.shown[source] * tint_of(link), 0);
      }
      return;
    }
    const float scale = std::min(factor, 1.0f) / all;
    see(source, scale * sum, share.seen / all * factor);
    const float brings = luminance(sum) * scale;
    group_of(pool_[source]).variance +=
        std::max(0.0f, squares * scale * scale - brings * brings / static_cast<float>(count));
    faced_ += factor;
  }

  // Whether a source may have faces turned away from each other: of a window that is lit from within a point
  // outside sees the dark ones alone.
  static bool has_unlike_sides(const Element& s) {
    return s.kind == ElementKind::kCluster && s.cone_cosine < kTurned;
  }

  // Whether the leaves of a source differ so much that their mean says little of what is seen.
  bool is_unlike(const Element& s, ElementId source, float factor) const {
    if (!is_surface(s.kind) || s.kind == ElementKind::kVolume || s.first_child == kNoElement) return false;
    const RadiosityState& state = solver_.state();
    return (state.high[source] - state.low[source]) * factor > kUneven * whole_;
  }

  // Where it is known how light varies within leaves, reading it is dearer only by the rays.
  float uneven_share() const { return light_.rise.empty() ? kUneven : 0.1f * kUneven; }

  bool is_near(const Element& s) const {
    if (!is_surface(s.kind) || s.kind == ElementKind::kVolume) return false;
    const vec3 apart = s.centre - x_;
    return dot(apart, apart) < kNear * kNear * s.radius * s.radius;
  }

  // Of `count` rays, that next to the seen share might have been seen, or not (Laplace); without rays, what
  // is seen in part is known to about four.
  void add_doubt(const Element& source, float brings, float visible, uint32_t count) {
    if (count <= 1 && (visible <= 0 || visible >= 1)) return;  // lamps without size, and weak sources
    const float n = static_cast<float>(std::max(count, 4u));
    const float likely = (visible * n + 0.5f) / (n + 1);
    group_of(source).variance += brings * brings * likely * (1 - likely) / n;
  }

  const HierarchicalSolver& solver_;
  const ElementPool& pool_;
  const ShownLight& light_;
  const vec3 x_, n_;
  const GatherOptions& options_;
  const uint32_t seed_;
  RayCount& rays_;
  const float whole_;
  Seen sure_, guessed_;
  float faced_ = 0, nearest_brings_ = 0;
  ElementId nearest_leaf_ = kNoElement;
};

}  // namespace

float horizon_gain(float cosine, float seen) {
  const float all = kMostSeen / std::max(seen, 1e-3f);
  return all < 1 ? all : std::min(all, 2 / (1 + std::clamp(cosine, 0.0f, 1.0f)));
}

Gathered gather_at(const HierarchicalSolver& solver, const ShownLight& light, ElementId leaf, const vec3& x,
                   const vec3& n, const GatherOptions& options, uint32_t seed, RayCount& rays) {
  PointGather gather(solver, light, leaf, x, n, options, seed, rays);
  for (ElementId id = leaf; id != kNoElement; id = solver.pool()[id].parent)
    for (const Link& link : solver.links().into(id)) gather.add(link, id);
  return gather.result();
}

}  // namespace goldthread
