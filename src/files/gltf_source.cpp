#include "files/gltf_source.h"

#include <fmt/format.h>

#include <map>
#include <utility>

#include "files/gltf_read_container.h"

namespace goldthread {
namespace {

constexpr const char* kMeshopt[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};

Error changed(const Scene& scene, const std::string& place, const std::string& message) {
  return bad_input(scene.file, place, message, "if the file has changed since it was read, bake it again");
}

bool is_fallback(const Json& buffer) {
  for (const char* name : kMeshopt)
    if (buffer.contains("extensions") && buffer["extensions"].contains(name))
      return buffer["extensions"][name].value("fallback", false);
  return false;
}

/// Where the bytes of an old buffer went.
struct NewPlace {
  size_t buffer = 0;
  size_t offset = 0;
};

/// `view` is a bufferView, or meshopt's description of one inside it.
void move_view(Json& view, const std::vector<NewPlace>& places) {
  const NewPlace& place = places.at(view.at("buffer").get<size_t>());
  view["buffer"] = place.buffer;
  if (place.offset > 0) view["byteOffset"] = view.value("byteOffset", size_t{0}) + place.offset;
}

/// All buffers that hold bytes become buffer 0, so that one .bin or binary chunk takes them. Meshopt's
/// fallbacks, which only state a length, follow it.
void join_buffers(GltfDocument& document, const tinygltf::Model& model) {
  if (!document.json.contains("buffers")) return;
  const Json old = document.json["buffers"];
  Json joined = Json::object();
  Json fallbacks = Json::array();
  std::vector<NewPlace> places;
  bool first = true;
  for (size_t i = 0; i < old.size(); ++i) {
    if (is_fallback(old[i])) {
      fallbacks.push_back(old[i]);
      places.push_back({fallbacks.size(), 0});
      continue;
    }
    if (std::exchange(first, false)) joined = old[i];
    document.bin.resize((document.bin.size() + 15) / 16 * 16);  // no accessor loses its alignment
    places.push_back({0, document.bin.size()});
    const std::vector<unsigned char>& data = model.buffers.at(i).data;
    document.bin.insert(document.bin.end(), data.begin(), data.end());
  }
  document.json["buffers"] = Json::array({joined});
  for (Json& fallback : fallbacks) document.json["buffers"].push_back(fallback);
  if (!document.json.contains("bufferViews")) return;
  for (Json& view : document.json["bufferViews"]) {
    move_view(view, places);
    for (const char* name : kMeshopt)
      if (view.contains("extensions") && view["extensions"].contains(name))
        move_view(view["extensions"][name], places);
  }
}

DocumentMap map_scene(const Scene& scene) {
  DocumentMap map;
  std::map<uint32_t, uint32_t> seen;
  for (const Instance& instance : scene.instances) {
    map.nodes.push_back(instance.source_node);
    map.copies.push_back(seen[instance.source_node]++);
  }
  for (const Mesh& mesh : scene.meshes) {
    std::vector<uint32_t>& places = map.primitives.emplace_back();
    for (const Primitive& primitive : mesh.primitives) places.push_back(primitive.source_primitive);
  }
  return map;
}

/// After this, every instance has a node with a mesh, and every primitive of its mesh is one of the file's.
Status check_map(const GltfSource& source, const Scene& scene) {
  const Json& json = source.document.json;
  const size_t node_count = json.contains("nodes") ? json["nodes"].size() : 0;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const uint32_t node = source.map.nodes[i];
    const std::string place = fmt::format("node {}", node);
    if (node >= node_count || !json["nodes"][node].contains("mesh"))
      return changed(scene, place, "has no mesh");
    const size_t mesh = json["nodes"][node]["mesh"];
    if (mesh >= source.model.meshes.size()) return changed(scene, place, "names a mesh that is not there");
    const size_t count = json["meshes"].at(mesh).at("primitives").size();
    for (uint32_t primitive : source.map.primitives[scene.instances[i].mesh])
      if (primitive >= count || primitive >= source.model.meshes[mesh].primitives.size())
        return changed(scene, fmt::format("mesh {}", mesh), fmt::format("has no primitive {}", primitive));
  }
  return Nothing{};
}

Result<GltfSource> open(const Scene& scene) {
  Result<tinygltf::Model> model = load_gltf_model(scene.file);
  if (!model) return model.error();
  const Result<Bytes> bytes = read_file_bytes(scene.file);
  if (!bytes) return bytes.error();
  const Result<GltfChunks> chunks = split_gltf(*bytes, scene.file);
  if (!chunks) return chunks.error();
  GltfSource source;
  source.document.json = Json::parse(chunks->json);
  source.document.source_file = scene.file;
  source.model = *std::move(model);
  join_buffers(source.document, source.model);
  source.map = map_scene(scene);
  if (Status status = check_map(source, scene); !status) return status.error();
  return source;
}

}  // namespace

Result<GltfSource> open_source(const Scene& scene) {
  try {
    return open(scene);
  } catch (const Json::exception& problem) {  // a member of another type than glTF says
    return bad_input(scene.file, "", problem.what(), "export the file again");
  } catch (const std::out_of_range& problem) {
    return bad_input(scene.file, "", problem.what(), "export the file again");
  }
}

}  // namespace goldthread
