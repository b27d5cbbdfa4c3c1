// The figures of a bake, and their JSON (design.md section 9).
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "session/power_balance.h"
#include "session/profile_facts.h"

namespace goldthread {

struct BakeReport {
  struct {
    uint64_t triangles = 0, surfaces = 0, face_clusters = 0, volume_clusters = 0, lights = 0;
    double area_m2 = 0;
    std::vector<ProfileUse> light_profiles;
  } scene;
  struct {
    double load = 0, preprocess = 0, face_clusters = 0, volume_clusters = 0, ray_bvh = 0, first_image = 0,
           solve = 0, reconstruct = 0, represent = 0, write = 0, total = 0;
  } seconds;
  uint64_t peak_memory_bytes = 0;
  uint64_t preprocess_bytes = 0;  ///< hierarchies and placed geometry, without Embree
  uint64_t ray_bvh_bytes = 0;
  struct {
    std::array<uint64_t, 4> elements{};  ///< volume, face, patch, light
    uint64_t links = 0, rays = 0, reconstruct_rays = 0;
    double ray_time_share = 0;
    uint64_t iterations = 0;
    uint64_t clear_links = 0;  ///< without rays: all of the source is seen
    double epsilon = 0;
    double link_error = 0;  ///< root of the links' squared errors, over the light that lands
    std::optional<double>
        error_estimate;              ///< of the light as written: root mean square by area over the mean
    double interpolation_error = 0;  ///< of light between vertices: root mean square over the mean
  } solver;
  PowerBalance power;
  struct {
    double least = 0, most = 0;
  } irradiance;  ///< luminance over all vertices that light was worked out for, lx
  struct Atlas {
    uint64_t pages = 0, page_size = 0, charts = 0, covered_texels = 0, clipped_texels = 0;
    double texels_per_metre = 0;
    double use = 0;                             ///< share of texels that charts touch
    double mean_stretch = 0, most_stretch = 0;  ///< of charts (Chart::stretch)
    double encoding_error = 0;                  ///< of eight bits: root mean square over the mean light
    uint64_t triangles = 0, vertices = 0;       ///< that carry the maps
  };
  std::optional<Atlas> atlas;
  int threads = 1;
  std::vector<std::string> warnings;
  bool converged = false;

  std::string json() const;
};

/// The most resident memory this process has had, bytes.
uint64_t peak_memory();
/// What it has now.
uint64_t resident_memory();

}  // namespace goldthread
