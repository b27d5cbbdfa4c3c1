#include "visibility/ray_caster.h"

#if GOLDTHREAD_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "base/check.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "math/box.h"
#include "visibility/triangle_tree.h"

namespace goldthread {
namespace {

struct FilterData {
  Transparency transparency;
  bool coloured = false;
  std::vector<uint32_t> triangles;  // of the see-through geometry's primitives
};

#if GOLDTHREAD_EMBREE >= 4
using Context = RTCRayQueryContext;
void init_context(Context& context) {
  rtcInitRayQueryContext(&context);
}
#else
using Context = RTCIntersectContext;
void init_context(Context& context) {
  rtcInitIntersectContext(&context);
}
#endif

// What one query for shadows knows besides its rays: how much of each one's light is left, by the ray's id.
// Written for those only that meet something that lets light through.
struct ShadowContext {
  Context embree;  // first, so that a pointer to it is one to all
  uint32_t met = 0;
  bool by_coin = false;  // what rays that were let through by the coin carry, instead of what light is left
  union {
    std::array<vec3, 16> left;
  };

  ShadowContext() { init_context(embree); }
  vec3 light(uint32_t id) const { return (met >> id & 1) != 0 ? left[id] : vec3(1); }
};

// What one query for the nearest hit knows besides its ray.
struct ClosestContext {
  Context embree;
  bool through_colour = false;

  ClosestContext() { init_context(embree); }
};

struct Candidate {
  Ray ray;
  uint32_t triangle = 0;
  Passing passing{0.0f};
};

float largest(const vec3& v) {
  return std::max(v.x, std::max(v.y, v.z));
}

Candidate candidate(const RTCFilterFunctionNArguments* args, unsigned i) {
  const auto* data = static_cast<const FilterData*>(args->geometryUserPtr);
  Candidate c;
  c.ray.origin = {RTCRayN_org_x(args->ray, args->N, i), RTCRayN_org_y(args->ray, args->N, i),
                  RTCRayN_org_z(args->ray, args->N, i)};
  c.ray.direction = {RTCRayN_dir_x(args->ray, args->N, i), RTCRayN_dir_y(args->ray, args->N, i),
                     RTCRayN_dir_z(args->ray, args->N, i)};
  c.triangle = data->triangles[RTCHitN_primID(args->hit, args->N, i)];
  c.passing = data->transparency(c.triangle,
                                 {RTCHitN_u(args->hit, args->N, i), RTCHitN_v(args->hit, args->N, i)}, c.ray);
  return c;
}

float coin(const Candidate& c) {
  const uint32_t a =
      hash(std::bit_cast<uint32_t>(c.ray.direction.x), std::bit_cast<uint32_t>(c.ray.direction.y));
  const uint32_t b =
      hash(std::bit_cast<uint32_t>(c.ray.origin.x) ^ c.triangle, std::bit_cast<uint32_t>(c.ray.origin.z));
  return unit_float(hash(a, b));
}

// Embree asks these for every candidate hit on a see-through triangle; clearing `valid` lets the ray go on.
void filter_closest(const RTCFilterFunctionNArguments* args) {
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    const Candidate c = candidate(args, i);
    if (!(c.passing.rays > 0) || !(coin(c) < c.passing.rays)) continue;
    args->valid[i] = 0;
    if (c.passing.light != vec3(c.passing.rays))
      reinterpret_cast<ClosestContext*>(args->context)->through_colour = true;
  }
}

void filter_shadow(const RTCFilterFunctionNArguments* args) {
  auto* context = reinterpret_cast<ShadowContext*>(args->context);
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    const uint32_t id = RTCRayN_id(args->ray, args->N, i);
    const Candidate c = candidate(args, i);
    vec3& left = context->left[id];
    if ((context->met >> id & 1) == 0) left = vec3(1);
    context->met |= 1u << id;
    left *= context->by_coin ? c.passing.light / std::max(c.passing.rays, 1e-6f) : c.passing.light;
    if (largest(left) > 0) args->valid[i] = 0;
  }
}

// One call of Embree; both versions share the names but not the signatures.
void intersect1(RTCScene scene, RTCRayHit* hit, ClosestContext* context) {
#if GOLDTHREAD_EMBREE >= 4
  if (context == nullptr) return rtcIntersect1(scene, hit, nullptr);
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &context->embree;
  rtcIntersect1(scene, hit, &arguments);
#else
  ClosestContext own;
  rtcIntersect1(scene, context != nullptr ? &context->embree : &own.embree, hit);
#endif
}

void occluded1(RTCScene scene, RTCRay* ray, ShadowContext& context) {
#if GOLDTHREAD_EMBREE >= 4
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.context = &context.embree;
  rtcOccluded1(scene, ray, &arguments);
#else
  rtcOccluded1(scene, &context.embree, ray);
#endif
}

void occluded16(RTCScene scene, const int* valid, RTCRay16* rays, ShadowContext& context) {
#if GOLDTHREAD_EMBREE >= 4
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.context = &context.embree;
  rtcOccluded16(valid, scene, rays, &arguments);
#else
  rtcOccluded16(valid, scene, &context.embree, rays);
#endif
}

RTCRay to_embree(const Ray& ray) {
  RTCRay r{};
  r.org_x = ray.origin.x;
  r.org_y = ray.origin.y;
  r.org_z = ray.origin.z;
  r.dir_x = ray.direction.x;
  r.dir_y = ray.direction.y;
  r.dir_z = ray.direction.z;
  r.tnear = ray.near;
  r.tfar = ray.far;
  r.mask = 0xffffffffu;
  return r;
}

float epsilon_for(std::span<const vec3> positions) {
  Box box;
  float magnitude = 0;
  for (const vec3& p : positions) {
    if (!is_finite(p)) continue;
    box.add(p);
    magnitude = std::max({magnitude, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  return std::max(4e-6f * magnitude, 2e-6f * box.diagonal());
}

}  // namespace

struct RayCaster::State {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::atomic<int64_t> bytes{0};
  LoopOrder building;  // Embree counts its memory on all threads
  float epsilon = 0;
  std::vector<uint32_t> opaque;  // source triangle of geometry 0's primitives; empty when it is the identity
  FilterData see_through;
  std::vector<std::pair<std::span<const vec3>, std::span<const UVec3>>> geometries;  // Embree's own buffers
  std::vector<unsigned> geometry_ids;                                                // theirs
  std::vector<TriangleTree> trees;                                                   // over these, for shafts

  uint32_t triangle_of(unsigned geometry, unsigned primitive) const {
    const std::vector<uint32_t>& map = geometry == 1 ? see_through.triangles : opaque;
    return map.empty() ? primitive : map[primitive];
  }

  // Embree marks a blocked ray by tfar = -inf.
  vec3 light(const Ray& ray) const {
    RTCRay query = to_embree(ray);
    ShadowContext context;
    occluded1(scene, &query, context);
    return query.tfar < 0 ? vec3(0) : context.light(0);
  }

  // What a ray carries that the coin let through colour. Candidates come in no order, and some may lie beyond
  // the hit: what lies before it is looked at once more, and each of these has let the ray through.
  vec3 tint(const Ray& ray, const RTCRayHit& found) const {
    RTCRay query = to_embree(ray);
    if (found.hit.geomID != RTC_INVALID_GEOMETRY_ID) query.tfar = std::nextafter(found.ray.tfar, ray.near);
    ShadowContext context;
    context.by_coin = true;
    occluded1(scene, &query, context);
    return context.light(0);
  }

  ~State() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  void add_geometry(unsigned id, std::span<const vec3> positions, std::span<const UVec3> triangles,
                    const std::vector<uint32_t>* subset) {
    const size_t count = subset != nullptr ? subset->size() : triangles.size();
    if (count == 0) return;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
    auto* vertices = static_cast<vec3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(vec3), positions.size()));
    std::copy(positions.begin(), positions.end(), vertices);
    auto* indices = static_cast<UVec3*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(UVec3), count));
    for (size_t i = 0; i < count; ++i) indices[i] = triangles[subset != nullptr ? (*subset)[i] : i];
    geometries.emplace_back(std::span<const vec3>(vertices, positions.size()),
                            std::span<const UVec3>(indices, count));
    geometry_ids.push_back(id);
    if (id == 1) {
      rtcSetGeometryUserData(geometry, &see_through);
      rtcSetGeometryOccludedFilterFunction(geometry, filter_shadow);
      rtcSetGeometryIntersectFilterFunction(geometry, filter_closest);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);
  }
};

RayCaster::RayCaster(std::span<const vec3> positions, std::span<const UVec3> triangles,
                     std::span<const uint8_t> see_through, Transparency transparency)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.epsilon = epsilon_for(positions);
  s.device = rtcNewDevice(nullptr);
  GOLDTHREAD_CHECK_EQ(s.device != nullptr, true);
  rtcSetDeviceMemoryMonitorFunction(
      s.device,
      [](void* user, ssize_t bytes, bool) {
        auto& state = *static_cast<State*>(user);
        state.building.run([&] { state.bytes.fetch_add(bytes, std::memory_order_relaxed); });
        return true;
      },
      &s);
  s.scene = rtcNewScene(s.device);
  rtcSetSceneFlags(s.scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(s.scene, RTC_BUILD_QUALITY_MEDIUM);
  s.see_through.transparency = std::move(transparency);
  s.see_through.coloured = std::find(see_through.begin(), see_through.end(), 2) != see_through.end();
  for (size_t i = 0; i < see_through.size(); ++i)
    if (see_through[i] != 0) s.see_through.triangles.push_back(static_cast<uint32_t>(i));
  if (s.see_through.triangles.empty()) {
    s.add_geometry(0, positions, triangles, nullptr);
  } else {
    for (size_t i = 0; i < triangles.size(); ++i)
      if (see_through[i] == 0) s.opaque.push_back(static_cast<uint32_t>(i));
    s.add_geometry(0, positions, triangles, &s.opaque);
    s.add_geometry(1, positions, triangles, &s.see_through.triangles);
  }
  rtcCommitScene(s.scene);
}

RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

// Written where it is to lie: copying what has just been written in other widths stalls.
void RayCaster::closest(const Ray& ray, Hit& hit) const {
  RTCRayHit query;
  query.ray = to_embree(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  hit.triangle = Hit::kMiss;
  hit.tint = vec3(1);
  if (is_coloured()) {
    ClosestContext context;
    intersect1(state_->scene, &query, &context);
    if (context.through_colour) hit.tint = state_->tint(ray, query);
  } else {
    intersect1(state_->scene, &query, nullptr);
  }
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
  hit.triangle = state_->triangle_of(query.hit.geomID, query.hit.primID);
  hit.distance = query.ray.tfar;
  hit.weights = {query.hit.u, query.hit.v};
  hit.normal = {query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z};
}

Hit RayCaster::closest(const Ray& ray) const {
  Hit hit;
  closest(ray, hit);
  return hit;
}

void RayCaster::closest(std::span<const Ray> rays, std::span<Hit> hits) const {
  GOLDTHREAD_CHECK_EQ(rays.size(), hits.size());
  for (size_t i = 0; i < rays.size(); ++i) closest(rays[i], hits[i]);
}

float RayCaster::transmittance(const Ray& ray) const {
  return largest(state_->light(ray));
}

void RayCaster::transmittance(std::span<const Ray> rays, std::span<vec3> out) const {
  GOLDTHREAD_CHECK_EQ(rays.size(), out.size());
  for (size_t i = 0; i < rays.size(); ++i) out[i] = state_->light(rays[i]);
}

void RayCaster::packet_transmittance(std::span<const Ray> rays, std::span<float> out,
                                     std::span<vec3> colours) const {
  GOLDTHREAD_CHECK_LE(rays.size(), size_t{16});
  GOLDTHREAD_CHECK_EQ(rays.size(), out.size());
  if (!colours.empty()) GOLDTHREAD_CHECK_EQ(rays.size(), colours.size());
  if (rays.size() == 1) {
    const vec3 light = state_->light(rays[0]);
    out[0] = largest(light);
    if (!colours.empty()) colours[0] = light;
    return;
  }
  alignas(64) int valid[16];
  alignas(64) RTCRay16 packet;
  for (size_t i = 0; i < 16; ++i) {
    valid[i] = i < rays.size() ? -1 : 0;
    const Ray& ray = rays[i < rays.size() ? i : 0];
    packet.org_x[i] = ray.origin.x;
    packet.org_y[i] = ray.origin.y;
    packet.org_z[i] = ray.origin.z;
    packet.dir_x[i] = ray.direction.x;
    packet.dir_y[i] = ray.direction.y;
    packet.dir_z[i] = ray.direction.z;
    packet.tnear[i] = ray.near;
    packet.tfar[i] = ray.far;
    packet.time[i] = 0;
    packet.mask[i] = 0xffffffffu;
    packet.id[i] = static_cast<unsigned>(i);
    packet.flags[i] = 0;
  }
  ShadowContext context;
  occluded16(state_->scene, valid, &packet, context);
  for (size_t i = 0; i < rays.size(); ++i) {
    const vec3 light = packet.tfar[i] < 0 ? vec3(0) : context.light(static_cast<uint32_t>(i));
    out[i] = largest(light);
    if (!colours.empty()) colours[i] = light;
  }
}

void RayCaster::near(const vec3& point, float radius, const std::function<void(uint32_t)>& visit) const {
  struct Visitor {
    const State& state;
    const std::function<void(uint32_t)>& visit;
  } visitor{*state_, visit};
  RTCPointQuery query{};
  query.x = point.x;
  query.y = point.y;
  query.z = point.z;
  query.radius = radius;
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(
      state_->scene, &query, &context,
      [](RTCPointQueryFunctionArguments* args) {
        const auto* v = static_cast<const Visitor*>(args->userPtr);
        v->visit(v->state.triangle_of(args->geomID, args->primID));
        return false;  // the radius stays
      },
      &visitor);
}

bool RayCaster::is_coloured() const {
  return state_->see_through.coloured;
}

void RayCaster::prepare_shafts() const {
  if (!state_->trees.empty()) return;
  for (const auto& [positions, triangles] : state_->geometries)
    state_->trees.emplace_back(positions, triangles);
}

bool RayCaster::is_clear(const Shaft& shaft) const {
  GOLDTHREAD_CHECK_EQ(state_->trees.size(), state_->geometries.size());
  for (const TriangleTree& tree : state_->trees)
    if (!tree.is_clear(shaft)) return false;
  return true;
}

void RayCaster::visit_near(const Box& box, const vec3& normal, float offset, float slack,
                           const std::function<void(uint32_t triangle)>& visit) const {
  GOLDTHREAD_CHECK_EQ(state_->trees.size(), state_->geometries.size());
  for (size_t g = 0; g < state_->trees.size(); ++g)
    state_->trees[g].visit_near(box, normal, offset, slack, [&](uint32_t primitive) {
      visit(state_->triangle_of(state_->geometry_ids[g], primitive));
    });
}

float RayCaster::epsilon() const {
  return state_->epsilon;
}

uint64_t RayCaster::memory_bytes() const {
  uint64_t bytes = static_cast<uint64_t>(std::max<int64_t>(0, state_->bytes.load(std::memory_order_relaxed)));
  for (const TriangleTree& tree : state_->trees) bytes += tree.memory_bytes();
  return bytes;
}

}  // namespace goldthread
