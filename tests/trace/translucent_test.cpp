// Paths through translucent sheets, where the light is known.
#include "scene/translucent_scenes.h"
#include "trace/path_tracer.h"
#include "trace/traced.h"

namespace goldthread {
namespace {

using namespace test;

TEST(TracedTranslucent, TwoRoomsHaveTheirKnownLight) {
  const Traced t(parted_rooms());
  // On the floors, and on both sides of the sheet.
  const vec3 up(0, 0, 1), along(1, 0, 0);
  expect_estimates(t.at({0.7f, 1, 0}, up, 65536), dvec3(kBehindSheet), 0.01);
  expect_estimates(t.at({3.1f, 1, 0}, up, 65536), dvec3(kBeforeSheet), 0.01);
  expect_estimates(t.at({2, 1.1f, 0.9f}, along, 65536), dvec3(kBeforeSheet), 0.01);
  expect_estimates(t.at({2, 1.1f, 0.9f}, -along, 65536), dvec3(kBehindSheet), 0.01);
}

TEST(TracedTranslucent, ReceiversAreOnBothSides) {
  const Traced t(parted_rooms());
  int backs = 0;
  for (const Receiver& r : random_receivers(*t.traced, 200, 1)) backs += r.back ? 1 : 0;
  EXPECT_GT(backs, 0);
}

TEST(TracedTranslucent, CameraSeesWhatComesThrough) {
  const Traced t(parted_rooms());
  const CameraPath path{{vec3(0.5f, 1.1f, 0.9f), vec3(1, 0.01f, 0.02f)}, {}};
  dvec3 sum(0);
  constexpr int kPaths = 4000;
  for (uint32_t i = 0; i < kPaths; ++i) {
    CameraPath one = path;
    one.seed = {i, 3};
    vec3 nits;
    PathCost cost;
    t.tracer->radiance({&one, 1}, {&nits, 1}, cost);
    sum += dvec3(nits) / double(kPaths);
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] * double(kPi) / double(kBehindSheet[c]), 1, 0.05) << c;
}

}  // namespace
}  // namespace goldthread
