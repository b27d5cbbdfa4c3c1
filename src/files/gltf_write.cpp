#include "files/gltf_write.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include "files/atomic_file.h"
#include "files/file_name.h"
#include "files/gltf_read_container.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;

/// A file name as a relative URI.
std::string name_to_uri(std::string_view name) {
  std::string uri;
  for (char c : name) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                       std::string_view("-._~").find(c) != std::string_view::npos;
    char escaped[4];
    std::snprintf(escaped, sizeof escaped, "%%%02X", static_cast<unsigned>(static_cast<uint8_t>(c)));
    uri += plain ? std::string(1, c) : std::string(escaped);
  }
  return uri;
}

bool same_folder(const std::string& a, const std::string& b) {
  std::error_code trouble;
  const bool same = fs::equivalent(a.empty() ? "." : a, b.empty() ? "." : b, trouble);
  return same && !trouble;
}

/// By the first bytes, which are surer than a name.
std::string mime_type(const std::vector<uint8_t>& bytes) {
  const auto starts = [&](std::string_view magic, size_t at = 0) {
    return bytes.size() >= at + magic.size() &&
           std::memcmp(bytes.data() + at, magic.data(), magic.size()) == 0;
  };
  if (starts("\x89PNG")) return "image/png";
  if (starts("\xff\xd8\xff")) return "image/jpeg";
  if (starts("RIFF") && starts("WEBP", 8)) return "image/webp";
  if (starts("\xabKTX 20\xbb")) return "image/ktx2";
  if (starts("DDS ")) return "image/vnd-ms.dds";
  return "";
}

void embed_images(GltfDocument& document) {
  if (!document.json.contains("images")) return;
  for (Json& image : document.json["images"]) {
    if (!image.is_object() || !image.contains("uri") || !image["uri"].is_string()) continue;
    const std::string uri = image["uri"];
    if (uri.starts_with("data:")) continue;
    const Result<Bytes> bytes = fetch_uri(uri, document.source_file);
    if (!bytes || bytes->empty()) continue;
    const std::string type = mime_type(*bytes);
    if (type.empty() && !image.contains("mimeType")) continue;  // glTF wants a type beside a bufferView
    const uint32_t view = append_view(document, *bytes);
    image.erase("uri");
    image["bufferView"] = view;
    if (!type.empty()) image["mimeType"] = type;
  }
}

/// The photometric files of EXT_lights_ies.
void embed_profiles(GltfDocument& document) {
  const Json::json_pointer place("/extensions/EXT_lights_ies/lights");
  if (!document.json.contains(place) || !document.json[place].is_array()) return;
  for (Json& profile : document.json[place]) {
    if (!profile.is_object() || !profile.contains("uri") || !profile["uri"].is_string()) continue;
    const std::string uri = profile["uri"];
    if (uri.starts_with("data:")) continue;
    const Result<Bytes> bytes = fetch_uri(uri, document.source_file);
    if (!bytes || bytes->empty()) continue;
    profile.erase("uri");
    profile["bufferView"] = append_view(document, *bytes);
    profile["mimeType"] = "application/x-ies-lm-63";
  }
}

/// Buffer 0 becomes what `bin` holds now; `uri` is empty in a GLB.
void describe_buffer(GltfDocument& document, const std::string& uri) {
  document.bin.resize((document.bin.size() + 3) / 4 * 4);
  Json& buffers = document.json["buffers"];
  if (!buffers.is_array() || buffers.empty()) {
    if (document.bin.empty()) {
      document.json.erase("buffers");
      return;
    }
    buffers = Json::array({Json::object()});
  }
  if (document.bin.empty()) document.bin.resize(4);  // glTF has no empty buffers
  buffers[0].erase("uri");
  if (!uri.empty()) buffers[0]["uri"] = uri;
  buffers[0]["byteLength"] = document.bin.size();
}

void put32(std::vector<uint8_t>& bytes, uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<uint8_t>(value >> shift));
}

/// The 12-byte header, the JSON chunk, and the binary chunk's own header: all but the buffer.
std::optional<std::vector<uint8_t>> glb_head(const std::string& text, size_t bin_size) {
  const size_t text_size = (text.size() + 3) / 4 * 4;
  const size_t total = 12 + 8 + text_size + (bin_size ? 8 + bin_size : 0);
  if (total > 0xffffffffu) return std::nullopt;
  std::vector<uint8_t> head;
  head.reserve(text_size + 28);
  for (uint32_t word : {0x46546C67u, 2u, static_cast<uint32_t>(total)}) put32(head, word);
  put32(head, static_cast<uint32_t>(text_size));
  put32(head, 0x4E4F534Au);
  head.insert(head.end(), text.begin(), text.end());
  head.resize(20 + text_size, ' ');
  if (bin_size) {
    put32(head, static_cast<uint32_t>(bin_size));
    put32(head, 0x004E4942u);
  }
  return head;
}

/// Names out of CAD files are not always UTF-8; JSON must be.
std::string to_text(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

Status write_glb(const std::string& file, GltfDocument& document) {
  describe_buffer(document, "");
  const auto head = glb_head(to_text(document.json, -1), document.bin.size());
  if (!head)
    return Error{ErrorCode::kCannotWrite, "the scene is larger than the 4 GiB a .glb can hold", file, "",
                 "write .gltf instead"};
  Result<AtomicFile> output = AtomicFile::create(file);
  if (!output) return output.error();
  if (Status status = output->write(*head); !status) return status;
  if (Status status = output->write(document.bin); !status) return status;
  return output->commit();
}

Status write_gltf_and_bin(const std::string& file, GltfDocument& document) {
  const std::string bin_file = fs::path(file).replace_extension(".bin").string();
  describe_buffer(document, name_to_uri(fs::path(bin_file).filename().string()));
  Result<AtomicFile> text = AtomicFile::create(file);
  if (!text) return text.error();
  if (Status status = text->write(to_text(document.json, 1)); !status) return status;
  if (document.bin.empty()) return text->commit();

  Result<AtomicFile> bin = AtomicFile::create(bin_file);
  if (!bin) return bin.error();
  if (Status status = bin->write(document.bin); !status) return status;
  // Everything that is likely to fail comes before the first rename.
  if (Status status = bin->flush(); !status) return status;
  if (Status status = text->flush(); !status) return status;
  if (Status status = bin->commit(); !status) return status;
  return text->commit();
}

}  // namespace

Status write_gltf_document(const std::string& file, GltfDocument document) {
  const std::string extension = file_extension(file);
  if (extension != ".glb" && extension != ".gltf")
    return Error{ErrorCode::kCannotWrite, "is neither .glb nor .gltf", file, "",
                 "give the file one of these endings"};
  const bool beside_source =
      extension == ".gltf" && same_folder(fs::path(document.source_file).parent_path().string(),
                                          fs::path(file).parent_path().string());
  if (!beside_source) {
    embed_images(document);
    embed_profiles(document);
  }
  return extension == ".glb" ? write_glb(file, document) : write_gltf_and_bin(file, document);
}

}  // namespace goldthread
