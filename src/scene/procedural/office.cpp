// Two office cubicles under a ceiling with light panels, after the model in Cohen, Chen, Wallace and
// Greenberg, "A Progressive Refinement Approach to Fast Radiosity Image Generation" (SIGGRAPH 1988),
// figure 6.
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>

#include "scene/procedural/scenes.h"
#include "scene/procedural/shapes.h"

namespace goldthread::procedural {
namespace {

constexpr double kTile = 0.6;  // metres: the ceiling's grid, and the lattice of the room
constexpr int kTilesX = 12, kTilesZ = 9;
constexpr double kRoomHeight = 2.7;
constexpr double kCubicleWidth = 3.0, kPartitionThickness = 0.06, kPartitionHeight = 1.6;
constexpr double kCubicleX = 0.54, kCubicleZ = 0.9;  // inner back corner of the first cubicle

struct OfficeMaterials {
  uint32_t paint, carpet, fabric, desk, metal, plastic, screen, cushion, books[3], paper, light;
};

OfficeMaterials add_office_materials(Scene& scene) {
  OfficeMaterials m{};
  m.paint = add_material(scene, "wall paint", {0.72f, 0.7f, 0.64f});
  m.carpet = add_material(scene, "carpet", {0.2f, 0.24f, 0.3f});
  m.fabric = add_material(scene, "partition fabric", {0.5f, 0.36f, 0.24f});
  m.desk = add_material(scene, "desk top", {0.55f, 0.4f, 0.25f});
  m.metal = add_material(scene, "metal", vec3(0.35f));
  m.plastic = add_material(scene, "plastic", {0.65f, 0.62f, 0.54f});
  m.screen = add_material(scene, "screen", {0.03f, 0.05f, 0.045f});
  m.cushion = add_material(scene, "cushion", {0.45f, 0.1f, 0.08f});
  m.books[0] = add_material(scene, "red book", {0.5f, 0.08f, 0.07f});
  m.books[1] = add_material(scene, "green book", {0.1f, 0.3f, 0.14f});
  m.books[2] = add_material(scene, "blue book", {0.1f, 0.16f, 0.45f});
  m.paper = add_material(scene, "paper", vec3(0.8f));
  m.light = add_material(scene, "ceiling panel", vec3(0.7f), vec3(3200, 3150, 3000));
  return m;
}

/// Panels of one by two tiles, in two rows of three.
bool is_light_tile(int column, int row) {
  const bool in_column = column % 4 == 1 || column % 4 == 2;
  return in_column && (row == 2 || row == 6);
}

void add_shell(Scene& scene, const OfficeMaterials& m, int rate) {
  // The walls' height is no whole number of tiles; their rows only meet floor and ceiling at the ends.
  const double width = kTilesX * kTile, depth = kTilesZ * kTile;
  const LatticeRectangle flat{{0, 0, kTilesZ}, {1, 0, 0}, {0, 0, -1}, kTilesX, kTilesZ};
  const LatticeRectangle upper{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, kTilesX, kTilesZ};
  Primitive floor, ceiling, lights, walls;
  add_lattice(floor, flat, kTile, rate);
  add_lattice(ceiling, upper, kTile, rate, is_light_tile);
  add_lattice(lights, upper, kTile, rate, [](int i, int j) { return !is_light_tile(i, j); });
  for (Primitive* p : {&ceiling, &lights})
    for (vec3& position : p->positions) position.y = float(kRoomHeight);
  const dvec3 up(0, kRoomHeight, 0);
  add_grid(walls, {0, 0, 0}, {width, 0, 0}, up, kTilesX * rate, 4 * rate);
  add_grid(walls, {width, 0, depth}, {-width, 0, 0}, up, kTilesX * rate, 4 * rate);
  add_grid(walls, {0, 0, depth}, {0, 0, -depth}, up, kTilesZ * rate, 4 * rate);
  add_grid(walls, {width, 0, 0}, {0, 0, depth}, up, kTilesZ * rate, 4 * rate);
  add_object(scene, "floor", std::move(floor), m.carpet);
  add_object(scene, "ceiling", std::move(ceiling), m.paint);
  add_object(scene, "ceiling panels", std::move(lights), m.light);
  add_object(scene, "walls", std::move(walls), m.paint);

  Primitive door;
  add_box(door, {0.003, 0.01, 4.0}, {0.04, 2.05, 4.9}, rate);
  add_object(scene, "door", std::move(door), m.desk);
}

void add_partitions(Scene& scene, const OfficeMaterials& m, int rate) {
  constexpr double kLength = 2.4, kFoot = 0.05;
  const double t = kPartitionThickness;
  Primitive out;
  add_box(out, {kCubicleX - t, kFoot, kCubicleZ - t},
          {kCubicleX + 2 * kCubicleWidth + 2 * t, kPartitionHeight, kCubicleZ}, 4 * rate);
  for (int i = 0; i < 3; ++i) {
    const double x = kCubicleX - t + i * (kCubicleWidth + t);
    add_box(out, {x, kFoot, kCubicleZ}, {x + t, kPartitionHeight, kCubicleZ + kLength}, 4 * rate);
  }
  add_object(scene, "partitions", std::move(out), m.fabric);
}

/// Makes things of a cubicle in its own coordinates (x along the back partition, z into the room) and places
/// each in both cubicles.
class CubicleBuilder {
 public:
  CubicleBuilder(Scene& scene, int rate) : scene_(scene), rate_(rate) {}

  int rate() const { return rate_; }

  void add(const std::string& name, Primitive out, uint32_t material) {
    const uint32_t mesh = add_object(scene_, name, std::move(out), material);
    scene_.instances.back().transform = place(0);
    add_instance(scene_, mesh, name + " 2", place(1));
  }

  void add_boxes(const std::string& name, uint32_t material,
                 std::initializer_list<std::array<dvec3, 2>> boxes) {
    Primitive out;
    for (const auto& box : boxes) add_box(out, box[0], box[1], rate_);
    add(name, std::move(out), material);
  }

 private:
  static mat4 place(int cubicle) {
    const double x = kCubicleX + cubicle * (kCubicleWidth + kPartitionThickness);
    return glm::translate(mat4(1), vec3(float(x), 0, float(kCubicleZ)));
  }

  Scene& scene_;
  int rate_;
};

void add_desk(CubicleBuilder& cubicle, const OfficeMaterials& m) {
  Primitive top;
  add_box(top, {0.01, 0.71, 0.01}, {2.99, 0.745, 0.76}, 3 * cubicle.rate());
  add_box(top, {0.01, 0.71, 0.762}, {0.71, 0.745, 2.1}, 2 * cubicle.rate());
  cubicle.add("desk top", std::move(top), m.desk);
  cubicle.add_boxes("desk legs", m.metal,
                    {{dvec3(2.93, 0, 0.06), dvec3(2.97, 0.709, 0.7)},
                     {dvec3(1.6, 0, 0.06), dvec3(1.64, 0.709, 0.7)},
                     {dvec3(0.03, 0, 2.02), dvec3(0.69, 0.709, 2.06)},
                     {dvec3(0.05, 0, 0.05), dvec3(0.09, 0.709, 0.09)}});
  // Pedestal with three drawers and their handles.
  cubicle.add_boxes("drawers", m.plastic,
                    {{dvec3(2.45, 0.04, 0.1), dvec3(2.9, 0.7, 0.68)},
                     {dvec3(2.46, 0.50, 0.682), dvec3(2.89, 0.69, 0.70)},
                     {dvec3(2.46, 0.29, 0.682), dvec3(2.89, 0.48, 0.70)},
                     {dvec3(2.46, 0.06, 0.682), dvec3(2.89, 0.27, 0.70)}});
  cubicle.add_boxes("drawer handles", m.metal,
                    {{dvec3(2.60, 0.60, 0.701), dvec3(2.75, 0.615, 0.72)},
                     {dvec3(2.60, 0.39, 0.701), dvec3(2.75, 0.405, 0.72)},
                     {dvec3(2.60, 0.18, 0.701), dvec3(2.75, 0.195, 0.72)}});
}

void add_shelf(CubicleBuilder& cubicle, const OfficeMaterials& m) {
  cubicle.add_boxes("shelf", m.metal,
                    {{dvec3(0.9, 1.14, 0.005), dvec3(2.7, 1.165, 0.30)},
                     {dvec3(0.88, 1.10, 0.005), dvec3(0.899, 1.5, 0.30)},
                     {dvec3(2.701, 1.10, 0.005), dvec3(2.72, 1.5, 0.30)}});
  Primitive books[3];
  uint32_t state = 1988;  // a linear congruential generator: the same books everywhere
  const auto next = [&] { return double((state = state * 1664525u + 1013904223u) >> 8) / double(1u << 24); };
  for (double x = 0.93; x < 2.3;) {
    const double thickness = 0.02 + 0.035 * next(), height = 0.2 + 0.09 * next(),
                 depth = 0.15 + 0.07 * next();
    add_box(books[size_t(3 * next())], {x, 1.166, 0.02}, {x + thickness, 1.166 + height, 0.02 + depth},
            cubicle.rate());
    x += thickness + 0.002;
  }
  for (size_t i = 0; i < 3; ++i) cubicle.add("books", std::move(books[i]), m.books[i]);
}

void add_terminal(CubicleBuilder& cubicle, const OfficeMaterials& m) {
  // A tube monitor on its foot, the keyboard, and paper beside it.
  const int rate = cubicle.rate();
  Primitive shell, foot, glass;
  const auto cabinet = [](double u, double v) {  // rounded sections that shrink towards the back
    const double angle = 2 * double(kPi) * u, size = 1 - 0.45 * v * v;
    const double c = std::cos(angle), s = std::sin(angle);
    const double round = std::pow(std::pow(std::abs(c), 6) + std::pow(std::abs(s), 6), -1.0 / 6);
    return dvec3(1.35 + 0.21 * size * round * c, 1.0 + 0.175 * size * round * s, 0.52 - 0.38 * v);
  };
  add_surface(shell, {cabinet, true, false, true}, 32 * rate, 6 * rate);
  const auto front = [=](double u, double v) {
    return glm::mix(cabinet(u, 0), dvec3(1.35, 1.0, 0.51), 0.6 * v);
  };
  const auto back = [=](double u, double v) {
    return glm::mix(cabinet(u, 1), dvec3(1.35, 1.0, 0.13), 0.95 * v);
  };
  add_surface(shell, {front, true, false, false}, 32 * rate, 2 * rate);
  add_surface(shell, {back, true, false, true}, 32 * rate, 2 * rate);
  const auto bulge = [](double u, double v) {
    const double x = 2 * u - 1, y = 2 * v - 1;
    return dvec3(1.35 + 0.165 * x, 1.0 + 0.13 * y, 0.525 + 0.012 * (2 - x * x - y * y));
  };
  add_surface(glass, {bulge}, 8 * rate, 6 * rate);
  add_surface(foot, tube({1.35, 0.747, 0.38}, {1.35, 0.85, 0.38}, 0.1), 16 * rate, rate);
  cubicle.add("monitor", std::move(shell), m.plastic);
  cubicle.add("monitor foot", std::move(foot), m.metal);
  cubicle.add("monitor glass", std::move(glass), m.screen);
  Primitive keys;
  add_box(keys, {1.12, 0.747, 0.56}, {1.58, 0.765, 0.73}, rate);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 12; ++column) {
      const dvec3 low(1.14 + 0.035 * column, 0.766, 0.575 + 0.036 * row);
      add_box(keys, low, low + dvec3(0.027, 0.008, 0.027));
    }
  }
  cubicle.add("keyboard", std::move(keys), m.plastic);
  cubicle.add_boxes("papers", m.paper,
                    {{dvec3(1.85, 0.747, 0.3), dvec3(2.06, 0.765, 0.6)},
                     {dvec3(0.2, 0.747, 1.1), dvec3(0.41, 0.752, 1.4)},
                     {dvec3(0.25, 0.747, 1.5), dvec3(0.55, 0.78, 1.71)}});
}

void add_chair(CubicleBuilder& cubicle, const OfficeMaterials& m) {
  const int rate = cubicle.rate();
  const dvec3 centre(1.4, 0, 1.35), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  Primitive soft, frame;
  add_surface(soft,
              pillow(centre + dvec3(0, 0.47, -0.24), centre + dvec3(0, 0.47, 0.24), 0.23 * x, 0.045 * y),
              16 * rate, 8 * rate);
  add_surface(soft, pillow(centre + dvec3(0, 0.62, 0.25), centre + dvec3(0, 1.0, 0.31), 0.21 * x, 0.035 * z),
              16 * rate, 8 * rate);
  add_surface(frame, tube(centre + 0.09 * y, centre + 0.43 * y, 0.025), 10 * rate, 2 * rate);
  add_surface(frame, tube(centre + dvec3(0, 0.43, 0.1), centre + dvec3(0, 0.7, 0.30), 0.015), 8 * rate,
              2 * rate);
  for (int i = 0; i < 5; ++i) {
    const double angle = 2 * double(kPi) * (i + 0.25) / 5;
    const dvec3 outward(std::cos(angle), 0, std::sin(angle)), aside(-std::sin(angle), 0, std::cos(angle));
    const dvec3 end = centre + 0.28 * outward + 0.075 * y;
    add_surface(frame, pillow(centre + 0.095 * y, end, 0.016 * y, 0.016 * aside), 8 * rate, 3 * rate);
    add_surface(
        frame,
        pillow(end - 0.045 * y - 0.015 * aside, end - 0.045 * y + 0.015 * aside, 0.025 * y, 0.025 * outward),
        10 * rate, 4 * rate);
  }
  cubicle.add("chair cushions", std::move(soft), m.cushion);
  cubicle.add("chair frame", std::move(frame), m.metal);
}

void add_basket(CubicleBuilder& cubicle, const OfficeMaterials& m) {
  const int rate = cubicle.rate();
  const dvec3 foot(2.6, 0.01, 1.1);
  const auto cone = [=](double radius) {
    return [=](double u, double v) {
      const double angle = 2 * double(kPi) * u, r = radius * (1 + 0.25 * v);
      return foot + dvec3(r * std::cos(angle), 0.32 * v, -r * std::sin(angle));
    };
  };
  Primitive out;
  add_surface(out, {cone(0.12), true, false, false}, 20 * rate, 3 * rate);
  add_surface(out, {cone(0.117), true, false, true}, 20 * rate, 3 * rate);
  add_surface(out, ring(foot + dvec3(0, 0.01, 0), {1, 0, 0}, {0, 0, -1}, 0.004, 0.117), 20 * rate, 2 * rate);
  cubicle.add("waste basket", std::move(out), m.metal);
}

Scene build(int rate) {
  Scene scene;
  const OfficeMaterials m = add_office_materials(scene);
  add_shell(scene, m, rate);
  add_partitions(scene, m, rate);
  CubicleBuilder cubicle(scene, rate);
  add_desk(cubicle, m);
  add_shelf(cubicle, m);
  add_terminal(cubicle, m);
  add_chair(cubicle, m);
  add_basket(cubicle, m);
  add_camera(scene, {5.0f, 1.95f, 5.2f}, {3.1f, 0.85f, 1.2f}, 52, 4.0f / 3);
  return scene;
}

}  // namespace

Scene office(uint64_t triangles) {
  Scene scene = build(1);
  const int rate = rate_for(triangles, scene.triangle_count());
  return rate == 1 ? scene : build(rate);
}

}  // namespace goldthread::procedural
