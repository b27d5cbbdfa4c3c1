#include "math/tone_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "math/colour.h"

namespace goldthread {
namespace {

TEST(ToneMap, EquationFourAtItsFixedPoints) {
  const ToneMap map{2, 5};
  EXPECT_EQ(map(vec3(0)), vec3(0));
  EXPECT_NEAR(map(vec3(2.5f)).x, 1, 1e-6f);  // scaled luminance is white
  EXPECT_NEAR(map(vec3(0.5f)).x, 1 * (1 + 1.0f / 25) / 2, 1e-6f);
  const ToneMap open{1, 1e30f};
  EXPECT_NEAR(open(vec3(3)).x, 0.75f, 1e-6f);  // equation 3
}

TEST(ToneMap, KeepsHueAndRange) {
  const ToneMap map{10, 4};
  const vec3 red = map(vec3(1, 0.5f, 0.25f));
  EXPECT_LE(red.x, 1);
  EXPECT_NEAR(red.y / red.x, 0.5f, 1e-6f);
  EXPECT_NEAR(red.z / red.x, 0.25f, 1e-6f);
  const float inf = std::numeric_limits<float>::infinity();
  for (const vec3& odd : {vec3(inf), vec3(std::nanf("")), vec3(-1), vec3(1e38f)}) {
    const vec3 shown = map(odd);
    for (int c = 0; c < 3; ++c) EXPECT_TRUE(shown[c] >= 0 && shown[c] <= 1) << odd.x;
  }
}

TEST(ToneMap, LogAverageMapsToTheKey) {
  // The log average of 1 and 100 is 10; black and broken pixels do not count.
  const std::vector<vec3> nits{vec3(1), vec3(100), vec3(0), vec3(0), vec3(std::nanf(""))};
  EXPECT_NEAR(choose_tone_map(nits, 0.18f).scale, 0.018f, 1e-6f);
  EXPECT_NEAR(choose_tone_map(nits, 0.36f).scale, 0.036f, 1e-6f);
  EXPECT_EQ(choose_tone_map(nits, 0.18f, 2.5f).scale, 2.5f);
}

TEST(ToneMap, NearlyBlackHalvesOfPicturesDoNotMoveTheExposure) {
  // A lit room seen through a window: two decades of luminance, and around it a wall without light, on which
  // there is a little all the same.
  std::vector<vec3> nits;
  for (int i = 0; i < 1000; ++i) nits.emplace_back(2 * std::pow(10.0f, static_cast<float>(i % 100) / 50.0f));
  const ToneMap alone = choose_tone_map(nits);
  for (const float wall : {0.0f, 1e-5f, 1e-3f, 0.02f}) {
    std::vector<vec3> framed = nits;
    framed.resize(2 * nits.size(), vec3(wall));
    const ToneMap map = choose_tone_map(framed);
    EXPECT_EQ(map.scale, alone.scale) << wall;
    EXPECT_EQ(map.white, alone.white) << wall;
  }
  // Nine tenths of it, too.
  std::vector<vec3> slit = nits;
  slit.resize(10 * nits.size(), vec3(1e-4f));
  EXPECT_EQ(choose_tone_map(slit).scale, alone.scale);
}

TEST(ToneMap, ShadesCountAndLampsInViewDoNotHideThem) {
  // A corner at a fiftieth of the room's light is part of the picture, a lamp's few bright pixels do not make
  // it black.
  std::vector<vec3> nits(500, vec3(50));
  nits.resize(990, vec3(1));
  const double log_mean = (500 * std::log(50.0)) / 990;
  EXPECT_NEAR(choose_tone_map(nits).scale, 0.18 / std::exp(log_mean), 1e-4);
  nits.resize(1000, vec3(1e5f));
  const double with_lamp = (500 * std::log(50.0) + 10 * std::log(1e5)) / 1000;
  EXPECT_NEAR(choose_tone_map(nits).scale, 0.18 / std::exp(with_lamp), 1e-4);
}

TEST(ToneMap, ARoomPastABrightWindowStaysInThePicture) {
  // A fifth of the picture outshines the rest 250 times. Not the window alone is exposed for.
  std::vector<vec3> nits(800, vec3(20));
  nits.resize(1000, vec3(5000));
  const double log_mean = (800 * std::log(20.0) + 200 * std::log(5000.0)) / 1000;
  EXPECT_NEAR(choose_tone_map(nits).scale, 0.18 / std::exp(log_mean), 1e-4);
}

TEST(ToneMap, WhiteIsNearTheBrightestAndNotTheOutlier) {
  std::vector<vec3> nits(1000);
  for (size_t i = 0; i < nits.size(); ++i) nits[i] = vec3(static_cast<float>(i + 1));
  nits.back() = vec3(1e9f);
  const ToneMap map = choose_tone_map(nits, 0.72f);
  EXPECT_NEAR(map.white / map.scale, 995, 1);
  EXPECT_EQ(choose_tone_map(std::vector<vec3>(10, vec3(7))).white, 1);  // a grey picture is not stretched
}

TEST(ToneMap, TheUnitOfLightDoesNotMatter) {
  std::vector<vec3> nits;
  for (int i = 1; i < 100; ++i) nits.emplace_back(static_cast<float>(i), 2.0f, 0.1f * static_cast<float>(i));
  const ToneMap map = choose_tone_map(nits);
  std::vector<vec3> brighter = nits;
  for (vec3& pixel : brighter) pixel *= 1000;
  const ToneMap other = choose_tone_map(brighter);
  for (size_t i = 0; i < nits.size(); ++i) EXPECT_LT(length(map(nits[i]) - other(brighter[i])), 1e-5f);
}

TEST(ToneMap, BlackPicturesStayBlack) {
  const ToneMap map = choose_tone_map(std::vector<vec3>(4, vec3(0)));
  EXPECT_EQ(map(vec3(0)), vec3(0));
  EXPECT_TRUE(std::isfinite(choose_tone_map({}).scale));
}

}  // namespace
}  // namespace goldthread
