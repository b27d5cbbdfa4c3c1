#include "trace/reference_image.h"

#include <tbb/global_control.h>

#include "trace/preview.h"
#include "trace/traced.h"

namespace goldthread {
namespace {

using namespace test;

ReferenceImage render(const Traced& t, int width, uint64_t samples, uint64_t seed = 0) {
  ReferenceImageOptions options;
  options.width = width;
  options.seed = seed;
  options.stop.samples = samples;
  EstimateProgress progress;
  return trace_reference_image(*t.tracer, options, CancelToken(), progress);
}

// Everything glows alike: B / pi = (1 + 0.5 * 2) / pi nits wherever one looks.
TEST(ReferenceImage, FurnaceIsEven) {
  const Traced t(procedural("furnace"));
  const ReferenceImage picture = render(t, 12, 256);
  EXPECT_EQ(picture.image.width, 12u);
  EXPECT_EQ(picture.image.height, 8u);  // the camera's aspect of 1.5
  EXPECT_EQ(picture.least_samples, 256u);
  double mean = 0;
  for (const vec3& nits : picture.image.pixels) mean += double(nits.x) / double(picture.image.pixels.size());
  EXPECT_NEAR(mean * double(kPi) / 2, 1, 0.01);
  EXPECT_GT(picture.relative_error, 0);
  EXPECT_LT(picture.relative_error, 0.05);
}

TEST(ReferenceImage, SameForAnyNumberOfThreads) {
  const Traced t(procedural("cornell-box"));
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 4);
  const ReferenceImage many = render(t, 16, 32);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(render(t, 16, 32).image.pixels, many.image.pixels);
  EXPECT_NE(render(t, 16, 32, 1).image.pixels, many.image.pixels);
}

// With the light that was measured at vertices, a preview shows the same: it shares the camera.
TEST(ReferenceImage, ShowsWhatAPreviewShows) {
  Scene scene;
  add(scene, square(1, 0, true), diffuse(vec3(0.5f, 0.25f, 0.9f)));
  scene.sky.radiance = vec3(10);
  Camera camera;
  camera.position = vec3(0, 0, 5);
  camera.vertical_fov = 0;
  camera.orthographic_height = 4;
  camera.aspect = 1;
  scene.cameras = {camera};
  const Traced t(scene);
  Lighting lighting;
  lighting.primitives.emplace_back();
  lighting.primitives[0].irradiance.assign(4, 10 * kPi * vec3(1));
  const FloatImage preview = render_preview(scene, lighting, {8, 0, 1});
  const ReferenceImage picture = render(t, 8, 1024);
  for (size_t i = 0; i < preview.pixels.size(); ++i)
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(picture.image.pixels[i][k], preview.pixels[i][k], 0.05f * preview.pixels[i][k]) << i;
}

TEST(ReferenceImage, StopsInTimeAndAtAnError) {
  const Traced t(procedural("cornell-box"));
  ReferenceImageOptions options;
  options.width = 64;
  options.stop.time_limit = 0.3;
  EstimateProgress progress;
  EXPECT_EQ(trace_reference_image(*t.tracer, options, CancelToken(), progress).stop_reason,
            StopReason::kTimeLimit);
  options.width = 8;
  options.stop = {};
  options.stop.target_error = 0.1;
  const ReferenceImage picture = trace_reference_image(*t.tracer, options, CancelToken(), progress);
  EXPECT_EQ(picture.stop_reason, StopReason::kTargetError);
  EXPECT_LE(picture.relative_error, 0.1);
  CancelToken cancelled;
  cancelled.cancel();
  EXPECT_EQ(trace_reference_image(*t.tracer, options, cancelled, progress).stop_reason,
            StopReason::kCancelled);
}

}  // namespace
}  // namespace goldthread
