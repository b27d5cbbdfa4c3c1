// Bytes of glTF files: reading them, splitting a GLB, following URIs. Nothing here knows what the JSON means.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "goldthread/error.h"

namespace goldthread {

using Bytes = std::vector<unsigned char>;

/// An Error of code kBadInput.
Error bad_input(const std::string& file, std::string place, std::string message, std::string cure = "");

/// All bytes of a regular file. Devices and folders are refused, so that the size is bounded by the disk.
Result<Bytes> read_file_bytes(const std::string& file);

/// The two parts of a glTF file, as views into its bytes. `binary` is empty where there is none.
struct GltfChunks {
  std::string_view json;
  std::span<const unsigned char> binary;
  bool is_glb = false;
};

/// Splits a GLB by its chunk headers; anything else is taken as JSON text.
Result<GltfChunks> split_gltf(const Bytes& bytes, const std::string& file);

/// How deep brackets nest in JSON text. Parsers that recurse need this to be small.
size_t json_depth(std::string_view text);

/// The bytes that a URI of the file at `base_file` names: a data URI's own, or those of the file beside it.
Result<Bytes> fetch_uri(const std::string& uri, const std::string& base_file);

/// Media type of a data URI ("" when it names none), or "" for other URIs.
std::string data_uri_type(std::string_view uri);

}  // namespace goldthread
