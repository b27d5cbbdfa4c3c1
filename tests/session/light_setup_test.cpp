// What a bake says about its light before and after.
#include "session/light_setup.h"

#include <gtest/gtest.h>

#include <limits>

namespace goldthread {
namespace {

TEST(IrradianceRange, OfBothSides) {
  Lighting lighting;
  lighting.primitives.resize(2);
  lighting.primitives[0].irradiance = {vec3(2), vec3(5)};
  lighting.primitives[1].irradiance = {vec3(3)};
  lighting.primitives[1].irradiance_back = {vec3(1)};
  const IrradianceRange range = irradiance_range(lighting);
  EXPECT_NEAR(range.least, 1, 1e-6);
  EXPECT_NEAR(range.most, 5, 1e-6);
  EXPECT_EQ(range.not_finite, 0u);
}

TEST(IrradianceRange, CountsWhatIsNoNumberAndLeavesItOut) {
  Lighting lighting;
  lighting.primitives.resize(1);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  lighting.primitives[0].irradiance = {vec3(nan), vec3(2), vec3(std::numeric_limits<float>::infinity()),
                                       vec3(4)};
  const IrradianceRange range = irradiance_range(lighting);
  EXPECT_NEAR(range.least, 2, 1e-6);
  EXPECT_NEAR(range.most, 4, 1e-6);
  EXPECT_EQ(range.not_finite, 2u);
}

TEST(IrradianceRange, OfNothingIsNought) {
  const IrradianceRange range = irradiance_range({});
  EXPECT_EQ(range.least, 0);
  EXPECT_EQ(range.most, 0);
}

}  // namespace
}  // namespace goldthread
