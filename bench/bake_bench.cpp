// Figures of the whole program beside those of the thesis (chapter 7, one core of 2002): preprocessing rate
// and memory, seconds to the first image, how the solve grows with tessellation, and what a second core
// brings to it; and the error where the answer is known.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "folder.h"
#include "goldthread/bake.h"

namespace goldthread {
namespace {

/// Bakes a scene of our own and returns the report.
nlohmann::json bake_own(const Folder& folder, const std::string& name, uint64_t triangles, int threads) {
  const std::string file = folder.path(fmt::format("{}{}.glb", name, triangles));
  if (!std::filesystem::exists(file)) {
    const Result<uint64_t> made = make_scene({name, triangles, file});
    if (!made) throw std::runtime_error(made.error().line());
  }
  BakeOptions options;
  options.input = file;
  options.outputs = {folder.path("lit.gold")};
  options.quality = Quality::kMedium;
  options.threads = threads;
  const Result<BakeResult> result = bake(options);
  if (!result) throw std::runtime_error(result.error().line());
  nlohmann::json report = nlohmann::json::parse(result->json);
  const double emitted = report["power_lm"]["emitted"], residual = report["power_lm"]["residual"];
  // A time is worth nothing if the answer is wrong.
  if (!(emitted > 0) || std::abs(residual) > 0.01 * emitted)
    throw std::runtime_error(fmt::format("{}: {:.1f}% of the power is lost", file, 100 * residual / emitted));
  return report;
}

void print_preprocessing(const nlohmann::json& report) {
  const double triangles = report["scene"]["triangles"];
  const auto& seconds = report["seconds"];
  const double clusters = seconds["preprocess"].get<double>() - seconds["ray_bvh"].get<double>();
  fmt::print(
      "car {:>8.0f} triangles: {:>6.0f} thousand triangles/s (thesis 16-21), {:>4.0f} bytes/triangle (thesis "
      "365-455), ray caster {:.2f} s and {:.0f} bytes/triangle\n",
      triangles, triangles / clusters / 1000, report["preprocess_bytes"].get<double>() / triangles,
      seconds["ray_bvh"].get<double>(), report["ray_bvh_bytes"].get<double>() / triangles);
  fmt::print(
      "car {:>8.0f} triangles: first image after {:.2f} s, of which reading {:.2f} s (thesis: under a "
      "minute)\n",
      triangles, seconds["first_image"].get<double>(), seconds["load"].get<double>());
}

void print_solve(const nlohmann::json& report, double base) {
  const auto& solver = report["solver"];
  const double solve = report["seconds"]["solve"];
  fmt::print(
      "car {:>8} triangles: solve {:6.2f} s, {:.2f} times the smallest; {} links, {:.1f} Mrays, {:.0f}% of "
      "it in the "
      "ray caster\n",
      report["scene"]["triangles"].get<uint64_t>(), solve, solve / base, solver["links"].get<uint64_t>(),
      solver["rays"].get<double>() * 1e-6, 100 * solver["ray_time_share"].get<double>());
}

/// Closed rooms in which everything emits 1 and reflects half: each vertex gets 2 lx.
void print_known(const Folder& folder) {
  fmt::print("known answers at a million triangles\n");
  for (const char* name : {"furnace", "sphere"}) {
    const nlohmann::json report = bake_own(folder, name, 1000000, 2);
    fmt::print("{:8} {:>8} triangles: {:.4f} to {:.4f} lx at its vertices (exactly: 2)\n", name,
               report["scene"]["triangles"].get<uint64_t>(), report["irradiance_lx"]["least"].get<double>(),
               report["irradiance_lx"]["most"].get<double>());
  }
}

void run_all() {
  const Folder folder;
  std::map<uint64_t, nlohmann::json> reports;
  for (const uint64_t triangles : {31000, 125000, 250000, 500000, 2000000})
    reports[triangles] = bake_own(folder, "car", triangles, 2);
  fmt::print("preprocessing: welding, face and volume clusters, placed geometry; two threads\n");
  for (const uint64_t triangles : {250000, 500000}) print_preprocessing(reports[triangles]);
  fmt::print("solve against tessellation, medium quality, two threads\n");
  const double base = reports[31000]["seconds"]["solve"];
  for (const uint64_t triangles : {31000, 125000, 500000, 2000000}) print_solve(reports[triangles], base);
  fmt::print("cores\n");
  const double one = bake_own(folder, "car", 125000, 1)["seconds"]["solve"];
  const double two = reports[125000]["seconds"]["solve"];
  fmt::print("car   125000 triangles: solve {:.2f} s on one core, {:.2f} s on two: {:.2f} times as fast\n",
             one, two, one / two);
  print_known(folder);
}

}  // namespace
}  // namespace goldthread

int main() {
  try {
    goldthread::run_all();
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
