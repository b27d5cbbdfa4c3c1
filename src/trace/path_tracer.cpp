#include "trace/path_tracer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <type_traits>
#include <vector>

#include "base/check.h"
#include "base/wide.h"
#include "trace/directions.h"

namespace goldthread {
namespace {

// Russian roulette starts where paths have mostly said what they have to say. It never lets all of them live,
// and never so few that whether a receiver meets a survivor at all is chance: in a dark room the light of
// many bounces would then be missing from most sequences, and from their spread with it.
constexpr int kSureBounces = 3;
constexpr float kLeastSurvival = 0.25f, kMostSurvival = 0.95f;

constexpr size_t kBundle = PathTracer::kBundle;

float largest(const vec3& v) {
  return std::max({v.x, v.y, v.z});
}

using Clock = std::chrono::steady_clock;

int64_t nanoseconds_since(Clock::time_point begin) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begin).count();
}

/// Up to N of something, in place, none of them made before it is there.
template <typename T, size_t N>
class Few {
 public:
  void clear() { size_ = 0; }
  void push_back(const T& item) { storage_.items[size_++] = item; }
  void resize(size_t size) { size_ = size; }
  size_t size() const { return size_; }
  T& operator[](size_t i) { return storage_.items[i]; }
  const T& operator[](size_t i) const { return storage_.items[i]; }
  std::span<T> all() { return {storage_.items.data(), size_}; }

 private:
  static_assert(std::is_trivially_copyable_v<T>);
  union Storage {
    Storage() {}
    std::array<T, N> items;
  } storage_;
  size_t size_ = 0;
};

/// Where a path has got to.
struct Path {
  vec3 point{0};   ///< on a surface
  vec3 origin{0};  ///< a little above, where its rays start
  vec3 normal{0};  ///< unit
  vec3 throughput{1};
  uint32_t slot = 0;  ///< whose sum its light goes to
  vec3 surface{0};    ///< PathStart::surface, and 0 after the first bounce
};

/// Light that is there unless something is in between.
struct Promise {
  vec3 lux{0};
  uint32_t slot = 0;
};

/// Ways that paths go, by coordinate. Where they end is known of those only that end on a live side.
struct Flights {
  Vec3Lanes origins, directions;
  FloatLanes distances{};  ///< in lengths of the directions
  Vec3Lanes normals{};     ///< where they end: Meeting::normal
};

/// Some paths on the same bounce.
class Bundle {
 public:
  Bundle(const TracedScene& scene, const LightSampler& lights, PathCost& count)
      : scene_(scene), lights_(lights), count_(count), lamp_sums_(lights.lamp_count()) {}

  /// Adds what each start receives to `sums`. At most kBundle starts.
  void trace(std::span<const PathStart> starts, std::span<vec3> sums);

 private:
  void draw(uint32_t& pair, Few<SobolPoint, kBundle>& points) {
    points.resize(paths_.size());
    path_points(seeds_.all(), ++pair, points.all());
  }
  void ask_emitters(uint32_t& pair);
  void ask_sky(uint32_t& pair);
  void ask_lamps(uint32_t& pair);
  void look_around();
  void ask();
  void cast();
  void collect(std::span<vec3> sums);
  void send_on(uint32_t& pair);
  void meet();
  void look_up();
  void bounce(bool sure, std::span<vec3> sums);
  bool arrive(size_t i, double side, Path& path, vec3& sum) const;
  void choose_side(const vec3& normal, const Diffuse& diffuse, double side, Path& path) const;
  vec3 emission_found(const Path& path, const Ray& ray, const Meeting& met) const;

  const TracedScene& scene_;
  const LightSampler& lights_;
  PathCost& count_;
  Few<Path, kBundle> paths_;
  Places places_;                 ///< of paths_
  Few<PathSeed, kBundle> seeds_;  ///< of paths_
  Few<SobolPoint, kBundle> choices_, points_, sides_;
  Few<Ray, kBundle> rays_;
  Few<Hit, kBundle> hits_;
  Few<Meeting, kBundle> meetings_;
  Few<Diffuse, kBundle> diffuse_;             ///< where meetings_ are live
  Few<uint32_t, kBundle> painted_;            ///< those of meetings_ that are live and not even
  Few<TextureLookup, kBundle> base_colours_;  ///< of painted_
  Few<Ray, 3 * kBundle> shadows_;
  Few<Promise, 3 * kBundle> promises_;  ///< of shadows_
  Few<vec3, 3 * kBundle> passed_;       ///< of shadows_
  LightSamples samples_;
  Flights flights_;
  FloatLanes density_ratios_;
  std::vector<FloatLanes> lamp_sums_;
};

// E = integral of L cos = E[pi L] over cosine-distributed directions, and the L that comes back from a
// diffuse surface is rho E / pi: so a path's throughput, relative to irradiance, is the product of
// reflectances.
void Bundle::trace(std::span<const PathStart> starts, std::span<vec3> sums) {
  paths_.clear();
  seeds_.clear();
  for (const PathStart& start : starts) {
    const vec3 point =
        start.origin - scene_.epsilon() * (start.surface == vec3(0) ? start.normal : start.surface);
    const auto slot = static_cast<uint32_t>(paths_.size());
    paths_.push_back({point, start.origin, start.normal, vec3(1), slot, start.surface});
    seeds_.push_back(start.seed);
  }
  uint32_t pair = kLensPair;
  for (int number = 1; paths_.size() > 0; ++number) {
    const bool sure = number < kSureBounces;
    if (!sure || lights_.has_lamps()) draw(pair, choices_);
    shadows_.clear();
    promises_.clear();
    look_around();
    if (lights_.has_emitters()) ask_emitters(pair);
    if (lights_.has_sky()) ask_sky(pair);
    if (lights_.has_lamps()) ask_lamps(pair);
    send_on(pair);
    cast();
    collect(sums);
    if (scene_.has_translucent()) draw(pair, sides_);
    bounce(sure, sums);
  }
}

void Bundle::look_around() {
  places_.count = paths_.size();
  for (size_t i = 0; i < paths_.size(); ++i) {
    places_.points.set(i, paths_[i].point);
    places_.normals.set(i, paths_[i].normal);
  }
}

void Bundle::ask_emitters(uint32_t& pair) {
  draw(pair, points_);
  lights_.sample_emitters(places_, points_.all(), samples_);
  ask();
}

void Bundle::ask_sky(uint32_t& pair) {
  draw(pair, points_);
  lights_.sample_sky(places_, points_.all(), samples_);
  ask();
}

void Bundle::ask_lamps(uint32_t& pair) {
  points_.clear();
  if (lights_.has_lamps_with_size()) draw(pair, points_);
  lights_.sample_lamps(places_, choices_.all(), points_.all(), lamp_sums_, samples_);
  ask();
}

/// Weighs light samples, of strategies that have a density, against what bounces find.
GOLDTHREAD_WIDE_CLONES void weigh(const LightSamples& lights, size_t count, FloatLanes& __restrict weights) {
  for (size_t i = 0; i < count; ++i) {
    const float weight = power_heuristic(lights.density[i], lights.cosine[i] / kPi);
    weights[i] = lights.density[i] > 0 ? weight : 1.0f;
  }
}

/// Has the ray caster asked, with the others, for the light of samples_.
void Bundle::ask() {
  FloatLanes weights;
  weigh(samples_, paths_.size(), weights);
  for (size_t i = 0; i < paths_.size(); ++i) {
    const Path& path = paths_[i];
    const vec3& light = samples_.irradiance[i];
    if (!(largest(light) > 0)) continue;
    // What it brings is that of the point; the ray that asks starts above it and ends where it would.
    Ray shadow;
    shadow.origin = path.origin;
    shadow.direction = samples_.ways[i];
    shadow.far = samples_.far[i];
    if (std::isfinite(shadow.far)) shadow.direction += path.point - path.origin;
    if (dot(path.surface, shadow.direction) < 0) continue;
    shadows_.push_back(shadow);
    promises_.push_back({path.throughput * light * weights[i], path.slot});
  }
}

void Bundle::send_on(uint32_t& pair) {
  draw(pair, points_);
  cosine_directions(places_.normals, points_.all(), flights_.directions);
  rays_.resize(paths_.size());
  for (size_t i = 0; i < paths_.size(); ++i) {
    rays_[i] = Ray();
    rays_[i].origin = paths_[i].origin;
    rays_[i].direction = flights_.directions[i];
    flights_.origins.set(i, paths_[i].origin);
  }
}

/// All rays of this bounce: looks at the clock cost time, too.
void Bundle::cast() {
  passed_.resize(shadows_.size());
  hits_.resize(rays_.size());
  const auto begin = Clock::now();
  scene_.caster().transmittance(shadows_.all(), passed_.all());
  scene_.caster().closest(rays_.all(), hits_.all());
  count_.ray_nanoseconds += nanoseconds_since(begin);
  count_.rays += shadows_.size() + rays_.size();
}

void Bundle::collect(std::span<vec3> sums) {
  for (size_t i = 0; i < promises_.size(); ++i) sums[promises_[i].slot] += promises_[i].lux * passed_[i];
}

// A ray that starts a little above its point meets y with another density than one from the point itself
// would: cos cos' / r² of the one over that of the other makes up for it. Without, light from close by would
// be off by the lift over the distance, twice. Nought where the point does not see y.
GOLDTHREAD_WIDE_CLONES void density_ratios(const Places& from, const Flights& flights, float epsilon,
                                           FloatLanes& __restrict ratios) {
  const Vec3Lanes &points = from.points, &normals = from.normals, &origins = flights.origins,
                  &ways = flights.directions, &there = flights.normals;
  for (size_t i = 0; i < from.count; ++i) {
    const vec3 way(ways.x[i], ways.y[i], ways.z[i]), point(points.x[i], points.y[i], points.z[i]);
    const vec3 origin(origins.x[i], origins.y[i], origins.z[i]);
    const vec3 n(normals.x[i], normals.y[i], normals.z[i]), n_there(there.x[i], there.y[i], there.z[i]);
    const float distance = flights.distances[i];
    const vec3 d = origin + distance * way - point;
    const float squared = dot(d, d), lifted_squared = distance * distance, cosine = dot(n, d);
    const float cosines = cosine * -dot(n_there, d);
    const float lifted_cosines = dot(n, way) * -dot(n_there, way);
    const float ratio = cosines * lifted_squared / (lifted_cosines * squared * squared);
    const bool seen = cosine > 0 && cosines > 0 && lifted_cosines > 0;
    // In a corner, a few lifts from the walls, the ratio is anything; and there all looks the same from a
    // little further off, so that nothing has to be made up for.
    ratios[i] = distance < 32 * epsilon ? 1.0f : seen ? ratio : 0.0f;
  }
}

/// Says where rays have ended. What is read of each, here and in `look_up`, is asked for while others are
/// worked on.
void Bundle::meet() {
  for (const Hit& hit : hits_.all()) scene_.prefetch(hit);
  meetings_.resize(paths_.size());
  diffuse_.resize(paths_.size());
  painted_.resize(paths_.size());
  size_t painted = 0;
  for (size_t i = 0; i < paths_.size(); ++i) {
    const Meeting& met = meetings_[i];
    scene_.meet(rays_[i], hits_[i], meetings_[i]);
    if (!met.live) continue;
    scene_.prefetch_texcoords(met);
    flights_.distances[i] = met.distance;
    flights_.normals.set(i, met.normal);
    diffuse_[i] = met.part->diffuse;
    // No branch: whether the next surface is painted nobody can foresee.
    painted_[painted] = static_cast<uint32_t>(i);
    painted += met.part->even ? 0 : 1;
  }
  painted_.resize(painted);
}

/// Reflectance of what is not even.
void Bundle::look_up() {
  base_colours_.resize(painted_.size());
  for (size_t k = 0; k < painted_.size(); ++k) base_colours_[k] = scene_.begin_lookup(meetings_[painted_[k]]);
  for (size_t k = 0; k < painted_.size(); ++k)
    diffuse_[painted_[k]] = scene_.diffuse(meetings_[painted_[k]], base_colours_[k]);
}

/// Adds what was met to the sums, and keeps those paths that go on.
void Bundle::bounce(bool sure, std::span<vec3> sums) {
  meet();
  look_up();
  density_ratios(places_, flights_, scene_.epsilon(), density_ratios_);
  size_t kept = 0;
  for (size_t i = 0; i < paths_.size(); ++i) {
    Path path = paths_[i];
    if (dot(path.surface, rays_[i].direction) < 0) continue;
    path.surface = vec3(0);
    const double side = scene_.has_translucent() ? unit_double(sides_[i].u) : 0;
    if (!arrive(i, side, path, sums[path.slot])) continue;
    if (!sure) {
      const float survival = std::clamp(largest(path.throughput), kLeastSurvival, kMostSurvival);
      if (unit_double(choices_[i].v) >= static_cast<double>(survival)) continue;
      path.throughput /= survival;
    }
    paths_[kept] = path;
    seeds_[kept] = seeds_[i];
    ++kept;
  }
  paths_.resize(kept);
  seeds_.resize(kept);
}

/// The other half of direct light: what bounces find by themselves, weighed against sample_emitters.
vec3 Bundle::emission_found(const Path& path, const Ray& ray, const Meeting& met) const {
  const vec3 nits = scene_.emission(met);
  if (!(largest(nits) > 0)) return vec3(0);
  const vec3 d = ray.origin + met.distance * ray.direction - path.point;
  const float distance = length(d);
  const float cosine = dot(path.normal, d) / distance, cosine_there = -dot(met.normal, d) / distance;
  const float density = lights_.emitter_density(met.triangle, distance, cosine_there);
  return kPi * power_heuristic(cosine / kPi, density) * nits;
}

/// Diffuse light goes on to either side of what is translucent: to which, `side` (0..1) says. `normal` is
/// that of the side where it came from.
void Bundle::choose_side(const vec3& normal, const Diffuse& diffuse, double side, Path& path) const {
  path.normal = normal;
  if (diffuse.through == vec3(0)) {
    path.throughput *= diffuse.back;
    return;
  }
  const float likely = largest(diffuse.through) / (largest(diffuse.back) + largest(diffuse.through));
  if (side < static_cast<double>(likely)) {
    path.throughput *= diffuse.through / likely;
    path.normal = -normal;
  } else {
    path.throughput *= diffuse.back / (1 - likely);
  }
}

/// Moves the path to where its ray, of number `i`, has ended; false when it ends there, too.
bool Bundle::arrive(size_t i, double side, Path& path, vec3& sum) const {
  const Ray& ray = rays_[i];
  const Meeting& met = meetings_[i];
  path.throughput *= met.tint;
  if (met.missed()) {
    const float cosine = std::max(0.0f, dot(path.normal, ray.direction));
    if (lights_.has_sky())
      sum += path.throughput *
             (kPi * power_heuristic(cosine / kPi, lights_.sky_density(ray.direction, cosine))) *
             scene_.scene().sky.radiance_towards(ray.direction);
    return false;
  }
  if (!met.live) return false;
  if (!(density_ratios_[i] > 0)) return false;
  path.throughput *= density_ratios_[i];
  if (met.part->shines) sum += path.throughput * emission_found(path, ray, met);
  path.point = ray.origin + met.distance * ray.direction;
  choose_side(met.normal, diffuse_[i], side, path);
  path.origin = path.point + scene_.epsilon() * path.normal;
  return largest(path.throughput) > 0;
}

}  // namespace

double PathCost::ray_share() const {
  if (path_nanoseconds <= 0) return 0;
  return std::clamp(static_cast<double>(ray_nanoseconds) / static_cast<double>(path_nanoseconds), 0.0, 1.0);
}

void PathTracer::irradiance(std::span<const PathStart> starts, std::span<vec3> lux, PathCost& count) const {
  GOLDTHREAD_CHECK_EQ(starts.size(), lux.size());
  const auto begin = Clock::now();
  std::fill(lux.begin(), lux.end(), vec3(0));
  Bundle bundle(scene_, lights_, count);
  for (size_t first = 0; first < starts.size(); first += kBundle) {
    const size_t size = std::min(kBundle, starts.size() - first);
    bundle.trace(starts.subspan(first, size), lux.subspan(first, size));
  }
  count.path_nanoseconds += nanoseconds_since(begin);
}

void PathTracer::radiance(std::span<const CameraPath> seen, std::span<vec3> nits, PathCost& count) const {
  GOLDTHREAD_CHECK_EQ(seen.size(), nits.size());
  const auto begin = Clock::now();
  std::vector<Ray> rays;
  std::vector<Hit> hits(seen.size());
  for (const CameraPath& path : seen) rays.push_back(path.ray);
  const auto cast = Clock::now();
  scene_.caster().closest(rays, hits);
  count.ray_nanoseconds += nanoseconds_since(cast);
  count.rays += rays.size();
  std::vector<PathStart> starts;
  std::vector<vec3> reflectance, tints(seen.size(), vec3(1));
  std::vector<size_t> pixels;
  for (size_t i = 0; i < seen.size(); ++i) {
    Ray ray = rays[i];
    Meeting met;
    scene_.meet(ray, hits[i], met);
    tints[i] = met.tint;
    while (!met.missed() && !met.live && !scene_.material(met.triangle).unlit) {
      ray.near = met.distance + 2 * scene_.epsilon();
      met = scene_.closest(ray);
      tints[i] *= met.tint;
      ++count.rays;
    }
    if (met.missed()) {
      nits[i] = scene_.scene().sky.radiance_towards(ray.direction);
    } else if (scene_.material(met.triangle).unlit) {
      nits[i] = scene_.unlit_colour(met.triangle, met.weights);
    } else {
      nits[i] = scene_.emission(met);
      const vec3 point = ray.origin + met.distance * ray.direction;
      const auto start = [&](const vec3& normal, const vec3& share) {
        if (!(largest(share) > 0)) return;
        starts.push_back({point + scene_.epsilon() * normal, normal, seen[i].seed});
        reflectance.push_back(share / kPi);
        pixels.push_back(i);
      };
      const Diffuse diffuse = scene_.diffuse(met.triangle, met.weights);
      start(met.normal, diffuse.back);
      start(-met.normal, diffuse.through);
    }
  }
  count.path_nanoseconds += nanoseconds_since(begin);
  std::vector<vec3> lux(starts.size());
  irradiance(starts, lux, count);
  for (size_t k = 0; k < pixels.size(); ++k) nits[pixels[k]] += reflectance[k] * lux[k];
  for (size_t i = 0; i < seen.size(); ++i) nits[i] *= tints[i];
}

}  // namespace goldthread
