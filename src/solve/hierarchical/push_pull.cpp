#include "solve/hierarchical/push_pull.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"

namespace goldthread {

void RadiosityState::grow_to(const ElementPool& pool) {
  const size_t before = radiosity.size(), count = pool.size();
  radiosity.resize(count);
  irradiance.resize(count, vec3(0));
  shown.resize(count);
  openness.resize(count);
  low.resize(count);
  high.resize(count);
  vector.resize(count, mat3(0));
  ambient.resize(count, vec3(0));
  for (size_t i = before; i < count; ++i) {
    const Element& e = pool[static_cast<ElementId>(i)];
    if (e.parent != kNoElement) {
      irradiance[i] = irradiance[e.parent];
      vector[i] = vector[e.parent];
      ambient[i] = ambient[e.parent];
    }
  }
  for (size_t i = before; i < count; ++i) {
    const Element& e = pool[static_cast<ElementId>(i)];
    radiosity[i] = leaving_light(pool, static_cast<ElementId>(i), irradiance[i], irradiance);
    shown[i] = radiosity[i];
    openness[i] = e.area;
    const float uneven = pool.unevenness(static_cast<ElementId>(i));
    low[i] = largest(radiosity[i]) - uneven;
    high[i] = largest(radiosity[i]) + uneven;
  }
}

namespace {

constexpr float kLeastOpenness = 1e-3f;
constexpr float kBuried = 0.02f;
// Irradiance below this share of the mean is none.
constexpr float kNothing = 1e-6f;

// Irradiance vectors by octant of the direction they come from; a column a colour channel.
struct Octants {
  std::array<mat3, 8> sum{};
  std::array<vec3, 8> shares{};  // the same for sources of radiosity one, lamps apart
  vec3 ambient{0};               // what falls on every normal alike
  float ambient_share = 0;
  float faced = 0, seen = 0;  // form factors, without and with occlusion
  uint32_t used = 0;

  void add(const Link& link, const vec3& radiosity, bool form_factor) {
    const vec3& transfer = link.transfer;
    ambient += link.ambient * radiosity;
    const uint32_t octant =
        (transfer.x < 0 ? 1u : 0u) | (transfer.y < 0 ? 2u : 0u) | (transfer.z < 0 ? 4u : 0u);
    if ((used >> octant & 1) == 0) {
      sum[octant] = mat3(0);
      shares[octant] = vec3(0);
    }
    used |= 1u << octant;
    sum[octant][0] += transfer * radiosity.x;
    sum[octant][1] += transfer * radiosity.y;
    sum[octant][2] += transfer * radiosity.z;
    if (!form_factor) return;
    shares[octant] += transfer;
    ambient_share += link.ambient;
  }

  // Irradiance on a plane of unit normal `n`, each octant clipped by it; a shorter `n` stands for a bundle of
  // normals.
  vec3 on(const vec3& n) const {
    vec3 e = ambient;
    for (uint32_t o = 0; o < 8; ++o)
      if ((used >> o & 1) != 0) e += glm::max(n * sum[o], vec3(0));
    return e;
  }

  // How much of the hemisphere over `n` these links say that they fill.
  float share_on(const vec3& n) const {
    float share = ambient_share;
    for (uint32_t o = 0; o < 8; ++o)
      if ((used >> o & 1) != 0) share += std::max(0.0f, dot(n, shares[o]));
    return share;
  }

  mat3 facing(const vec3& n) const {
    mat3 total(0);
    for (uint32_t o = 0; o < 8; ++o) {
      if ((used >> o & 1) == 0) continue;
      for (int c = 0; c < 3; ++c)
        if (dot(sum[o][c], n) > 0) total[c] += sum[o][c];
    }
    return total;
  }
};

// What flat elements get from links above them: a value at the element's centre and its gradient, a column a
// channel.
struct Field {
  vec3 at_centre{0};
  mat3 gradient{0};
  float share = 0;  // the same for sources of radiosity one, lamps apart
  vec3 share_gradient{0};

  Field moved(const vec3& by) const {
    return {at_centre + by * gradient, gradient, share + dot(by, share_gradient), share_gradient};
  }
  void add(const Link& link, const vec3& b, bool form_factor) {
    at_centre += link.ambient * b;
    for (int c = 0; c < 3; ++c) gradient[c] += b[c] * link.transfer;
    if (!form_factor) return;
    share += link.ambient;
    share_gradient += link.transfer;
  }
};

struct Sweep {
  const ElementPool& pool;
  const LinkPool& links;
  RadiosityState& state;
  float most_seen;               // what the form factors of a leaf may add up to
  const std::vector<vec3>& old;  // radiosity shown before the sweep: the order of visits must not matter
  const std::vector<vec3>& old_irradiance;  // the same, for what is behind; empty where nothing comes through
  const Regard& regard;
  const float nothing;  // lux: less is darkness

  // Returns by how much the reflected light of all leaves below `id` has changed: in lm, and in m^2 times its
  // share.
  vec2 visit(ElementId id, const Octants& inherited) const {
    const Element& e = pool[id];
    if (e.flat) return visit_flat(id, inherited, {});
    Octants octants = inherited;
    vec3 direct(0);
    float direct_share = 0;
    for (const Link& link : links.into(id)) {
      if (is_form_factor(link)) {
        octants.faced += link.unoccluded;
        octants.seen += link.mean;
      }
      if (link.mean <= 0) continue;
      const vec3 b = seen_radiosity(link, links.views(), old);
      octants.add(link, b, is_form_factor(link));
      direct += link.mean * b;
      if (is_form_factor(link)) direct_share += link.mean;
    }
    if (e.first_child == kNoElement) return leaf(id, e, inherited, octants, direct, direct_share);
    vec2 left(0), right(0);
    if (e.depth < 12) {
      parallel_invoke([&] { left = visit(e.first_child, octants); },
                      [&] { right = visit(e.first_child + 1, octants); });
    } else {
      left = visit(e.first_child, octants);
      right = visit(e.first_child + 1, octants);
    }
    pull(id, e);
    return left + right;
  }

  vec2 visit_flat(ElementId id, const Octants& above, Field field) const {
    const Element& e = pool[id];
    float faced = above.faced, seen = above.seen;
    for (const Link& link : links.into(id)) {
      if (is_form_factor(link)) {
        faced += link.unoccluded;
        seen += link.mean;
      }
      if (link.mean > 0) field.add(link, seen_radiosity(link, links.views(), old), is_form_factor(link));
    }
    if (e.first_child == kNoElement) {
      const vec3 n = e.summed_normal / std::max(e.area, 1e-30f);
      state.vector[id] = field.gradient;
      state.ambient[id] = vec3(0);
      return settle(id, e, glm::max(above.on(n) + field.at_centre, vec3(0)), above.share_on(n) + field.share,
                    faced, seen);
    }
    Octants passed = above;
    passed.faced = faced;
    passed.seen = seen;
    vec2 change(0);
    for (uint32_t c = 0; c < 2; ++c)
      change += visit_flat(e.first_child + c, passed, field.moved(pool[e.first_child + c].centre - e.centre));
    pull(id, e);
    return change;
  }

  vec2 leaf(ElementId id, const Element& e, const Octants& inherited, const Octants& all, const vec3& direct,
            float direct_share) const {
    vec3 irradiance = direct;
    float share = direct_share;
    if (e.cone_cosine < 0.95f) {
      for (uint32_t i = 0; i < kStoredSamples; ++i) {
        const vec3& n = pool.stored_sample(id, i).normal;
        irradiance += inherited.on(n) * (1.0f / static_cast<float>(kStoredSamples));
        share += inherited.share_on(n) * (1.0f / static_cast<float>(kStoredSamples));
      }
    } else {
      const vec3 n = e.summed_normal / std::max(e.area, 1e-30f);
      irradiance += inherited.on(n);
      share += inherited.share_on(n);
    }
    state.vector[id] = all.facing(e.summed_normal);
    state.ambient[id] = all.ambient;
    return settle(id, e, irradiance, share, all.faced, all.seen);
  }

  // A lamp's transfer is no share of a hemisphere.
  bool is_form_factor(const Link& link) const {
    const ElementKind kind = pool[link.source].kind;
    return kind != ElementKind::kPoint && kind != ElementKind::kSun;
  }

  vec2 settle(ElementId id, const Element& e, const vec3& gathered, float share, float faced,
              float seen) const {
    // What a point sees adds up to one at most. Samples that say more would, between bright surfaces, let
    // light grow.
    const vec3 irradiance = gathered * std::min(1.0f, most_seen / std::max(share, 1e-20f));
    const float change =
        regard.of(e) * e.area *
        largest((e.reflectance + pool.transmittance(id)) * glm::abs(irradiance - state.irradiance[id]));
    const float light = largest(glm::max(irradiance, state.irradiance[id])) + nothing;
    state.irradiance[id] = irradiance;
    state.radiosity[id] = leaving_light(pool, id, irradiance, old_irradiance);
    state.shown[id] = state.radiosity[id];
    state.openness[id] = e.area * (faced > 0 ? std::clamp(seen / faced, kLeastOpenness, 1.0f) : 1.0f);
    state.low[id] = state.high[id] = largest(state.radiosity[id]);
    return {change, change / std::max(light, 1e-30f)};
  }

  void pull(ElementId id, const Element& e) const {
    const ElementId a = e.first_child, b = a + 1;
    const float total = pool[a].area + pool[b].area;
    const float share = total > 0 ? pool[a].area / total : 0.5f;
    state.radiosity[id] = share * state.radiosity[a] + (1 - share) * state.radiosity[b];
    state.irradiance[id] = share * state.irradiance[a] + (1 - share) * state.irradiance[b];
    const float open = state.openness[a] + state.openness[b];
    const float open_share = open > 0 ? state.openness[a] / open : share;
    state.openness[id] = open;
    state.shown[id] = open_share * state.shown[a] + (1 - open_share) * state.shown[b];
    // What is all but buried has no say in how even the rest is.
    const bool a_counts = state.openness[a] > kBuried * pool[a].area,
               b_counts = state.openness[b] > kBuried * pool[b].area;
    state.low[id] = a_counts != b_counts ? state.low[a_counts ? a : b] : std::min(state.low[a], state.low[b]);
    state.high[id] =
        a_counts != b_counts ? state.high[a_counts ? a : b] : std::max(state.high[a], state.high[b]);
  }
};

}  // namespace

SweepChange gather_push_pull(const ElementPool& pool, const LinkPool& links, RadiosityState& state,
                             float most_seen, const Regard& regard) {
  if (pool.root() == kNoElement) return {};
  const std::vector<vec3> old = state.shown;
  std::vector<vec3> old_irradiance;
  if (pool.surfaces().has_translucent) old_irradiance = state.irradiance;
  const float nothing = kNothing * largest(state.irradiance[pool.root()]);
  const Sweep sweep{pool, links, state, most_seen, old, old_irradiance, regard, nothing};
  const vec2 change = sweep.visit(pool.root(), Octants{});
  const double all = static_cast<double>(largest(regarded_power(pool, state, regard)));
  return {static_cast<double>(change.x) / std::max(1e-30, all),
          static_cast<double>(change.y) / std::max(1e-30, regarded_area(pool, regard))};
}

vec3 landing_power(const ElementPool& pool, const RadiosityState& state) {
  return regarded_power(pool, state, Regard());
}

}  // namespace goldthread
