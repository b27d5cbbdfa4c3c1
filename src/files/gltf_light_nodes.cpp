#include "files/gltf_light_nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "files/gltf_read_container.h"

namespace goldthread {
namespace {

constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";
constexpr uint32_t kNoGroup = 0xffffffffu;

/// Per lit node, per copy of it in the Scene: the group that copy belongs to.
using NodeGroups = std::map<uint32_t, std::vector<uint32_t>>;

NodeGroups groups_of_nodes(const DocumentMap& map, const std::vector<LitGroup>& groups) {
  NodeGroups nodes;
  for (const LitGroup& group : groups)
    for (uint32_t instance : group.instances) nodes[map.nodes[instance]];
  for (uint32_t node : map.nodes)
    if (const auto found = nodes.find(node); found != nodes.end()) found->second.push_back(kNoGroup);
  for (uint32_t g = 0; g < groups.size(); ++g)
    for (uint32_t instance : groups[g].instances) nodes[map.nodes[instance]][map.copies[instance]] = g;
  return nodes;
}

bool is_instanced(const Json& node) {
  return node.contains("extensions") && node["extensions"].contains(kInstancing);
}

/// Meshes that some node, or some copy of one, goes on using as they are.
std::set<uint32_t> meshes_still_used(const Json& json, const NodeGroups& nodes) {
  std::set<uint32_t> used;
  for (uint32_t n = 0; n < json["nodes"].size(); ++n) {
    if (!json["nodes"][n].contains("mesh")) continue;
    const auto found = nodes.find(n);
    const bool all_lit = found != nodes.end() && std::find(found->second.begin(), found->second.end(),
                                                           kNoGroup) == found->second.end();
    if (!all_lit) used.insert(json["nodes"][n]["mesh"].get<uint32_t>());
  }
  return used;
}

/// Per group, the index of its mesh in the document.
std::vector<uint32_t> place_meshes(GltfDocument& document, const std::vector<LitGroup>& groups,
                                   std::set<uint32_t> taken) {
  std::vector<uint32_t> places;
  std::map<uint32_t, uint32_t> copies;
  for (const LitGroup& group : groups) {
    Json mesh = group.lit_mesh;
    const uint32_t number = ++copies[group.mesh];
    if (taken.insert(group.mesh).second) {
      document.json["meshes"][group.mesh] = std::move(mesh);
      places.push_back(group.mesh);
      continue;
    }
    mesh["name"] = fmt::format("{}_lit{}", mesh.value("name", std::string("mesh")), number);
    places.push_back(append_to(document, "meshes", std::move(mesh)));
  }
  return places;
}

/// Translations, rotations and scales of a node's GPU instances, as members of plain nodes.
Result<std::vector<Json>> placements(const Json& attributes, size_t count, const SourceReader& read) {
  constexpr std::pair<const char*, const char*> kMembers[] = {
      {"TRANSLATION", "translation"}, {"ROTATION", "rotation"}, {"SCALE", "scale"}};
  std::vector<Json> nodes(count, Json::object());
  for (const auto& [attribute, member] : kMembers) {
    if (!attributes.contains(attribute)) continue;
    const Result<Elements> values = read.accessor(attributes[attribute].get<uint32_t>(), count);
    if (!values) return values.error();
    for (size_t i = 0; i < count; ++i) {
      vec4 value(0);
      const int components = static_cast<int>(std::min(4u, values->components()));
      for (int c = 0; c < components; ++c) value[c] = values->value(i, static_cast<uint32_t>(c));
      if (components == 4) value = value / std::max(length(value), 1e-20f);  // rotations kept in 8 or 16 bits
      nodes[i][member] = json_array({&value.x, static_cast<size_t>(components)});
    }
  }
  return nodes;
}

Status split_node(GltfDocument& document, uint32_t node_index, const std::vector<uint32_t>& copies,
                  const std::vector<uint32_t>& places, const SourceReader& read) {
  const Json node = document.json["nodes"][node_index];
  Result<std::vector<Json>> children =
      placements(node["extensions"][kInstancing].at("attributes"), copies.size(), read);
  if (!children) return children.error();
  Json numbers = node.value("children", Json::array());
  for (size_t i = 0; i < copies.size(); ++i) {
    Json& child = (*children)[i];
    child["mesh"] = copies[i] == kNoGroup ? node["mesh"].get<uint32_t>() : places[copies[i]];
    for (const char* member : {"skin", "weights"})
      if (node.contains(member)) child[member] = node[member];
    numbers.push_back(append_to(document, "nodes", child));
  }
  Json& parent = document.json["nodes"][node_index];
  for (const char* member : {"mesh", "skin", "weights"}) parent.erase(member);
  parent["extensions"].erase(kInstancing);
  if (parent["extensions"].empty()) parent.erase("extensions");
  parent["children"] = std::move(numbers);
  return Nothing{};
}

}  // namespace

Status assign_meshes(GltfDocument& document, const DocumentMap& map, const std::vector<LitGroup>& groups,
                     const SourceReader& read, const std::string& file) {
  const NodeGroups nodes = groups_of_nodes(map, groups);
  const std::vector<uint32_t> places =
      place_meshes(document, groups, meshes_still_used(document.json, nodes));
  for (const auto& [node, copies] : nodes) {
    const bool alike = std::equal(copies.begin() + 1, copies.end(), copies.begin());
    if (alike) {
      document.json["nodes"][node]["mesh"] = places[copies[0]];
      continue;
    }
    if (!is_instanced(document.json["nodes"][node]))
      return bad_input(file, fmt::format("node {}", node), "is placed several times but is not instanced",
                       "if the file has changed since it was read, bake it again");
    if (Status status = split_node(document, node, copies, places, read); !status) return status;
  }
  return Nothing{};
}

}  // namespace goldthread
