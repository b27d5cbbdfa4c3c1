#include "session/light_map.h"

#include <fmt/format.h>

#include <filesystem>

#include "files/image_write.h"

namespace goldthread {
namespace {

using Json = nlohmann::ordered_json;

std::string counted(size_t count, const char* one) {
  return fmt::format("{} {}{}", count, one, count == 1 ? "" : "s");
}

std::string coordinates(const TexelLayout& layout) {
  return layout.uv ? fmt::format("TEXCOORD_{}", *layout.uv) : std::string("texture coordinates");
}

constexpr const char* kUnwrapCure = "unwrap the scene in the program that made it, or measure --vertices";

}  // namespace

std::vector<LightMap> light_maps_of(const std::vector<Receiver>& receivers) {
  std::vector<LightMap> maps;
  for (size_t i = 0; i < receivers.size(); ++i) {
    const Receiver& r = receivers[i];
    if (!r.is_texel()) return {};
    if (maps.empty() || maps.back().instance != r.instance || maps.back().primitive != r.primitive ||
        maps.back().back != r.back)
      maps.push_back({r.instance, r.primitive, r.back, i, 0});
    ++maps.back().count;
  }
  return maps;
}

std::string light_map_file(const std::string& file, const LightMap& map, size_t map_count) {
  if (map_count == 1) return file;
  std::filesystem::path path(file);
  const std::string name = fmt::format("{}-{}-{}{}{}", path.stem().string(), map.instance, map.primitive,
                                       map.back ? "-back" : "", path.extension().string());
  return path.replace_filename(name).string();
}

Status write_light_map(const std::string& file, const SavedEstimate& estimate, const LightMap& map) {
  const uint32_t width = estimate.layout.width, height = estimate.layout.height;
  const size_t count = size_t{width} * height;
  LayeredImage out;
  out.image = {width, height, std::vector<vec3>(count, vec3(0))};
  const auto layer = [&](const char* name) -> std::vector<float>& {
    return out.layers[name] = std::vector<float>(count, 0.0f);
  };
  std::vector<float>&covered = layer("A"), &samples = layer("samples"), &error = layer("error");
  for (size_t i = map.first; i < map.first + map.count; ++i) {
    const Receiver& r = estimate.receivers[i];
    const IrradianceSums& sums = estimate.sums[i];
    const size_t texel = size_t{r.texel_y} * width + r.texel_x;
    out.image.pixels[texel] = vec3(evaluate(sums).mean);
    covered[texel] = 1;
    samples[texel] = static_cast<float>(sums.samples);
    error[texel] = static_cast<float>(luminance_standard_error(sums));
  }
  out.notes["goldthread.seed"] = fmt::format("{}", estimate.seed);
  out.notes["goldthread.scene"] = fmt::format("{:016x}", estimate.fingerprint);
  out.notes["goldthread.instance"] = fmt::format("{}", map.instance);
  out.notes["goldthread.primitive"] = fmt::format("{}", map.primitive);
  return write_layered_exr(file, out);
}

Json describe_light_maps(const std::vector<LightMap>& maps, const Scene& scene) {
  Json list = Json::array();
  for (const LightMap& map : maps) {
    const std::string name = map.instance < scene.instances.size() ? scene.instances[map.instance].name : "";
    list.push_back({{"instance", map.instance},
                    {"name", name},
                    {"primitive", map.primitive},
                    {"back", map.back},
                    {"texels", map.count}});
  }
  return list;
}

std::vector<std::string> texel_warnings(const TexelProblems& problems, const TexelLayout& layout) {
  std::vector<std::string> lines;
  const std::string of_all = fmt::format(" of {}", counted(problems.parts, "lit primitive"));
  if (problems.without_uv > 0)
    lines.push_back(
        fmt::format("no {} and no light map: {}{}", coordinates(layout), problems.without_uv, of_all));
  if (problems.without_texel > 0)
    lines.push_back(
        fmt::format("no texel's centre in any triangle, and no light map: {}{}; try a larger --texels",
                    problems.without_texel, of_all));
  if (problems.overlapping > 0)
    lines.push_back(
        fmt::format("texture coordinates on top of others, where the first in the file is measured: {}",
                    counted(problems.overlapping, "triangle")));
  if (problems.outside > 0)
    lines.push_back(fmt::format("texture coordinates beyond 0..1, where there are no texels: {}",
                                counted(problems.outside, "triangle")));
  if (problems.without_uv_area > 0)
    lines.push_back(fmt::format("no area in texture coordinates, and no texels: {}",
                                counted(problems.without_uv_area, "triangle")));
  return lines;
}

Error no_texels(const TexelReceivers& texels, const TexelLayout& layout, const std::string& scene_file) {
  const TexelProblems& problems = texels.problems;
  if (texels.too_many)
    return {ErrorCode::kLimit, fmt::format("--texels makes more than {} receivers", kMostTexelReceivers),
            scene_file, "", "give a smaller size"};
  if (problems.without_uv == problems.parts)
    return {ErrorCode::kBadInput, fmt::format("no lit primitive has {}", coordinates(layout)), scene_file, "",
            layout.uv ? "leave --uv out, or unwrap the scene in the program that made it" : kUnwrapCure};
  return {
      ErrorCode::kBadInput,
      fmt::format(
          "no texel's centre lies in a triangle: {}, without {}: {}; {} without area there, {} beyond 0..1",
          counted(problems.parts, "lit primitive"), coordinates(layout), problems.without_uv,
          counted(problems.without_uv_area, "triangle"), problems.outside),
      scene_file, "", "give a larger --texels, or unwrap the scene within 0..1"};
}

}  // namespace goldthread
