#include "files/light_map_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "files/atomic_file.h"
#include "files/file_name.h"
#include "files/hdr_encode.h"
#include "files/image_write.h"
#include "files/light_map_pack.h"
#include "files/png_encode.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr MapEncoding kOfExr[] = {MapEncoding::kFloat, MapEncoding::kHalf};
constexpr MapEncoding kOfHdr[] = {MapEncoding::kRgbe};
constexpr MapEncoding kOfPng[] = {MapEncoding::kRgbm, MapEncoding::kRgbd, MapEncoding::kRgbe,
                                  MapEncoding::kSrgb};

const char* name_of(MapEncoding encoding) {
  switch (encoding) {
    case MapEncoding::kFloat:
      return "linear float";
    case MapEncoding::kHalf:
      return "linear half";
    case MapEncoding::kRgbe:
      return "linear rgbe";
    case MapEncoding::kRgbm:
      return "linear rgbm";
    case MapEncoding::kRgbd:
      return "linear rgbd";
    case MapEncoding::kSrgb:
      return "srgb";
  }
  return "";
}

Status write_exr_page(const std::string& file, const AtlasPage& page, ExrDepth depth) {
  LayeredImage layered;
  layered.image = page.irradiance;
  layered.layers["A"] = {page.covered.begin(), page.covered.end()};
  return write_layered_exr(file, layered, depth);
}

/// `description`, of the page in the list, gets the scale.
Status write_png_page(const std::string& file, const AtlasPage& page, MapEncoding encoding, float white,
                      Json& description) {
  const FloatImage& light = page.irradiance;
  const PackedLight packed = pack_light(light, encoding, white);
  description["scale"] = packed.scale;
  const PngContent content = encoding == MapEncoding::kSrgb ? PngContent::kSrgb : PngContent::kData;
  const std::vector<uint8_t> png =
      encode_png(light.width, light.height, packed.channels, packed.bytes, content);
  if (png.empty())
    return Error{ErrorCode::kCannotWrite, "a page of the light map is larger than PNG holds", file, "",
                 "give a smaller --page-size"};
  return write_file_atomically(file, png);
}

/// The same, of any extension; `white` is what kSrgb clips at.
Status write_page(const std::string& file, const AtlasPage& page, MapEncoding encoding, float white,
                  Json& description) {
  const std::string extension = file_extension(file);
  if (extension == ".png") return write_png_page(file, page, encoding, white, description);
  if (extension == ".hdr") return write_file_atomically(file, encode_hdr(page.irradiance));
  return write_exr_page(file, page, encoding == MapEncoding::kHalf ? ExrDepth::kHalf : ExrDepth::kFloat);
}

Json describe_page(const std::string& file, const AtlasPage& page) {
  float least = std::numeric_limits<float>::infinity(), most = 0;
  for (size_t i = 0; i < page.covered.size(); ++i) {
    if (!page.covered[i]) continue;
    const vec3& light = page.irradiance.pixels[i];
    least = std::min({least, light.x, light.y, light.z});
    most = std::max({most, light.x, light.y, light.z});
  }
  return {{"file", fs::path(file).filename().string()},
          {"width", page.irradiance.width},
          {"height", page.irradiance.height},
          {"least", std::min(least, most)},
          {"most", most}};
}

Json describe_mesh(const MappedMesh& mesh, const Scene& scene) {
  vec2 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
  for (const vec2& at : mesh.coordinates) {
    low = glm::min(low, at);
    high = glm::max(high, at);
  }
  return {{"instance", mesh.instance},
          {"name", scene.instances[mesh.instance].name},
          {"primitive", mesh.primitive},
          {"side", mesh.back ? "back" : "front"},
          {"page", mesh.page},
          {"triangles", mesh.faces.size()},
          {"box", {low.x, low.y, high.x, high.y}}};
}

}  // namespace

std::string light_map_page_file(const std::string& file, size_t page) {
  fs::path path(file);
  return path.replace_filename(fmt::format("{}-{}{}", path.stem().string(), page, path.extension().string()))
      .string();
}

std::string light_map_list_file(const std::string& file) {
  return fs::path(file).replace_extension(".json").string();
}

std::span<const MapEncoding> encodings_of(const std::string& extension) {
  if (extension == ".exr") return kOfExr;
  if (extension == ".hdr") return kOfHdr;
  if (extension == ".png") return kOfPng;
  return {};
}

Result<std::vector<std::string>> write_light_map_files(const std::string& file, MapEncoding encoding,
                                                       const Scene& scene, const LightAtlas& atlas,
                                                       std::span<const EncodedPage> encoded) {
  std::vector<std::string> written;
  Json list = {{"encoding", name_of(encoding)},
               {"unit", "lux"},
               {"texels_per_metre", atlas.texels_per_metre},
               {"pages", Json::array()},
               {"objects", Json::array()}};
  for (size_t page = 0; page < atlas.pages.size(); ++page) {
    written.push_back(light_map_page_file(file, page));
    Json description = describe_page(written.back(), atlas.pages[page]);
    const Status status =
        write_page(written.back(), atlas.pages[page], encoding, encoded[page].intensity, description);
    if (!status) return status.error();
    list["pages"].push_back(std::move(description));
  }
  for (const MappedMesh& mesh : atlas.meshes) list["objects"].push_back(describe_mesh(mesh, scene));
  const std::string text = list.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
  written.push_back(light_map_list_file(file));
  const Status status =
      write_file_atomically(written.back(), {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  if (!status) return status.error();
  return written;
}

}  // namespace goldthread
