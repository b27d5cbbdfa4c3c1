// Photometric files that we write are those that we read.
#include "files/ies_write.h"

#include <gtest/gtest.h>

#include "files/ies_read.h"
#include "scene/small_profiles.h"

namespace goldthread {
namespace {

LightProfile read(const std::string& text) {
  Result<LightProfile> profile = parse_ies(text, "a.ies");
  if (!profile) throw std::runtime_error(profile.error().line() + "\n" + text);
  return *std::move(profile);
}

TEST(IesWrite, WhatIsWrittenIsReadBack) {
  const auto uneven = [](double v, double h) { return 100 + v + 0.1 * h; };
  for (const std::string& text :
       {test::lopsided_ies(), test::lopsided_type_b_ies(), test::ies_text(1, {0, 30, 60}, {0}, uneven),
        test::ies_text(1, {0, 60, 180}, {90, 120, 270}, uneven),
        test::ies_text(1, {0, 90}, {0, 120, 240}, uneven), test::ies_text(1, {90, 180}, {0, 45, 90}, uneven),
        test::ies_text(2, {-20, 0, 50}, {-30, 0, 10}, uneven)}) {
    const LightProfile before = read(text), after = read(ies_text(before, 2));
    EXPECT_EQ(after.pole, before.pole);
    for (int i = 0; i < 2000; ++i) {
      const double z = 1 - 2 * (i + 0.5) / 2000, turn = 2.399963 * i, r = std::sqrt(1 - z * z);
      const vec3 d(dvec3(r * std::cos(turn), r * std::sin(turn), z));
      EXPECT_NEAR(after.intensity(d), 2 * before.intensity(d), 2e-3f * before.peak()) << text;
    }
  }
}

}  // namespace
}  // namespace goldthread
