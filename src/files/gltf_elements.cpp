#include "files/gltf_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include "files/gltf_read_container.h"

namespace goldthread {
namespace {

template <typename T>
T load_as(const uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

const char* type_name(int tinygltf_type) {
  constexpr std::pair<int, const char*> kNames[] = {
      {TINYGLTF_TYPE_SCALAR, "SCALAR"}, {TINYGLTF_TYPE_VEC2, "VEC2"}, {TINYGLTF_TYPE_VEC3, "VEC3"},
      {TINYGLTF_TYPE_VEC4, "VEC4"},     {TINYGLTF_TYPE_MAT2, "MAT2"}, {TINYGLTF_TYPE_MAT3, "MAT3"},
      {TINYGLTF_TYPE_MAT4, "MAT4"}};
  for (const auto& [type, name] : kNames)
    if (type == tinygltf_type) return name;
  return "";
}

/// Columns of byte and short matrices begin at multiples of 4 in a buffer.
struct Layout {
  size_t column_size = 0, column_stride = 0, columns = 1;
  size_t size() const { return column_stride * (columns - 1) + column_size; }

  static Layout of(const Elements& elements) {
    const size_t whole = elements.element_size();
    if (!elements.type.starts_with("MAT")) return {whole, whole, 1};
    const size_t columns = elements.type == "MAT2" ? 2 : elements.type == "MAT3" ? 3 : 4;
    return {whole / columns, (whole / columns + 3) / 4 * 4, columns};
  }
  void copy(uint8_t* to, const uint8_t* from) const {
    for (size_t c = 0; c < columns; ++c)
      std::memcpy(to + c * column_size, from + c * column_stride, column_size);
  }
};

/// `count` elements of `size` bytes every `stride` bytes from `offset` in a view, or nothing when they do not
/// fit.
std::optional<std::span<const uint8_t>> bytes_in_view(const tinygltf::Model& model, int view_index,
                                                      size_t offset, size_t count, size_t size,
                                                      size_t stride) {
  if (view_index < 0 || static_cast<size_t>(view_index) >= model.bufferViews.size()) return std::nullopt;
  const tinygltf::BufferView& view = model.bufferViews[static_cast<size_t>(view_index)];
  if (view.buffer < 0 || static_cast<size_t>(view.buffer) >= model.buffers.size()) return std::nullopt;
  const std::vector<unsigned char>& data = model.buffers[static_cast<size_t>(view.buffer)].data;
  if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset) return std::nullopt;
  if (offset > view.byteLength || stride == 0) return std::nullopt;
  const size_t room = view.byteLength - offset;
  if (count > 0 && (size > room || count - 1 > (room - size) / stride)) return std::nullopt;
  return std::span<const uint8_t>(data).subspan(view.byteOffset + offset, room);
}

size_t read_index(const uint8_t* bytes, ComponentType type) {
  if (type == ComponentType::kUnsignedByte) return *bytes;
  if (type == ComponentType::kUnsignedShort) return load_as<uint16_t>(bytes);
  return load_as<uint32_t>(bytes);
}

bool apply_sparse(const tinygltf::Model& model, const tinygltf::Accessor& accessor, const Layout& layout,
                  Elements& elements) {
  const auto& sparse = accessor.sparse;
  if (!sparse.isSparse) return true;
  const auto type = static_cast<ComponentType>(sparse.indices.componentType);
  const size_t width = component_size(type), count = static_cast<size_t>(std::max(0, sparse.count));
  const auto indices = bytes_in_view(model, sparse.indices.bufferView,
                                     static_cast<size_t>(sparse.indices.byteOffset), count, width, width);
  const auto values =
      bytes_in_view(model, sparse.values.bufferView, static_cast<size_t>(sparse.values.byteOffset), count,
                    layout.size(), layout.size());
  if (!indices || !values) return false;
  for (size_t i = 0; i < count; ++i) {
    const size_t index = read_index(indices->data() + i * width, type);
    if (index >= elements.count) return false;
    layout.copy(elements.bytes.data() + index * elements.element_size(), values->data() + i * layout.size());
  }
  return true;
}

template <typename Vector>
Elements wrap(std::span<const Vector> values, const char* type) {
  Elements elements;
  elements.type = type;
  elements.count = values.size();
  const auto* bytes = reinterpret_cast<const uint8_t*>(values.data());
  elements.bytes.assign(bytes, bytes + values.size_bytes());
  return elements;
}

}  // namespace

float Elements::value(size_t element, uint32_t which) const {
  const uint8_t* at = bytes.data() + element * element_size() + size_t{which} * component_size(component);
  switch (component) {
    case ComponentType::kByte: {
      const float v = load_as<int8_t>(at);
      return normalized ? std::max(v / 127, -1.0f) : v;
    }
    case ComponentType::kUnsignedByte:
      return normalized ? static_cast<float>(*at) / 255 : static_cast<float>(*at);
    case ComponentType::kShort: {
      const float v = load_as<int16_t>(at);
      return normalized ? std::max(v / 32767, -1.0f) : v;
    }
    case ComponentType::kUnsignedShort: {
      const float v = load_as<uint16_t>(at);
      return normalized ? v / 65535 : v;
    }
    case ComponentType::kUnsignedInt:
      return static_cast<float>(load_as<uint32_t>(at));
    case ComponentType::kFloat:
      return load_as<float>(at);
  }
  return 0;
}

Result<Elements> read_elements(const tinygltf::Model& model, int accessor_index, size_t expected_count,
                               const std::string& file) {
  const std::string place = fmt::format("accessor {}", accessor_index);
  if (accessor_index < 0 || static_cast<size_t>(accessor_index) >= model.accessors.size())
    return bad_input(file, place, "there is no such accessor", "export the file again");
  const tinygltf::Accessor& accessor = model.accessors[static_cast<size_t>(accessor_index)];
  if (accessor.count != expected_count)
    return bad_input(file, place,
                     fmt::format("has {} elements where {} are expected", accessor.count, expected_count),
                     "if the file has changed since it was read, bake it again");
  Elements elements;
  elements.component = static_cast<ComponentType>(accessor.componentType);
  elements.type = type_name(accessor.type);
  elements.normalized = accessor.normalized;
  elements.count = accessor.count;
  if (elements.element_size() == 0)
    return bad_input(file, place, "is of no known type", "export the file again");
  elements.bytes.resize(elements.count * elements.element_size());
  const Layout layout = Layout::of(elements);
  if (accessor.bufferView >= 0) {
    const bool known = static_cast<size_t>(accessor.bufferView) < model.bufferViews.size();
    const size_t own = known ? model.bufferViews[static_cast<size_t>(accessor.bufferView)].byteStride : 0;
    const size_t stride = own ? own : layout.size();
    const auto bytes =
        bytes_in_view(model, accessor.bufferView, accessor.byteOffset, elements.count, layout.size(), stride);
    if (!bytes) return bad_input(file, place, "lies outside its buffer", "export the file again");
    for (size_t i = 0; i < elements.count; ++i)
      layout.copy(elements.bytes.data() + i * elements.element_size(), bytes->data() + i * stride);
  }
  if (!apply_sparse(model, accessor, layout, elements))
    return bad_input(file, place, "has sparse values outside its buffer or itself", "export the file again");
  return elements;
}

Elements to_elements(std::span<const vec2> values) {
  return wrap(values, "VEC2");
}
Elements to_elements(std::span<const vec3> values) {
  return wrap(values, "VEC3");
}
Elements to_elements(std::span<const vec4> values) {
  return wrap(values, "VEC4");
}

uint32_t append_elements(GltfDocument& document, const Elements& elements, std::string_view attribute) {
  const uint32_t accessor = append_elements(document, elements.bytes, elements.component, elements.type,
                                            elements.normalized, elements.count);
  if (attribute != "POSITION") return accessor;
  // Bounds are of the stored numbers: integers stay integers, normalized or not.
  Elements stored;
  stored.component = elements.component;
  stored.type = elements.type;
  Json low = Json::array(), high = Json::array();
  for (uint32_t c = 0; c < elements.components(); ++c) {
    float least = std::numeric_limits<float>::max(), most = std::numeric_limits<float>::lowest();
    for (size_t i = 0; i < elements.count; ++i) {
      const uint8_t* at = elements.bytes.data() + i * elements.element_size();
      stored.bytes.assign(at, at + elements.element_size());
      least = std::min(least, stored.value(0, c));
      most = std::max(most, stored.value(0, c));
    }
    low.push_back(shortest(least));
    high.push_back(shortest(most));
  }
  document.json["accessors"][accessor]["min"] = low;
  document.json["accessors"][accessor]["max"] = high;
  return accessor;
}

}  // namespace goldthread
