// Closed enclosures with an exact answer: every surface emits and reflects alike, so light is equal
// everywhere.
#include <algorithm>
#include <cmath>

#include "scene/procedural/scenes.h"
#include "scene/procedural/shapes.h"

namespace goldthread::procedural {
namespace {

constexpr float kReflectance = 0.5f;
constexpr float kExitance = 1;  // lm/m2

uint32_t add_glowing(Scene& scene) {
  return add_material(scene, "glowing", vec3(kReflectance), vec3(kExitance / kPi));
}

constexpr int kIcosahedronFaces = 20;

/// Corners and faces (outward, counter-clockwise) of the regular icosahedron: three golden rectangles.
struct Icosahedron {
  std::array<dvec3, 12> corners;
  std::array<std::array<int, 3>, kIcosahedronFaces> faces = {
      {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
       {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
       {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

  Icosahedron() {
    const double g = (1 + std::sqrt(5.0)) / 2;
    corners = {dvec3(-1, g, 0), dvec3(1, g, 0), dvec3(-1, -g, 0), dvec3(1, -g, 0),
               dvec3(0, -1, g), dvec3(0, 1, g), dvec3(0, -1, -g), dvec3(0, 1, -g),
               dvec3(g, 0, -1), dvec3(g, 0, 1), dvec3(-g, 0, -1), dvec3(-g, 0, 1)};
  }
};

}  // namespace

Scene furnace(uint64_t triangles) {
  Scene scene;
  const uint32_t glowing = add_glowing(scene);
  Primitive cube;
  add_box(cube, dvec3(-0.5), dvec3(0.5), rate_for(triangles, 12), Facing::kInward);
  add_object(scene, "furnace", std::move(cube), glowing);
  add_camera(scene, {0.4f, 0.3f, 0.45f}, {-0.2f, -0.1f, -0.5f}, 70, 1.5f);
  return scene;
}

Scene sphere(uint64_t triangles) {
  constexpr uint64_t kOwnNumber = 5120;
  const int rate = rate_for(triangles == 0 ? kOwnNumber : triangles, kIcosahedronFaces);
  const Icosahedron icosahedron;
  Primitive ball;
  for (const auto& face : icosahedron.faces) {
    // Corners 1 and 2 change places: the front is inside.
    add_triangle(ball, icosahedron.corners[size_t(face[0])], icosahedron.corners[size_t(face[2])],
                 icosahedron.corners[size_t(face[1])], rate);
  }
  for (size_t i = 0; i < ball.positions.size(); ++i) {
    const dvec3 direction = normalize(dvec3(ball.positions[i]));
    ball.positions[i] = vec3(direction);
    ball.normals[i] = vec3(-direction);
  }
  Scene scene;
  const uint32_t glowing = add_glowing(scene);
  add_object(scene, "sphere", std::move(ball), glowing);
  add_camera(scene, {0, 0, 0.8f}, {0, 0, -1}, 70, 1.5f);
  return scene;
}

}  // namespace goldthread::procedural
