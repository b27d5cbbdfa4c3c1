#include "visibility/ray_caster.h"

#if GOLDTHREAD_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <vector>

#include "base/check.h"
#include "base/parallel.h"

namespace goldthread {
namespace {

struct FilterData {
  PassThrough pass;
  std::vector<uint32_t> triangles;  // of the see-through geometry's primitives
};

// Embree asks this for every candidate hit on a see-through triangle; clearing `valid` lets the ray go on.
void filter(const RTCFilterFunctionNArguments* args) {
  const auto* data = static_cast<const FilterData*>(args->geometryUserPtr);
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    Ray ray;
    ray.origin = {RTCRayN_org_x(args->ray, args->N, i), RTCRayN_org_y(args->ray, args->N, i),
                  RTCRayN_org_z(args->ray, args->N, i)};
    ray.direction = {RTCRayN_dir_x(args->ray, args->N, i), RTCRayN_dir_y(args->ray, args->N, i),
                     RTCRayN_dir_z(args->ray, args->N, i)};
    const uint32_t triangle = data->triangles[RTCHitN_primID(args->hit, args->N, i)];
    const vec2 weights{RTCHitN_u(args->hit, args->N, i), RTCHitN_v(args->hit, args->N, i)};
    if (data->pass(triangle, weights, ray)) args->valid[i] = 0;
  }
}

// One call of Embree; both versions share the names but not the signatures.
void occluded1(RTCScene scene, RTCRay* ray) {
#if GOLDTHREAD_EMBREE >= 4
  rtcOccluded1(scene, ray, nullptr);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, ray);
#endif
}

void intersect1(RTCScene scene, RTCRayHit* hit) {
#if GOLDTHREAD_EMBREE >= 4
  rtcIntersect1(scene, hit, nullptr);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, hit);
#endif
}

void occluded16(RTCScene scene, const int* valid, RTCRay16* rays) {
#if GOLDTHREAD_EMBREE >= 4
  rtcOccluded16(valid, scene, rays, nullptr);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded16(valid, scene, &context, rays);
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

}  // namespace

struct RayCaster::State {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::atomic<int64_t> bytes{0};
  LoopOrder building;            // Embree counts its memory on all threads
  std::vector<uint32_t> opaque;  // source triangle of geometry 0's primitives; empty when it is the identity
  FilterData see_through;

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
      rtcSetGeometryOccludedFilterFunction(geometry, filter);
      rtcSetGeometryIntersectFilterFunction(geometry, filter);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);
  }
};

RayCaster::RayCaster(std::span<const vec3> positions, std::span<const UVec3> triangles,
                     std::span<const uint8_t> see_through, PassThrough pass)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
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
  s.see_through.pass = std::move(pass);
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

Hit RayCaster::closest(const Ray& ray) const {
  RTCRayHit query{};
  query.ray = to_embree(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersect1(state_->scene, &query);
  Hit hit;
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  const std::vector<uint32_t>& map = query.hit.geomID == 1 ? state_->see_through.triangles : state_->opaque;
  hit.triangle = map.empty() ? query.hit.primID : map[query.hit.primID];
  hit.distance = query.ray.tfar;
  hit.weights = {query.hit.u, query.hit.v};
  hit.normal = {query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z};
  return hit;
}

bool RayCaster::occluded(const Ray& ray) const {
  RTCRay query = to_embree(ray);
  occluded1(state_->scene, &query);
  return query.tfar < 0;  // Embree marks a blocked ray by tfar = -inf
}

uint32_t RayCaster::occluded_packet(std::span<const Ray> rays) const {
  GOLDTHREAD_CHECK_LE(rays.size(), size_t{16});
  if (rays.size() == 1) return occluded(rays[0]) ? 1u : 0u;
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
    packet.id[i] = 0;
    packet.flags[i] = 0;
  }
  occluded16(state_->scene, valid, &packet);
  uint32_t blocked = 0;
  for (size_t i = 0; i < rays.size(); ++i)
    if (packet.tfar[i] < 0) blocked |= 1u << i;
  return blocked;
}

uint64_t RayCaster::memory_bytes() const {
  return static_cast<uint64_t>(std::max<int64_t>(0, state_->bytes.load(std::memory_order_relaxed)));
}

}  // namespace goldthread
