#include "goldthread/reference.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "files/atomic_file.h"
#include "files/file_name.h"
#include "files/image_write.h"
#include "files/scene_read.h"
#include "math/colour.h"
#include "math/tone_map.h"
#include "session/buried_lamps.h"
#include "session/light_map.h"
#include "session/light_setup.h"
#include "session/profile_facts.h"
#include "session/reference_options.h"
#include "session/reference_picture.h"
#include "session/reference_points.h"
#include "session/requested_lights.h"
#include "session/watched.h"
#include "trace/reference_image.h"

namespace goldthread {
namespace {

using Json = nlohmann::ordered_json;

constexpr uint64_t kUsualSamples = 1024, kUsualPixelSamples = 64;

Status write_out(const std::string& file, const std::string& text) {
  return write_file_atomically(file, {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

const char* name_of(StopReason reason) {
  switch (reason) {
    case StopReason::kSamples:
      return "samples";
    case StopReason::kTargetError:
      return "target_error";
    case StopReason::kTimeLimit:
      return "time_limit";
    case StopReason::kCancelled:
      return "cancelled";
  }
  return "";
}

bool shines(const Scene& scene, const PathTracer& tracer) {
  return scene.sky.present() || tracer.lights().has_emitters() || tracer.lights().has_lamps();
}

// One run from start to end.
class Run {
 public:
  Run(const ReferenceOptions& options, const BakeListener& listener)
      : options_(options), listener_(listener) {}

  Result<ReferenceResult> run() {
    if (const Status status = check_reference_options(options_); !status) return status.error();
    threads_ = options_.threads > 0 ? options_.threads : tbb::info::default_concurrency();
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      static_cast<size_t>(threads_));
    if (const Status status = load(); !status) return status.error();
    if (const Status status = paints(options_) ? paint() : measure(); !status) return status.error();
    if (!options_.report_file.empty()) {
      if (const Status status = write_out(options_.report_file, result_.report); !status)
        return status.error();
      result_.written.push_back(options_.report_file);
    }
    return std::move(result_);
  }

 private:
  Status load();
  Status measure();
  Status paint();
  Status write_shown(const std::string& file, FloatImage picture) const;
  Status resume_picture(ReferenceImageOptions& image_options) const;
  Result<SavedEstimate> receivers();
  Result<SavedEstimate> resumed() const;
  Status lay_out_texels(SavedEstimate& estimate);
  Status write_light_maps(const SavedEstimate& estimate);
  Status write_json(const SavedEstimate& estimate);
  void describe_points(const SavedEstimate& estimate);
  void name_profiles();
  void describe_run(Json& figures, uint64_t rays, double seconds, double ray_share, StopReason reason);
  StopRules rules(uint64_t usual_samples) const;
  template <typename Work>
  void run_watched(const EstimateProgress& progress, const Work& work);

  const ReferenceOptions& options_;
  const BakeListener& listener_;
  const Clock::time_point start_ = Clock::now();
  int threads_ = 1;
  Scene scene_;
  std::unique_ptr<TracedScene> traced_;
  std::unique_ptr<PathTracer> tracer_;
  Json figures_;
  ReferenceResult result_;
};

Status Run::load() {
  if (listener_.on_progress) listener_.on_progress({"load", 0, 0, 0, since(start_), -1});
  Result<Scene> scene = read_scene(options_.input, NormalTextures::kRead);
  if (!scene) return scene.error();
  scene_ = std::move(*scene);
  if (Status status = add_requested_lights(scene_, options_); !status) return status;
  result_.warnings = scene_.warnings;
  traced_ = std::make_unique<TracedScene>(scene_);
  if (traced_->triangles().empty())
    return Error{
        ErrorCode::kNothingToBake, "has no triangles", options_.input, {}, "give a file with a mesh in it"};
  for (const std::string& warning : describe_buried_lamps(scene_, [this](const Ray& ray) {
         const Meeting met = traced_->closest(ray);
         return !met.missed() && !met.live;
       }))
    result_.warnings.push_back(warning);
  tracer_ = std::make_unique<PathTracer>(*traced_);
  if (!shines(scene_, *tracer_))
    return Error{ErrorCode::kNothingToBake,
                 "no light in the scene: nothing emits and there is no lamp",
                 options_.input,
                 {},
                 "add --sky 1000 or --sun 50000, or give a material an emission"};
  if (listener_.cancelled && listener_.cancelled())
    return Error{ErrorCode::kCancelled, "stopped before there was any light to keep", options_.input, {}, {}};
  return Nothing{};
}

StopRules Run::rules(uint64_t usual_samples) const {
  StopRules rules;
  const bool open = !options_.samples && !options_.time_limit && !options_.target_error;
  rules.samples = options_.samples.value_or(open ? usual_samples : 0);
  rules.target_error = options_.target_error.value_or(0);
  if (options_.time_limit) rules.time_limit = std::max(0.0, *options_.time_limit - since(start_));
  return rules;
}

/// Runs `work(cancel)` on a thread of its own while this one tells its progress and listens for a stop.
template <typename Work>
void Run::run_watched(const EstimateProgress& progress, const Work& work) {
  const auto begin = Clock::now();
  goldthread::run_watched(
      work, [&] { return listener_.cancelled && listener_.cancelled(); },
      [&] {
        if (!listener_.on_progress) return;
        const double elapsed = since(begin), share = progress.share;
        listener_.on_progress({"trace", share, static_cast<double>(progress.rays) / std::max(1e-3, elapsed),
                               progress.error, since(start_),
                               share > 0.02 ? elapsed * (1 - share) / share : -1});
      });
}

Result<SavedEstimate> Run::resumed() const {
  Result<SavedEstimate> saved = read_estimate(options_.resume_file);
  if (!saved) return saved.error();
  if (saved->fingerprint != traced_->fingerprint())
    return Error{ErrorCode::kBadInput,
                 "was made of another scene, or under another light",
                 options_.resume_file,
                 {},
                 "give the scene, sky and sun that it was made with"};
  if (options_.seed && *options_.seed != saved->seed)
    return usage_error(
        fmt::format("--seed {} is not the seed that is resumed, {}", *options_.seed, saved->seed),
        "leave --seed out");
  if (!options_.pictures.empty() && saved->layout.width == 0)
    return Error{ErrorCode::kUsage,
                 "holds no texels, of which -o could make light maps",
                 options_.resume_file,
                 {},
                 "leave -o out, or give a file of --texels"};
  return saved;
}

Status Run::lay_out_texels(SavedEstimate& estimate) {
  const ReferenceOptions::Texels& wish = *options_.texels;
  estimate.layout.width = static_cast<uint32_t>(wish.width);
  estimate.layout.height = static_cast<uint32_t>(wish.height);
  if (wish.uv) estimate.layout.uv = static_cast<uint32_t>(*wish.uv);
  TexelReceivers texels = texel_receivers(*traced_, estimate.layout);
  if (texels.receivers.empty() && texels.problems.parts > 0)
    return no_texels(texels, estimate.layout, options_.input);
  for (std::string& line : texel_warnings(texels.problems, estimate.layout))
    result_.warnings.push_back(std::move(line));
  estimate.receivers = std::move(texels.receivers);
  return Nothing{};
}

/// The points to measure, with what is known of them.
Result<SavedEstimate> Run::receivers() {
  SavedEstimate estimate;
  if (!options_.resume_file.empty()) return resumed();
  estimate.seed = options_.seed.value_or(0);
  estimate.fingerprint = traced_->fingerprint();
  if (!options_.points_file.empty()) {
    Result<std::vector<Receiver>> points = read_points(options_.points_file, *traced_);
    if (!points) return points.error();
    estimate.receivers = std::move(*points);
  } else if (options_.texels) {
    if (const Status status = lay_out_texels(estimate); !status) return status.error();
  } else if (options_.vertices) {
    estimate.receivers = vertex_receivers(*traced_);
  } else {
    estimate.receivers =
        random_receivers(*traced_, options_.random_points, static_cast<uint32_t>(estimate.seed));
  }
  if (estimate.receivers.empty())
    return Error{ErrorCode::kNothingToBake,
                 "no surface can receive light",
                 options_.input,
                 {},
                 "every triangle is degenerate or of an unlit material"};
  return estimate;
}

Status Run::measure() {
  Result<SavedEstimate> before = receivers();
  if (!before) return before.error();
  SavedEstimate estimate = std::move(*before);
  IrradianceEstimate tracing(*tracer_, estimate.receivers, estimate.seed, estimate.sums);
  StopReason reason = StopReason::kSamples;
  const auto begin = Clock::now();
  run_watched(tracing.progress(),
              [&](const CancelToken& cancel) { reason = tracing.run(rules(kUsualSamples), cancel); });
  estimate.sums = tracing.sums();
  estimate.rays += tracing.rays().rays;
  const double seconds = since(begin), before_seconds = estimate.seconds;
  estimate.seconds += seconds;
  estimate.ray_time_share =
      (estimate.ray_time_share * before_seconds + tracing.rays().ray_share() * seconds) / estimate.seconds;
  describe_points(estimate);
  if (const Status status = write_light_maps(estimate); !status) return status.error();
  describe_run(figures_, estimate.rays, estimate.seconds, estimate.ray_time_share, reason);
  figures_["seed"] = estimate.seed;
  result_.report = figures_.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  return write_json(estimate);
}

Status Run::write_json(const SavedEstimate& estimate) {
  if (options_.json_file.empty()) return Nothing{};
  result_.json = write_estimate(figures_, estimate);
  if (options_.json_file == "-") return Nothing{};  // the caller prints
  if (const Status status = write_out(options_.json_file, result_.json); !status) return status.error();
  result_.written.push_back(options_.json_file);
  return Nothing{};
}

Status Run::write_light_maps(const SavedEstimate& estimate) {
  if (estimate.layout.width == 0) return Nothing{};
  const std::vector<LightMap> maps = light_maps_of(estimate.receivers);
  figures_["light_maps"] = describe_light_maps(maps, scene_);
  result_.summary += fmt::format("{} light map{} of {} x {} texels\n", maps.size(),
                                 maps.size() == 1 ? "" : "s", estimate.layout.width, estimate.layout.height);
  for (const std::string& file : options_.pictures)
    for (const LightMap& map : maps) {
      const std::string name = light_map_file(file, map, maps.size());
      if (const Status status = write_light_map(name, estimate, map); !status) return status.error();
      result_.written.push_back(name);
    }
  return Nothing{};
}

void Run::describe_points(const SavedEstimate& estimate) {
  uint64_t least = ~uint64_t{0}, most = 0, without = 0;
  double low = std::numeric_limits<double>::infinity(), high = 0, sum = 0;
  for (const IrradianceSums& point : estimate.sums) {
    least = std::min(least, point.samples);
    most = std::max(most, point.samples);
    without += point.samples == 0;
    const auto lux = static_cast<double>(luminance(vec3(evaluate(point).mean)));
    low = std::min(low, lux);
    high = std::max(high, lux);
    sum += lux;
  }
  const auto count = estimate.sums.size();
  const double error = mean_relative_error(estimate.sums), mean = sum / static_cast<double>(count);
  if (without > 0)
    result_.warnings.push_back(fmt::format("{} of {} points have no samples yet", without, count));
  figures_["scene"] = scene_.file;
  name_profiles();
  figures_["samples"] = {{"least", least}, {"most", most}};
  figures_["mean_relative_error"] = error;
  figures_["irradiance_lx"] = {{"least", low}, {"mean", mean}, {"most", high}};
  result_.summary = fmt::format(
      "{} points, {} samples each, mean standard error {:.2g}%\nirradiance {:.4g} to {:.4g} lx, mean {:.4g} "
      "lx\n",
      count, least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most), 100 * error,
      low, high, mean);
}

void Run::name_profiles() {
  if (const auto uses = profiles_in(scene_); !uses.empty()) figures_["light_profiles"] = to_json(uses);
}

void Run::describe_run(Json& figures, uint64_t rays, double seconds, double ray_share, StopReason reason) {
  const double rate = static_cast<double>(rays) * 1e-6 / std::max(1e-9, seconds);
  figures["rays"] = rays;
  figures["seconds"] = seconds;
  figures["mrays_per_second"] = rate;
  figures["ray_time_share"] = ray_share;
  figures["seed"] = options_.seed.value_or(0);
  figures["threads"] = threads_;
  figures["stopped_by"] = name_of(reason);
  figures["warnings"] = result_.warnings;
  result_.cancelled = reason == StopReason::kCancelled;
  result_.summary +=
      fmt::format("{:.1f} Mrays in {:.1f} s, {:.2f} Mrays/s, {:.0f}% of the time in the ray caster\n",
                  static_cast<double>(rays) * 1e-6, seconds, rate, 100 * ray_share);
}

Status Run::resume_picture(ReferenceImageOptions& image_options) const {
  Result<SavedPicture> saved = read_picture_to_go_on(options_.resume_file);
  if (!saved) return saved.error();
  if (saved->fingerprint != picture_fingerprint(*traced_))
    return Error{ErrorCode::kBadInput,
                 "was made of another scene, under another light or by another camera",
                 options_.resume_file,
                 {},
                 "give the scene, sky and sun that it was made with"};
  if (options_.seed && *options_.seed != saved->seed)
    return usage_error(
        fmt::format("--seed {} is not the seed that is resumed, {}", *options_.seed, saved->seed),
        "leave --seed out");
  const bool other_size =
      options_.picture_width != ReferenceOptions().picture_width || options_.picture_height != 0;
  if (other_size &&
      (options_.picture_width != static_cast<int>(saved->width) ||
       (options_.picture_height != 0 && options_.picture_height != static_cast<int>(saved->height))))
    return usage_error(fmt::format("--picture-size is not that of the picture that is resumed, {}x{}",
                                   saved->width, saved->height),
                       "leave --picture-size out");
  image_options.seed = saved->seed;
  image_options.width = static_cast<int>(saved->width);
  image_options.height = static_cast<int>(saved->height);
  image_options.before = std::move(saved->pixels);
  return Nothing{};
}

Status Run::write_shown(const std::string& file, FloatImage picture) const {
  const ToneMap map = choose_tone_map(picture.pixels, 0.18f, static_cast<float>(options_.exposure));
  for (vec3& pixel : picture.pixels) pixel = map(pixel);
  return write_png(file, picture);
}

Status Run::paint() {
  ReferenceImageOptions image_options;
  image_options.width = options_.picture_width;
  image_options.height = options_.picture_height;
  image_options.seed = options_.seed.value_or(0);
  if (resumes_picture(options_))
    if (const Status status = resume_picture(image_options); !status) return status.error();
  EstimateProgress progress;
  ReferenceImage traced;
  const auto begin = Clock::now();
  run_watched(progress, [&](const CancelToken& cancel) {
    image_options.stop = rules(kUsualPixelSamples);
    traced = trace_reference_image(*tracer_, image_options, cancel, progress);
  });
  figures_["scene"] = scene_.file;
  figures_["picture"] = {{"width", traced.image.width}, {"height", traced.image.height}};
  name_profiles();
  figures_["samples"] = {{"least", traced.least_samples}, {"most", traced.most_samples}};
  figures_["mean_relative_error"] = traced.relative_error;
  result_.summary =
      fmt::format("{} x {} pixels, {} samples each, mean standard error {:.2g}%\n", traced.image.width,
                  traced.image.height, traced.least_samples, 100 * traced.relative_error);
  describe_run(figures_, traced.rays.rays, since(begin), traced.rays.ray_share(), traced.stop_reason);
  figures_["seed"] = image_options.seed;
  result_.report = figures_.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  for (const std::string& file : options_.pictures) {
    const Status status = file_extension(file) == ".png" ? write_shown(file, traced.image)
                                                         : write_picture(file, traced, image_options.seed,
                                                                         picture_fingerprint(*traced_));
    if (!status) return status.error();
    result_.written.push_back(file);
  }
  return Nothing{};
}

}  // namespace

Result<ReferenceResult> reference(const ReferenceOptions& options, const BakeListener& listener) {
  try {
    return Run(options, listener).run();
  } catch (const std::bad_alloc&) {
    return Error{
        ErrorCode::kLimit, "ran out of memory", options.input, {}, "try fewer points or a smaller scene"};
  }
}

}  // namespace goldthread
