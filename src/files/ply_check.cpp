#include "files/ply_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "files/gltf_read_container.h"
#include "files/mesh_import.h"

namespace goldthread {
namespace {

struct Property {
  size_t size = 0;        ///< bytes of the value, or of each in a list
  size_t count_size = 0;  ///< bytes of a list's length, 0 for single values
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  enum class Kind { kText, kLittle, kBig } kind = Kind::kText;
  std::vector<PlyElement> elements;
  size_t size = 0;  ///< bytes up to the body
};

size_t size_of_type(const std::string& type) {
  constexpr std::pair<const char*, size_t> kTypes[] = {
      {"char", 1},   {"int8", 1},    {"uchar", 1},  {"uint8", 1},  {"short", 2}, {"int16", 2},
      {"ushort", 2}, {"uint16", 2},  {"int", 4},    {"int32", 4},  {"uint", 4},  {"uint32", 4},
      {"float", 4},  {"float32", 4}, {"double", 8}, {"float64", 8}};
  for (const auto& [name, size] : kTypes)
    if (type == name) return size;
  return 0;
}

std::optional<Property> parse_property(std::istringstream& words) {
  std::string type, count_type;
  words >> type;
  if (type != "list")
    return size_of_type(type) > 0 ? std::optional(Property{size_of_type(type), 0}) : std::nullopt;
  words >> count_type >> type;
  const Property list{size_of_type(type), size_of_type(count_type)};
  return list.size > 0 && list.count_size > 0 ? std::optional(list) : std::nullopt;
}

/// Takes one line of the header in; false when it makes no sense.
bool take_line(const std::string& line, Header& header) {
  std::istringstream words(line);
  std::string word;
  words >> word;
  if (word == "format") {
    words >> word;
    if (word == "binary_little_endian") header.kind = Header::Kind::kLittle;
    if (word == "binary_big_endian") header.kind = Header::Kind::kBig;
    return word == "ascii" || header.kind != Header::Kind::kText;
  }
  if (word == "element") {
    PlyElement& element = header.elements.emplace_back();
    return bool(words >> element.name >> element.count);
  }
  if (word == "property") {
    const std::optional<Property> property = parse_property(words);
    if (!property || header.elements.empty()) return false;
    header.elements.back().properties.push_back(*property);
    return true;
  }
  return word.empty() || word == "comment" || word == "obj_info";
}

Result<Header> parse_header(std::string_view bytes, const std::string& file) {
  Header header;
  size_t number = 0;
  for (size_t at = 0; at < bytes.size();) {
    const size_t end = bytes.find('\n', at);
    if (end == bytes.npos) break;
    std::string line(bytes.substr(at, end - at));
    at = end + 1;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    ++number;
    if (line.rfind("end_header", 0) == 0) {
      header.size = at;
      return header;
    }
    if (number > 1 && !take_line(line, header))  // the first names the format
      return bad_input(file, fmt::format("header line {}", number),
                       fmt::format("\"{}\" makes no sense", plain_text(line)), "export the file again");
  }
  return bad_input(file, "header", "the file is cut off: it has no end_header", "copy or export it again");
}

/// How many elements of this kind the text holds, one a line, from `at` on, which moves past them.
uint64_t count_lines(std::string_view bytes, const PlyElement& element, size_t& at) {
  uint64_t found = 0;
  while (found < element.count && at < bytes.size()) {
    const size_t end = std::min(bytes.find('\n', at), bytes.size());
    if (bytes.substr(at, end - at).find_first_not_of(" \t\r") != bytes.npos) ++found;
    at = end + 1;
  }
  return found;
}

uint64_t list_length(std::string_view bytes, size_t at, size_t size, bool big) {
  uint64_t length = 0;
  for (size_t i = 0; i < size; ++i)
    length |= uint64_t(static_cast<unsigned char>(bytes[at + (big ? size - 1 - i : i)])) << 8 * i;
  return length;
}

/// The same of binary bodies.
uint64_t count_binary(std::string_view bytes, const PlyElement& element, size_t& at, bool big) {
  for (uint64_t found = 0; found < element.count; ++found) {
    for (const Property& property : element.properties) {
      uint64_t values = 1;
      if (property.count_size > 0) {
        if (property.count_size > bytes.size() - at) return found;
        values = list_length(bytes, at, property.count_size, big);
        at += property.count_size;
      }
      if (values > (bytes.size() - at) / property.size) return found;
      at += values * property.size;
    }
  }
  return element.count;
}

}  // namespace

Status check_ply_length(std::string_view bytes, const std::string& file) {
  const Result<Header> header = parse_header(bytes, file);
  if (!header) return header.error();
  size_t at = header->size;
  for (const PlyElement& element : header->elements) {
    if (element.properties.empty()) continue;
    const uint64_t found = header->kind == Header::Kind::kText
                               ? count_lines(bytes, element, at)
                               : count_binary(bytes, element, at, header->kind == Header::Kind::kBig);
    if (found < element.count)
      return bad_input(file, fmt::format("{} {}", element.name, found),
                       fmt::format("the file is cut off: it holds {} of {}", found, element.count),
                       "copy or export it again");
  }
  return Nothing{};
}

}  // namespace goldthread
