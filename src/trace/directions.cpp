#include "trace/directions.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/wide.h"

namespace goldthread {
namespace {

struct Turn {
  float cosine, sine;
};

/// Of a turn's 2^-32 parts: the nearest quarter is known exactly, and what is left, an eighth at the most, is
/// short enough for the polynomials of Moshier's Cephes library (sinf.c), which err by less than 1e-7.
inline Turn turn(uint32_t parts) {
  constexpr float kPart = 2 * kPi * 0x1p-32f;
  const uint32_t shifted = parts + (1u << 29), quarter = shifted >> 30;
  const float a = static_cast<float>(static_cast<int32_t>(shifted & 0x3fffffffu) - (1 << 29)) * kPart;
  const float z = a * a;
  const float sine = ((-1.9515295891e-4f * z + 8.3321608736e-3f) * z - 1.6666654611e-1f) * z * a + a;
  const float cosine =
      ((2.443315711809948e-5f * z - 1.388731625493765e-3f) * z + 4.166664568298827e-2f) * z * z - 0.5f * z +
      1;
  const bool odd = (quarter & 1) != 0;
  const float along = odd ? sine : cosine, across = odd ? cosine : sine;
  return {((quarter + 1) & 2) != 0 ? -along : along, (quarter & 2) != 0 ? -across : across};
}

inline vec3 about(float nx, float ny, float nz, uint32_t u, uint32_t v) {
  const float radius = std::sqrt(static_cast<float>(u) * 0x1p-32f);
  const float height = std::sqrt((static_cast<float>(~u) + 1) * 0x1p-32f);
  const Turn t = turn(v);
  const float along = radius * t.cosine, aside = radius * t.sine;
  // The frame of Duff et al., Building an Orthonormal Basis, Revisited (2017): no root, no branch.
  const float sign = std::copysign(1.0f, nz);
  const float a = -1 / (sign + nz), b = nx * ny * a;
  return {along * (1 + sign * nx * nx * a) + aside * b + height * nx,
          along * (sign * b) + aside * (sign + ny * ny * a) + height * ny,
          along * (-sign * nx) - aside * ny + height * nz};
}

GOLDTHREAD_WIDE_CLONES void about_all(const Vec3Lanes& n, const SobolPoint* points, size_t count,
                                      Vec3Lanes& __restrict out) {
  for (size_t i = 0; i < count; ++i) {
    const vec3 d = about(n.x[i], n.y[i], n.z[i], points[i].u, points[i].v);
    out.x[i] = d.x;
    out.y[i] = d.y;
    out.z[i] = d.z;
  }
}

}  // namespace

vec3 cosine_direction(const vec3& normal, SobolPoint p) {
  return about(normal.x, normal.y, normal.z, p.u, p.v);
}

void cosine_directions(const Vec3Lanes& normals, std::span<const SobolPoint> points, Vec3Lanes& directions) {
  GOLDTHREAD_CHECK_LE(points.size(), kLanes);
  about_all(normals, points.data(), points.size(), directions);
}

vec3 even_direction(SobolPoint p) {
  const double z = 1 - 2 * unit_double(p.u), angle = 2 * 3.14159265358979323846 * unit_double(p.v);
  const double radius = std::sqrt(std::max(0.0, 1 - z * z));
  return vec3(dvec3(radius * std::cos(angle), radius * std::sin(angle), z));
}

}  // namespace goldthread
