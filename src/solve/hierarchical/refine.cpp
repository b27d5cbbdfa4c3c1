#include "solve/hierarchical/refine.h"

#include <algorithm>
#include <atomic>
#include <numbers>

#include "base/parallel.h"
#include "solve/hierarchical/point_transfer.h"
#include "solve/hierarchical/push_pull.h"

namespace goldthread {
namespace {

enum class Decision : uint8_t { kKeep, kReceiver, kSource, kBoth };

bool is_light(ElementKind kind) {
  return kind == ElementKind::kPoint || kind == ElementKind::kSun;
}

// Share of what could pass between two touching elements that counts as error.
constexpr double kNearError = 0.02;

// Share of what a curved receiver could get that counts as error, times how far its normals disagree.
constexpr double kTurnError = 0.1;

// Standard error of a link's power, in bounds of its error, that is good enough: errors of thousands of links
// cancel.
constexpr double kNoise = 0.5;

// And of its irradiance, in the scene's mean: or small leaves that see a large wall in part would be
// blotched.
constexpr double kBlotch = 0.01;

// How much of an element's area cancels in its summed normal: 0 for a plane, 1 for a closed object.
double turned_share(const Element& e) {
  return e.area > 0 ? std::max(0.0, 1 - static_cast<double>(length(e.summed_normal) / e.area)) : 0;
}

// A form factor that the samples may have missed: what a source of this size could have at this distance, as
// far as the rays that were cast do not say that it is hidden.
double likely_factor(const ElementPool& pool, const Link& link) {
  const Element &r = pool[link.receiver], &s = pool[link.source];
  const vec3 apart = s.centre - r.centre;
  const double squared = static_cast<double>(dot(apart, apart));
  double most = 0;
  switch (s.kind) {
    case ElementKind::kSun:
      most = 1;
      break;
    case ElementKind::kPoint:
      // An area lamp brings no more than were it all that is seen: pi F / area, with F at most 1.
      most = 1 / std::max({squared, static_cast<double>(r.radius * r.radius),
                           static_cast<double>(pool.light(link.source).area() / kPi)});
      break;
    case ElementKind::kSky: {
      most = static_cast<double>(pool.sky_cell(link.source).solid_angle / kPi);
      break;
    }
    default:
      most = static_cast<double>(s.area) / (3.14159 * squared + static_cast<double>(s.area));
  }
  // The share of the rays that arrive, were one more to arrive of two more (Laplace).
  const double seen = (link.visibility / 255.0 * link.rays + 1) / (link.rays + 2.0);
  return std::max(static_cast<double>(link.unoccluded), most * seen);
}

// The most that a point of `e` can lie above the plane through `at` with unit normal `n`: exact for polygons,
// and for flat clusters that of a disc of their thickness.
float highest_above(const ElementPool& pool, ElementId id, const vec3& at, const vec3& n) {
  const Element& e = pool[id];
  if (e.kind == ElementKind::kTriangle || e.kind == ElementKind::kPatch) {
    float highest = std::numeric_limits<float>::lowest();
    const ElementPolygon polygon = pool.polygon(id);  // must outlive its span
    for (const vec3& corner : polygon.span()) highest = std::max(highest, dot(corner - at, n));
    return highest;
  }
  const vec3 axis = normalize_or(e.summed_normal, n);
  const float reach = e.thickness * std::abs(dot(axis, n)) + e.radius * length(cross(axis, n));
  return dot(e.centre - at, n) + std::min(reach, e.radius);
}

// Whether a lamp shines to one half of space only, and all of the receiver lies in the other.
bool shines_away(const ElementPool& pool, const Light& light, ElementId receiver) {
  const bool half =
      light.has_area() || (light.kind == LightKind::kSpot && !light.profile && light.outer_cone <= kPi / 2);
  return half && highest_above(pool, receiver, light.position, light.direction) <= -light.radius;
}

// What a lamp could bring at most on the average, per candela, to a receiver too large for its light to be
// told by a few samples: all that is within reach of it, and of its cone. 0 for smaller ones.
double most_of_lamp(const ElementPool& pool, const Link& link) {
  const Element& r = pool[link.receiver];
  if (pool[link.source].kind != ElementKind::kPoint || !(r.area > 0)) return 0;
  const Light& light = pool.light(link.source);
  const vec3 way = r.centre - light.position;
  const double distance = static_cast<double>(length(way)), radius = static_cast<double>(r.radius);
  if (r.flat && dot(way, normalize_or(r.summed_normal, vec3(0))) > light.reach() + light.radius) return 0;
  if (shines_away(pool, light, link.receiver)) return 0;
  if (light.range > 0 && distance - radius >= static_cast<double>(light.range)) return 0;
  const bool within = distance <= radius;
  // Of the receiver's ball; a plane fills no more than half of what is around.
  const double ball =
      within ? (r.flat ? 2 : 4) * std::numbers::pi
             : 2 * std::numbers::pi * (1 - std::sqrt(1 - radius * radius / (distance * distance)));
  bool is_coarse = distance < 2 * radius;
  if (light.kind == LightKind::kSpot && !light.profile) {
    const auto outer = static_cast<double>(light.outer_cone);
    if (!within) {
      const double cosine = static_cast<double>(dot(way, light.direction)) / distance;
      if (std::acos(std::clamp(cosine, -1.0, 1.0)) > outer + std::asin(radius / distance)) return 0;
    }
    is_coarse = is_coarse || distance * std::sin(outer) < radius;
  }
  return is_coarse
             ? std::min(ball, static_cast<double>(lamp_solid_angle(light))) / static_cast<double>(r.area)
             : 0;
}

bool divisible(const Element& e) {
  return e.first_child != kNoElement ||
         (!e.indivisible && !is_light(e.kind) && e.kind != ElementKind::kVolume);
}

// Receivers above the triangle may always be opened; below, cuts make new geometry and stop at the least
// area.
bool may_open_receiver(const Element& e, float least_area) {
  if (!divisible(e)) return false;
  if (e.kind == ElementKind::kVolume || e.first_child != kNoElement) return true;
  return e.area > 2 * least_area;
}

bool may_open_source(const Element& e, float least_area) {
  return e.kind == ElementKind::kSky ? divisible(e) : may_open_receiver(e, least_area);
}

// Whether a flat element's plane cuts another.
bool cuts(const ElementPool& pool, ElementId flat, ElementId other, float rounding) {
  const Element& e = pool[flat];
  const vec3 n = normalize_or(e.summed_normal, vec3(0));
  const float most = rounding + e.thickness;
  return e.flat && highest_above(pool, other, e.centre, n) > most &&
         highest_above(pool, other, e.centre, -n) > most;
}

Decision decide(const ElementPool& pool, const Feet& feet, const RadiosityState& state, const Link& link,
                const RefineOptions& options, float rounding) {
  const Element &r = pool[link.receiver], &s = pool[link.source];
  const bool self = link.receiver == link.source;
  LinkError error = estimate_error(pool, state, link);
  const double weight = static_cast<double>(options.regard.of(pool[link.receiver]));
  error.receiver *= weight;
  error.source *= weight;
  // There may be two rooms there, whatever the samples say.
  if (feet.part(link.receiver) && link.receiver != link.source && s.kind != ElementKind::kVolume &&
      link.sight != Sight::kClear && may_open_receiver(r, kLeastAtFoot * options.least_area))
    return Decision::kReceiver;
  // Of a floor that goes on behind a wall, the wall sees the part before it.
  if (feet.part(link.source) && link.receiver != link.source && r.kind != ElementKind::kVolume &&
      may_open_source(s, kLeastAtFoot * options.least_area) &&
      cuts(pool, link.receiver, link.source, rounding))
    return Decision::kSource;
  if (error.total() <= options.power_error) return Decision::kKeep;
  const bool receiver = may_open_receiver(r, options.least_area),
             source = may_open_source(s, options.least_area);
  if (self) return receiver ? Decision::kBoth : Decision::kKeep;
  if (!receiver && !source) return Decision::kKeep;
  // A box knows too little of what is in it: open the larger of two that are still boxes, and boxes before
  // the rest.
  const bool r_box = r.kind == ElementKind::kVolume, s_box = s.kind == ElementKind::kVolume;
  if (r_box != s_box) return r_box ? Decision::kReceiver : Decision::kSource;
  if (r_box) return r.radius >= s.radius ? Decision::kReceiver : Decision::kSource;
  if (error.receiver >= error.source)
    return receiver ? Decision::kReceiver
                    : (error.source > options.power_error ? Decision::kSource : Decision::kKeep);
  return source ? Decision::kSource
                : (error.receiver > options.power_error ? Decision::kReceiver : Decision::kKeep);
}

struct Child {
  ElementId receiver, source;
  Sight sight;
};

// How many samples a link deserves: one for every way in which its receiver's normals or a hard shadow may
// differ.
void sampling_effort(const ElementPool& pool, const Child& child, uint32_t& points, uint32_t& rays) {
  const Element &r = pool[child.receiver], &s = pool[child.source];
  points = r.kind <= ElementKind::kCluster || is_light(s.kind) ? 8 : 4;
  rays = is_light(s.kind) ? 1 : r.kind <= ElementKind::kCluster ? 2 : 4;
}

// Whether all of `to` lies on or below all of the flat element `from`: nothing passes between them.
// `rounding` metres above are as good as none.
bool faces_away(const ElementPool& pool, ElementId from, ElementId to, float rounding) {
  const Element& e = pool[from];
  if (!e.flat) return false;
  const vec3 n = normalize_or(e.summed_normal, vec3(0));
  return highest_above(pool, to, e.centre, n) <= rounding - e.thickness;
}

bool hopeless(const ElementPool& pool, const Child& child, float rounding) {
  const Element &r = pool[child.receiver], &s = pool[child.source];
  if (child.receiver == child.source) return r.flat && r.thickness <= rounding;
  if (!is_surface(s.kind)) return false;
  return faces_away(pool, child.receiver, child.source, rounding) ||
         faces_away(pool, child.source, child.receiver, rounding);
}

void list_children(const ElementPool& pool, const Link& link, Decision decision, std::vector<Child>& out) {
  const Element &r = pool[link.receiver], &s = pool[link.source];
  const Sight sight = link.sight;  // what is clear as a whole is so in its parts
  if (decision == Decision::kBoth) {
    for (uint32_t i = 0; i < 4; ++i)
      out.push_back({r.first_child + (i & 1), r.first_child + (i >> 1), sight});
  } else if (decision == Decision::kReceiver) {
    for (uint32_t i = 0; i < 2; ++i) out.push_back({r.first_child + i, link.source, sight});
  } else if (decision == Decision::kSource) {
    for (uint32_t i = 0; i < 2; ++i) out.push_back({link.receiver, s.first_child + i, sight});
  }
}

// Opens every element that a decision needs opened. One that turns out indivisible stays childless: its link
// comes up again in the next wave with the other side.
void open_elements(ElementPool& pool, const Visibility& visibility, Feet& feet,
                   const std::vector<Link>& links, std::span<const uint64_t> active,
                   std::span<const Decision> decisions, RadiosityState& state, RayCount& rays) {
  std::vector<ElementId> wanted;
  for (size_t i = 0; i < active.size(); ++i) {
    const Link& link = links[active[i]];
    if (decisions[i] == Decision::kReceiver || decisions[i] == Decision::kBoth)
      wanted.push_back(link.receiver);
    if (decisions[i] == Decision::kSource) wanted.push_back(link.source);
  }
  std::erase_if(wanted, [&](ElementId id) { return pool[id].first_child != kNoElement; });
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  if (wanted.empty()) return;
  const LampLinks lamps(pool, state, links);
  pool.expand(wanted, find_discontinuities(pool, visibility, wanted, feet, lamps, rays));
  feet.grow_to(pool, visibility);
  state.grow_to(pool);
}

// Whether what is seen of a link's source may well be brighter or darker than its mean.
bool is_uneven(const ElementPool& pool, const RadiosityState& state, const Link& link) {
  const Element& s = pool[link.source];
  if (s.first_child == kNoElement || s.kind == ElementKind::kVolume || !is_surface(s.kind)) return false;
  return state.high[link.source] - state.low[link.source] > 0.02f * state.high[link.source];
}

}  // namespace

LinkError estimate_error(const ElementPool& pool, const RadiosityState& state, const Link& link) {
  const Element &r = pool[link.receiver], &s = pool[link.source];
  const auto b = static_cast<double>(largest(state.shown[link.source]));
  const auto area = static_cast<double>(r.area);
  LinkError error;
  if (b <= 0) return error;
  const auto unoccluded = static_cast<double>(link.unoccluded);
  if (r.kind == ElementKind::kVolume || s.kind == ElementKind::kVolume || link.receiver == link.source) {
    // Boxes are guesses: all that they could bring counts as error; so does what a cluster sends to itself.
    const double guess =
        s.kind == ElementKind::kVolume && link.receiver != link.source
            ? std::max(unoccluded,
                       static_cast<double>(s.area) * 0.25 /
                           (3.14 * std::max(1e-30, static_cast<double>(
                                                       dot(s.centre - r.centre, s.centre - r.centre)))))
            : std::max(unoccluded, 0.25);
    error.receiver = b * std::min(guess, is_light(s.kind) ? 1e30 : 1.0) * area;
    return error;
  }
  // Where two elements nearly touch, most of what passes between them passes where they do, and samples
  // elsewhere see neither it nor each other's doubts: a link kept because its samples happened to be small
  // would lose light.
  const float reach = r.radius + s.radius;
  const vec3 apart = s.centre - r.centre;
  const double squared = static_cast<double>(dot(apart, apart));
  if (is_surface(s.kind) && squared < static_cast<double>(reach * reach)) {
    error.receiver += kNearError * b * static_cast<double>(std::min(r.area, s.area));
  } else if (is_surface(s.kind) && unoccluded <= 0) {
    // No sample of the one faced the other, yet nothing says that they are turned away.
    error.receiver += kNearError * b * area * static_cast<double>(s.area) / (3.14159 * squared);
  }
  // A receiver that turns many ways: few samples may all look away, and such links would be kept just because
  // of that.
  if (!r.flat) error.receiver += kTurnError * b * area * turned_share(r) * likely_factor(pool, link);
  const double v = link.visibility / 255.0;
  // With n rays all alike, the chance that the next differs is about 1/(n + 2) (Laplace).
  const double missed = std::max(unoccluded, most_of_lamp(pool, link)) * (0.5 / (link.rays + 2.0));
  error.receiver += b * area * (static_cast<double>(link.spread) + missed);
  const double range = static_cast<double>(state.high[link.source] - state.low[link.source]);
  error.source = 0.25 * range * static_cast<double>(link.mean) * area;
  if (link.visibility > 0 && link.visibility < 255 && (s.radius > r.radius || s.kind == ElementKind::kSky))
    error.source += b * area * unoccluded * v * (1 - v) * 0.25;
  return error;
}

RefineCounters refine(ElementPool& pool, const Visibility& visibility, LinkPool& links, Feet& feet,
                      RadiosityState& state, const RefineOptions& options, const CancelToken& cancel,
                      RayCount& total_rays, const std::function<void()>& between_waves) {
  RefineCounters counters;
  std::vector<Link>& all = links.all();
  std::vector<uint64_t> active(all.size());
  for (size_t i = 0; i < active.size(); ++i) active[i] = i;
  std::vector<Decision> decisions;
  std::vector<Child> children;
  while (!active.empty() && !cancel.cancelled()) {
    decisions.assign(active.size(), Decision::kKeep);
    parallel_for(
        active.size(),
        [&](size_t i) {
          decisions[i] = decide(pool, feet, state, all[active[i]], options, visibility.epsilon);
        },
        256);
    open_elements(pool, visibility, feet, all, active, decisions, state, total_rays);
    std::vector<uint64_t> next;
    children.clear();
    for (size_t i = 0; i < active.size(); ++i) {
      if (decisions[i] == Decision::kKeep) continue;
      Link& link = all[active[i]];
      const ElementId opened = decisions[i] == Decision::kSource ? link.source : link.receiver;
      if (pool[opened].first_child == kNoElement) {
        next.push_back(active[i]);
        continue;
      }
      link.alive = false;
      ++counters.links_refined;
      list_children(pool, link, decisions[i], children);
    }
    std::erase_if(children, [&](const Child& c) { return hopeless(pool, c, visibility.epsilon); });
    if (options.most_links > 0 && all.size() + children.size() > options.most_links) counters.limited = true;
    std::atomic<uint64_t> rays{0}, nanoseconds{0};
    const size_t first = all.size();
    all.resize(first + children.size());
    parallel_for(
        children.size(),
        [&](size_t i) {
          uint32_t points = 0, per_point = 0;
          sampling_effort(pool, children[i], points, per_point);
          RayCount cast;
          if (children[i].receiver == children[i].source &&
              pool[children[i].receiver].kind == ElementKind::kVolume) {
            all[first + i].receiver = all[first + i].source =
                children[i].receiver;  // always opened: no samples needed
          } else {
            all[first + i] = make_link(pool, visibility, children[i].receiver, children[i].source, points,
                                       per_point, cast, children[i].sight);
          }
          rays.fetch_add(cast.rays, std::memory_order_relaxed);
          nanoseconds.fetch_add(cast.nanoseconds, std::memory_order_relaxed);
        },
        16);
    for (size_t i = 0; i < children.size(); ++i) next.push_back(first + i);
    total_rays += {rays.load(), nanoseconds.load()};
    if (between_waves) between_waves();
    if (counters.limited) break;
    active = std::move(next);
  }
  links.sort(pool.size());
  return counters;
}

void measure_all(const ElementPool& pool, const Visibility& visibility, LinkPool& links,
                 const RadiosityState& state, const RefineOptions& options, const CancelToken& cancel,
                 RayCount& total_rays) {
  std::vector<Link>& all = links.all();
  uint32_t views = 0;
  for (Link& link : all) link.view = is_uneven(pool, state, link) ? views++ : kNoView;
  links.views().resize(views);
  const double mean = static_cast<double>(largest(regarded_power(pool, state, options.regard))) /
                      std::max(regarded_area(pool, options.regard), 1e-300);
  std::atomic<uint64_t> rays{0}, nanoseconds{0};
  parallel_for(
      all.size(),
      [&](size_t i) {
        if (cancel.cancelled()) {
          all[i].view = kNoView;
          return;
        }
        RayCount cast;
        Link& link = all[i];
        const auto b = static_cast<double>(largest(state.shown[link.source]));
        const double area = static_cast<double>(pool[link.receiver].area);
        const double weight = static_cast<double>(options.regard.of(pool[link.receiver]));
        const auto tolerance = static_cast<float>(
            std::min(kNoise * options.power_error / std::max(area * weight, 1e-300), kBlotch * mean) /
            std::max(b, 1e-300));
        measure_link(pool, visibility, link, tolerance,
                     link.view != kNoView ? &links.views()[link.view] : nullptr, cast);
        rays.fetch_add(cast.rays, std::memory_order_relaxed);
        nanoseconds.fetch_add(cast.nanoseconds, std::memory_order_relaxed);
      },
      64);
  total_rays += {rays.load(), nanoseconds.load()};
}

}  // namespace goldthread
