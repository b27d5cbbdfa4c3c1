#include "visibility/ray_caster.h"

#if GOLDTHREAD_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <array>
#include <bit>
#include <vector>

#include "base/check.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "math/box.h"

namespace goldthread {
namespace {

struct FilterData {
  Transparency transparency;
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
struct ShadowContext {
  Context embree;  // first, so that a pointer to it is one to all
  std::array<float, 16> left;

  ShadowContext() {
    init_context(embree);
    left.fill(1);
  }
};

struct Candidate {
  Ray ray;
  uint32_t triangle = 0;
  float passing = 0;
};

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
    if (c.passing > 0 && coin(c) < c.passing) args->valid[i] = 0;
  }
}

void filter_shadow(const RTCFilterFunctionNArguments* args) {
  auto* context = reinterpret_cast<ShadowContext*>(args->context);
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    float& left = context->left[RTCRayN_id(args->ray, args->N, i)];
    left *= candidate(args, i).passing;
    if (left > 0) args->valid[i] = 0;
  }
}

// One call of Embree; both versions share the names but not the signatures.
void intersect1(RTCScene scene, RTCRayHit* hit) {
#if GOLDTHREAD_EMBREE >= 4
  rtcIntersect1(scene, hit, nullptr);
#else
  Context context;
  init_context(context);
  rtcIntersect1(scene, &context, hit);
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

  uint32_t triangle_of(unsigned geometry, unsigned primitive) const {
    const std::vector<uint32_t>& map = geometry == 1 ? see_through.triangles : opaque;
    return map.empty() ? primitive : map[primitive];
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
  intersect1(state_->scene, &query);
  hit.triangle = Hit::kMiss;
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
  RTCRay query = to_embree(ray);
  ShadowContext context;
  occluded1(state_->scene, &query, context);
  return query.tfar < 0 ? 0.0f : context.left[0];  // Embree marks a blocked ray by tfar = -inf
}

void RayCaster::transmittance(std::span<const Ray> rays, std::span<float> out) const {
  GOLDTHREAD_CHECK_EQ(rays.size(), out.size());
  for (size_t i = 0; i < rays.size(); ++i) out[i] = transmittance(rays[i]);
}

void RayCaster::packet_transmittance(std::span<const Ray> rays, std::span<float> out) const {
  GOLDTHREAD_CHECK_LE(rays.size(), size_t{16});
  GOLDTHREAD_CHECK_EQ(rays.size(), out.size());
  if (rays.size() == 1) {
    out[0] = transmittance(rays[0]);
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
  for (size_t i = 0; i < rays.size(); ++i) out[i] = packet.tfar[i] < 0 ? 0.0f : context.left[i];
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

float RayCaster::epsilon() const {
  return state_->epsilon;
}

uint64_t RayCaster::memory_bytes() const {
  return static_cast<uint64_t>(std::max<int64_t>(0, state_->bytes.load(std::memory_order_relaxed)));
}

}  // namespace goldthread
