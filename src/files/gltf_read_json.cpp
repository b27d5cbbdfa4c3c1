#include "files/gltf_read_json.h"

#include <fmt/format.h>

#include "files/gltf_read_container.h"

namespace goldthread {
namespace {

using nlohmann::json;

constexpr size_t kDeepestJson = 100;
constexpr const char* kExportAgain = "export the file again";

/// A section and what messages call one of its members.
struct Section {
  const char* key;
  const char* singular;
};
constexpr Section kSections[] = {{"buffers", "buffer"},      {"bufferViews", "bufferView"},
                                 {"accessors", "accessor"},  {"meshes", "mesh"},
                                 {"nodes", "node"},          {"scenes", "scene"},
                                 {"materials", "material"},  {"images", "image"},
                                 {"textures", "texture"},    {"skins", "skin"},
                                 {"samplers", "sampler"},    {"cameras", "camera"},
                                 {"animations", "animation"}};

/// Member of an object as array, or an empty one.
const json& member_array(const json& object, const char* key) {
  static const json none = json::array();
  const auto found = object.find(key);
  return found != object.end() && found->is_array() ? *found : none;
}

bool is_unsigned(const json& object, const char* key, bool required) {
  const auto found = object.find(key);
  return found == object.end() ? !required : found->is_number_unsigned();
}

Status check_sections(const json& root, const std::string& file) {
  for (const Section& section : kSections) {
    const auto found = root.find(section.key);
    if (found == root.end()) continue;
    if (!found->is_array()) return bad_input(file, section.key, "is not an array", kExportAgain);
    for (size_t i = 0; i < found->size(); ++i)
      if (!(*found)[i].is_object())
        return bad_input(file, fmt::format("{} {}", section.singular, i), "is not an object", kExportAgain);
  }
  return Nothing{};
}

/// Every member of the section must have these as whole numbers; the others, if at all, as whole numbers.
Status check_numbers(const json& root, const Section& section, std::initializer_list<const char*> required,
                     std::initializer_list<const char*> optional, const std::string& file) {
  const json& members = member_array(root, section.key);
  const auto complaint = [&](size_t i, const char* key) {
    return bad_input(file, fmt::format("{} {}", section.singular, i),
                     fmt::format("{} is missing or not a whole number from 0", key), kExportAgain);
  };
  for (size_t i = 0; i < members.size(); ++i) {
    for (const char* key : required)
      if (!is_unsigned(members[i], key, true)) return complaint(i, key);
    for (const char* key : optional)
      if (!is_unsigned(members[i], key, false)) return complaint(i, key);
  }
  return Nothing{};
}

Status check_data_members(const json& root, const std::string& file) {
  if (Status status = check_numbers(root, kSections[0], {"byteLength"}, {}, file); !status) return status;
  if (Status status =
          check_numbers(root, kSections[1], {"buffer", "byteLength"}, {"byteOffset", "byteStride"}, file);
      !status)
    return status;
  return check_numbers(root, kSections[2], {"count", "componentType"}, {"byteOffset", "bufferView"}, file);
}

/// tinygltf drops primitives that it cannot parse, and all later ones would change their numbers.
Status check_primitives(const json& root, const std::string& file) {
  const json& meshes = member_array(root, "meshes");
  for (size_t m = 0; m < meshes.size(); ++m) {
    const json& primitives = member_array(meshes[m], "primitives");
    for (size_t p = 0; p < primitives.size(); ++p) {
      const std::string place = fmt::format("mesh {} primitive {}", m, p);
      const json& primitive = primitives[p];
      if (!primitive.is_object() || !primitive.contains("attributes") || !primitive["attributes"].is_object())
        return bad_input(file, place, "there are no attributes", kExportAgain);
      for (const auto& attribute : primitive["attributes"].items())
        if (!attribute.value().is_number_unsigned())
          return bad_input(file, place, fmt::format("{} names no accessor", attribute.key()), kExportAgain);
      if (!is_unsigned(primitive, "indices", false))
        return bad_input(file, place, "indices names no accessor", kExportAgain);
    }
  }
  return Nothing{};
}

Status check_version(const json& root, const std::string& file) {
  const auto asset = root.find("asset");
  if (asset == root.end() || !asset->is_object() || !asset->contains("version") ||
      !(*asset)["version"].is_string())
    return bad_input(file, "asset", "this is not a glTF file: there is no asset version",
                     "name a .gltf or .glb file");
  const std::string version = (*asset)["version"];
  if (version.rfind("2.", 0) != 0)
    return bad_input(file, "asset", fmt::format("glTF {} is not supported", version.substr(0, 20)),
                     "convert it to glTF 2.0");
  return Nothing{};
}

/// A copy of the document that tinygltf accepts.
json reduced_for_tinygltf(const json& root) {
  json copy = root;
  copy.erase("buffers");
  // A picture needs a bufferView or a uri to be parsed; this one is looked for nowhere (see no_files below).
  if (copy.contains("images"))
    for (json& image : copy["images"]) {
      image.erase("bufferView");
      image["uri"] = "taken out";
    }
  if (copy.contains("bufferViews"))
    for (json& view : copy["bufferViews"]) view.erase("byteStride");
  if (copy.contains("meshes"))
    for (json& mesh : copy["meshes"])
      if (mesh.contains("primitives") && mesh["primitives"].is_array())
        for (json& primitive : mesh["primitives"]) primitive.erase("indices");
  return copy;
}

std::string string_member(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// Index as tinygltf holds it; what does not fit an int becomes the largest, which no section reaches.
int index_member(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number_integer()) return -1;
  const bool fits = found->is_number_unsigned() ? found->get<uint64_t>() <= uint64_t(INT32_MAX) : true;
  if (!fits) return INT32_MAX;
  const int64_t value = found->get<int64_t>();
  return value < 0 ? INT32_MAX : int(value);
}

void restore_members(const json& root, tinygltf::Model& model) {
  const json& buffers = member_array(root, "buffers");
  model.buffers.resize(buffers.size());
  for (size_t i = 0; i < buffers.size(); ++i) {
    model.buffers[i].uri = string_member(buffers[i], "uri");
    model.buffers[i].name = string_member(buffers[i], "name");
  }
  const json& views = member_array(root, "bufferViews");
  for (size_t i = 0; i < views.size(); ++i) {
    model.bufferViews[i].buffer = index_member(views[i], "buffer");
    model.bufferViews[i].byteStride = views[i].value("byteStride", size_t(0));
  }
  const json& accessors = member_array(root, "accessors");
  for (size_t i = 0; i < accessors.size(); ++i)
    model.accessors[i].bufferView = index_member(accessors[i], "bufferView");
  const json& images = member_array(root, "images");
  for (size_t i = 0; i < images.size(); ++i) {
    tinygltf::Image& image = model.images[i];
    image.uri = string_member(images[i], "uri");
    image.mimeType = string_member(images[i], "mimeType");
    image.bufferView = index_member(images[i], "bufferView");
    image.as_is = true;
  }
  const json& meshes = member_array(root, "meshes");
  for (size_t m = 0; m < meshes.size(); ++m) {
    const json& primitives = member_array(meshes[m], "primitives");
    for (size_t p = 0; p < primitives.size(); ++p) {
      tinygltf::Primitive& primitive = model.meshes[m].primitives[p];
      primitive.indices = index_member(primitives[p], "indices");
      for (auto& [name, accessor] : primitive.attributes)
        accessor = index_member(primitives[p]["attributes"], name.c_str());
    }
  }
}

bool keep_nothing(tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int,
                  void*) {
  return true;
}

}  // namespace

Result<nlohmann::json> parse_gltf_json(std::string_view text, const std::string& file) {
  while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.remove_suffix(1);
  if (json_depth(text) > kDeepestJson)
    return bad_input(file, "", fmt::format("JSON is nested deeper than {}", kDeepestJson), kExportAgain);
  json root;
  try {
    root = json::parse(text);
  } catch (const std::exception& problem) {
    return bad_input(file, "", fmt::format("this is not a glTF file: {}", problem.what()),
                     "name a .gltf or .glb file, or export it again");
  }
  if (!root.is_object())
    return bad_input(file, "", "this is not a glTF file: JSON, but no object", "name a .gltf or .glb file");
  for (const auto& check : {check_version, check_sections, check_data_members, check_primitives})
    if (Status status = check(root, file); !status) return status.error();
  return root;
}

Result<tinygltf::Model> build_gltf_model(const nlohmann::json& json, const std::string& file) {
  tinygltf::Model model;
  std::string errors, warnings;
  try {
    const std::string text = reduced_for_tinygltf(json).dump(-1, ' ', false, json::error_handler_t::replace);
    if (text.size() > UINT32_MAX)
      return bad_input(file, "", "the JSON is larger than 4 GiB", "store the geometry in buffers");
    tinygltf::TinyGLTF parser;
    tinygltf::FsCallbacks no_files{};  // with none set, tinygltf opens no file
    parser.SetFsCallbacks(no_files);
    parser.SetImageLoader(keep_nothing, nullptr);
    if (!parser.LoadASCIIFromString(&model, &errors, &warnings, text.c_str(), unsigned(text.size()), ""))
      return bad_input(file, "", "tinygltf cannot read it: " + errors.substr(0, 400), kExportAgain);
    restore_members(json, model);
  } catch (const std::exception& problem) {
    return bad_input(file, "", fmt::format("tinygltf cannot read it: {}", problem.what()), kExportAgain);
  }
  return model;
}

}  // namespace goldthread
