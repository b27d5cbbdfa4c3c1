#include "scene/procedural/shapes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace goldthread::procedural {
namespace {

constexpr double kTau = 2 * double(kPi);

uint32_t next_vertex(const Primitive& out) {
  return static_cast<uint32_t>(out.positions.size());
}

void add_vertex(Primitive& out, const dvec3& position, const dvec3& normal) {
  out.positions.emplace_back(position);
  out.normals.emplace_back(normal);
}

void add_face(Primitive& out, uint32_t a, uint32_t b, uint32_t c) {
  out.indices.insert(out.indices.end(), {a, b, c});
}

/// Vertex `j` of row `i` of a triangle whose row i holds i + 1 vertices.
uint32_t triangle_vertex(uint32_t first, int i, int j) {
  return first + static_cast<uint32_t>(i * (i + 1) / 2 + j);
}

/// Vertex numbers of a grid; wrapping joins its last column to the first, or its last row.
struct Grid {
  uint32_t first = 0;
  int columns = 0, rows = 0;
  bool wrap_columns = false, wrap_rows = false;

  int stored_columns() const { return wrap_columns ? columns : columns + 1; }
  int stored_rows() const { return wrap_rows ? rows : rows + 1; }
  uint32_t operator()(int i, int j) const {
    const int column = wrap_columns ? i % columns : i, row = wrap_rows ? j % rows : j;
    return first + static_cast<uint32_t>(row * stored_columns() + column);
  }
};

void add_grid_faces(Primitive& out, const Grid& grid, bool flip) {
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      const uint32_t a = grid(i, j), b = grid(i + 1, j), c = grid(i + 1, j + 1), d = grid(i, j + 1);
      add_face(out, a, flip ? c : b, flip ? b : c);
      add_face(out, a, flip ? d : c, flip ? c : d);
    }
  }
}

}  // namespace

void add_triangle(Primitive& out, const dvec3& a, const dvec3& b, const dvec3& c, int rate) {
  const uint32_t first = next_vertex(out);
  const dvec3 normal = normalize(cross(b - a, c - a));
  for (int i = 0; i <= rate; ++i) {
    for (int j = 0; j <= i; ++j) {
      const dvec3 sum = double(rate - i) * a + double(i - j) * b + double(j) * c;
      add_vertex(out, sum / double(rate), normal);
    }
  }
  for (int i = 0; i < rate; ++i) {
    for (int j = 0; j <= i; ++j) {
      const uint32_t left = triangle_vertex(first, i + 1, j);
      add_face(out, triangle_vertex(first, i, j), left, left + 1);
      if (j < i) add_face(out, triangle_vertex(first, i, j), left + 1, triangle_vertex(first, i, j + 1));
    }
  }
}

void add_quad(Primitive& out, const std::array<dvec3, 4>& corners, int rate) {
  add_triangle(out, corners[0], corners[1], corners[2], rate);
  add_triangle(out, corners[0], corners[2], corners[3], rate);
}

void add_grid(Primitive& out, const dvec3& corner, const dvec3& across, const dvec3& up, int columns,
              int rows) {
  const Grid grid{next_vertex(out), columns, rows};
  const dvec3 normal = normalize(cross(across, up));
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i)
      add_vertex(out, corner + across * (double(i) / columns) + up * (double(j) / rows), normal);
  add_grid_faces(out, grid, false);
}

void add_lattice(Primitive& out, const LatticeRectangle& rectangle, double step, int rate,
                 const std::function<bool(int, int)>& is_hole) {
  const int columns = rectangle.columns * rate, rows = rectangle.rows * rate;
  const dvec3 normal = cross(dvec3(rectangle.across), dvec3(rectangle.up));
  constexpr uint32_t kNone = 0xffffffffu;
  std::vector<uint32_t> vertices(size_t(columns + 1) * size_t(rows + 1), kNone);  // made when first used
  const auto vertex = [&](int i, int j) {
    uint32_t& number = vertices[size_t(j) * size_t(columns + 1) + size_t(i)];
    if (number == kNone) {
      number = next_vertex(out);
      const glm::ivec3 place = rectangle.corner * rate + rectangle.across * i + rectangle.up * j;
      add_vertex(out, dvec3(place) * step / double(rate), normal);
    }
    return number;
  };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      if (is_hole && is_hole(i / rate, j / rate)) continue;
      const uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      add_face(out, a, b, c);
      add_face(out, a, c, d);
    }
  }
}

void add_box(Primitive& out, const dvec3& low, const dvec3& high, int rate, Facing facing) {
  const auto corner = [&](int x, int y, int z) {
    return dvec3(x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z);
  };
  const std::array<std::array<dvec3, 4>, 6> sides = {{
      {corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1), corner(0, 1, 0)},  // -x
      {corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1), corner(1, 0, 1)},  // +x
      {corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1)},  // -y
      {corner(0, 1, 0), corner(0, 1, 1), corner(1, 1, 1), corner(1, 1, 0)},  // +y
      {corner(0, 0, 0), corner(0, 1, 0), corner(1, 1, 0), corner(1, 0, 0)},  // -z
      {corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1)},  // +z
  }};
  for (const auto& s : sides) {
    if (facing == Facing::kOutward)
      add_quad(out, s, rate);
    else
      add_quad(out, {s[3], s[2], s[1], s[0]}, rate);
  }
}

dvec3 surface_normal(const Surface& surface, double u, double v) {
  constexpr double kStep = 1e-5;
  const double u0 = surface.closed_u ? u - kStep : std::max(0.0, u - kStep);
  const double u1 = surface.closed_u ? u + kStep : std::min(1.0, u + kStep);
  const double v0 = surface.closed_v ? v - kStep : std::max(0.0, v - kStep);
  const double v1 = surface.closed_v ? v + kStep : std::min(1.0, v + kStep);
  const dvec3 along_u = surface.point(u1, v) - surface.point(u0, v);
  const dvec3 along_v = surface.point(u, v1) - surface.point(u, v0);
  const dvec3 normal = normalize(cross(along_u, along_v));
  return surface.flip ? -normal : normal;
}

void add_surface(Primitive& out, const Surface& surface, int columns, int rows) {
  const Grid grid{next_vertex(out), columns, rows, surface.closed_u, surface.closed_v};
  for (int j = 0; j < grid.stored_rows(); ++j) {
    for (int i = 0; i < grid.stored_columns(); ++i) {
      const double u = double(i) / columns, v = double(j) / rows;
      add_vertex(out, surface.point(u, v), surface_normal(surface, u, v));
    }
  }
  add_grid_faces(out, grid, surface.flip);
}

Surface ring(const dvec3& centre, const dvec3& x, const dvec3& y, double inner, double outer) {
  const auto point = [=](double u, double v) {
    const double angle = kTau * u, radius = outer + (inner - outer) * v;
    return centre + radius * (std::cos(angle) * x + std::sin(angle) * y);
  };
  return {point, true, false, false};
}

Surface tube(const dvec3& a, const dvec3& b, double radius) {
  const dvec3 axis = normalize(b - a);
  const dvec3 x = normalize(cross(axis, std::abs(axis.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0)));
  const dvec3 y = cross(axis, x);
  const auto point = [=](double u, double v) {
    const double angle = kTau * u;
    return a + v * (b - a) + radius * (std::cos(angle) * x + std::sin(angle) * y);
  };
  return {point, true, false, false};
}

Surface pillow(const dvec3& a, const dvec3& b, const dvec3& x, const dvec3& y) {
  const auto point = [=](double u, double v) {
    const double along = 2 * v - 1;
    const double size = 0.1 + 0.9 * std::sqrt(std::max(0.0, 1 - std::pow(along, 4)) + 1e-4);
    const double angle = kTau * u;
    return a + v * (b - a) + size * (std::cos(angle) * x + std::sin(angle) * y);
  };
  const bool left_handed = dot(cross(x, y), b - a) < 0;
  return {point, true, false, left_handed};
}

Surface torus(const dvec3& centre, const dvec3& x, const dvec3& y, double radius, double thickness) {
  const dvec3 axis = cross(x, y);
  const auto point = [=](double u, double v) {
    const double round = kTau * u, section = kTau * v;
    const dvec3 outward = std::cos(round) * x + std::sin(round) * y;
    return centre + radius * outward + thickness * (std::cos(section) * outward + std::sin(section) * axis);
  };
  return {point, true, true, false};
}

uint32_t add_material(Scene& scene, std::string name, const vec3& reflectance, const vec3& emission) {
  Material material;
  material.name = std::move(name);
  material.base_colour = reflectance;
  material.metallic = 0;
  material.emission = emission;
  scene.materials.push_back(std::move(material));
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

uint32_t add_object(Scene& scene, std::string name, Primitive primitive, uint32_t material) {
  primitive.material = material;
  Mesh mesh;
  mesh.name = name;
  mesh.primitives.push_back(std::move(primitive));
  scene.meshes.push_back(std::move(mesh));
  const auto index = static_cast<uint32_t>(scene.meshes.size() - 1);
  add_instance(scene, index, std::move(name), mat4(1));
  return index;
}

void add_instance(Scene& scene, uint32_t mesh, std::string name, const mat4& transform) {
  Instance instance;
  instance.mesh = mesh;
  instance.transform = transform;
  instance.source_node = static_cast<uint32_t>(scene.instances.size());
  instance.name = std::move(name);
  scene.instances.push_back(std::move(instance));
}

void add_camera(Scene& scene, const vec3& position, const vec3& target, float vertical_degrees,
                float aspect) {
  Camera camera;
  camera.name = "camera";
  camera.position = position;
  camera.forward = normalize(target - position);
  const vec3 right = normalize(cross(camera.forward, vec3(0, 1, 0)));
  camera.up = cross(right, camera.forward);
  camera.vertical_fov = vertical_degrees * kPi / 180;
  camera.aspect = aspect;
  scene.cameras.push_back(std::move(camera));
}

int rate_for(uint64_t wished, uint64_t at_rate_one) {
  if (wished <= at_rate_one || at_rate_one == 0) return 1;
  return std::max(1, static_cast<int>(std::lround(std::sqrt(double(wished) / double(at_rate_one)))));
}

}  // namespace goldthread::procedural
