#include "session/mapped_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "files/atomic_file.h"
#include "files/file_name.h"
#include "files/light_map_files.h"
#include "reconstruct/buried.h"
#include "represent/atlas_fill.h"
#include "represent/atlas_layout.h"
#include "represent/outgoing.h"

namespace goldthread {
namespace {

constexpr float kMostHalf = 65504;
constexpr uint32_t kLeastPage = 4, kMostPage = 16384, kMostPages = 256, kMostPadding = 64;

Error usage(std::string message, std::string cure) {
  return Error{ErrorCode::kUsage, std::move(message), {}, {}, std::move(cure)};
}

std::vector<AtlasPart> parts_of(const SurfaceSet& surfaces) {
  std::vector<AtlasPart> parts;
  for (const Part& part : surfaces.parts)
    parts.push_back({part.instance, part.primitive, &surfaces.tree(part), part.scale});
  return parts;
}

/// Whether a place lies inside a solid.
bool is_hidden(const HierarchicalSolver& solver, const MappedPlace& place) {
  const Scene& scene = *solver.pool().surfaces().scene;
  const Instance& instance = scene.instances[place.mesh->instance];
  const Primitive& source = scene.meshes[instance.mesh].primitives[place.mesh->primitive];
  const uint32_t* index = &source.indices[3 * size_t{place.mesh->face_parents[place.face]}];
  const auto corner = [&](int k) { return vec3(instance.transform * vec4(source.positions[index[k]], 1)); };
  const vec3 a = corner(0), u = corner(1) - a, v = corner(2) - a;
  const bool mirrored = glm::determinant(mat3(instance.transform)) < 0;
  const vec3 normal = normalize_or(cross(u, v), vec3(0, 0, 1));
  RayCount rays;
  return is_buried(solver.pool(), solver.visibility(), a + place.weights.x * u + place.weights.y * v,
                   place.mesh->back != mirrored ? -normal : normal, rays);
}

/// Root mean square error of the bytes over the mean of the light, both over all channels of covered texels.
double relative_error(const LightAtlas& atlas, const std::vector<EncodedPage>& encoded) {
  double squares = 0, light = 0, texels = 0;
  for (size_t p = 0; p < atlas.pages.size(); ++p) {
    double own = 0;
    for (size_t i = 0; i < atlas.pages[p].covered.size(); ++i) {
      if (!atlas.pages[p].covered[i]) continue;
      const dvec3 value(atlas.pages[p].irradiance.pixels[i]);
      light += value.x + value.y + value.z;
      own += 3;
    }
    squares += encoded[p].error * encoded[p].error * own;
    texels += own;
  }
  return light > 0 ? std::sqrt(squares / texels) / (light / texels) : 0.0;
}

/// Covered texels of which a channel is above `lux`.
uint64_t count_brighter(const LightAtlas& atlas, float lux) {
  uint64_t count = 0;
  for (const AtlasPage& page : atlas.pages)
    for (size_t i = 0; i < page.covered.size(); ++i)
      count += page.covered[i] && glm::any(glm::greaterThan(page.irradiance.pixels[i], vec3(lux)));
  return count;
}

BakeReport::Atlas describe(const MappedLight& mapped, const AtlasStats& stats, uint32_t page_size) {
  BakeReport::Atlas facts;
  facts.pages = mapped.atlas.pages.size();
  facts.page_size = page_size;
  facts.charts = stats.placed;
  facts.texels_per_metre = static_cast<double>(mapped.atlas.texels_per_metre);
  facts.use = stats.use;
  facts.mean_stretch = stats.charts.area > 0 ? stats.charts.sum_of_stretch / stats.charts.area : 0.0;
  facts.most_stretch = static_cast<double>(stats.charts.most_stretch);
  for (const AtlasPage& page : mapped.atlas.pages)
    facts.covered_texels += static_cast<uint64_t>(std::count(page.covered.begin(), page.covered.end(), 1));
  for (const EncodedPage& page : mapped.encoded) facts.clipped_texels += page.clipped;
  for (const MappedMesh& mesh : mapped.atlas.meshes) {
    facts.triangles += mesh.faces.size();
    facts.vertices += mesh.coordinates.size();
  }
  facts.encoding_error = relative_error(mapped.atlas, mapped.encoded);
  return facts;
}

}  // namespace

Status check_lightmap(const LightmapOptions& options) {
  if (options.page_size < kLeastPage || options.page_size > kMostPage)
    return usage(fmt::format("light maps cannot have {} texels aside", options.page_size),
                 fmt::format("choose a --page-size from {} to {}", kLeastPage, kMostPage));
  if (options.pages < 1 || options.pages > kMostPages)
    return usage(fmt::format("there cannot be {} light maps", options.pages),
                 fmt::format("choose --pages from 1 to {}", kMostPages));
  if (options.padding > kMostPadding)
    return usage(fmt::format("{} texels between charts are too many", options.padding),
                 fmt::format("choose a --padding from 0 to {}", kMostPadding));
  if (!(options.texel_density >= 0) || !std::isfinite(options.texel_density))
    return usage(fmt::format("{:g} texels a metre cannot be had", options.texel_density),
                 "choose a --texel-density above 0, or leave it out");
  if (options.files.empty()) return Nothing{};
  const std::span<const MapEncoding> known = encodings_of(file_extension(options.files));
  if (known.empty())
    return Error{
        ErrorCode::kUsage, "light maps are no such files", options.files, {}, "end it in .exr, .hdr or .png"};
  if (options.encoding && std::find(known.begin(), known.end(), *options.encoding) == known.end())
    return Error{ErrorCode::kUsage,
                 "such files have no light maps of that encoding",
                 options.files,
                 {},
                 ".exr has float and half, .hdr rgbe, .png rgbm, rgbd, rgbe and srgb"};
  if (const auto probe = AtomicFile::create(light_map_list_file(options.files)); !probe) return probe.error();
  return Nothing{};
}

MapEncoding map_encoding(const LightmapOptions& options) {
  return options.encoding.value_or(encodings_of(file_extension(options.files)).front());
}

Result<MappedLight> map_light(const HierarchicalSolver& solver, const Lighting& lighting,
                              const LightmapOptions& options, BakeReport& report) {
  const SurfaceSet& surfaces = solver.pool().surfaces();
  AtlasOptions layout;
  layout.pages.page_size = options.page_size;
  layout.pages.pages = options.pages;
  layout.pages.padding = options.padding;
  layout.pages.texels_per_metre = static_cast<float>(options.texel_density);
  const CancelToken never;  // who stops a bake wants what light there is, and it needs a place
  AtlasStats stats;
  std::optional<LightAtlas> atlas =
      lay_out_atlas(*surfaces.scene, lighting, parts_of(surfaces), layout, never, stats);
  if (!atlas)
    return Error{ErrorCode::kLimit,
                 fmt::format("{} charts do not fit on {} light map{} of {} texels aside", stats.placed,
                             options.pages, options.pages == 1 ? "" : "s", options.page_size),
                 surfaces.scene->file,
                 {},
                 "give a larger --page-size, more --pages or less --padding"};
  if (options.texel_density > 0 &&
      static_cast<double>(atlas->texels_per_metre) < options.texel_density * 0.999)
    report.warnings.push_back(
        fmt::format("{:.4g} texels a metre instead of {:.4g}: more do not fit on the pages",
                    atlas->texels_per_metre, options.texel_density));
  MappedLight mapped{*std::move(atlas), {}};
  fill_atlas(mapped.atlas, *surfaces.scene, lighting,
             {options.page_size, options.padding,
              [&](const MappedPlace& place) { return is_hidden(solver, place); }});
  for (const AtlasPage& page : mapped.atlas.pages) mapped.encoded.push_back(encode_page(page));
  if (options.encoding == MapEncoding::kHalf)
    if (const uint64_t brighter = count_brighter(mapped.atlas, kMostHalf); brighter > 0)
      report.warnings.push_back(fmt::format(
          "{} texels of the map files are clipped: half floats end at {} lx", brighter, kMostHalf));
  report.atlas = describe(mapped, stats, options.page_size);
  return mapped;
}

std::vector<BakedPage> baked_pages(const LightAtlas& atlas, const Scene& scene,
                                   const LightmapOptions& options, float exposure) {
  std::vector<BakedPage> pages;
  for (const OutgoingPage& page : outgoing_pages(atlas, scene, options.padding))
    pages.push_back(encode_baked_page(page.nits, page.alpha, exposure));
  return pages;
}

}  // namespace goldthread
