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

// Stopped behind some pixels, and then by the number of passes: as if it had never stopped.
TEST(ReferenceImage, GoesOnWhereItWas) {
  const Traced t(procedural("cornell-box"));
  const ReferenceImage whole = render(t, 12, 96);
  ReferenceImageOptions options;
  options.width = 12;
  options.stop.samples = 48;
  EstimateProgress progress;
  ReferenceImage part = trace_reference_image(*t.tracer, options, CancelToken(), progress);
  options.before = part.pixels;
  for (size_t i = 0; i < options.before.size(); i += 3)  // a third is a pass ahead
    options.before[i] = render(t, 12, 64).pixels[i];
  options.stop.samples = 96;
  const ReferenceImage resumed = trace_reference_image(*t.tracer, options, CancelToken(), progress);
  EXPECT_EQ(resumed.least_samples, 96u);
  EXPECT_EQ(resumed.most_samples, 96u);
  EXPECT_LT(resumed.rays.rays, whole.rays.rays);
  for (size_t i = 0; i < whole.pixels.size(); ++i) {
    EXPECT_EQ(resumed.image.pixels[i], whole.image.pixels[i]) << i;
    EXPECT_EQ(resumed.pixels[i].squares, whole.pixels[i].squares) << i;
  }
}

TEST(ReferenceImage, SumsComeBackFromWhatIsTold) {
  PixelSums pixel;
  for (const float nits : {3.0f, 5.0f, 4.5f, 0.0f}) pixel.add(dvec3(vec3(nits, nits / 2, 1)));
  const PixelSums again = PixelSums::of(pixel.mean(), pixel.standard_error(), pixel.passes);
  EXPECT_EQ(again.passes, 4u);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(again.sum[k], pixel.sum[k], 1e-6);
  EXPECT_NEAR(again.luminance, pixel.luminance, 1e-5);
  EXPECT_NEAR(again.squares, pixel.squares, 1e-4);
  EXPECT_EQ(PixelSums().standard_error(), 0);
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
