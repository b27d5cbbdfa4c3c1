#include "files/gltf_read_container.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace goldthread {
namespace {

namespace fs = std::filesystem;

uint32_t little_endian_32(const unsigned char* p) {
  return uint32_t(p[0]) | uint32_t(p[1]) << 8 | uint32_t(p[2]) << 16 | uint32_t(p[3]) << 24;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percent_decode(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (size_t i = 0; i < text.size(); ++i) {
    const bool escape = text[i] == '%' && i + 2 < text.size();
    const int high = escape ? hex_digit(text[i + 1]) : -1;
    const int low = escape ? hex_digit(text[i + 2]) : -1;
    if (high >= 0 && low >= 0) {
      out.push_back(char(high * 16 + low));
      i += 2;
    } else {
      out.push_back(text[i]);
    }
  }
  return out;
}

/// Base64 with or without padding, in either alphabet; white space is skipped. False on any other character.
bool base64_decode(std::string_view text, Bytes& out) {
  out.reserve(text.size() / 4 * 3 + 3);
  uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    uint32_t value = 0;
    if (c >= 'A' && c <= 'Z')
      value = uint32_t(c - 'A');
    else if (c >= 'a' && c <= 'z')
      value = uint32_t(c - 'a') + 26;
    else if (c >= '0' && c <= '9')
      value = uint32_t(c - '0') + 52;
    else if (c == '+' || c == '-')
      value = 62;
    else if (c == '/' || c == '_')
      value = 63;
    else if (c == '=')
      break;
    else if (c == ' ' || c == '\n' || c == '\r' || c == '\t')
      continue;
    else
      return false;
    bits = bits << 6 | value;
    count += 6;
    if (count >= 8) {
      count -= 8;
      out.push_back(static_cast<unsigned char>(bits >> count & 0xff));
    }
  }
  return true;
}

bool is_data_uri(std::string_view uri) {
  return uri.substr(0, 5) == "data:";
}

Result<Bytes> decode_data_uri(std::string_view uri, const std::string& file) {
  const size_t comma = uri.find(',');
  if (comma == std::string_view::npos)
    return bad_input(file, "", "a data URI has no comma", "export the file again");
  const bool base64 = uri.substr(0, comma).find(";base64") != std::string_view::npos;
  Bytes out;
  if (!base64) {
    const std::string text = percent_decode(uri.substr(comma + 1));
    out.assign(text.begin(), text.end());
  } else if (!base64_decode(uri.substr(comma + 1), out)) {
    return bad_input(file, "", "a data URI is not base64", "export the file again");
  }
  return out;
}

}  // namespace

Error bad_input(const std::string& file, std::string place, std::string message, std::string cure) {
  return Error{ErrorCode::kBadInput, std::move(message), file, std::move(place), std::move(cure)};
}

Result<Bytes> read_file_bytes(const std::string& file) {
  std::error_code status;
  const fs::file_status kind = fs::status(file, status);
  if (!fs::exists(kind)) return bad_input(file, "", "cannot open: no such file", "check the path");
  if (!fs::is_regular_file(kind))
    return bad_input(file, "", "cannot open: not a regular file", "name a file, not a folder or device");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return bad_input(file, "", "cannot open: permission denied", "check the file's permissions");
  const uintmax_t size = fs::file_size(file, status);
  if (status) return bad_input(file, "", "cannot open: " + status.message(), "check the file");
  Bytes bytes(size);
  stream.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(size));
  if (uintmax_t(stream.gcount()) != size)
    return bad_input(file, "", "cannot be read to its end", "check the disk");
  return bytes;
}

Result<GltfChunks> split_gltf(const Bytes& bytes, const std::string& file) {
  const char* const text = reinterpret_cast<const char*>(bytes.data());
  GltfChunks chunks;
  if (bytes.empty()) return bad_input(file, "", "the file is empty", "export it again");
  if (bytes.size() < 4 || std::memcmp(text, "glTF", 4) != 0) {
    chunks.json = std::string_view(text, bytes.size());
    if (chunks.json.substr(0, 3) == "\xEF\xBB\xBF") chunks.json.remove_prefix(3);
    return chunks;
  }
  chunks.is_glb = true;
  const char* const cut_off = "the file is cut off: it holds {} of its {} bytes";
  if (bytes.size() < 20)
    return bad_input(file, "GLB header", "the file is cut off", "copy or export it again");
  const uint32_t version = little_endian_32(&bytes[4]);
  if (version != 2)
    return bad_input(file, "GLB header", fmt::format("glTF {} is not supported", version),
                     "convert it to glTF 2.0");
  const uint64_t length = little_endian_32(&bytes[8]);
  if (length > bytes.size())
    return bad_input(file, "GLB header", fmt::format(fmt::runtime(cut_off), bytes.size(), length),
                     "copy or export it again");
  // Chunks follow one another from byte 12; the first is JSON, the first of kind BIN after it is the buffer.
  for (uint64_t at = 12; at + 8 <= length;) {
    const uint64_t size = little_endian_32(&bytes[at]);
    const uint32_t kind = little_endian_32(&bytes[at + 4]);
    if (size > length - at - 8)
      return bad_input(file, "GLB chunk", "a chunk is longer than the file", "copy or export it again");
    if (kind == 0x4E4F534Au && chunks.json.empty())
      chunks.json = std::string_view(text + at + 8, size);
    else if (kind == 0x004E4942u && chunks.binary.empty())
      chunks.binary = std::span(bytes).subspan(at + 8, size);
    at += 8 + (size + 3) / 4 * 4;
  }
  if (chunks.json.empty())
    return bad_input(file, "GLB chunk", "there is no JSON chunk", "export the file again");
  return chunks;
}

size_t json_depth(std::string_view text) {
  size_t depth = 0, deepest = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\')
        ++i;
      else if (c == '"')
        in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      deepest = std::max(deepest, ++depth);
    } else if ((c == '}' || c == ']') && depth > 0) {
      --depth;
    }
  }
  return deepest;
}

Result<Bytes> fetch_uri(const std::string& uri, const std::string& base_file) {
  if (is_data_uri(uri)) return decode_data_uri(uri, base_file);
  std::string path = percent_decode(uri);
  if (path.rfind("file://", 0) == 0) path.erase(0, 7);
  const std::string shown = path.size() > 200 ? path.substr(0, 200) + "..." : path;
  if (path.find('\0') != std::string::npos || path.empty())
    return bad_input(base_file, "", "cannot open \"\": not a file name", "export the file again");
  const fs::path folder = fs::path(base_file).parent_path();
  Result<Bytes> bytes = read_file_bytes((folder / path).string());
  if (!bytes && path.find('\\') != std::string::npos) {  // written by a careless exporter on Windows
    std::replace(path.begin(), path.end(), '\\', '/');
    bytes = read_file_bytes((folder / path).string());
  }
  if (bytes) return bytes;
  return bad_input(base_file, "", fmt::format("\"{}\": {}", shown, bytes.error().message),
                   "put it beside the scene file, where that says");
}

std::string data_uri_type(std::string_view uri) {
  if (!is_data_uri(uri)) return "";
  const size_t end = uri.find_first_of(";,");
  return end == std::string_view::npos ? "" : std::string(uri.substr(5, end - 5));
}

}  // namespace goldthread
