#include "represent/atlas/flatten.h"

namespace goldthread {
namespace {

dvec3 normal_of(const Piece& piece) {
  dvec3 sum(0);
  for (const UVec3& f : piece.faces) {
    const dvec3 from = piece.positions[f.x];
    sum += cross(piece.positions[f.y] - from, piece.positions[f.z] - from);
  }
  return sum;
}

}  // namespace

std::optional<PlaneImage> project(const Piece& piece) {
  const dvec3 sum = normal_of(piece);
  const double size = length(sum);
  if (!(size > 0) || !std::isfinite(size)) return std::nullopt;
  const dvec3 normal = sum / size, magnitude = glm::abs(normal);
  const bool x_least = magnitude.x <= magnitude.y && magnitude.x <= magnitude.z;
  const dvec3 axis = x_least ? dvec3(1, 0, 0) : magnitude.y <= magnitude.z ? dvec3(0, 1, 0) : dvec3(0, 0, 1);
  const dvec3 u = normalize(cross(axis, normal)), v = cross(normal, u);
  PlaneImage image(piece.positions.size());
  for (size_t i = 0; i < image.size(); ++i)
    image[i] = {dot(u, piece.positions[i]), dot(v, piece.positions[i])};
  return image;
}

double stretch_of(const Piece& piece, const PlaneImage& image) {
  double area = 0, stretched = 0, pressed = 0;
  for (const UVec3& f : piece.faces) {
    const dvec3 a = piece.positions[f.y] - piece.positions[f.x],
                b = piece.positions[f.z] - piece.positions[f.x];
    const dvec2 p = image[f.y] - image[f.x], q = image[f.z] - image[f.x];
    const double surface = length(cross(a, b)), plane = p.x * q.y - p.y * q.x;
    if (!(plane > 0)) return std::numeric_limits<double>::infinity();
    // Half the squared Frobenius norm of the map, by its triangle's sides (Sander et al. 2001, section 3),
    // from which and from the determinant follow the singular values.
    const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b);
    const double half = (bb * dot(p, p) - 2 * ab * dot(p, q) + aa * dot(q, q)) / (2 * surface * surface);
    const double determinant = plane / surface;
    const double larger = half + std::sqrt(std::max(0.0, half * half - determinant * determinant));
    area += surface;
    stretched += surface * larger;
    pressed += surface * larger / (determinant * determinant);  // 1 / the smaller one's square
  }
  return std::sqrt(std::max(stretched, pressed) / area);
}

}  // namespace goldthread
