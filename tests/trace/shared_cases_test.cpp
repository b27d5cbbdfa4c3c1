// Radiosity with exact answers, from the shared collection of accuracy cases.
#include <random>

#include "scene/shared_rooms.h"
#include "trace/traced.h"

namespace goldthread {
namespace {

using namespace test;
/// A sphere of so many rings. Its facets lie within the ball, by about this share of the radius at most.
constexpr uint32_t kRings = 96;
constexpr double kFlatness = 0.5 * (3.1416 / kRings) * (3.1416 / kRings);

/// The unit sphere's part for which `keep` holds of a triangle's middle, scaled; seen from inside or outside.
template <typename Keep>
shapes::Soup ball(float radius, bool inside, const Keep& keep) {
  const shapes::Soup whole = shapes::sphere(kRings);
  shapes::Soup part;
  for (const vec3& p : whole.positions) part.positions.push_back(radius * p);
  for (size_t i = 0; i < whole.indices.size(); i += 3) {
    const uint32_t* t = &whole.indices[i];
    const vec3 middle = (whole.positions[t[0]] + whole.positions[t[1]] + whole.positions[t[2]]) / 3.0f;
    if (keep(middle)) part.triangle(t[0], t[1], t[2]);
  }
  return inside ? turned(part) : part;
}

void add_primitive(Scene& scene, const Json& primitive) {
  const bool inside = primitive["side"] == "inside";
  const float radius = primitive["radius"].get<float>();
  if (primitive.contains("zones")) {
    for (const auto& zone : primitive["zones"]) {
      const float sign = zone["where"] == "z>0" ? 1.0f : -1.0f;
      add(scene, ball(radius, inside, [&](const vec3& p) { return sign * p.z > 0; }), material_of(zone));
    }
  } else {
    add(scene, ball(radius, inside, [](const vec3&) { return true; }), material_of(primitive));
  }
}

Scene scene_of(const Json& c) {
  Scene scene;
  add_surfaces(scene, c);
  if (c.contains("primitives"))
    for (const auto& primitive : c["primitives"]) add_primitive(scene, primitive);
  if (c.contains("lights"))
    for (const auto& light : c["lights"]) {
      scene.lights.push_back(lamp(LightKind::kPoint, 1, vector_of<vec3>(light["position"])));
      scene.lights.back().intensity = vector_of<vec3>(light["intensity"]);
    }
  return scene;
}

/// Points at random of one part's front.
std::vector<Receiver> points_of(const Traced& t, uint32_t part, size_t count) {
  const TracedPart& p = t.traced->parts()[part];
  std::vector<double> areas;
  for (uint32_t i = 0; i < p.triangle_count; ++i)
    areas.push_back(double(t.traced->area(p.first_triangle + i)));
  std::mt19937 engine(part);
  std::discrete_distribution<uint32_t> choose(areas.begin(), areas.end());
  std::uniform_real_distribution<float> uniform;
  std::vector<Receiver> points(count);
  for (Receiver& r : points) {
    const uint32_t triangle = p.first_triangle + choose(engine);
    vec2 weights(uniform(engine), uniform(engine));
    if (weights.x + weights.y > 1) weights = 1.0f - weights;
    r.point = t.traced->point(triangle, weights);
    r.normal = t.traced->triangles()[triangle].normal;
    r.origin = r.point + t.traced->epsilon() * r.normal;
  }
  return points;
}

// One number for a whole room: where light is the same everywhere, the mean over points of every surface is
// tested, which is sharper than each point by itself and fails by chance no more than once in hundreds of
// cases.
class SharedRoom : public ::testing::TestWithParam<const char*> {};

TEST_P(SharedRoom, UniformRadiosity) {
  const Json c = shared_room(GetParam());
  if (c.is_null()) GTEST_SKIP() << kNoSharedCases;
  const Traced t(scene_of(c));
  size_t part = 0;
  for (const auto& expect : c["expect"]) {
    ASSERT_EQ(expect["quantity"], "uniform_radiosity");
    const Material& m = t.scene->materials[part];
    const IrradianceValue e = t.mean(points_of(t, static_cast<uint32_t>(part), 16), 1024);
    const dvec3 radiosity = vector_of<dvec3>(expect["value"]);
    for (int k = 0; k < 3; ++k) {
      const double reflected = radiosity[k] - double(m.emission[k]) * double(kPi);
      EXPECT_NEAR(double(m.base_colour[k]) * e.mean[k], reflected,
                  double(m.base_colour[k]) * 4 * e.standard_error[k] + 1e-3 * radiosity[k])
          << GetParam() << " surface " << part << " channel " << k;
    }
    ++part;
  }
  EXPECT_EQ(part, t.scene->materials.size());
}

INSTANTIATE_TEST_SUITE_P(Rooms, SharedRoom,
                         ::testing::Values("gi-p-furnace-cube", "gi-p-furnace-lroom", "gi-p-furnace-facet8",
                                           "gi-p-hetero-lroom", "gi-p-hetero-facet8"),
                         CaseName());

/// Cases that give irradiance at points.
class SharedPoints : public ::testing::TestWithParam<const char*> {};

TEST_P(SharedPoints, Irradiance) {
  const Json c = shared_room(GetParam());
  if (c.is_null()) GTEST_SKIP() << kNoSharedCases;
  const Traced t(scene_of(c));
  size_t checked = 0;
  for (const auto& expect : c["expect"]) {
    if (!expect.contains("point")) continue;
    const vec3 normal = vector_of<vec3>(expect["normal"]);
    expect_estimates(t.at(vector_of<vec3>(expect["point"]), normal, 16384, checked),
                     vector_of<dvec3>(expect["value"]), 0.01,
                     c.contains("primitives") ? 4 * kFlatness : 1e-3);
    ++checked;
  }
  EXPECT_GT(checked, 0u);
}

INSTANTIATE_TEST_SUITE_P(Points, SharedPoints,
                         ::testing::Values("gi-p-direct-parallel", "gi-p-direct-perp", "gi-p-nori-polylum-1",
                                           "gi-p-nori-polylum-2", "gi-p-nori-polylum-3",
                                           "gi-p-sphere-offcentre-light-1"),
                         CaseName());

/// The mean over a surface: of few samples each at many places, whose spread holds both errors.
IrradianceValue surface_mean(const Traced& t, uint32_t part) {
  constexpr size_t kPoints = 512;
  IrradianceValue mean;
  dvec3 squares(0);
  for (const IrradianceSums& sums : t.sums(points_of(t, part, kPoints), 128)) {
    const dvec3 one = evaluate(sums).mean;
    mean.mean += one / double(kPoints);
    squares += one * one / double(kPoints);
  }
  mean.standard_error = glm::sqrt((squares - mean.mean * mean.mean) / double(kPoints - 1));
  return mean;
}

// Means over surfaces, exact or by another unbiased method with its own standard error.
class SharedMeans : public ::testing::TestWithParam<const char*> {};

TEST_P(SharedMeans, IrradianceOfSurfaces) {
  const Json c = shared_room(GetParam());
  if (c.is_null()) GTEST_SKIP() << kNoSharedCases;
  const Traced t(scene_of(c));
  const std::vector<std::string> names = surface_names(c);
  double squares = 0;
  int checked = 0;
  for (const auto& expect : c["expect"]) {
    if (expect["quantity"] != "mean_irradiance") continue;
    const auto part = std::find(names.begin(), names.end(), expect["surface"]) - names.begin();
    const IrradianceValue e = surface_mean(t, static_cast<uint32_t>(part));
    const double truth = expect["value"][1],
                 own = expect.contains("std_err") ? expect["std_err"][1].get<double>() : 0,
                 error = std::hypot(e.standard_error.y, own) + 1e-4 * truth;
    if (!(error > 0)) {
      EXPECT_EQ(e.mean.y, truth);
      continue;
    }
    EXPECT_NEAR(e.mean.y, truth, 4 * error) << names[size_t(part)];
    squares += std::pow((e.mean.y - truth) / error, 2);
    ++checked;
  }
  // All surfaces together: chi-square with so many degrees of freedom, to its mean and four deviations.
  EXPECT_LT(squares, checked + 4 * std::sqrt(2.0 * checked)) << checked << " surfaces";
  EXPECT_GT(checked, 4);
}

INSTANTIATE_TEST_SUITE_P(Rooms, SharedMeans,
                         ::testing::Values("gi-p-black-box", "gi-p-black-lroom", "gi-p-cube-ceiling",
                                           "gi-p-globillum-room", "gi-p-lroom-colour", "gi-p-cornell-rgb"),
                         CaseName());

// Smooth shapes, finely tessellated: the answer is theirs to the square of the facets' size.
class SharedBalls : public ::testing::TestWithParam<const char*> {};

TEST_P(SharedBalls, UniformRadiosityOfEachPart) {
  const Json c = shared_room(GetParam());
  if (c.is_null()) GTEST_SKIP() << kNoSharedCases;
  const Traced t(scene_of(c));
  uint32_t part = 0;
  for (const auto& expect : c["expect"]) {
    if (expect["quantity"] != "uniform_radiosity") continue;
    const Material& m = t.scene->materials[part];
    const IrradianceValue e = t.mean(points_of(t, part, 16), 2048);
    for (int k = 0; k < 3; ++k) {
      const double reflectance = double(m.base_colour[k]), truth = expect["value"][size_t(k)],
                   got = double(m.emission[k]) * double(kPi) + reflectance * e.mean[k];
      EXPECT_NEAR(got, truth, 3 * reflectance * e.standard_error[k] + 4 * kFlatness * truth);
      EXPECT_LT(e.standard_error[k], 0.01 * e.mean[k]);
    }
    ++part;
  }
  EXPECT_EQ(part, t.scene->materials.size());
}

INSTANTIATE_TEST_SUITE_P(Balls, SharedBalls,
                         ::testing::Values("gi-p-sphere-point-light", "gi-p-sphere-emitting",
                                           "gi-p-sphere-two-zones", "gi-p-concentric-spheres-1"),
                         CaseName());

}  // namespace
}  // namespace goldthread
