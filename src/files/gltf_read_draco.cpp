#include "files/gltf_read_draco.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wextra"
#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#pragma GCC diagnostic pop
#include <fmt/format.h>

#include <cstring>
#include <map>

namespace goldthread {
namespace {

constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr const char* kCure = "export the file again, without compression if need be";
constexpr uint64_t kMostFacesPerByte = 1024;  ///< large flat grids reach some 50

bool decode_count(draco::DecoderBuffer& buffer, uint16_t version, uint64_t& out) {
  uint32_t value = 0;
  const bool ok =
      version < DRACO_BITSTREAM_VERSION(2, 2) ? buffer.Decode(&value) : draco::DecodeVarint(&value, &buffer);
  out = value;
  return ok;
}

/// Reads the counts that Draco's decoder would take memory for, and compares them with the size of the
/// stream.
bool plausible_stream(const char* data, size_t size) {
  draco::DecoderBuffer buffer;
  buffer.Init(data, size);
  draco::DracoHeader header;
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) return false;
  if (header.encoder_type != draco::TRIANGULAR_MESH) return false;
  const auto version = uint16_t(DRACO_BITSTREAM_VERSION(header.version_major, header.version_minor));
  buffer.set_bitstream_version(version);
  if (header.flags & METADATA_FLAG_MASK) {
    draco::GeometryMetadata metadata;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) return false;
  }
  const bool edgebreaker = header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING;
  uint64_t first = 0, second = 0;
  uint8_t traversal = 0;
  if (edgebreaker && !buffer.Decode(&traversal)) return false;
  if (edgebreaker && version < DRACO_BITSTREAM_VERSION(2, 2) && !decode_count(buffer, version, first))
    return false;
  if (!decode_count(buffer, version, first) || !decode_count(buffer, version, second)) return false;
  return std::max(first, second) <= kMostFacesPerByte * size;
}

std::unique_ptr<draco::Mesh> decode_stream(const char* data, size_t size) {
  if (!plausible_stream(data, size)) return nullptr;
  draco::DecoderBuffer buffer;
  buffer.Init(data, size);
  draco::Decoder decoder;
  draco::StatusOr<std::unique_ptr<draco::Mesh>> mesh = decoder.DecodeMeshFromBuffer(&buffer);
  return mesh.ok() ? std::move(mesh).value() : nullptr;
}

template <typename T>
bool copy_attribute(const draco::Mesh& mesh, const draco::PointAttribute& attribute, int components,
                    unsigned char* out) {
  T values[16] = {};
  for (uint32_t i = 0; i < mesh.num_points(); ++i) {
    const draco::AttributeValueIndex index = attribute.mapped_index(draco::PointIndex(i));
    if (index.value() >= attribute.size()) return false;
    if (!attribute.ConvertValue<T>(index, int8_t(components), values)) return false;
    std::memcpy(out, values, sizeof(T) * size_t(components));
    out += sizeof(T) * size_t(components);
  }
  return true;
}

bool copy_attribute(const draco::Mesh& mesh, const draco::PointAttribute& attribute,
                    const tinygltf::Accessor& accessor, unsigned char* out) {
  const int components = tinygltf::GetNumComponentsInType(uint32_t(accessor.type));
  switch (accessor.componentType) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return copy_attribute<int8_t>(mesh, attribute, components, out);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return copy_attribute<uint8_t>(mesh, attribute, components, out);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return copy_attribute<int16_t>(mesh, attribute, components, out);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return copy_attribute<uint16_t>(mesh, attribute, components, out);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return copy_attribute<uint32_t>(mesh, attribute, components, out);
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return copy_attribute<float>(mesh, attribute, components, out);
    default:
      return false;
  }
}

/// One file's Draco streams on their way into the model.
class DracoExpansion {
 public:
  DracoExpansion(tinygltf::Model& model, const std::string& file, ExpandedBuffer& expanded)
      : model_(model), file_(file), expanded_(expanded), new_buffer_(int(model.buffers.size())) {}

  Status expand(tinygltf::Primitive& primitive, const std::string& place) {
    const tinygltf::Value extension = primitive.extensions.at(kDraco);
    const int view = extension.Has("bufferView") && extension.Get("bufferView").IsInt()
                         ? extension.Get("bufferView").GetNumberAsInt()
                         : -1;
    if (size_t(view) >= model_.bufferViews.size() || !extension.Has("attributes") ||
        !extension.Get("attributes").IsObject())
      return bad_input(file_, place, fmt::format("{} is malformed", kDraco), kCure);
    const std::unique_ptr<draco::Mesh> mesh = decode(size_t(view));
    if (!mesh)
      return bad_input(file_, place, fmt::format("{}: the compressed data is broken", kDraco), kCure);
    if (Status status = write_indices(*mesh, view, primitive, place); !status) return status;
    for (auto& [name, accessor] : primitive.attributes) {
      if (!extension.Get("attributes").Has(name)) continue;
      const int id = extension.Get("attributes").Get(name).GetNumberAsInt();
      if (Status status =
              write_attribute(*mesh, view, uint32_t(id), accessor, fmt::format("{} {}", place, name));
          !status)
        return status;
    }
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.extensions.erase(kDraco);
    return Nothing{};
  }

 private:
  std::unique_ptr<draco::Mesh> decode(size_t view_index) const {
    const tinygltf::BufferView& view = model_.bufferViews[view_index];
    const bool expanded = view.buffer == new_buffer_;  // compressed twice, once by each extension
    const Bytes& data = expanded ? expanded_.data : model_.buffers[size_t(view.buffer)].data;
    return decode_stream(reinterpret_cast<const char*>(data.data()) + view.byteOffset, view.byteLength);
  }

  /// A new view of `bytes` in the expanded buffer.
  Result<int> append_view(size_t bytes, const std::string& place) {
    const std::optional<size_t> offset = expanded_.append(bytes);
    if (!offset) return expanded_.too_much(file_, place);
    tinygltf::BufferView view;
    view.buffer = new_buffer_;
    view.byteOffset = *offset;
    view.byteLength = bytes;
    model_.bufferViews.push_back(view);
    return int(model_.bufferViews.size()) - 1;
  }

  /// The accessor to overwrite for `index`: itself, or a copy where another stream has already written it.
  int accessor_to_write(int index, int stream) {
    const auto [owner, is_new] = owners_.try_emplace(index, stream);
    if (is_new || owner->second == stream) return index;
    model_.accessors.push_back(tinygltf::Accessor(model_.accessors[size_t(index)]));
    return int(model_.accessors.size()) - 1;
  }

  void point_at(tinygltf::Accessor& accessor, int view, size_t count) {
    accessor.bufferView = view;
    accessor.byteOffset = 0;
    accessor.count = count;
    accessor.sparse.isSparse = false;
  }

  Status write_indices(const draco::Mesh& mesh, int stream, tinygltf::Primitive& primitive,
                       const std::string& place) {
    if (primitive.indices < 0) {
      tinygltf::Accessor accessor;
      accessor.type = TINYGLTF_TYPE_SCALAR;
      model_.accessors.push_back(accessor);
      primitive.indices = int(model_.accessors.size()) - 1;
    }
    if (size_t(primitive.indices) >= model_.accessors.size())
      return bad_input(file_, place, fmt::format("there is no accessor {}", primitive.indices), kCure);
    const size_t count = size_t(mesh.num_faces()) * 3;
    const Result<int> view = append_view(count * sizeof(uint32_t), place);
    if (!view) return view.error();
    unsigned char* out = expanded_.data.data() + model_.bufferViews[size_t(*view)].byteOffset;
    for (uint32_t f = 0; f < mesh.num_faces(); ++f)
      for (size_t corner = 0; corner < 3; ++corner, out += 4) {
        const uint32_t point = mesh.face(draco::FaceIndex(f))[corner].value();
        std::memcpy(out, &point, 4);
      }
    primitive.indices = accessor_to_write(primitive.indices, stream);
    tinygltf::Accessor& accessor = model_.accessors[size_t(primitive.indices)];
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    point_at(accessor, *view, count);
    return Nothing{};
  }

  Status write_attribute(const draco::Mesh& mesh, int stream, uint32_t id, int& index,
                         const std::string& place) {
    if (size_t(index) >= model_.accessors.size())
      return bad_input(file_, place, fmt::format("there is no accessor {}", index), kCure);
    const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(id);
    const tinygltf::Accessor& declared = model_.accessors[size_t(index)];
    const int component = tinygltf::GetComponentSizeInBytes(uint32_t(declared.componentType));
    const int components = tinygltf::GetNumComponentsInType(uint32_t(declared.type));
    if (!attribute || component <= 0 || components <= 0)
      return bad_input(file_, place, fmt::format("{} lacks this attribute", kDraco), kCure);
    const Result<int> view = append_view(size_t(mesh.num_points()) * size_t(component * components), place);
    if (!view) return view.error();
    if (!copy_attribute(mesh, *attribute, declared,
                        expanded_.data.data() + model_.bufferViews[size_t(*view)].byteOffset))
      return bad_input(file_, place, fmt::format("{}: the compressed data is broken", kDraco), kCure);
    index = accessor_to_write(index, stream);
    point_at(model_.accessors[size_t(index)], *view, mesh.num_points());
    return Nothing{};
  }

  tinygltf::Model& model_;
  const std::string& file_;
  ExpandedBuffer& expanded_;
  int new_buffer_;
  std::map<int, int> owners_;  ///< accessor -> the view of the stream that was written there
};

}  // namespace

ExpandedBuffer::ExpandedBuffer(const tinygltf::Model& model) : limit(size_t(1) << 30) {
  for (const tinygltf::Buffer& buffer : model.buffers) limit += 4096 * buffer.data.size();
}

std::optional<size_t> ExpandedBuffer::append(size_t bytes) {
  const size_t offset = (data.size() + 3) / 4 * 4;
  if (bytes > limit || offset > limit - bytes) return std::nullopt;
  data.resize(offset + bytes);
  used = true;
  return offset;
}

Error ExpandedBuffer::too_much(const std::string& file, const std::string& place) const {
  return bad_input(file, place, fmt::format("decompressed data exceeds {} MiB", limit >> 20),
                   "export the file again, without compression");
}

Status expand_draco(tinygltf::Model& model, const std::string& file, ExpandedBuffer& expanded) {
  DracoExpansion expansion(model, file, expanded);
  for (size_t m = 0; m < model.meshes.size(); ++m)
    for (size_t p = 0; p < model.meshes[m].primitives.size(); ++p) {
      tinygltf::Primitive& primitive = model.meshes[m].primitives[p];
      if (!primitive.extensions.contains(kDraco)) continue;
      const std::string place = fmt::format("mesh {} primitive {}", m, p);
      if (!primitive.extensions.at(kDraco).IsObject())
        return bad_input(file, place, fmt::format("{} is malformed", kDraco), kCure);
      if (Status status = expansion.expand(primitive, place); !status) return status;
    }
  return Nothing{};
}

}  // namespace goldthread
