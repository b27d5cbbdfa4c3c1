#include "files/gltf_geometry.h"

#include <fmt/format.h>

#include <cstring>

#include "files/gltf_read_container.h"

namespace goldthread {
namespace {

constexpr const char* kDraco = "KHR_draco_mesh_compression";
/// Extensions of a primitive that number its vertices or triangles: meaningless on a refined mesh.
constexpr const char* kTiedToMesh[] = {"CESIUM_primitive_outline", "FB_ngon_encoding"};

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool mentions_extension(const Json& json, const char* name) {
  if (json.is_object() && json.contains("extensions") && json["extensions"].contains(name)) return true;
  if (!json.is_structured()) return false;
  for (const Json& child : json)
    if (mentions_extension(child, name)) return true;
  return false;
}

/// Drops the name from extensionsUsed and extensionsRequired when nothing in the document uses it.
void drop_unused_extension(Json& json, const char* name) {
  if (mentions_extension(json, name)) return;
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    if (!json.contains(list)) continue;
    Json kept = Json::array();
    for (const Json& known : json[list])
      if (known != name) kept.push_back(known);
    json[list] = kept;
    if (kept.empty()) json.erase(list);
  }
}

void drop_mesh_extensions(Json& primitive, bool source_mesh) {
  if (!primitive.contains("extensions")) return;
  Json& extensions = primitive["extensions"];
  extensions.erase(kDraco);
  if (!source_mesh)
    for (const char* name : kTiedToMesh) extensions.erase(name);
  if (extensions.empty()) primitive.erase("extensions");
}

bool is_direction(std::string_view name) {
  return name == "NORMAL" || name == "TANGENT";
}

/// Directions turned about, and with a tangent the side on which its bitangent lies, so that a normal texture
/// bends the back as it bends the front seen from behind.
Elements turned_about(const Elements& elements) {
  const uint32_t components = elements.components();
  std::vector<float> values(elements.count * components);
  for (size_t i = 0; i < elements.count; ++i)
    for (uint32_t c = 0; c < components; ++c) values[i * components + c] = -elements.value(i, c);
  Elements turned;
  turned.type = elements.type;
  turned.count = elements.count;
  turned.bytes.resize(values.size() * sizeof(float));
  std::memcpy(turned.bytes.data(), values.data(), turned.bytes.size());
  return turned;
}

size_t vertex_count(const Scene& scene, const LitMesh& lit) {
  return lit.source_mesh ? source_of(scene, lit).positions.size() : lit.origins.size();
}

}  // namespace

const Primitive& source_of(const Scene& scene, const LitMesh& lit) {
  return scene.meshes[scene.instances[lit.instance].mesh].primitives[lit.primitive];
}

bool same_mesh(const LitMesh& a, const LitMesh& b) {
  return a.source_mesh == b.source_mesh && same_bytes(a.origins, b.origins) && same_bytes(a.faces, b.faces);
}

Status check_mesh(const Scene& scene, const LitMesh& lit, size_t values) {
  bool fits = lit.instance < scene.instances.size() &&
              lit.primitive < scene.meshes[scene.instances[lit.instance].mesh].primitives.size();
  if (fits) {
    fits = values == vertex_count(scene, lit);
    for (const VertexOrigin& origin : lit.origins)
      fits = fits && origin.triangle < source_of(scene, lit).triangle_count();
    for (const UVec3& face : lit.faces)
      fits = fits && glm::all(glm::lessThan(face, UVec3(static_cast<uint32_t>(values))));
  }
  if (fits) return Nothing{};
  return bad_input(scene.file, fmt::format("instance {} primitive {}", lit.instance, lit.primitive),
                   "the light does not fit the scene", "bake it again");
}

Status GeometryWriter::renew(Json& primitive, const LitMesh& lit, uint32_t mesh, uint32_t place,
                             Facing facing) {
  Json& attributes = primitive.at("attributes");
  for (const char* light : {"_IRRADIANCE", "_IRRADIANCE_BACK"})
    attributes.erase(light);  // of an earlier bake
  const bool draco = primitive.contains("extensions") && primitive["extensions"].contains(kDraco);
  if (lit.source_mesh && !draco && facing == Facing::kFront) return check_vertex_count(primitive, lit);
  std::vector<Written>& known = written_[{mesh, place}];
  for (const Written& written : known)
    if (written.facing == facing && same_mesh(*written.lit, lit)) {
      primitive = written.primitive;
      return Nothing{};
    }
  if (Status status = rewrite_attributes(attributes, lit, mesh, place, -1, facing); !status) return status;
  if (primitive.contains("targets"))
    for (size_t t = 0; t < primitive["targets"].size(); ++t) {
      Status status =
          rewrite_attributes(primitive["targets"][t], lit, mesh, place, static_cast<int>(t), facing);
      if (!status) return status;
    }
  rewrite_indices(primitive, lit, facing);
  drop_mesh_extensions(primitive, lit.source_mesh);
  known.push_back({&lit, facing, primitive});
  return Nothing{};
}

void GeometryWriter::drop_unused_extensions() {
  for (const char* name : {kDraco, "EXT_mesh_gpu_instancing", kTiedToMesh[0], kTiedToMesh[1]})
    drop_unused_extension(document_.json, name);
}

Status GeometryWriter::check_vertex_count(const Json& primitive, const LitMesh& lit) const {
  const size_t accessor = primitive["attributes"].at("POSITION");
  const size_t count = document_.json["accessors"].at(accessor).at("count");
  const size_t lit_count = vertex_count(scene_, lit);
  if (count == lit_count) return Nothing{};
  return bad_input(scene_.file, fmt::format("accessor {}", accessor),
                   fmt::format("has {} vertices where {} are lit", count, lit_count),
                   "if the file has changed since it was read, bake it again");
}

Status GeometryWriter::rewrite_attributes(Json& attributes, const LitMesh& lit, uint32_t mesh, uint32_t place,
                                          int target, Facing facing) {
  for (auto& [name, accessor] : attributes.items()) {
    Result<Elements> elements = read_.attribute(lit, mesh, place, name, target);
    if (!elements) return elements.error();
    if (!lit.source_mesh)
      *elements = refine_elements(*elements, name, target >= 0, source_of(scene_, lit).indices, lit.origins);
    if (facing == Facing::kBack && is_direction(name)) *elements = turned_about(*elements);
    accessor = append_elements(document_, *elements, name);
  }
  return Nothing{};
}

void GeometryWriter::rewrite_indices(Json& primitive, const LitMesh& lit, Facing facing) {
  std::vector<uint32_t> corners;
  for (const UVec3& face : lit.faces) corners.insert(corners.end(), {face.x, face.y, face.z});
  if (lit.source_mesh) corners = source_of(scene_, lit).indices;  // strips expanded, compression undone
  if (facing == Facing::kBack)
    for (size_t i = 0; i + 2 < corners.size(); i += 3) std::swap(corners[i + 1], corners[i + 2]);
  primitive["indices"] = append_indices(document_, corners, vertex_count(scene_, lit));
  primitive.erase("mode");  // absent means triangles
}

}  // namespace goldthread
