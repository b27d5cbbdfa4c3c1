#include "math/oriented_box.h"

#include <Eigen/Eigenvalues>
#include <limits>

namespace goldthread {
namespace {

vec3 column(const Eigen::Matrix3d& m, int i) {
  return vec3(dvec3(m(0, i), m(1, i), m(2, i)));
}

}  // namespace

PrincipalAxes principal_axes(std::span<const vec3> points) {
  if (points.empty()) return {};
  dvec3 mean(0);
  for (const vec3& p : points) mean += dvec3(p);
  mean /= double(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const vec3& p : points) {
    const dvec3 d = dvec3(p) - mean;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j <= i; ++j) covariance(i, j) += d[i] * d[j];
  }
  // The iterative solver, not the closed form: axes of nearly equal variance must still be orthogonal.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance / double(points.size()));
  PrincipalAxes result;
  result.mean = vec3(mean);
  for (int i = 0; i < 2; ++i) result.axes[i] = column(solver.eigenvectors(), 2 - i);
  result.axes[2] = cross(result.axes[0], result.axes[1]);
  for (int i = 0; i < 3; ++i)
    result.deviation[i] = float(std::sqrt(std::max(0.0, solver.eigenvalues()(2 - i))));
  return result;
}

OrientedBox box_along(const mat3& axes, std::span<const vec3> points) {
  OrientedBox box;
  box.axes = axes;
  if (points.empty()) return box;
  vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
  const vec3 origin = points[0];  // far from zero, small differences would be lost
  for (const vec3& p : points) {
    const vec3 along = (p - origin) * axes;  // row vector times matrix: the dot product with each column
    low = glm::min(low, along);
    high = glm::max(high, along);
  }
  box.half = 0.5f * (high - low);
  box.centre = origin + axes * (0.5f * (low + high));
  return box;
}

mat3 frame_about(const vec3& normal) {
  // The coordinate axis farthest from the normal makes the best conditioned cross product.
  const vec3 magnitude = glm::abs(normal);
  const vec3 aside = magnitude.x <= magnitude.y && magnitude.x <= magnitude.z ? vec3(1, 0, 0)
                     : magnitude.y <= magnitude.z                             ? vec3(0, 1, 0)
                                                                              : vec3(0, 0, 1);
  const vec3 u = normalize(cross(aside, normal));
  return mat3(u, cross(normal, u), normal);
}

}  // namespace goldthread
