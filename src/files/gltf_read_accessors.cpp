#include "files/gltf_read_accessors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "files/gltf_read_container.h"
#include "files/gltf_read_values.h"

namespace goldthread {
namespace {

constexpr const char* kExportAgain = "export the file again";

std::string accessor_place(int accessor) {
  return fmt::format("accessor {}", accessor);
}

template <typename T>
T load(const unsigned char* p) {
  T value;
  std::memcpy(&value, p, sizeof(T));
  return value;
}

/// One component as a float. Normalized integers map as glTF 2.0 section 3.11 says: c/127 and never below -1.
float component_as_float(const unsigned char* p, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
      const float v = float(load<int8_t>(p));
      return normalized ? std::max(v / 127.0f, -1.0f) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
      const float v = float(load<uint8_t>(p));
      return normalized ? v / 255.0f : v;
    }
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
      const float v = float(load<int16_t>(p));
      return normalized ? std::max(v / 32767.0f, -1.0f) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
      const float v = float(load<uint16_t>(p));
      return normalized ? v / 65535.0f : v;
    }
    case TINYGLTF_COMPONENT_TYPE_INT: {
      const double v = double(load<int32_t>(p));
      return float(normalized ? std::max(v / 2147483647.0, -1.0) : v);
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: {
      const double v = double(load<uint32_t>(p));
      return float(normalized ? v / 4294967295.0 : v);
    }
    case TINYGLTF_COMPONENT_TYPE_DOUBLE:
      return float(load<double>(p));
    default:
      return load<float>(p);
  }
}

uint32_t component_as_integer(const unsigned char* p, int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<uint8_t>(p);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<uint16_t>(p);
    default:
      return load<uint32_t>(p);
  }
}

bool is_unsigned_type(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

/// Columns of matrices start at multiples of 4 bytes: bytes to skip after each column.
size_t column_padding(const tinygltf::Accessor& accessor, size_t component) {
  if (accessor.type == TINYGLTF_TYPE_MAT2 && component == 1) return 2;
  if (accessor.type == TINYGLTF_TYPE_MAT3 && component < 4) return component;
  return 0;
}

struct ElementLayout {
  size_t component = 0, components = 0, rows = 0, padding = 0;

  explicit ElementLayout(const tinygltf::Accessor& accessor)
      : component(size_t(tinygltf::GetComponentSizeInBytes(uint32_t(accessor.componentType)))),
        components(size_t(tinygltf::GetNumComponentsInType(uint32_t(accessor.type)))),
        padding(column_padding(accessor, component)) {
    const bool matrix = accessor.type >= TINYGLTF_TYPE_MAT2 && accessor.type <= TINYGLTF_TYPE_MAT4;
    rows = matrix ? size_t(accessor.type - 32) : components;
  }
  size_t offset(size_t i) const { return i * component + i / rows * padding; }
  size_t size() const { return offset(components - 1) + component; }
};

}  // namespace

AccessorReader::AccessorReader(const tinygltf::Model& model, const std::string& file)
    : model_(model), file_(file), left_(size_t(1) << 30) {
  for (const tinygltf::Buffer& buffer : model.buffers) left_ += 4096 * buffer.data.size();
  for (const std::string& name : model.extensionsRequired)
    if (!is_known_extension(name)) unknown_ = name;
}

Status AccessorReader::spend(size_t bytes, const std::string& place) {
  if (bytes > left_)
    return bad_input(file_, place, "the file repeats its data until it fills the memory",
                     "give the meshes vertex buffers of their own");
  left_ -= bytes;
  return Nothing{};
}

Result<int> AccessorReader::components(int accessor) const {
  if (size_t(accessor) >= model_.accessors.size())
    return bad_input(file_, accessor_place(accessor), "there is no such accessor", kExportAgain);
  return tinygltf::GetNumComponentsInType(uint32_t(model_.accessors[size_t(accessor)].type));
}

Result<size_t> AccessorReader::count(int accessor) const {
  if (size_t(accessor) >= model_.accessors.size())
    return bad_input(file_, accessor_place(accessor), "there is no such accessor", kExportAgain);
  return model_.accessors[size_t(accessor)].count;
}

Result<const tinygltf::Accessor*> AccessorReader::find(int accessor, int expected) const {
  const Result<int> actual = components(accessor);
  if (!actual) return actual.error();
  const tinygltf::Accessor& found = model_.accessors[size_t(accessor)];
  if (*actual != expected)
    return bad_input(file_, accessor_place(accessor),
                     fmt::format("it has {} components where {} are needed", *actual, expected),
                     kExportAgain);
  if (tinygltf::GetComponentSizeInBytes(uint32_t(found.componentType)) <= 0)
    return bad_input(file_, accessor_place(accessor),
                     fmt::format("component type {} is unknown", found.componentType), kExportAgain);
  return &found;
}

Result<AccessorReader::Raw> AccessorReader::locate(int buffer_view, size_t offset, size_t element,
                                                   size_t count, bool packed,
                                                   const std::string& place) const {
  if (size_t(buffer_view) >= model_.bufferViews.size())
    return bad_input(file_, place, fmt::format("there is no bufferView {}", buffer_view), kExportAgain);
  const tinygltf::BufferView& view = model_.bufferViews[size_t(buffer_view)];
  const std::span data(model_.buffers[size_t(view.buffer)].data);
  Raw raw;
  raw.bytes = data.subspan(view.byteOffset, view.byteLength);  // in range since load_gltf_model
  raw.stride = packed || view.byteStride == 0 ? element : view.byteStride;
  raw.count = count;
  // Divisions, so that no huge number can overflow its way past the check.
  const size_t size = raw.bytes.size();
  const bool fits = count == 0 || (offset <= size && element <= size - offset &&
                                   (count - 1) <= (size - offset - element) / raw.stride);
  if (!fits)
    return bad_input(
        file_, place,
        fmt::format("{} elements of {} bytes, {} apart, lie beyond the {} bytes of bufferView {}", count,
                    element, raw.stride, size, buffer_view),
        "copy or export the file again");
  raw.bytes = raw.bytes.subspan(count == 0 ? 0 : offset);
  return raw;
}

template <typename T, typename Convert>
Status AccessorReader::overlay_sparse(const tinygltf::Accessor& accessor, const std::string& place,
                                      std::vector<T>& values, Convert convert) const {
  const auto& sparse = accessor.sparse;
  const ElementLayout layout(accessor);
  const auto negative = [](auto v) { return std::cmp_less(v, 0); };  // newer tinygltf: offsets are size_t
  if (negative(sparse.count) || negative(sparse.indices.byteOffset) || negative(sparse.values.byteOffset) ||
      !is_unsigned_type(sparse.indices.componentType))
    return bad_input(file_, place, "its sparse part is malformed", kExportAgain);
  const size_t index_size = size_t(tinygltf::GetComponentSizeInBytes(uint32_t(sparse.indices.componentType)));
  const size_t count = size_t(sparse.count);
  const Result<Raw> indices = locate(sparse.indices.bufferView, size_t(sparse.indices.byteOffset), index_size,
                                     count, true, place + " sparse indices");
  if (!indices) return indices.error();
  const Result<Raw> replaced = locate(sparse.values.bufferView, size_t(sparse.values.byteOffset),
                                      layout.size(), count, true, place + " sparse values");
  if (!replaced) return replaced.error();
  for (size_t i = 0; i < count; ++i) {
    const uint32_t at = component_as_integer(&indices->bytes[i * index_size], sparse.indices.componentType);
    if (at >= accessor.count)
      return bad_input(file_, place,
                       fmt::format("sparse index {} is beyond its {} elements", at, accessor.count),
                       kExportAgain);
    for (size_t c = 0; c < layout.components; ++c)
      values[at * layout.components + c] =
          convert(&replaced->bytes[i * layout.size() + layout.offset(c)], accessor);
  }
  return Nothing{};
}

template <typename T, typename Convert>
Result<std::vector<T>> AccessorReader::read(int index, int expected, Convert convert) {
  const Result<const tinygltf::Accessor*> found = find(index, expected);
  if (!found) return found.error();
  const tinygltf::Accessor& accessor = **found;
  const std::string place = accessor_place(index);
  const ElementLayout layout(accessor);
  Result<Raw> raw = Raw{};
  if (accessor.bufferView >= 0) {
    raw = locate(accessor.bufferView, accessor.byteOffset, layout.size(), accessor.count, false, place);
    if (!raw) return raw.error();
  } else if (!accessor.sparse.isSparse && !unknown_.empty()) {
    return bad_input(file_, place, fmt::format("it holds no data of its own; the file requires {}", unknown_),
                     "export the file again, without that extension");
  }
  if (accessor.count > left_ / (layout.components * sizeof(T))) return spend(SIZE_MAX, place).error();
  const size_t total = accessor.count * layout.components;
  if (Status status = spend(total * sizeof(T), place); !status) return status.error();
  std::vector<T> values(total);
  for (size_t i = 0; i < raw->count; ++i)
    for (size_t c = 0; c < layout.components; ++c)
      values[i * layout.components + c] = convert(&raw->bytes[i * raw->stride + layout.offset(c)], accessor);
  if (accessor.sparse.isSparse)
    if (Status status = overlay_sparse(accessor, place, values, convert); !status) return status.error();
  return values;
}

Result<std::vector<float>> AccessorReader::floats(int accessor, int components, bool normalize) {
  return read<float>(accessor, components, [normalize](const unsigned char* p, const tinygltf::Accessor& a) {
    return component_as_float(p, a.componentType, a.normalized || normalize);
  });
}

Result<std::vector<uint32_t>> AccessorReader::integers(int accessor, int components) {
  if (const Result<const tinygltf::Accessor*> found = find(accessor, components); !found)
    return found.error();
  else if (!is_unsigned_type((*found)->componentType))
    return bad_input(file_, accessor_place(accessor),
                     fmt::format("component type {} is no unsigned integer", (*found)->componentType),
                     kExportAgain);
  return read<uint32_t>(accessor, components, [](const unsigned char* p, const tinygltf::Accessor& a) {
    return component_as_integer(p, a.componentType);
  });
}

namespace {

/// Floats regrouped into vectors of glm, which are arrays of floats in memory.
template <typename Vector>
Result<std::vector<Vector>> regroup(const Result<std::vector<float>>& floats) {
  if (!floats) return floats.error();
  std::vector<Vector> vectors(floats->size() * sizeof(float) / sizeof(Vector));
  if (!vectors.empty())
    std::memcpy(static_cast<void*>(vectors.data()), floats->data(), vectors.size() * sizeof(Vector));
  return vectors;
}

}  // namespace

Result<std::vector<vec2>> AccessorReader::vec2s(int accessor) {
  return regroup<vec2>(floats(accessor, 2));
}
Result<std::vector<vec3>> AccessorReader::vec3s(int accessor) {
  return regroup<vec3>(floats(accessor, 3));
}
Result<std::vector<vec4>> AccessorReader::vec4s(int accessor, bool normalize) {
  return regroup<vec4>(floats(accessor, 4, normalize));
}
Result<std::vector<mat4>> AccessorReader::mat4s(int accessor) {
  return regroup<mat4>(floats(accessor, 16));
}

}  // namespace goldthread
