// The JSON of a glTF file made fit for tinygltf: checked where it is careless, and without the parts that it
// refuses in good files.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "files/gltf_load.h"
#include "goldthread/error.h"

namespace goldthread {

/// Parses the text and checks what every later step relies on: version 2, sections that are arrays of
/// objects, accessors, bufferViews and primitives with their required members. Nesting is limited to 100.
Result<nlohmann::json> parse_gltf_json(std::string_view text, const std::string& file);

/// tinygltf's model of a parsed file, complete but for the data of buffers and pictures. tinygltf refuses
/// files whose index accessors have no bufferView (sparse or Draco ones) or whose strides are odd, and would
/// fetch buffers and pictures in its own way; those members never reach it and are put back into the model by
/// hand.
Result<tinygltf::Model> build_gltf_model(const nlohmann::json& json, const std::string& file);

}  // namespace goldthread
