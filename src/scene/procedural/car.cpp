// The car in its studio. The studio is the same at every count; the car's panels share the rest of the
// triangles.
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

#include "scene/procedural/car_parts.h"
#include "scene/procedural/scenes.h"
#include "scene/procedural/shapes.h"

namespace goldthread::procedural {
namespace {

constexpr double kHalfLength = 7, kHalfWidth = 6, kHeight = 5;  // of the studio

CarMaterials add_car_materials(Scene& scene) {
  CarMaterials m{};
  m.paint = add_material(scene, "paint", {0.42f, 0.035f, 0.03f});
  m.glass = add_material(scene, "glass", {0.5f, 0.56f, 0.55f});
  scene.materials[m.glass].alpha = 0.2f;
  scene.materials[m.glass].alpha_mode = AlphaMode::kBlend;
  scene.materials[m.glass].double_sided = true;
  m.trim = add_material(scene, "trim", vec3(0.04f));
  m.metal = add_material(scene, "metal", vec3(0.55f));
  m.rubber = add_material(scene, "rubber", vec3(0.03f));
  m.leather = add_material(scene, "leather", {0.32f, 0.2f, 0.12f});
  m.lining = add_material(scene, "lining", {0.45f, 0.42f, 0.38f});
  m.lamp = add_material(scene, "lamp", vec3(0.75f));
  m.tail_lamp = add_material(scene, "tail lamp", {0.5f, 0.02f, 0.02f});
  return m;
}

/// A softbox: a glowing face on a dark box of 15 cm depth. `corner`, `across` and `up` are of the face, whose
/// front is that of cross(across, up).
void add_softbox(Scene& scene, const std::string& name, const dvec3& corner, const dvec3& across,
                 const dvec3& up, uint32_t glow, uint32_t housing) {
  const dvec3 back = -0.15 * normalize(cross(across, up));
  Primitive face, box;
  add_grid(face, corner, across, up, 2, 2);
  add_grid(box, corner + back, up, across, 1, 1);
  add_grid(box, corner, back, across, 1, 1);
  add_grid(box, corner, up, back, 1, 1);
  add_grid(box, corner + up, across, back, 1, 1);
  add_grid(box, corner + across, back, up, 1, 1);
  add_object(scene, name, std::move(face), glow);
  add_object(scene, name + " housing", std::move(box), housing);
}

void add_softboxes(Scene& scene) {
  const uint32_t housing = add_material(scene, "housing", vec3(0.1f));
  const uint32_t overhead = add_material(scene, "overhead glow", vec3(0.5f), vec3(3000));
  const uint32_t warm = add_material(scene, "warm glow", vec3(0.5f), vec3(4200, 3600, 2900));
  const uint32_t cool = add_material(scene, "cool glow", vec3(0.5f), vec3(2300, 2600, 3000));
  add_softbox(scene, "overhead softbox", {-2, 3.6, -1}, {4, 0, 0}, {0, 0, 2}, overhead, housing);
  add_softbox(scene, "warm softbox", {5.2, 0.8, 1.2}, {0, 0, 2.4}, {-0.5, 2.2, 0}, warm, housing);
  add_softbox(scene, "cool softbox", {-5.2, 0.8, 3.2}, {0, 0, -2.4}, {0.5, 2.2, 0}, cool, housing);
}

void add_studio(Scene& scene) {
  const uint32_t floor = add_material(scene, "studio floor", vec3(0.35f));
  const uint32_t backdrop = add_material(scene, "backdrop", vec3(0.6f));
  const uint32_t wall = add_material(scene, "studio wall", vec3(0.3f));

  Primitive ground;
  add_grid(ground, {-kHalfLength, 0, kHalfWidth}, {2 * kHalfLength, 0, 0}, {0, 0, -2 * kHalfWidth}, 14, 12);
  add_object(scene, "studio floor", std::move(ground), floor);

  Primitive cove;  // from the floor up in a quarter circle, then straight
  add_surface(cove, {[](double u, double v) {
                constexpr double kRadius = 1.5, kFoot = -3.8;
                const double angle = std::min(1.0, 2 * v) * double(kPi) / 2,
                             rise = std::max(0.0, 2 * v - 1) * 2.4;
                return dvec3(kHalfLength * (2 * u - 1), 0.002 + kRadius * (1 - std::cos(angle)) + rise,
                             kFoot - kRadius * std::sin(angle));
              }},
              14, 24);
  add_object(scene, "backdrop", std::move(cove), backdrop);

  Primitive walls;
  const dvec3 up(0, kHeight, 0);
  add_grid(walls, {-kHalfLength, 0, -kHalfWidth}, {2 * kHalfLength, 0, 0}, up, 14, 5);
  add_grid(walls, {kHalfLength, 0, kHalfWidth}, {-2 * kHalfLength, 0, 0}, up, 14, 5);
  add_grid(walls, {-kHalfLength, 0, kHalfWidth}, {0, 0, -2 * kHalfWidth}, up, 12, 5);
  add_grid(walls, {kHalfLength, 0, -kHalfWidth}, {0, 0, 2 * kHalfWidth}, up, 12, 5);
  add_grid(walls, {-kHalfLength, kHeight, -kHalfWidth}, {2 * kHalfLength, 0, 0}, {0, 0, 2 * kHalfWidth}, 14,
           12);
  add_object(scene, "studio walls", std::move(walls), wall);
}

Primitive tessellate(const Panel& panel) {
  Primitive out;
  add_surface(out, panel.surface, panel.rate_u, panel.rate_v);
  out.material = panel.material;
  return out;
}

void add_wheels(Scene& scene, const std::vector<Panel>& panels) {
  Mesh wheel;
  wheel.name = "wheel";
  for (const Panel& panel : panels) {
    wheel.primitives.push_back(tessellate(panel));
    wheel.primitives.back().source_primitive = static_cast<uint32_t>(wheel.primitives.size() - 1);
  }
  scene.meshes.push_back(std::move(wheel));
  const auto mesh = static_cast<uint32_t>(scene.meshes.size() - 1);
  for (const double axle : {kFrontAxle, kRearAxle}) {
    for (const double side : {1.0, -1.0}) {
      const mat4 place = glm::translate(mat4(1), vec3(dvec3(axle, kWheelRadius + 0.002, side * kTrack)));
      const mat4 turn = side > 0 ? mat4(1) : glm::rotate(mat4(1), kPi, vec3(0, 1, 0));
      add_instance(scene, mesh, axle > 0 ? "front wheel" : "rear wheel", place * turn);
    }
  }
}

}  // namespace

Scene car(uint64_t triangles) {
  constexpr uint64_t kOwnNumber = 250'000;
  Scene scene;
  const CarMaterials materials = add_car_materials(scene);
  add_studio(scene);
  add_softboxes(scene);
  const uint64_t studio = scene.triangle_count();

  PanelList body, wheel;
  add_car_body(body, materials);
  add_car_interior(body, materials);
  add_car_wheel(wheel, materials);
  std::vector<Panel*> all;
  for (Panel& panel : body.panels()) all.push_back(&panel);
  for (Panel& panel : wheel.panels()) {
    panel.copies = 4;
    all.push_back(&panel);
  }
  const uint64_t wished = triangles == 0 ? kOwnNumber : triangles;
  choose_rates(all, std::max(wished, studio) - studio);

  for (const Panel& panel : body.panels()) add_object(scene, panel.name, tessellate(panel), panel.material);
  add_wheels(scene, wheel.panels());
  add_camera(scene, {4.0f, 1.55f, 4.6f}, {0.1f, 0.55f, 0}, 36, 16.0f / 9);
  return scene;
}

}  // namespace goldthread::procedural
