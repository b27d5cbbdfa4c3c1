// The Cornell box. Vertices in millimetres as published on the data page of the Cornell University Program of
// Computer Graphics. The light lies in the ceiling's plane and the ceiling is cut round it. The data page
// gives spectra; the linear RGB here are the values that most renderers share for it.
#include "scene/procedural/scenes.h"
#include "scene/procedural/shapes.h"

namespace goldthread::procedural {
namespace {

using Quad = std::array<dvec3, 4>;

constexpr double kMetresPerMillimetre = 0.001;

// Light radiance 17, 12, 4 in the usual relative units, here 200 nits each: 2500 nits, as a bright ceiling
// panel.
const vec3 kLightNits = 200.0f * vec3(17, 12, 4);

void add_quads(Scene& scene, const char* name, std::initializer_list<Quad> quads, uint32_t material,
               int rate) {
  Primitive out;
  for (const Quad& q : quads) {
    add_quad(out,
             {q[0] * kMetresPerMillimetre, q[1] * kMetresPerMillimetre, q[2] * kMetresPerMillimetre,
              q[3] * kMetresPerMillimetre},
             rate);
  }
  add_object(scene, name, std::move(out), material);
}

void add_blocks(Scene& scene, uint32_t white, int rate) {
  add_quads(scene, "short block",
            {Quad{dvec3(130, 165, 65), {82, 165, 225}, {240, 165, 272}, {290, 165, 114}},
             Quad{dvec3(290, 0, 114), {290, 165, 114}, {240, 165, 272}, {240, 0, 272}},
             Quad{dvec3(130, 0, 65), {130, 165, 65}, {290, 165, 114}, {290, 0, 114}},
             Quad{dvec3(82, 0, 225), {82, 165, 225}, {130, 165, 65}, {130, 0, 65}},
             Quad{dvec3(240, 0, 272), {240, 165, 272}, {82, 165, 225}, {82, 0, 225}}},
            white, rate);
  add_quads(scene, "tall block",
            {Quad{dvec3(423, 330, 247), {265, 330, 296}, {314, 330, 456}, {472, 330, 406}},
             Quad{dvec3(423, 0, 247), {423, 330, 247}, {472, 330, 406}, {472, 0, 406}},
             Quad{dvec3(472, 0, 406), {472, 330, 406}, {314, 330, 456}, {314, 0, 456}},
             Quad{dvec3(314, 0, 456), {314, 330, 456}, {265, 330, 296}, {265, 0, 296}},
             Quad{dvec3(265, 0, 296), {265, 330, 296}, {423, 330, 247}, {423, 0, 247}}},
            white, rate);
}

}  // namespace

Scene cornell_box(uint64_t triangles) {
  constexpr uint64_t kPublished = 38;
  const int rate = rate_for(triangles, kPublished);
  Scene scene;
  const uint32_t white = add_material(scene, "white", {0.725f, 0.71f, 0.68f});
  const uint32_t red = add_material(scene, "red", {0.63f, 0.065f, 0.05f});
  const uint32_t green = add_material(scene, "green", {0.14f, 0.45f, 0.091f});
  const uint32_t light = add_material(scene, "light", vec3(0.78f), kLightNits);

  add_quads(scene, "floor", {Quad{dvec3(552.8, 0, 0), {0, 0, 0}, {0, 0, 559.2}, {549.6, 0, 559.2}}}, white,
            rate);
  add_quads(scene, "light",
            {Quad{dvec3(343, 548.8, 227), {343, 548.8, 332}, {213, 548.8, 332}, {213, 548.8, 227}}}, light,
            rate);
  add_quads(scene, "ceiling",
            {Quad{dvec3(556, 548.8, 0), {556, 548.8, 559.2}, {343, 548.8, 559.2}, {343, 548.8, 0}},
             Quad{dvec3(213, 548.8, 0), {213, 548.8, 559.2}, {0, 548.8, 559.2}, {0, 548.8, 0}},
             Quad{dvec3(343, 548.8, 0), {343, 548.8, 227}, {213, 548.8, 227}, {213, 548.8, 0}},
             Quad{dvec3(343, 548.8, 332), {343, 548.8, 559.2}, {213, 548.8, 559.2}, {213, 548.8, 332}}},
            white, rate);
  add_quads(scene, "back wall",
            {Quad{dvec3(549.6, 0, 559.2), {0, 0, 559.2}, {0, 548.8, 559.2}, {556, 548.8, 559.2}}}, white,
            rate);
  add_quads(scene, "right wall", {Quad{dvec3(0, 0, 559.2), {0, 0, 0}, {0, 548.8, 0}, {0, 548.8, 559.2}}},
            green, rate);
  add_quads(scene, "left wall",
            {Quad{dvec3(552.8, 0, 0), {549.6, 0, 559.2}, {556, 548.8, 559.2}, {556, 548.8, 0}}}, red, rate);
  add_blocks(scene, white, rate);

  // Film 25 mm, focal length 35 mm, square picture: 2 atan(12.5 / 35) degrees.
  add_camera(scene, {0.278f, 0.273f, -0.8f}, {0.278f, 0.273f, 0}, 39.3077f, 1);
  return scene;
}

}  // namespace goldthread::procedural
