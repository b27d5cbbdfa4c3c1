// Tiny glTF files made in a test: JSON with one data-URI buffer, and accessors appended one at a time.
#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace goldthread::test {

using nlohmann::json;

constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kInt = 5124,
              kUnsignedInt = 5125, kFloat = 5126;

inline std::string base64(const std::string& bytes) {
  const char* const digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
  }
  return out;
}

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// A folder of this test's own, removed in the end.
class TempFolder {
 public:
  TempFolder() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("goldthread_") + test->test_suite_name() + "_" + test->name() + "_" +
                       std::to_string(::getpid());
    std::replace(name.begin(), name.end(), '/', '_');  // one folder, or its parents would stay behind
    path_ = std::filesystem::temp_directory_path() / name;
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path(name);
  }
  std::string path(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

struct GltfBuilder {
  json doc = {{"asset", {{"version", "2.0"}}}};
  std::string bytes;

  int push(const char* section, json value) {
    doc[section].push_back(std::move(value));
    return int(doc[section].size()) - 1;
  }

  /// A bufferView of new bytes, aligned to 4.
  int view(const std::string& data, json more = json::object()) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    more.update({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", data.size()}});
    bytes += data;
    return push("bufferViews", more);
  }

  template <typename T>
  int accessor(const std::vector<T>& values, const char* type, int component, json more = json::object()) {
    const size_t components = std::string(type) == "SCALAR" ? 1
                              : std::string(type) == "MAT4" ? 16
                                                            : size_t(type[3] - '0');
    more.update({{"bufferView", view(bytes_of(values))},
                 {"componentType", component},
                 {"count", values.size() / components},
                 {"type", type}});
    return push("accessors", more);
  }
  int vec3s(const std::vector<float>& values) { return accessor(values, "VEC3", kFloat); }
  int indices(const std::vector<uint16_t>& values) { return accessor(values, "SCALAR", kUnsignedShort); }

  /// A mesh of one primitive, and a node that shows it. Returns the primitive, to be added to.
  json& mesh(json primitive, json node = json::object()) {
    const int index = push("meshes", {{"primitives", json::array({std::move(primitive)})}});
    node["mesh"] = index;
    push("nodes", std::move(node));
    return doc["meshes"][size_t(index)]["primitives"][0];
  }

  /// One right triangle in the xy plane.
  json& triangle(json node = json::object()) {
    const int positions = vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
    return mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices({0, 1, 2})}},
                std::move(node));
  }

  std::string text() const {
    json copy = doc;
    if (!bytes.empty() && !copy.contains("buffers"))
      copy["buffers"] = json::array(
          {{{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}});
    return copy.dump();
  }
};

inline void append_32(std::string& out, size_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(char(value >> shift & 0xff));
}

/// The same file as GLB.
inline std::string to_glb(const GltfBuilder& builder) {
  json doc = builder.doc;
  doc["buffers"] = json::array({{{"byteLength", builder.bytes.size()}}});
  std::string text = doc.dump(), binary = builder.bytes;
  text.resize((text.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  std::string out = "glTF";
  append_32(out, 2);
  append_32(out, 12 + 8 + text.size() + 8 + binary.size());
  append_32(out, text.size());
  append_32(out, 0x4E4F534A);
  out += text;
  append_32(out, binary.size());
  append_32(out, 0x004E4942);
  return out + binary;
}

}  // namespace goldthread::test
