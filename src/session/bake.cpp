#include "goldthread/bake.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "base/rng.h"
#include "element/overlap.h"
#include "files/atomic_file.h"
#include "files/file_name.h"
#include "files/image_write.h"
#include "files/light_map_files.h"
#include "files/scene_read.h"
#include "files/scene_write.h"
#include "files/solution_file.h"
#include "math/tone_map.h"
#include "reconstruct/place_gather.h"
#include "session/buried_lamps.h"
#include "session/effort.h"
#include "session/light_setup.h"
#include "session/mapped_light.h"
#include "session/reference_points.h"
#include "session/report.h"
#include "session/requested_lights.h"
#include "session/solve_session.h"
#include "session/watched.h"
#include "trace/preview.h"
#include "visibility/coincident.h"

namespace goldthread {
namespace {

std::span<const uint8_t> as_bytes(const std::string& text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

// One bake from start to end; the steps in order, each leaving its result and its seconds.
class Bake {
 public:
  Bake(const BakeOptions& options, const BakeListener& listener) : options_(options), listener_(listener) {}

  Result<BakeResult> run() {
    if (const Status status = check_options(); !status) return status.error();
    const int threads = options_.threads > 0 ? options_.threads : tbb::info::default_concurrency();
    report_.threads = threads;
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      static_cast<size_t>(threads));
    if (const Status status = load(); !status) return status.error();
    if (const Status status = preprocess(); !status) return status.error();
    if (const Status status = solve(); !status) return status.error();
    reconstruct_light();
    if (const Status status = represent(); !status) return status.error();
    if (const Status status = write(); !status) return status.error();
    result_.cancelled = cancelled_;
    return std::move(result_);
  }

 private:
  Status check_options() const;
  Status load();
  Status read_places();
  Status preprocess();
  Status build_hierarchies(const CancelToken& stop);
  Status solve();
  void reconstruct_light();
  Status represent();
  Status write();
  Status write_places();
  Status write_one(const std::string& file);
  void finish_report();
  std::string summary() const;
  bool stop_asked() {
    if (listener_.cancelled && listener_.cancelled()) cancelled_ = true;
    return cancelled_;
  }
  void tell(const std::string& stage, double share, double rays_per_second = 0, double error = 0,
            double remaining = -1) {
    if (listener_.on_progress)
      listener_.on_progress({stage, share, rays_per_second, error, since(start_), remaining});
  }
  /// Runs `work(stop)` on a thread of its own, telling `stage` meanwhile; `stop` is raised when the listener
  /// asks to stop, or when `reserve` of the time limit is all that is left. Throws what `work` throws.
  template <typename Work>
  void run_watched(const std::string& stage, double share, double reserve, const Work& work) {
    goldthread::run_watched(
        work, [&] { return stop_asked() || time_left() < reserve * options_.time_limit.value_or(0); },
        [&] { tell(stage, share); });
  }
  bool uses_atlas() const {
    return options_.mode == OutputMode::kLightmap || options_.mode == OutputMode::kBaked ||
           options_.mode == OutputMode::kOcclusion;
  }
  double tolerated() const { return options_.error.value_or(tolerated_error(options_.quality)); }
  double time_left() const {
    return options_.time_limit ? *options_.time_limit - since(start_)
                               : std::numeric_limits<double>::infinity();
  }

  const BakeOptions& options_;
  const BakeListener& listener_;
  const Clock::time_point start_ = Clock::now();
  BakeReport report_;
  BakeResult result_;
  bool cancelled_ = false, out_of_memory_ = false, out_of_time_ = false;

  Scene scene_;
  SurfaceSet surfaces_;
  std::unique_ptr<RayCaster> caster_;
  std::unique_ptr<HierarchicalSolver> solver_;
  Lighting lighting_;
  MappedLight mapped_;                // where uses_atlas()
  std::vector<Receiver> receivers_;   // of options_.points_file
  std::vector<SurfacePlace> places_;  // the same
  std::vector<std::optional<vec3>> light_;
};

Status Bake::check_options() const {
  if (options_.outputs.empty() && options_.points_file.empty() &&
      !(uses_atlas() && !options_.lightmap.files.empty()))
    return Error{ErrorCode::kUsage, "no output given", {}, {}, "add -o lit.glb"};
  if (options_.error && !(*options_.error >= kLeastError && *options_.error <= kMostError))
    return Error{ErrorCode::kUsage,
                 fmt::format("an error of {:g}% cannot be aimed at", 100 * *options_.error),
                 {},
                 {},
                 fmt::format("choose from {:g}% to {:g}%", 100 * kLeastError, 100 * kMostError)};
  if (const Status status = check_lightmap(options_.lightmap); !status) return status;
  for (const std::string& file : options_.outputs) {
    const std::string extension = file_extension(file);
    if (extension != ".glb" && extension != ".gltf" && extension != ".gold" && extension != ".png" &&
        extension != ".exr")
      return Error{ErrorCode::kUsage,
                   "cannot tell the output's format",
                   file,
                   {},
                   "end it in .glb, .gltf, .gold, .png or .exr"};
    // Known before hours are spent on what cannot be kept.
    if (const auto probe = AtomicFile::create(file); !probe) return probe.error();
  }
  if (options_.points_file.empty() != options_.json_file.empty())
    return Error{ErrorCode::kUsage,
                 "needs both points and a file for their light, or neither",
                 {},
                 {},
                 "add --points places.json --json light.json"};
  for (const std::string& file : {options_.report_file, options_.json_file})
    if (!file.empty() && file != "-")
      if (const auto probe = AtomicFile::create(file); !probe) return probe.error();
  return Nothing{};
}

Status Bake::load() {
  tell("load", 0);
  Result<Scene> scene = read_scene(
      options_.input, options_.points_file.empty() ? NormalTextures::kLeftOut : NormalTextures::kRead);
  if (!scene) return scene.error();
  scene_ = std::move(*scene);
  if (Status status = add_requested_lights(scene_, options_); !status) return status;
  report_.warnings.insert(report_.warnings.end(), scene_.warnings.begin(), scene_.warnings.end());
  if (options_.fix_normals) report_.warnings.push_back(fix_scene_normals(scene_));
  std::erase(report_.warnings, std::string());
  report_.seconds.load = since(start_);
  if (scene_.triangle_count() == 0)
    return Error{
        ErrorCode::kNothingToBake, "has no triangles", options_.input, {}, "give a file with a mesh in it"};
  return read_places();
}

Status Bake::read_places() {
  if (options_.points_file.empty()) return Nothing{};
  const TracedScene traced(scene_);
  Result<std::vector<Receiver>> receivers = read_points(options_.points_file, traced);
  if (!receivers) return receivers.error();
  receivers_ = *std::move(receivers);
  for (const Receiver& r : receivers_) {
    const TracedTriangle& triangle = traced.triangles()[r.triangle];
    const TracedPart& part = traced.parts()[triangle.part];
    places_.push_back(
        {part.instance, part.primitive, triangle.source, r.back, r.origin, r.normal, r.surface});
  }
  return Nothing{};
}

Status Bake::preprocess() {
  tell("preprocess", 0.02);
  Status status = Nothing{};
  run_watched("preprocess", 0.03, -1, [&](const CancelToken& stop) { status = build_hierarchies(stop); });
  if (status && stop_asked())
    return Error{ErrorCode::kCancelled, "stopped before there was any light to keep", options_.input, {}, {}};
  return status;
}

Status Bake::build_hierarchies(const CancelToken& stop) {
  const auto begin = Clock::now();
  surfaces_ = build_surfaces(scene_, stop);
  if (stop.cancelled()) return Nothing{};
  report_.seconds.face_clusters = since(begin);
  for (const std::string& warning : describe_problems(surfaces_)) report_.warnings.push_back(warning);
  if (surfaces_.surfaces.empty())
    return Error{ErrorCode::kNothingToBake,
                 "no surface can receive light",
                 options_.input,
                 {},
                 "every triangle is degenerate or of an unlit material"};
  if (!has_light(surfaces_))
    return Error{ErrorCode::kNothingToBake,
                 "no light in the scene: nothing emits and there is no lamp",
                 options_.input,
                 {},
                 "add --sky 1000 or --sun 50000, or give a material an emission"};
  const auto bvh = Clock::now();
  {
    const WorldTriangles world = world_triangles(surfaces_);
    Transparency passing;
    if (!world.see_through.empty())
      passing = [this](uint32_t t, vec2 w, const Ray&) { return transparency(t, w, surfaces_); };
    caster_ =
        std::make_unique<RayCaster>(world.positions, world.triangles, world.see_through, std::move(passing));
    report_.seconds.ray_bvh = since(bvh);
    for (const std::string& warning : describe_buried_lamps(
             scene_, [this](const Ray& ray) { return ends_on_back(surfaces_, *caster_, ray); }))
      report_.warnings.push_back(warning);
    const PlaceClaims claims{
        [this](uint32_t t) { return contends_for_place(surfaces_, t); },
        [this](uint32_t first, uint32_t second) { return owns_place(surfaces_, first, second); }};
    const auto covered = find_coincident(world.positions, world.triangles, *caster_, claims, stop);
    if (stop.cancelled()) return Nothing{};
    settle_overlaps(surfaces_, covered, caster_->epsilon());
    report_.warnings.push_back(describe_overlaps(surfaces_));
    std::erase(report_.warnings, std::string());
  }
  const auto volumes = Clock::now();
  Effort effort = effort_for(tolerated());
  effort.solve.seed = static_cast<uint32_t>(options_.seed);
  effort.solve.shafts = options_.shafts;
  effort.solve.discontinuities = options_.discontinuities;
  effort.solve.adaptive_sampling = options_.adaptive_sampling;
  solver_ = std::make_unique<HierarchicalSolver>(surfaces_, *caster_, effort.solve);
  report_.seconds.volume_clusters = since(volumes);
  report_.seconds.preprocess = since(begin);
  report_.preprocess_bytes = memory_bytes(surfaces_) + solver_->memory_bytes();
  report_.ray_bvh_bytes = caster_->memory_bytes();
  report_.scene = {surfaces_.triangles,
                   surfaces_.surfaces.size(),
                   surfaces_.face_clusters,
                   solver_->pool().volume_clusters(),
                   scene_.lights.size() + (scene_.sky.present() ? 1 : 0) + count_emitters(surfaces_),
                   surfaces_.area,
                   profiles_in(scene_)};
  return Nothing{};
}

Status Bake::solve() {
  const auto begin = Clock::now();
  SolveSession session(*solver_);
  const uint64_t memory_limit = options_.max_memory.value_or(0);
  std::atomic<bool> full{false};
  session.watch = [&] {
    // The reconstruction still needs room of its own.
    if (memory_limit > 0 && resident_memory() > memory_limit / 10 * 6) full = true;
    return full.load();
  };
  session.start();
  auto told = Clock::now() - std::chrono::hours(1);
  while (!session.wait(40)) {
    if (report_.seconds.first_image == 0 && session.snapshot()) report_.seconds.first_image = since(start_);
    if (stop_asked()) session.cancel();
    // What remains of the time is for gathering and writing.
    if (time_left() < 0.3 * options_.time_limit.value_or(0)) {
      out_of_time_ = true;
      session.cancel();
    }
    if (since(told) > 0.5) {
      told = Clock::now();
      const SolveProgress now = session.progress();
      const double elapsed = since(begin);
      const double remaining = now.share > 0.02 ? elapsed * (1 - now.share) / now.share * 1.3 : -1;
      tell("solve", 0.05 + 0.65 * now.share, static_cast<double>(now.rays) / std::max(1e-3, elapsed),
           now.error_estimate, remaining);
    }
  }
  if (report_.seconds.first_image == 0 && session.snapshot()) report_.seconds.first_image = since(start_);
  if (stop_asked()) cancelled_ = true;
  out_of_memory_ = full;
  report_.seconds.solve = since(begin);
  if (out_of_memory_) report_.warnings.push_back("stopped refining at the memory limit");
  if (out_of_time_) report_.warnings.push_back("stopped refining at the time limit");
  return Nothing{};
}

void Bake::reconstruct_light() {
  tell("reconstruct", 0.7);
  const auto begin = Clock::now();
  ReconstructOptions options = effort_for(tolerated()).reconstruct;
  if (out_of_memory_) options.growth = 0;
  if (options_.max_memory)
    options.full = [limit = *options_.max_memory] { return resident_memory() > limit / 10 * 7; };
  ReconstructStats stats;
  run_watched("reconstruct", 0.8, 0.1, [&](const CancelToken& stop) {
    ShownLight shown(solver_->state());
    lighting_ = cancelled_ ? average_lighting(*solver_)
                           : reconstruct(*solver_, options, stop, stats, places_.empty() ? nullptr : &shown);
    if (!places_.empty()) light_ = gather_places(*solver_, shown, places_, options, stop, stats);
  });
  lighting_.revision = 1;
  report_.solver.reconstruct_rays = stats.rays.rays;
  report_.solver.interpolation_error = stats.error;
  report_.solver.error_estimate = stats.estimate;
  report_.seconds.reconstruct = since(begin);
  // Who names a number wants to know; presets are ways of working, and the report has the figure.
  if (options_.error) report_.warnings.push_back(missed_error(*options_.error, stats.estimate));
  std::erase(report_.warnings, std::string());
}

Status Bake::represent() {
  if (!uses_atlas()) return Nothing{};
  tell("represent", 0.92);
  const auto begin = Clock::now();
  Result<MappedLight> mapped = map_light(*solver_, lighting_, options_.lightmap, report_);
  if (!mapped) return mapped.error();
  mapped_ = *std::move(mapped);
  report_.seconds.represent = since(begin);
  return Nothing{};
}

void Bake::finish_report() {
  const SolveStats& stats = solver_->stats();
  report_.solver.elements = solver_->pool().count_by_kind();
  report_.solver.links = solver_->links().all().size();
  for (const Link& link : solver_->links().all())
    report_.solver.clear_links += link.sight == Sight::kClear ? 1 : 0;
  report_.solver.rays = stats.rays.rays;
  report_.solver.ray_time_share = std::min(1.0, static_cast<double>(stats.rays.nanoseconds) * 1e-9 /
                                                    std::max(1e-9, report_.seconds.solve * report_.threads));
  report_.solver.iterations = stats.iterations;
  report_.solver.epsilon = stats.epsilon;
  report_.solver.link_error = stats.error_estimate;
  report_.converged = stats.converged && !stats.limited;
  const IrradianceRange irradiance = irradiance_range(lighting_);
  report_.irradiance = {irradiance.least, irradiance.most};
  if (irradiance.not_finite > 0)
    report_.warnings.push_back(fmt::format("the light of {} vertices is not finite: please report this scene",
                                           irradiance.not_finite));
  if (!cancelled_) report_.power = measure_power(*solver_, 400000, static_cast<uint32_t>(options_.seed));
}

Status Bake::write() {
  tell("write", 0.95);
  const auto begin = Clock::now();
  finish_report();
  if (const Status status = write_places(); !status) return status.error();
  for (const std::string& file : options_.outputs) {
    if (const Status status = write_one(file); !status) return status.error();
    result_.written.push_back(file);
  }
  if (!options_.lightmap.files.empty() && uses_atlas()) {
    Result<std::vector<std::string>> files = write_light_map_files(
        options_.lightmap.files, map_encoding(options_.lightmap), scene_, mapped_.atlas, mapped_.encoded);
    if (!files) return files.error();
    result_.written.insert(result_.written.end(), files->begin(), files->end());
  }
  report_.seconds.write = since(begin);
  report_.seconds.total = since(start_);
  report_.peak_memory_bytes = peak_memory();
  result_.json = report_.json();
  result_.warnings = report_.warnings;
  result_.summary = summary();
  if (!options_.report_file.empty())
    if (const Status status = write_file_atomically(options_.report_file, as_bytes(result_.json)); !status)
      return status.error();
  tell("write", 1);
  return Nothing{};
}

Status Bake::write_places() {
  if (places_.empty()) return Nothing{};
  result_.points_json = write_light(nlohmann::ordered_json::object(), receivers_, light_);
  if (options_.json_file == "-") return Nothing{};
  const Status status = write_file_atomically(options_.json_file, as_bytes(result_.points_json));
  if (status) result_.written.push_back(options_.json_file);
  return status;
}

Status Bake::write_one(const std::string& file) {
  const std::string extension = file_extension(file);
  if (extension == ".gold") {
    // Without times and peaks, so that the same bake gives the same bytes.
    BakeReport stable = report_;
    stable.seconds = {};
    stable.peak_memory_bytes = stable.preprocess_bytes = stable.ray_bvh_bytes = 0;
    stable.solver.ray_time_share = 0;
    stable.threads = 0;
    std::optional<LightAtlas> atlas;
    if (uses_atlas()) atlas = mapped_.atlas;
    return write_solution(file, Solution{stable.json(), scene_, lighting_, std::move(atlas)});
  }
  if (extension == ".png" || extension == ".exr") {
    PreviewOptions preview;
    preview.width = options_.picture_width;
    preview.height = options_.picture_height;
    FloatImage picture = render_preview(scene_, lighting_, preview);
    if (extension == ".exr") return write_exr(file, picture);
    const ToneMap map = choose_tone_map(picture.pixels, 0.18f, static_cast<float>(options_.exposure));
    for (vec3& pixel : picture.pixels) pixel = map(pixel);
    return write_png(file, picture);
  }
  if (options_.mode == OutputMode::kLightmap)
    return write_mapped_scene(file, scene_, mapped_.atlas, mapped_.encoded);
  if (options_.mode == OutputMode::kOcclusion) {
    std::vector<EncodedPage> grey;
    for (const AtlasPage& page : mapped_.atlas.pages) grey.push_back(encode_grey_page(page));
    return write_occluded_scene(file, scene_, mapped_.atlas, grey);
  }
  if (options_.mode == OutputMode::kBaked) {
    const float exposure = unlit_exposure(scene_, lighting_, static_cast<float>(options_.exposure));
    return write_baked_scene(file, scene_, mapped_.atlas,
                             baked_pages(mapped_.atlas, scene_, options_.lightmap, exposure));
  }
  SceneWriteOptions write_options;
  write_options.mode = options_.mode;
  if (options_.mode == OutputMode::kUnlit)
    write_options.exposure = unlit_exposure(scene_, lighting_, static_cast<float>(options_.exposure));
  return write_lit_scene(file, scene_, lighting_, write_options);
}

std::string Bake::summary() const {
  char text[256];
  const std::string error = report_.solver.error_estimate
                                ? fmt::format("error about {:.2g}%, ", 100 * *report_.solver.error_estimate)
                                : std::string();
  std::snprintf(text, sizeof text,
                "%llu triangles, %llu links, %.1f Mrays, %.1f s (solve %.1f s); %spower residual %.2f%%",
                static_cast<unsigned long long>(report_.scene.triangles),
                static_cast<unsigned long long>(report_.solver.links),
                static_cast<double>(report_.solver.rays + report_.solver.reconstruct_rays) * 1e-6,
                report_.seconds.total, report_.seconds.solve, error.c_str(),
                100 * report_.power.residual / std::max(1e-30, report_.power.emitted));
  return text;
}

}  // namespace

Result<BakeResult> bake(const BakeOptions& options, const BakeListener& listener) {
  try {
    Bake job(options, listener);
    return job.run();
  } catch (const std::bad_alloc&) {
    return Error{
        ErrorCode::kLimit, "ran out of memory", options.input, {}, "try --quality draft or a smaller scene"};
  }
}

}  // namespace goldthread
