// What lies beside charts: near it is the chart's own, and no filter reads darkness.
#include "represent/fill_empty.h"

#include <gtest/gtest.h>

namespace goldthread {
namespace {

struct Page {
  FloatImage image;
  std::vector<uint8_t> covered;

  explicit Page(uint32_t size) : image{size, size, std::vector<vec3>(size_t{size} * size, vec3(-1))} {
    covered.assign(image.pixels.size(), 0);
  }
  void cover(uint32_t x, uint32_t y, float value) {
    at(x, y) = vec3(value);
    covered[size_t{y} * image.width + x] = 1;
  }
  vec3& at(uint32_t x, uint32_t y) { return image.pixels[size_t{y} * image.width + x]; }
};

TEST(FillEmpty, CoveredTexelsStay) {
  Page page(8);
  page.cover(2, 3, 5);
  page.cover(6, 1, 0.125f);
  fill_empty(page.image, page.covered, 2);
  EXPECT_EQ(page.at(2, 3), vec3(5));
  EXPECT_EQ(page.at(6, 1), vec3(0.125f));
}

TEST(FillEmpty, OneLightFillsThePageWithItself) {
  for (const uint32_t size : {1u, 5u, 8u, 13u}) {
    Page page(size);
    page.cover(size / 2, size / 3, 7);
    fill_empty(page.image, page.covered, 1);
    for (const vec3& pixel : page.image.pixels) EXPECT_NEAR(pixel.x, 7, 1e-5) << size;
  }
}

TEST(FillEmpty, RingsBelongToTheChartBesideThem) {
  // A bright and a dark column, six texels apart: two rings round each are its own, whatever lies beyond.
  Page page(16);
  for (uint32_t y = 0; y < 16; ++y) {
    page.cover(3, y, 10);
    page.cover(10, y, 0);
  }
  fill_empty(page.image, page.covered, 2);
  for (uint32_t y = 0; y < 16; ++y) {
    for (const uint32_t x : {1u, 2u, 4u, 5u}) EXPECT_EQ(page.at(x, y), vec3(10)) << x;
    for (const uint32_t x : {8u, 9u, 11u, 12u}) EXPECT_EQ(page.at(x, y), vec3(0)) << x;
  }
}

TEST(FillEmpty, WhatIsFarLiesBetweenWhatIsAround) {
  Page page(32);
  for (uint32_t y = 0; y < 32; ++y) {
    page.cover(0, y, 2);
    page.cover(31, y, 4);
  }
  fill_empty(page.image, page.covered, 0);
  for (uint32_t y = 0; y < 32; ++y)
    for (uint32_t x = 0; x < 32; ++x) {
      EXPECT_GE(page.at(x, y).x, 2 - 1e-5);
      EXPECT_LE(page.at(x, y).x, 4 + 1e-5);
    }
  EXPECT_LT(page.at(4, 16).x, page.at(27, 16).x);
}

TEST(FillEmpty, NothingCoveredIsBlack) {
  Page page(4);
  fill_empty(page.image, page.covered, 2);
  for (const vec3& pixel : page.image.pixels) EXPECT_EQ(pixel, vec3(0));
}

}  // namespace
}  // namespace goldthread
