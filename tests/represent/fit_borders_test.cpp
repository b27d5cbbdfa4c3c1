// Filters at charts' edges show the light that is there.
#include "represent/fit_borders.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/light_atlas_lookup.h"

namespace goldthread {
namespace {

struct Edge {
  FloatImage page{16, 16, std::vector<vec3>(256, vec3(0))};
  std::vector<float> trust = std::vector<float>(256, 0.0f);
  std::vector<uint8_t> used = std::vector<uint8_t>(256, 0);
  std::vector<BorderSample> samples;

  vec3 shown(const vec2& at) const { return sample_page(page, at / 16.0f); }
  double worst() const {
    double worst = 0;
    for (const BorderSample& s : samples)
      worst = std::max(worst, double(glm::distance(shown(s.at), s.light)));
    return worst;
  }
};

TEST(FitBorders, ASlantingEdgeShowsALinearLight) {
  Edge edge;
  const auto light = [](const vec2& p) { return vec3(5 + p.x, 2 * p.y, 3); };
  for (int i = 0; i < 40; ++i) {
    const vec2 at = vec2(2, 3) + float(i) / 40 * vec2(11, 7);
    edge.samples.push_back({at, light(at)});
  }
  fit_borders(edge.page, edge.trust, edge.samples, edge.used);
  EXPECT_LT(edge.worst(), 0.02);
  size_t used = 0;
  for (size_t i = 0; i < 256; ++i) {
    used += edge.used[i];
    if (!edge.used[i]) {
      EXPECT_EQ(edge.page.pixels[i], vec3(0));
    }
  }
  EXPECT_GT(used, 20u);
  EXPECT_LT(used, 60u);
}

TEST(FitBorders, TwoChartsShowTheSameOnASharedEdge) {
  // One edge upright between texels, the other slanting elsewhere: the light bends along both.
  const auto light = [](float along) { return vec3(3 + std::sin(3 * along), 1, 1); };
  Edge edge;
  const auto first = [](float along) { return vec2(2.3f, 2 + 10 * along); };
  const auto second = [](float along) { return vec2(6 + 7 * along, 3 + 7 * along); };
  for (int i = 0; i < 30; ++i) {
    const float along = (float(i) + 0.5f) / 30;
    edge.samples.push_back({first(along), light(along)});
    edge.samples.push_back({second(along), light(along)});
  }
  fit_borders(edge.page, edge.trust, edge.samples, edge.used);
  for (int i = 0; i <= 100; ++i) {
    const float along = 0.02f + 0.96f * float(i) / 100;
    EXPECT_NEAR(edge.shown(first(along)).x, edge.shown(second(along)).x, 0.02) << along;
  }
}

TEST(FitBorders, WhatIsKnownWellHardlyMoves) {
  // Samples that contradict a known texel: the one beyond the edge gives way.
  Edge edge;
  for (uint32_t y = 0; y < 16; ++y) {
    edge.page.pixels[16 * y + 4] = vec3(10);
    edge.trust[16 * y + 4] = 1;
    edge.samples.push_back({vec2(5, float(y) + 0.5f), vec3(8)});
  }
  fit_borders(edge.page, edge.trust, edge.samples, edge.used);
  EXPECT_LT(edge.worst(), 0.05);
  for (uint32_t y = 0; y < 16; ++y) {
    EXPECT_NEAR(edge.page.pixels[16 * y + 4].x, 10, 0.1);
    EXPECT_NEAR(edge.page.pixels[16 * y + 5].x, 6, 0.2);
  }
}

TEST(FitBorders, NoTexelBecomesNegative) {
  Edge edge;
  for (uint32_t y = 0; y < 16; ++y) {
    edge.page.pixels[16 * y + 4] = vec3(100);
    edge.trust[16 * y + 4] = 1;
    edge.samples.push_back({vec2(5, float(y) + 0.5f), vec3(0)});
  }
  fit_borders(edge.page, edge.trust, edge.samples, edge.used);
  for (const vec3& pixel : edge.page.pixels) EXPECT_GE(pixel.x, 0);
}

TEST(FitBorders, NoSamplesChangeNothing) {
  Edge edge;
  edge.page.pixels[7] = vec3(3);
  fit_borders(edge.page, edge.trust, {}, edge.used);
  EXPECT_EQ(edge.page.pixels[7], vec3(3));
}

}  // namespace
}  // namespace goldthread
