// Two closed rooms and the corridor between them: light of one colour meets light of another on the way. The
// plan lies on a lattice of 40 cm, so that the whole shell is watertight.
#include <cmath>

#include "scene/procedural/scenes.h"
#include "scene/procedural/shapes.h"

namespace goldthread::procedural {
namespace {

constexpr double kStep = 0.4;
// In lattice units.
constexpr int kRoomSide = 10, kRoomHeight = 7;
constexpr int kCorridorLength = 8, kDoorFirst = 3, kDoorWidth = 4, kDoorHeight = 6;
constexpr int kSecondRoom = kRoomSide + kCorridorLength;

using Cells = std::function<bool(int, int)>;

bool in_door(int column, int row) {
  return column >= kDoorFirst && column < kDoorFirst + kDoorWidth && row < kDoorHeight;
}

/// The light: 2 * 2 cells in the middle of the ceiling.
bool in_panel(int column, int row) {
  return column / 2 == 2 && row / 2 == 2;
}

struct RoomLook {
  uint32_t wall, accent, floor, ceiling, light;
};

/// A room whose corner is at lattice x = x0; its door is in the wall at +x or at -x.
void add_room(Scene& scene, const std::string& name, int x0, bool door_at_high_x, const RoomLook& look,
              int rate) {
  const int s = kRoomSide, h = kRoomHeight;
  const auto add = [&](const char* part, const LatticeRectangle& r, uint32_t material,
                       const Cells& is_hole = {}) {
    Primitive out;
    add_lattice(out, r, kStep, rate, is_hole);
    add_object(scene, name + " " + part, std::move(out), material);
  };
  const LatticeRectangle ceiling{{x0, h, 0}, {1, 0, 0}, {0, 0, 1}, s, s};
  add("floor", {{x0, 0, s}, {1, 0, 0}, {0, 0, -1}, s, s}, look.floor);
  add("ceiling", ceiling, look.ceiling, in_panel);
  add("light", ceiling, look.light, [](int i, int j) { return !in_panel(i, j); });
  add("back wall", {{x0, 0, 0}, {1, 0, 0}, {0, 1, 0}, s, h}, look.accent);
  add("front wall", {{x0 + s, 0, s}, {-1, 0, 0}, {0, 1, 0}, s, h}, look.wall);
  add("low wall", {{x0, 0, s}, {0, 0, -1}, {0, 1, 0}, s, h}, look.wall, door_at_high_x ? Cells{} : in_door);
  add("high wall", {{x0 + s, 0, 0}, {0, 0, 1}, {0, 1, 0}, s, h}, look.wall,
      door_at_high_x ? in_door : Cells{});
}

void add_corridor(Scene& scene, uint32_t wall, uint32_t floor, uint32_t light, int rate) {
  const int x = kRoomSide, z = kDoorFirst, w = kDoorWidth, l = kCorridorLength, h = kDoorHeight;
  const auto is_light = [](int column, int row) {
    return (column == l / 2 || column == l / 2 - 1) && (row == w / 2 || row == w / 2 - 1);
  };
  const LatticeRectangle ceiling{{x, h, z}, {1, 0, 0}, {0, 0, 1}, l, w};
  Primitive ground, walls, panel;
  add_lattice(ground, {{x, 0, z + w}, {1, 0, 0}, {0, 0, -1}, l, w}, kStep, rate);
  add_lattice(walls, {{x, 0, z}, {1, 0, 0}, {0, 1, 0}, l, h}, kStep, rate);
  add_lattice(walls, {{x + l, 0, z + w}, {-1, 0, 0}, {0, 1, 0}, l, h}, kStep, rate);
  add_lattice(walls, ceiling, kStep, rate, is_light);
  add_lattice(panel, ceiling, kStep, rate, [&](int i, int j) { return !is_light(i, j); });
  add_object(scene, "corridor floor", std::move(ground), floor);
  add_object(scene, "corridor walls", std::move(walls), wall);
  add_object(scene, "corridor light", std::move(panel), light);
}

void add_furniture(Scene& scene, int rate) {
  const uint32_t wood = add_material(scene, "wood", {0.45f, 0.28f, 0.15f});
  const uint32_t stone = add_material(scene, "stone", vec3(0.6f));

  Primitive table;
  add_box(table, {1.2, 0.70, 0.5}, {2.8, 0.75, 1.3}, 2 * rate);
  for (const double x : {1.25, 2.67})
    for (const double z : {0.55, 1.17}) add_box(table, {x, 0, z}, {x + 0.08, 0.70, z + 0.08}, rate);
  add_object(scene, "table", std::move(table), wood);

  Primitive column;
  const double x = (kSecondRoom + 6) * kStep, z = 1.0;
  add_surface(column, tube({x, 0, z}, {x, kRoomHeight * kStep, z}, 0.18), 20 * rate, 8 * rate);
  add_object(scene, "column", std::move(column), stone);

  Primitive plinth, ball;
  const dvec3 centre((kSecondRoom + 3) * kStep, 0, 2.9);
  add_box(plinth, centre - dvec3(0.25, 0, 0.25), centre + dvec3(0.25, 0.8, 0.25), 2 * rate);
  add_object(scene, "plinth", std::move(plinth), stone);
  add_surface(ball, torus(centre + dvec3(0, 1.12, 0), {1, 0, 0}, {0, 1, 0}, 0.22, 0.08), 24 * rate,
              12 * rate);
  add_object(scene, "sculpture", std::move(ball), wood);
}

Scene build(int rate) {
  Scene scene;
  const uint32_t white = add_material(scene, "white", {0.75f, 0.74f, 0.72f});
  const uint32_t boards = add_material(scene, "boards", {0.4f, 0.3f, 0.22f});
  const uint32_t tiles = add_material(scene, "tiles", vec3(0.5f));
  const uint32_t ochre = add_material(scene, "ochre", {0.65f, 0.4f, 0.12f});
  const uint32_t blue = add_material(scene, "blue", {0.15f, 0.25f, 0.5f});
  const uint32_t warm = add_material(scene, "warm light", vec3(0.7f), {4800, 3200, 1700});
  const uint32_t cool = add_material(scene, "cool light", vec3(0.7f), {1700, 2700, 4200});
  const uint32_t dim = add_material(scene, "corridor light", vec3(0.7f), vec3(600));
  add_room(scene, "first room", 0, true, {white, ochre, boards, white, warm}, rate);
  add_room(scene, "second room", kSecondRoom, false, {white, blue, tiles, white, cool}, rate);
  add_corridor(scene, white, tiles, dim, rate);
  add_furniture(scene, rate);
  add_camera(scene, {0.35f, 1.65f, 3.3f}, {5.5f, 1.05f, 1.6f}, 55, 16.0f / 9);
  return scene;
}

}  // namespace

Scene two_rooms(uint64_t triangles) {
  Scene scene = build(1);
  const int rate = rate_for(triangles, scene.triangle_count());
  return rate == 1 ? scene : build(rate);
}

}  // namespace goldthread::procedural
