#include "files/gltf_read_compression.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <map>
#include <optional>
#include <span>

#include "files/gltf_read_container.h"
#include "files/gltf_read_draco.h"

namespace goldthread {
namespace {

constexpr const char* kMeshopt = "EXT_meshopt_compression";
constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr const char* kCure = "export the file again, without compression if need be";

enum class Mode { kAttributes, kTriangles, kIndices };
enum class Filter { kNone, kOctahedral, kQuaternion, kExponential };

/// The extension object of a bufferView, checked.
struct MeshoptView {
  std::span<const unsigned char> encoded;
  size_t stride = 0, count = 0;
  Mode mode = Mode::kAttributes;
  Filter filter = Filter::kNone;
};

/// A whole number from 0, or nothing.
std::optional<size_t> whole_number(const tinygltf::Value& object, const char* key) {
  const tinygltf::Value& value = object.Has(key) ? object.Get(key) : tinygltf::Value();
  if (!value.IsInt() || value.GetNumberAsInt() < 0) return std::nullopt;
  return size_t(value.GetNumberAsInt());
}

std::string text_member(const tinygltf::Value& object, const char* key, const char* otherwise) {
  return object.Has(key) && object.Get(key).IsString() ? object.Get(key).Get<std::string>() : otherwise;
}

/// meshoptimizer asserts what is checked here: element sizes that the mode and the filter can handle.
bool fits_mode(const MeshoptView& view) {
  if (view.mode == Mode::kAttributes) {
    if (view.stride == 0 || view.stride > 256 || view.stride % 4 != 0) return false;
    if (view.filter == Filter::kOctahedral) return view.stride == 4 || view.stride == 8;
    if (view.filter == Filter::kQuaternion) return view.stride == 8;
    return true;
  }
  if (view.filter != Filter::kNone || (view.stride != 2 && view.stride != 4)) return false;
  return view.mode == Mode::kIndices || view.count % 3 == 0;
}

/// Whether so few bytes can hold so much: a byte of zeros takes 2 bits in a group of 16; a triangle or an
/// index takes a byte.
bool plausible(const MeshoptView& view) {
  const size_t size = view.encoded.size();
  if (view.mode == Mode::kAttributes) return view.count <= (size + 64) * 64 / view.stride;
  return view.mode == Mode::kTriangles ? view.count / 3 <= size : view.count <= size;
}

std::optional<MeshoptView> parse_view(const tinygltf::Model& model, const tinygltf::Value& extension) {
  const auto buffer = whole_number(extension, "buffer"), length = whole_number(extension, "byteLength");
  const auto stride = whole_number(extension, "byteStride"), count = whole_number(extension, "count");
  const size_t offset = whole_number(extension, "byteOffset").value_or(0);
  if (!buffer || !length || !stride || !count || *buffer >= model.buffers.size()) return std::nullopt;
  const std::vector<unsigned char>& data = model.buffers[*buffer].data;
  if (offset > data.size() || *length > data.size() - offset) return std::nullopt;
  MeshoptView view;
  view.encoded = std::span(data).subspan(offset, *length);
  view.stride = *stride;
  view.count = *count;
  const std::string mode = text_member(extension, "mode", ""),
                    filter = text_member(extension, "filter", "NONE");
  const std::map<std::string, Mode> modes = {
      {"ATTRIBUTES", Mode::kAttributes}, {"TRIANGLES", Mode::kTriangles}, {"INDICES", Mode::kIndices}};
  const std::map<std::string, Filter> filters = {{"NONE", Filter::kNone},
                                                 {"OCTAHEDRAL", Filter::kOctahedral},
                                                 {"QUATERNION", Filter::kQuaternion},
                                                 {"EXPONENTIAL", Filter::kExponential}};
  if (!modes.contains(mode) || !filters.contains(filter)) return std::nullopt;
  view.mode = modes.at(mode);
  view.filter = filters.at(filter);
  if (!fits_mode(view) || !plausible(view)) return std::nullopt;
  return view;
}

bool decode_view(const MeshoptView& view, unsigned char* out) {
  const unsigned char* in = view.encoded.data();
  const size_t size = view.encoded.size();
  if (view.count == 0) return true;
  if (view.mode == Mode::kTriangles)
    return meshopt_decodeIndexBuffer(out, view.count, view.stride, in, size) == 0;
  if (view.mode == Mode::kIndices)
    return meshopt_decodeIndexSequence(out, view.count, view.stride, in, size) == 0;
  if (meshopt_decodeVertexBuffer(out, view.count, view.stride, in, size) != 0) return false;
  if (view.filter == Filter::kOctahedral) meshopt_decodeFilterOct(out, view.count, view.stride);
  if (view.filter == Filter::kQuaternion) meshopt_decodeFilterQuat(out, view.count, view.stride);
  if (view.filter == Filter::kExponential) meshopt_decodeFilterExp(out, view.count, view.stride);
  return true;
}

Status expand_meshopt(tinygltf::Model& model, const std::string& file, ExpandedBuffer& expanded) {
  for (size_t i = 0; i < model.bufferViews.size(); ++i) {
    tinygltf::BufferView& view = model.bufferViews[i];
    const auto extension = view.extensions.find(kMeshopt);
    if (extension == view.extensions.end()) continue;
    const std::string place = fmt::format("bufferView {}", i);
    const std::optional<MeshoptView> packed = parse_view(model, extension->second);
    if (!packed) return bad_input(file, place, fmt::format("{} is malformed", kMeshopt), kCure);
    const size_t bytes = packed->count * packed->stride;
    const std::optional<size_t> offset = expanded.append(bytes);
    if (!offset) return expanded.too_much(file, place);
    // Written after the encoded bytes were located: `expanded` is no buffer of the model yet.
    if (!decode_view(*packed, expanded.data.data() + *offset))
      return bad_input(file, place, fmt::format("{}: the compressed data is broken", kMeshopt), kCure);
    view.buffer = int(model.buffers.size());
    view.byteOffset = *offset;
    view.byteLength = bytes;
    view.byteStride = packed->mode == Mode::kAttributes ? packed->stride : 0;
    view.extensions.erase(extension);
  }
  return Nothing{};
}

void drop_name(std::vector<std::string>& names, const char* name) {
  std::erase(names, name);
}

}  // namespace

bool is_meshopt_fallback(const nlohmann::json& buffer) {
  const nlohmann::json::json_pointer fallback("/extensions/EXT_meshopt_compression/fallback");
  if (!buffer.contains(fallback)) return false;
  const nlohmann::json& value = buffer[fallback];
  return value.is_boolean() && value.get<bool>();
}

bool is_meshopt_view(const tinygltf::BufferView& view) {
  return view.extensions.contains(kMeshopt);
}

Status expand_compression(tinygltf::Model& model, const std::string& file) {
  ExpandedBuffer expanded(model);
  if (Status status = expand_meshopt(model, file, expanded); !status) return status;
  if (Status status = expand_draco(model, file, expanded); !status) return status;
  for (const char* name : {kMeshopt, kDraco}) {
    drop_name(model.extensionsUsed, name);
    drop_name(model.extensionsRequired, name);
  }
  if (expanded.data.empty() && !expanded.used) return Nothing{};
  tinygltf::Buffer buffer;
  buffer.data = std::move(expanded.data);
  model.buffers.push_back(std::move(buffer));
  return Nothing{};
}

}  // namespace goldthread
