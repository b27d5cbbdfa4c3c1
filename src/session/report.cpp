#include "session/report.h"

#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <nlohmann/json.hpp>

namespace goldthread {

std::string BakeReport::json() const {
  nlohmann::ordered_json j;
  j["scene"] = {{"triangles", scene.triangles},
                {"surfaces", scene.surfaces},
                {"face_clusters", scene.face_clusters},
                {"volume_clusters", scene.volume_clusters},
                {"lights", scene.lights},
                {"area_m2", scene.area_m2}};
  if (!scene.light_profiles.empty()) j["scene"]["light_profiles"] = to_json(scene.light_profiles);
  j["seconds"] = {{"load", seconds.load},
                  {"preprocess", seconds.preprocess},
                  {"face_clusters", seconds.face_clusters},
                  {"volume_clusters", seconds.volume_clusters},
                  {"ray_bvh", seconds.ray_bvh},
                  {"first_image", seconds.first_image},
                  {"solve", seconds.solve},
                  {"reconstruct", seconds.reconstruct},
                  {"represent", seconds.represent},
                  {"write", seconds.write},
                  {"total", seconds.total}};
  j["peak_memory_bytes"] = peak_memory_bytes;
  j["preprocess_bytes"] = preprocess_bytes;
  j["ray_bvh_bytes"] = ray_bvh_bytes;
  j["solver"] = {{"elements",
                  {{"volume", solver.elements[0]},
                   {"face", solver.elements[1]},
                   {"patch", solver.elements[2]},
                   {"light", solver.elements[3]}}},
                 {"links", solver.links},
                 {"rays", solver.rays},
                 {"reconstruct_rays", solver.reconstruct_rays},
                 {"ray_time_share", solver.ray_time_share},
                 {"iterations", solver.iterations},
                 {"epsilon", solver.epsilon},
                 {"error_estimate", solver.error_estimate ? nlohmann::ordered_json(*solver.error_estimate)
                                                          : nlohmann::ordered_json()},
                 {"clear_links", solver.clear_links},
                 {"link_error", solver.link_error},
                 {"interpolation_error", solver.interpolation_error}};
  j["power_lm"] = {{"emitted", power.emitted},
                   {"absorbed", power.absorbed},
                   {"escaped", power.escaped},
                   {"residual", power.residual}};
  j["irradiance_lx"] = {{"least", irradiance.least}, {"most", irradiance.most}};
  if (atlas)
    j["atlas"] = {{"pages", atlas->pages},
                  {"page_size", atlas->page_size},
                  {"texels_per_metre", atlas->texels_per_metre},
                  {"charts", atlas->charts},
                  {"use", atlas->use},
                  {"covered_texels", atlas->covered_texels},
                  {"mean_stretch", atlas->mean_stretch},
                  {"most_stretch", atlas->most_stretch},
                  {"encoding_error", atlas->encoding_error},
                  {"clipped_texels", atlas->clipped_texels},
                  {"triangles", atlas->triangles},
                  {"vertices", atlas->vertices}};
  j["threads"] = threads;
  j["warnings"] = warnings;
  j["converged"] = converged;
  return j.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

uint64_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

uint64_t resident_memory() {
  unsigned long total = 0, resident = 0;
  std::FILE* file = std::fopen("/proc/self/statm", "r");
  if (file == nullptr) return peak_memory();
  const int fields = std::fscanf(file, "%lu %lu", &total, &resident);
  std::fclose(file);
  return fields == 2 ? static_cast<uint64_t>(resident) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE))
                     : peak_memory();
}

}  // namespace goldthread
