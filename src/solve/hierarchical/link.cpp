#include "solve/hierarchical/link.h"

#include <algorithm>

#include "base/rng.h"
#include "solve/hierarchical/point_transfer.h"
#include "solve/hierarchical/sight.h"

namespace goldthread {
namespace {

// Splits a link's light into a part that follows the normal and one that does not, by least squares over the
// samples, keeping the sampled mean; and measures what remains unexplained.
void fit_model(Link& link, std::span<const float> received, std::span<const vec3> normals) {
  const auto count = static_cast<float>(received.size());
  float predicted_mean = 0;
  for (const vec3& n : normals) predicted_mean += std::max(0.0f, dot(n, link.transfer)) / count;
  if (predicted_mean > 0) {
    const float scale = link.mean / predicted_mean;
    float covariance = 0, variance = 0;
    for (size_t i = 0; i < received.size(); ++i) {
      const float predicted = scale * std::max(0.0f, dot(normals[i], link.transfer)) - link.mean;
      covariance += predicted * (received[i] - link.mean);
      variance += predicted * predicted;
    }
    // One normal, or none to tell apart: all is vector.
    const float follows = variance > 1e-6f * link.mean * link.mean * count
                              ? std::clamp(covariance / variance, 0.0f, 1.0f)
                              : 1.0f;
    link.transfer *= follows * scale;
    link.ambient = (1 - follows) * link.mean;
  } else {
    link.transfer = vec3(0);
    link.ambient = link.mean;
  }
  for (size_t i = 0; i < received.size(); ++i)
    link.spread = std::max(
        link.spread, std::abs(received[i] - link.ambient - std::max(0.0f, dot(normals[i], link.transfer))));
}

// What one receiver point gets of a link's source.
struct PointSample {
  vec3 transfer{0};  // visibility included
  float received = 0;
  float unoccluded = 0;
  vec3 by_channel{0};  // received, in the colour of what is in between
  uint32_t rays = 0;
};

// The colour of light that sums up to `by_channel`, and to `all` by each ray's best channel; white where
// there is none to tell it by.
Tint tint_of(const Visibility& visibility, const vec3& by_channel, float all) {
  return all > 0 && visibility.caster->is_coloured() ? Tint(by_channel / all) : Tint();
}

// No rays: all is seen.
PointSample sample_point(const ElementPool& pool, const Visibility& visibility, ElementId source,
                         const SurfacePoint& x, uint32_t rays, uint32_t seed, RayCount& count) {
  PointSample out;
  out.transfer = point_transfer(pool, source, x.position, x.normal);
  out.unoccluded = dot(out.transfer, x.normal);
  if (out.unoccluded <= 0) return {};
  const uint64_t before = count.rays;
  vec3 tint(1);
  const float v =
      rays == 0 ? 1.0f : visibility.fraction(pool, source, x.position, x.normal, rays, seed, count, 0, &tint);
  out.rays = static_cast<uint32_t>(count.rays - before);
  out.received = out.unoccluded * v;
  if (is_surface(pool[source].kind)) out.received = std::min(1.0f, out.received);
  out.transfer *= out.received / out.unoccluded;
  out.by_channel = out.received * tint;
  return out;
}

void finish(Link& link, float received, float unoccluded, uint32_t rays) {
  const float seen = unoccluded > 0 ? std::clamp(received / unoccluded, 0.0f, 1.0f) : 1.0f;
  link.visibility = static_cast<uint8_t>(std::lround(255 * seen));
  link.rays = static_cast<uint8_t>(std::min(rays, 255u));
}

// A gradient may take the light from nothing at one end to twice the mean at the other, and no further:
// fitted to samples that happen to lie close together it could be anything.
void limit_gradient(Link& link, float radius) {
  const float rise = length(link.transfer) * radius;
  if (rise > link.ambient) link.transfer *= link.ambient / std::max(rise, 1e-30f);
}

// A triangle or patch: mean and gradient from the quadrature's inner ring, doubt from what these leave and
// from the centre, which alone tells a bend.
void link_polygon(const ElementPool& pool, const Visibility& visibility, Link& link, uint32_t points,
                  uint32_t rays_per_point, RayCount& count) {
  std::array<SurfacePoint, 9> at;
  pool.quadrature(link.receiver, {at.data(), points});
  at[points] = {pool[link.receiver].centre, at[0].normal};
  std::array<PointSample, 9> sample;
  uint32_t rays = 0;
  vec3 by_channel(0);
  for (uint32_t i = 0; i <= points; ++i) {
    sample[i] =
        sample_point(pool, visibility, link.source, at[i], rays_per_point, link.receiver * 16 + i, count);
    rays += sample[i].rays;
    if (i == points) break;
    by_channel += sample[i].by_channel / static_cast<float>(points);
    link.mean += sample[i].received / static_cast<float>(points);
    link.unoccluded += sample[i].unoccluded / static_cast<float>(points);
  }
  finish(link, link.mean, link.unoccluded, rays);
  link.tint = tint_of(visibility, by_channel, link.mean);
  // The ring's corners lie at -+ along two orthogonal axes.
  const vec3 a1 = 0.5f * (at[1].position - at[0].position), a2 = 0.5f * (at[2].position - at[0].position);
  const float g1 = (sample[1].received + sample[3].received - sample[0].received - sample[2].received) / 4;
  const float g2 = (sample[2].received + sample[3].received - sample[0].received - sample[1].received) / 4;
  link.ambient = link.mean;
  link.transfer = a1 * (g1 / std::max(dot(a1, a1), 1e-30f)) + a2 * (g2 / std::max(dot(a2, a2), 1e-30f));
  limit_gradient(link, pool[link.receiver].radius);
  for (uint32_t i = 0; i <= points; ++i) {
    const float said = link.mean + dot(at[i].position - pool[link.receiver].centre, link.transfer);
    link.spread = std::max(link.spread, std::abs(sample[i].received - said));
  }
  // A tenth of what is linear: no light is wholly so.
  link.spread += 0.1f * (std::abs(g1) + std::abs(g2));
}

// A plane through samples over a flat receiver, by least squares.
class PlaneFit {
 public:
  explicit PlaneFit(const Element& receiver) : centre_(receiver.centre) {
    const vec3 n = normalize_or(receiver.summed_normal, vec3(0, 1, 0));
    u_ = normalize(std::abs(n.x) > 0.6f ? vec3(n.y, -n.x, 0) : vec3(0, n.z, -n.y));
    v_ = cross(n, u_);
  }

  void add(const vec3& place, float value) {
    const vec2 p(dot(place - centre_, u_), dot(place - centre_, v_));
    count_ += 1;
    place_ += p;
    value_ += value;
    squares_ += vec3(p.x * p.x, p.x * p.y, p.y * p.y);
    products_ += p * value;
  }

  vec3 gradient() const {
    if (count_ <= 0) return vec3(0);
    const vec3 square =
        squares_ - vec3(place_.x * place_.x, place_.x * place_.y, place_.y * place_.y) / count_;
    const vec2 product = products_ - place_ * (value_ / count_);
    const float xx = square.x, xy = square.y, yy = square.z;
    const float determinant = xx * yy - xy * xy;
    vec2 g(0);
    if (determinant > 1e-4f * (xx + yy) * (xx + yy)) {
      g = vec2(yy * product.x - xy * product.y, xx * product.y - xy * product.x) / determinant;
    } else if (xx + yy > 0) {
      // Samples along a line tell nothing across it.
      const vec2 along = glm::normalize(xx >= yy ? vec2(xx, xy) : vec2(xy, yy));
      g = along * (dot(along, product) / (xx + yy));
    }
    return g.x * u_ + g.y * v_;
  }

  vec3 middle() const {
    const vec2 p = place_ / std::max(count_, 1.0f);
    return p.x * u_ + p.y * v_;
  }

  // Standard deviation of the places along `direction`, times its length.
  float reach(const vec3& direction) const {
    const vec2 g(dot(direction, u_), dot(direction, v_)), m = place_ / std::max(count_, 1.0f);
    const vec3 square = squares_ / std::max(count_, 1.0f) - vec3(m.x * m.x, m.x * m.y, m.y * m.y);
    return std::sqrt(std::max(0.0f, square.x * g.x * g.x + 2 * square.y * g.x * g.y + square.z * g.y * g.y));
  }

 private:
  vec3 centre_, u_, v_;
  float count_ = 0, value_ = 0;
  vec2 place_{0}, products_{0};
  vec3 squares_{0};
};

// Mean and gradient from samples that lie where the triangles do.
void fit_plane(Link& link, const Element& receiver, std::span<const SurfacePoint> at,
               std::span<const float> received) {
  PlaneFit fit(receiver);
  for (size_t i = 0; i < at.size(); ++i) fit.add(at[i].position, received[i]);
  link.transfer = fit.gradient();
  link.ambient = std::max(0.0f, link.mean - dot(link.transfer, fit.middle()));
  const float linear = fit.reach(link.transfer);
  limit_gradient(link, receiver.radius);
  for (size_t i = 0; i < at.size(); ++i) {
    const float said = link.ambient + dot(at[i].position - receiver.centre, link.transfer);
    link.spread = std::max(link.spread, std::abs(received[i] - said));
  }
  link.spread += 0.1f * linear;
  link.mean = link.ambient;  // the centre is the centroid
}

void link_cluster(const ElementPool& pool, const Visibility& visibility, Link& link, uint32_t points,
                  uint32_t rays_per_point, RayCount& count) {
  std::array<SurfacePoint, kStoredSamples> at;
  pool.quadrature(link.receiver, {at.data(), points});
  std::array<float, kStoredSamples> received{};
  std::array<vec3, kStoredSamples> normals;
  uint32_t rays = 0, facing = 0;
  vec3 by_channel(0);
  for (uint32_t i = 0; i < points; ++i) {
    const PointSample sample =
        sample_point(pool, visibility, link.source, at[i], rays_per_point, link.receiver * 16 + i, count);
    normals[i] = at[i].normal;
    received[i] = sample.received;
    if (sample.unoccluded > 0) ++facing;
    rays += sample.rays;
    by_channel += sample.by_channel / static_cast<float>(points);
    link.transfer += sample.transfer;
    link.mean += sample.received / static_cast<float>(points);
    link.unoccluded += sample.unoccluded / static_cast<float>(points);
  }
  // The vector is that at the points which face the source: the others' normals clip it when it is pushed to
  // them.
  if (facing > 0) link.transfer /= static_cast<float>(facing);
  finish(link, link.mean, link.unoccluded, rays);
  link.tint = tint_of(visibility, by_channel, link.mean);
  const Element& receiver = pool[link.receiver];
  if (receiver.flat) {
    fit_plane(link, receiver, {at.data(), points}, {received.data(), points});
  } else if (receiver.kind != ElementKind::kVolume) {
    fit_model(link, {received.data(), points}, {normals.data(), points});
  }
}

// Of the last measurement of links.
constexpr uint32_t kFreshPoints = 8, kMostPoints = 64, kFreshRays = 2;

// Gives a link another mean, keeping the shape of its light over the receiver if there was any to speak of.
void set_mean(Link& link, float mean) {
  if (link.mean > 0.5f * mean) {
    link.transfer *= mean / link.mean;
    link.ambient *= mean / link.mean;
  } else {  // what shape the samples have says nothing of where the light is
    link.transfer = vec3(0);
    link.ambient = mean;
  }
  link.mean = mean;
}

// What an element gets of another at its own points: means over `at`.
PointSample sample_points(const ElementPool& pool, const Visibility& visibility, ElementId towards,
                          std::span<const SurfacePoint> at, uint32_t rays_per_point, uint32_t seed,
                          RayCount& count) {
  PointSample sum;
  const auto points = static_cast<float>(at.size());
  for (uint32_t i = 0; i < at.size(); ++i) {
    const PointSample sample =
        sample_point(pool, visibility, towards, at[i], rays_per_point, seed + i, count);
    sum.received += sample.received / points;
    sum.unoccluded += sample.unoccluded / points;
    sum.by_channel += sample.by_channel / points;
    sum.rays += sample.rays;
  }
  return sum;
}

// A link's mean from the source's end: A_r F_rs = A_s F_sr. Over a large receiver the light of a small source
// near it is a peak between the samples, lost more often than caught; seen from the source the same transfer
// is smooth.
PointSample sample_reciprocal(const ElementPool& pool, const Visibility& visibility, const Link& link,
                              RayCount& count) {
  const Element &r = pool[link.receiver], &s = pool[link.source];
  std::array<SurfacePoint, 8> at;
  const std::span<SurfacePoint> points(at.data(), s.flat ? 4 : 8);
  pool.quadrature(link.source, points);
  PointSample sample = sample_points(pool, visibility, link.receiver, points,
                                     link.sight == Sight::kClear ? 0
                                     : s.flat                    ? 4
                                                                 : 2,
                                     link.source * 16, count);
  sample.received *= s.area / r.area;
  sample.unoccluded *= s.area / r.area;
  sample.by_channel *= s.area / r.area;
  return sample;
}

bool reciprocity_helps(const Element& r, const Element& s) {
  if (r.kind == ElementKind::kVolume || s.kind == ElementKind::kVolume || s.kind > ElementKind::kPatch)
    return false;
  const vec3 apart = s.centre - r.centre;
  return s.area < 0.5f * r.area && dot(apart, apart) < 6.25f * r.radius * r.radius;
}

}  // namespace

Tint::Tint(const vec3& colour) : bits_(0) {
  for (int c = 0; c < 3; ++c) {
    const float root = std::sqrt(std::clamp(colour[c], 0.0f, 1.0f));
    bits_ |= static_cast<uint32_t>(std::lround(1023 * root)) << (10 * c);
  }
}

vec3 Tint::colour() const {
  const vec3 root(static_cast<float>(bits_ & 1023u), static_cast<float>(bits_ >> 10 & 1023u),
                  static_cast<float>(bits_ >> 20 & 1023u));
  return root * root / (1023.0f * 1023.0f);
}

Link make_link(const ElementPool& pool, const Visibility& visibility, ElementId receiver, ElementId source,
               uint32_t points, uint32_t rays_per_point, RayCount& ray_count, Sight sight) {
  Link link;
  link.receiver = receiver;
  link.source = source;
  link.sight = sight == Sight::kSampled ? certain_sight(pool, visibility, receiver, source) : sight;
  const uint32_t worth = points * rays_per_point;
  if (link.sight == Sight::kClear) rays_per_point = 0;
  const bool polygon =
      pool[receiver].kind == ElementKind::kTriangle || pool[receiver].kind == ElementKind::kPatch;
  (polygon ? link_polygon : link_cluster)(pool, visibility, link, points, rays_per_point, ray_count);
  if (receiver != source && reciprocity_helps(pool[receiver], pool[source])) {
    const PointSample sample = sample_reciprocal(pool, visibility, link, ray_count);
    link.spread += std::abs(sample.received - link.mean);
    set_mean(link, sample.received);
    link.unoccluded = sample.unoccluded;
    link.tint = tint_of(visibility, sample.by_channel, sample.received);
    finish(link, sample.received, sample.unoccluded, link.rays + sample.rays);
  }
  // The few points know no more of how the light bends than they would with rays.
  if (link.sight == Sight::kClear) link.rays = static_cast<uint8_t>(std::min(worth, 255u));
  return link;
}

namespace {

// Places of a source, and what each brings: more than a link can keep.
struct SeenElements {
  std::array<ElementId, 2 * kMostPoints * kFreshRays> elements;
  std::array<float, 2 * kMostPoints * kFreshRays> weights;
  uint32_t count = 0;

  void add(ElementId id, float weight) {
    if (!(weight > 0)) return;
    elements[count] = id;
    weights[count++] = weight;
  }

  // Evenly spaced along the running sum of weights: each place is as likely to be kept as it is bright.
  void choose(SourceView& view, ElementId otherwise, float start) const {
    float all = 0;
    for (uint32_t i = 0; i < count; ++i) all += weights[i];
    if (count == 0) {
      view.elements.fill(otherwise);
      return;
    }
    const float step = all / static_cast<float>(view.elements.size());
    float up_to = weights[0];
    uint32_t at = 0;
    for (size_t k = 0; k < view.elements.size(); ++k) {
      const float target = step * (static_cast<float>(k) + start);
      while (up_to < target && at + 1 < count) up_to += weights[++at];
      view.elements[k] = elements[at];
    }
  }
};

}  // namespace

void measure_link(const ElementPool& pool, const Visibility& visibility, Link& link, float tolerance,
                  SourceView* view, RayCount& ray_count) {
  const Element &r = pool[link.receiver], &s = pool[link.source];
  if (link.receiver == link.source && r.kind == ElementKind::kVolume) return;
  const bool from_source = link.receiver != link.source && reciprocity_helps(r, s);
  const ElementId here = from_source ? link.source : link.receiver,
                  there = from_source ? link.receiver : link.source;
  const float turned = from_source ? s.area / r.area : 1.0f;
  const uint32_t seed = hash(link.receiver, link.source);
  SeenElements places;
  const bool form_factors =
      is_surface(s.kind) && s.kind != ElementKind::kVolume && r.kind != ElementKind::kVolume;
  // How many points it takes is told by the first samples, never by these: to stop where they happen to agree
  // would lose light again.
  const bool clear = link.sight == Sight::kClear;
  const float likely = (link.visibility / 255.0f * link.rays + 0.5f) / (link.rays + 1.0f);
  // To count what is seen or what is hidden is right on the average either way; the one that is likely to be
  // small has little to be wrong about.
  const bool count_seen = form_factors && likely <= 0.5f;
  const float deviation = link.unoccluded * std::sqrt(likely * (1 - likely));
  const float wanted = deviation * deviation / std::max(tolerance * tolerance, 1e-30f);
  // Rays are cheaper than points, above all before curved sources, whose exact transfer takes hundreds of
  // triangles.
  const uint32_t per_point = wanted > kFreshPoints ? 2 * kFreshRays : kFreshRays;
  const bool costly = likely > 0.5f && pool[there].kind == ElementKind::kCluster && !pool[there].flat;
  const auto most = static_cast<float>(costly ? kFreshPoints : kMostPoints);
  const auto points =
      !visibility.adaptive
          ? static_cast<uint32_t>(most)
          : static_cast<uint32_t>(std::clamp(std::ceil(wanted * kFreshRays / static_cast<float>(per_point)),
                                             static_cast<float>(kFreshPoints), most));
  float received = 0, unoccluded = 0;
  vec3 by_channel(0);
  uint32_t rays = 0;
  PlaneFit fit(r);
  for (uint32_t i = 0; i < points; ++i) {
    // Anywhere at all: quadrature points lie well inside, and never see past what hides all but an edge. But
    // the same for all that an element is linked to: where the one fills more of the view the others fill
    // less, and the errors of their sum cancel.
    const UnitSquarePoint uv = r2_point(i, hash(here, visibility.seed));
    const SurfacePoint x = pool.sample_at(here, uv.u, uv.v);
    const uint64_t before = ray_count.rays;
    SeenPoints seen;
    float arriving = 0;
    float factor = 0;
    if (!count_seen) {
      factor = std::max(0.0f, dot(point_transfer(pool, there, x.position, x.normal), x.normal));
      unoccluded += factor;
      if (factor <= 0) {
        fit.add(x.position, 0);
        continue;
      }
    }
    if (clear) {
      arriving = is_surface(s.kind) ? std::min(1.0f, factor) : factor;
      by_channel += arriving;
      if (view != nullptr)
        visibility.look(pool, there, x.position, x.normal, per_point, seed + i, ray_count, &seen, link.sight);
    } else if (form_factors) {
      const SeenShare share = visibility.look(pool, there, x.position, x.normal, per_point, seed + i,
                                              ray_count, view != nullptr ? &seen : nullptr);
      arriving = count_seen ? share.seen : factor - share.hidden;
      if (count_seen) unoccluded += share.seen + share.hidden;
      by_channel += arriving - share.seen + share.by_channel;
    } else {
      vec3 tint;
      arriving = factor * visibility.fraction(pool, there, x.position, x.normal, per_point, seed + i,
                                              ray_count, likely, &tint);
      by_channel += arriving * tint;
    }
    received += arriving;
    fit.add(x.position, arriving);
    rays += static_cast<uint32_t>(ray_count.rays - before);
    if (view == nullptr) continue;
    if (from_source) {
      float all = 0;
      for (uint32_t k = 0; k < seen.count; ++k) all += seen.weights[k];
      places.add(pool.deepest(link.source, x), all);
    } else {
      for (uint32_t k = 0; k < seen.count; ++k)
        places.add(pool.deepest(link.source, seen.points[k]), seen.weights[k]);
    }
  }
  received = std::max(0.0f, received);
  const auto n = static_cast<float>(points);
  link.unoccluded = turned * unoccluded / n;
  float mean = turned * received / n;
  if (r.flat && !from_source) {
    // The slope by the first samples, which knows nothing of these, tells what their mean owes to where they
    // happen to lie.
    // It takes no more than there is, and adds no more: else what is all but hidden would gain on the
    // average.
    mean -= std::clamp(dot(link.transfer, fit.middle()), -mean, mean);
    // What the first samples say of the slope is as good as what these do, ray for ray.
    const float first =
        clear ? 0.5f : static_cast<float>(link.rays) / static_cast<float>(std::max(1u, link.rays + rays));
    link.transfer = first * link.transfer + (1 - first) * fit.gradient();
    link.mean = link.ambient = mean;
    limit_gradient(link, r.radius);
  } else {
    set_mean(link, mean);
  }
  finish(link, received, unoccluded, rays);
  link.tint = tint_of(visibility, by_channel, received);
  if (view != nullptr) places.choose(*view, link.source, unit_float(hash(seed, 99)));
}

}  // namespace goldthread
