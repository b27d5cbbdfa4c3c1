#include "goldthread/compare.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/parallel.h"
#include "files/atomic_file.h"
#include "files/file_name.h"
#include "files/image_read.h"
#include "files/image_write.h"
#include "files/solution_file.h"
#include "math/colour.h"
#include "scene/light_atlas_lookup.h"
#include "scene/lighting_lookup.h"
#include "session/error_measure.h"
#include "session/mapped_texels.h"
#include "session/watched.h"
#include "trace/irradiance_estimate.h"
#include "trace/lens.h"
#include "trace/preview.h"

namespace goldthread {
namespace {

constexpr uint64_t kUsualSamples = 1024;

Error usage(std::string message, std::string cure, std::string file = {}) {
  return Error{ErrorCode::kUsage, std::move(message), std::move(file), {}, std::move(cure)};
}

// A solution that can be asked for its light at a receiver of a scene with the same triangles.
struct Answer {
  Solution solution;
  std::unique_ptr<TracedScene> traced;
  std::unique_ptr<LightingLookup> lookup;
  std::unique_ptr<LightAtlasLookup> maps;  ///< where light is to be read from these

  std::optional<vec3> at(const TracedScene& scene, const Receiver& r) const {
    const TracedTriangle& triangle = scene.triangles()[r.triangle];
    const TracedPart& part = scene.parts()[triangle.part];
    if (maps) return maps->irradiance(part.instance, part.primitive, triangle.source, r.weights, r.back);
    return lookup->irradiance(part.instance, part.primitive, triangle.source, r.weights, r.back);
  }
};

// What the camera sees at the middle of each pixel.
struct View {
  uint32_t width = 0, height = 0;
  std::vector<Receiver> receivers;  ///< of the pixels that show a lit side
  std::vector<uint32_t> pixel;      ///< of each receiver
  std::vector<float> shade;         ///< of each pixel: how it faces the camera, 0 for the background
};

View look(const TracedScene& scene, int wanted_width, int wanted_height) {
  const Camera camera = first_camera(scene.scene());
  View view;
  view.width = static_cast<uint32_t>(std::max(1, wanted_width));
  view.height = picture_height(wanted_height, view.width, camera);
  const Lens lens(camera, view.width, view.height);
  const size_t count = size_t{view.width} * view.height;
  std::vector<Receiver> seen(count);
  view.shade.resize(count);
  parallel_for(count, [&](size_t i) {
    const vec2 at((static_cast<float>(i % view.width) + 0.5f) / static_cast<float>(view.width),
                  (static_cast<float>(i / view.width) + 0.5f) / static_cast<float>(view.height));
    Ray ray = lens.ray(at);
    constexpr int kMostBacks = 64;
    for (int layer = 0; layer < kMostBacks; ++layer) {
      const Meeting met = scene.closest(ray);
      if (met.missed()) return;
      ray.near = met.distance + 4 * scene.epsilon();
      if (!met.live) continue;  // viewers look through backs
      Receiver& r = seen[i];
      r.point = scene.point(met.triangle, met.weights);
      r.normal = met.normal;
      r.origin = r.point + scene.epsilon() * r.normal;
      r.triangle = met.triangle;
      r.weights = met.weights;
      r.back = dot(met.normal, scene.triangles()[met.triangle].normal) < 0;
      turn_to_shading_normal(scene, r);
      view.shade[i] = 0.15f + 0.35f * std::abs(dot(met.normal, ray.direction));
      return;
    }
  });
  for (uint32_t i = 0; i < count; ++i) {
    if (seen[i].triangle == Receiver::kNowhere) continue;
    view.receivers.push_back(seen[i]);
    view.pixel.push_back(i);
  }
  return view;
}

void add_line(std::string& lines, const Measured& m, const Receiver& r, bool buried) {
  lines += fmt::format("{:.7g},{:.7g},{:.7g},{:.5g},{:.5g},{:.5g},{:.6g},{:.6g},{:.3g},{}\n", r.point.x,
                       r.point.y, r.point.z, r.normal.x, r.normal.y, r.normal.z, m.value, m.truth,
                       m.standard_error, buried ? 1 : 0);
}

class Comparison {
 public:
  Comparison(const CompareOptions& options, const BakeListener& listener)
      : options_(options), listener_(listener) {}

  Result<CompareResult> run() {
    if (const Status status = check_options(); !status) return status.error();
    const int threads = options_.threads > 0 ? options_.threads : tbb::info::default_concurrency();
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      static_cast<size_t>(threads));
    const Status status = of_pictures_ ? compare_pictures() : compare_solutions();
    if (!status) return status.error();
    return write();
  }

 private:
  Status check_options();
  Status compare_pictures();
  Status compare_solutions();
  Result<Answer> load(const std::string& file) const;
  Result<std::vector<Measured>> measure(const Answer& first, const Answer* second,
                                        const std::vector<Receiver>& receivers, std::vector<size_t>& which,
                                        uint64_t seed, const MappedTexels* texels = nullptr);
  /// Where `sharing` receivers together are one place of those asked about, each gets its share of samples.
  std::vector<IrradianceSums> trace(const TracedScene& scene, const std::vector<Receiver>& receivers,
                                    uint64_t seed, uint32_t sharing = 1);
  std::vector<IrradianceSums> trace_texels(const TracedScene& scene, const MappedTexels& texels);
  Status paint_solutions(const Answer& first, const Answer* second);
  Status paint(const FloatImage& image);
  Result<CompareResult> write();

  const CompareOptions& options_;
  const BakeListener& listener_;
  const Clock::time_point start_ = Clock::now();
  bool of_pictures_ = false;
  uint64_t rays_ = 0, unlit_ = 0, least_samples_ = 0;
  uint64_t buried_ = 0;
  ErrorFigures figures_, with_buried_;
  CompareResult result_;
};

Status Comparison::check_options() {
  const auto is_solution = [](const std::string& file) { return file_extension(file) == ".gold"; };
  const auto is_picture = [](const std::string& file) {
    const std::string extension = file_extension(file);
    return extension == ".exr" || extension == ".png";
  };
  if (!is_solution(options_.first) && !is_picture(options_.first))
    return usage("cannot tell what this is", "give a .gold solution, or an .exr or .png picture",
                 options_.first);
  of_pictures_ = is_picture(options_.first);
  if (options_.reference) {
    if (!options_.second.empty())
      return usage("--reference stands in the place of a second file", "leave one of them out");
    if (of_pictures_)
      return usage("a picture has no scene to trace", "bake with -o x.gold and compare that", options_.first);
  } else if (options_.second.empty()) {
    return usage("there is nothing to compare with", "give a second file, or --reference");
  } else if (of_pictures_ ? !is_picture(options_.second) : !is_solution(options_.second)) {
    return usage("the two are not of a kind", "compare two .gold files, or two pictures", options_.second);
  }
  if (!options_.picture.empty()) {
    if (file_extension(options_.picture) != ".png")
      return usage("a signed picture is a .png", "end it in .png", options_.picture);
    if (const auto probe = AtomicFile::create(options_.picture); !probe) return probe.error();
  }
  if ((options_.light_maps || options_.texels) && of_pictures_)
    return usage("pictures have no light maps", "leave --light-maps and --texels out", options_.first);
  if (options_.seen && of_pictures_)
    return usage("of pictures every pixel is compared", "leave --seen out", options_.first);
  if (!options_.csv_file.empty() && of_pictures_)
    return usage("pictures have no points to list", "leave --csv out", options_.csv_file);
  for (const std::string& file : {options_.json_file, options_.csv_file})
    if (!file.empty() && file != "-")
      if (const auto probe = AtomicFile::create(file); !probe) return probe.error();
  return Nothing{};
}

Status Comparison::compare_pictures() {
  const Result<FloatImage> first = read_picture(options_.first);
  if (!first) return first.error();
  const Result<FloatImage> second = read_picture(options_.second);
  if (!second) return second.error();
  if (first->width != second->width || first->height != second->height)
    return Error{ErrorCode::kBadInput,
                 fmt::format("is {} x {} pixels, the other {} x {}", second->width, second->height,
                             first->width, first->height),
                 options_.second,
                 {},
                 "make both the same size"};
  std::vector<Measured> places(first->pixels.size());
  FloatImage signs = *first;
  for (size_t i = 0; i < places.size(); ++i)
    places[i] = {dvec3(static_cast<double>(i % first->width), static_cast<double>(i / first->width), 0),
                 static_cast<double>(luminance(first->pixels[i])),
                 static_cast<double>(luminance(second->pixels[i])), 0};
  figures_ = measure_errors(places);
  if (options_.picture.empty()) return Nothing{};
  for (size_t i = 0; i < places.size(); ++i)
    signs.pixels[i] = error_colour(
        (places[i].value - places[i].truth) / std::max({places[i].truth, 0.01 * figures_.mean_truth, 1e-30}),
        options_.full_scale, 0.3f);
  return paint(signs);
}

Result<Answer> Comparison::load(const std::string& file) const {
  Result<Solution> solution = read_solution(file);
  if (!solution) return solution.error();
  Answer answer;
  answer.solution = *std::move(solution);
  if ((options_.light_maps || options_.texels) && !answer.solution.atlas)
    return Error{ErrorCode::kBadInput, "has no light maps", file, {}, "bake it with --output lightmap"};
  return answer;
}

std::vector<IrradianceSums> Comparison::trace(const TracedScene& scene,
                                              const std::vector<Receiver>& receivers, uint64_t seed,
                                              uint32_t sharing) {
  const PathTracer tracer(scene);
  IrradianceEstimate estimate(tracer, receivers, seed);
  StopRules rules;
  const bool open = !options_.samples && !options_.target_error && !options_.time_limit;
  rules.samples = options_.samples.value_or(open ? kUsualSamples : 0);
  rules.samples = (rules.samples + sharing - 1) / sharing;
  rules.target_error = options_.target_error.value_or(0) * std::sqrt(sharing);
  if (options_.time_limit) rules.time_limit = std::max(0.0, *options_.time_limit - since(start_));
  run_watched(
      [&](const CancelToken& cancel) { static_cast<void>(estimate.run(rules, cancel)); },
      [&] {
        if (listener_.cancelled && listener_.cancelled()) result_.cancelled = true;
        return result_.cancelled;
      },
      [&] {
        if (!listener_.on_progress) return;
        const EstimateProgress& now = estimate.progress();
        const double share = now.share, seconds = since(start_);
        listener_.on_progress({"trace", share, static_cast<double>(now.rays) / std::max(1e-3, seconds),
                               now.error, seconds, share > 0.02 ? seconds * (1 - share) / share : -1});
      });
  rays_ += estimate.rays().rays;
  least_samples_ = std::numeric_limits<uint64_t>::max();
  for (const IrradianceSums& sums : estimate.sums()) least_samples_ = std::min(least_samples_, sums.samples);
  return estimate.sums();
}

// What a texel stands for is the mean over what it covers. Its places share the samples that a point gets.
std::vector<IrradianceSums> Comparison::trace_texels(const TracedScene& scene, const MappedTexels& texels) {
  const std::vector<IrradianceSums> places = trace(scene, texels.places, options_.seed, kPlacesInTexel);
  std::vector<IrradianceSums> means(texels.centres.size());
  least_samples_ = std::numeric_limits<uint64_t>::max();
  for (size_t i = 0; i < means.size(); ++i) {
    uint64_t each = std::numeric_limits<uint64_t>::max();  // an unfinished round leaves some with more
    for (size_t p = texels.first[i]; p < texels.first[i + 1]; ++p) each = std::min(each, places[p].samples);
    for (size_t p = texels.first[i]; p < texels.first[i + 1] && each > 0; ++p) {
      const double share = static_cast<double>(each) / static_cast<double>(places[p].samples);
      for (size_t b = 0; b < kBatches; ++b) means[i].batches[b] += share * places[p].batches[b];
      means[i].samples += each;
    }
    least_samples_ = std::min(least_samples_, means[i].samples);
  }
  return means;
}

// `which` receivers both have an answer for.
Result<std::vector<Measured>> Comparison::measure(const Answer& first, const Answer* second,
                                                  const std::vector<Receiver>& receivers,
                                                  std::vector<size_t>& which, uint64_t seed,
                                                  const MappedTexels* texels) {
  std::vector<IrradianceSums> sums(receivers.size());
  const TracedScene& scene = *first.traced;
  if (!second) sums = texels ? trace_texels(scene, *texels) : trace(scene, receivers, seed);
  if (!second && least_samples_ == 0)
    return Error{ErrorCode::kCancelled, "stopped before every point had a sample", options_.first, {}, {}};
  std::vector<Measured> places;
  for (size_t i = 0; i < receivers.size(); ++i) {
    const std::optional<vec3> value = first.at(scene, receivers[i]);
    const IrradianceValue truth = evaluate(sums[i]);
    const std::optional<vec3> other = second ? second->at(*second->traced, receivers[i]) : vec3(truth.mean);
    if (!value || !other) {
      ++unlit_;
      continue;
    }
    const auto error = static_cast<double>(luminance(vec3(truth.standard_error)));
    places.push_back({dvec3(receivers[i].point), static_cast<double>(luminance(*value)),
                      static_cast<double>(luminance(*other)), second ? 0.0 : error});
    which.push_back(i);
  }
  return places;
}

Status Comparison::compare_solutions() {
  Result<Answer> first = load(options_.first);
  if (!first) return first.error();
  const auto prepare = [&](Answer& answer) {
    answer.traced = std::make_unique<TracedScene>(answer.solution.scene);
    answer.lookup = std::make_unique<LightingLookup>(answer.solution.scene, answer.solution.lighting);
    if (options_.light_maps || options_.texels)
      answer.maps = std::make_unique<LightAtlasLookup>(answer.solution.scene, *answer.solution.atlas);
  };
  prepare(*first);
  std::optional<Answer> second;
  if (!options_.reference) {
    Result<Answer> loaded = load(options_.second);
    if (!loaded) return loaded.error();
    second = *std::move(loaded);
    prepare(*second);
    const TracedScene &a = *first->traced, &b = *second->traced;
    const auto same_corners = [&] {
      for (uint32_t t = 0; t < a.triangles().size(); ++t)
        for (int k = 0; k < 3; ++k)
          if (a.corner(t, k) != b.corner(t, k)) return false;
      return true;
    };
    if (a.triangles().size() != b.triangles().size() || a.parts().size() != b.parts().size() ||
        !same_corners())
      return Error{ErrorCode::kBadInput,
                   "is of another scene than the first",
                   options_.second,
                   {},
                   "compare solutions of the same geometry"};
  }
  std::vector<Receiver> receivers;
  MappedTexels texels;
  if (options_.seen) {
    receivers = look(*first->traced, options_.picture_width, options_.picture_height).receivers;
  } else if (options_.texels) {
    texels = mapped_texels(*first->traced, *first->solution.atlas, options_.points,
                           static_cast<uint32_t>(options_.seed));
    receivers = texels.centres;
  } else {
    receivers = random_receivers(*first->traced, options_.points, static_cast<uint32_t>(options_.seed));
    for (Receiver& r : receivers) turn_to_shading_normal(*first->traced, r);
  }
  if (options_.seen && receivers.empty())
    return Error{ErrorCode::kNothingToBake,
                 "its camera sees no surface that takes light",
                 options_.first,
                 {},
                 "leave --seen out, or turn the camera"};
  std::vector<size_t> which;
  const Result<std::vector<Measured>> places =
      measure(*first, second ? &*second : nullptr, receivers, which, options_.seed,
              options_.texels && !options_.seen ? &texels : nullptr);
  if (!places) return places.error();
  // What lies inside solids nobody sees; an error there is told by itself.
  std::vector<Measured> seen;
  std::string lines = "x,y,z,nx,ny,nz,value,truth,standard_error,inside_solid\n";
  for (size_t i = 0; i < places->size(); ++i) {
    const bool buried = is_buried(*first->traced, receivers[which[i]]);
    if (!buried) seen.push_back((*places)[i]);
    if (!options_.csv_file.empty()) add_line(lines, (*places)[i], receivers[which[i]], buried);
  }
  if (!options_.csv_file.empty()) {
    const Status status = write_file_atomically(
        options_.csv_file, {reinterpret_cast<const uint8_t*>(lines.data()), lines.size()});
    if (!status) return status.error();
    result_.written.push_back(options_.csv_file);
  }
  buried_ = places->size() - seen.size();
  figures_ = measure_errors(seen);
  if (buried_ > 0) with_buried_ = measure_errors(*places);
  if (seen.empty())
    return Error{
        ErrorCode::kNothingToBake, "no light on any of its surfaces", options_.first, {}, "bake it again"};
  if (unlit_ > 0)
    result_.warnings.push_back(
        fmt::format("{} of {} points lie where a solution has no light: left out", unlit_, receivers.size()));
  const uint64_t samples = least_samples_;
  if (!options_.picture.empty() && !result_.cancelled)
    if (const Status status = paint_solutions(*first, second ? &*second : nullptr); !status) return status;
  least_samples_ = samples;
  return Nothing{};
}

Status Comparison::paint_solutions(const Answer& first, const Answer* second) {
  const View view = look(*first.traced, options_.picture_width, options_.picture_height);
  FloatImage image;
  image.width = view.width;
  image.height = view.height;
  for (const float shade : view.shade) image.pixels.emplace_back(shade);
  if (!view.receivers.empty()) {
    std::vector<size_t> which;
    const Result<std::vector<Measured>> places =
        measure(first, second, view.receivers, which, options_.seed + 1);
    if (!places) return places.error();
    for (size_t i = 0; i < places->size(); ++i) {
      const Measured& m = (*places)[i];
      // Only what the reference is sure of: noise would be red and blue everywhere.
      const double off = m.value - m.truth,
                   sure = std::copysign(std::max(0.0, std::abs(off) - 2 * m.standard_error), off);
      const uint32_t pixel = view.pixel[which[i]];
      image.pixels[pixel] = error_colour(sure / std::max({m.truth, 0.01 * figures_.mean_truth, 1e-30}),
                                         options_.full_scale, view.shade[pixel]);
    }
  }
  return paint(image);
}

Status Comparison::paint(const FloatImage& image) {
  if (const Status status = write_png(options_.picture, image); !status) return status;
  result_.written.push_back(options_.picture);
  return Nothing{};
}

Result<CompareResult> Comparison::write() {
  nlohmann::ordered_json json = as_json(figures_);
  if (options_.reference) {
    json["samples"] = least_samples_;
    json["rays"] = rays_;
    json["seconds"] = since(start_);
  }
  json["points_inside_solids"] = buried_;
  if (buried_ > 0) json["with_points_inside_solids"] = as_json(with_buried_);
  json["seed"] = options_.seed;
  json["warnings"] = result_.warnings;
  result_.json = json.dump(2) + "\n";
  result_.summary = as_text(figures_, of_pictures_ ? "(pixels)" : "lx");
  if (buried_ > 0)
    result_.summary +=
        fmt::format("inside solids {} points, left out above; with them RMSE / mean {:.3g} %\n", buried_,
                    100 * with_buried_.relative_rmse);
  if (options_.reference)
    result_.summary += fmt::format("reference     {} samples a point, {:.1f} million rays, {:.1f} s\n",
                                   least_samples_, 1e-6 * static_cast<double>(rays_), since(start_));
  if (!options_.json_file.empty() && options_.json_file != "-") {
    const Status status = write_file_atomically(
        options_.json_file, {reinterpret_cast<const uint8_t*>(result_.json.data()), result_.json.size()});
    if (!status) return status.error();
    result_.written.push_back(options_.json_file);
  }
  return std::move(result_);
}

}  // namespace

Result<CompareResult> compare(const CompareOptions& options, const BakeListener& listener) {
  return Comparison(options, listener).run();
}

}  // namespace goldthread
