#include "files/gltf_read_primitives.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "files/gltf_read_container.h"
#include "files/gltf_read_materials.h"

namespace goldthread {
namespace {

constexpr const char* kExportAgain = "export the file again";

/// Joints and weights of one set (JOINTS_n, WEIGHTS_n): four of each a vertex.
struct Influences {
  std::vector<uint32_t> joints;
  std::vector<vec4> weights;
};

class PrimitiveReader {
 public:
  PrimitiveReader(AccessorReader& reader, const tinygltf::Primitive& source, std::string place,
                  const MeshPose& pose, Scene& scene)
      : reader_(reader), source_(source), place_(std::move(place)), pose_(pose), scene_(scene) {}

  /// Fills `out`; false where there is nothing to show.
  Result<bool> read(Primitive& out) {
    if (source_.mode < TINYGLTF_MODE_POINTS || source_.mode > TINYGLTF_MODE_TRIANGLE_FAN)
      return bad_input(reader_.file(), place_, fmt::format("mode {} is unknown", source_.mode), kExportAgain);
    if (source_.mode < TINYGLTF_MODE_TRIANGLES) return skip("points or lines; left out");
    const int position = attribute("POSITION");
    if (position == -1) return skip("has no positions; left out");
    for (const auto& step : {&PrimitiveReader::read_positions, &PrimitiveReader::read_indices,
                             &PrimitiveReader::read_attributes, &PrimitiveReader::read_tangents,
                             &PrimitiveReader::read_colours, &PrimitiveReader::apply_morph_targets,
                             &PrimitiveReader::apply_skin, &PrimitiveReader::assign_material})
      if (Status status = (this->*step)(out); !status) return status.error();
    settle_normals(out.normals);
    settle_tangents(out);
    return true;
  }

 private:
  int attribute(const std::string& name) const {
    const auto found = source_.attributes.find(name);
    return found == source_.attributes.end() ? -1 : found->second;
  }

  void warn(const std::string& message) { scene_.warnings.push_back(place_ + ": " + message); }

  bool skip(const std::string& message) {
    warn(message);
    return false;
  }

  /// Makes normals unit vectors. What has no direction becomes 0, which those who interpolate take as the
  /// face's own normal: what is no number would spread to its neighbours.
  void settle_normals(std::vector<vec3>& normals) {
    size_t none = 0;
    for (vec3& normal : normals) {
      normal = is_finite(normal) ? normalize_or(normal, vec3(0)) : vec3(0);
      if (normal == vec3(0)) ++none;
    }
    if (none > 0) warn(fmt::format("{} of {} normals have no direction; flat there", none, normals.size()));
    if (none == normals.size()) normals.clear();
  }

  /// Makes tangents unit vectors. Where one has no direction, or there are no normals that they belong to,
  /// they are left out: whoever needs them takes the texture coordinates'.
  void settle_tangents(Primitive& out) {
    std::vector<vec4>& tangents = out.tangents;
    if (tangents.empty()) return;
    size_t none = 0;
    for (vec4& tangent : tangents) {
      const vec3 along = is_finite(vec3(tangent)) ? normalize_or(vec3(tangent), vec3(0)) : vec3(0);
      if (along == vec3(0)) ++none;
      tangent = vec4(along, tangent.w < 0 ? -1.0f : 1.0f);
    }
    if (none > 0)
      warn(fmt::format("{} of {} tangents have no direction; taken from the texture coordinates", none,
                       tangents.size()));
    if (none > 0 || out.normals.empty()) tangents.clear();
  }

  /// Whether an attribute has an element for each vertex. Those that do not are left out: positions are
  /// enough.
  bool complete(const char* name, size_t count, size_t vertices) {
    if (count == vertices) return true;
    warn(fmt::format("{} has {} elements for {} vertices; left out", name, count, vertices));
    return false;
  }

  Status read_positions(Primitive& out) {
    const int accessor = attribute("POSITION");
    if (const Result<int> known = reader_.components(accessor); !known) return known.error();
    const int type = reader_.model().accessors[size_t(accessor)].componentType;
    if (type == TINYGLTF_COMPONENT_TYPE_INT || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
      return bad_input(reader_.file(), fmt::format("accessor {}", accessor),
                       fmt::format("component type {} cannot hold positions", type), kExportAgain);
    Result<std::vector<vec3>> positions = reader_.vec3s(accessor);
    if (!positions) return positions.error();
    out.positions = *std::move(positions);
    return Nothing{};
  }

  Status read_indices(Primitive& out) {
    std::vector<uint32_t> run;
    if (source_.indices != -1) {
      Result<std::vector<uint32_t>> indices = reader_.integers(source_.indices, 1);
      if (!indices) return indices.error();
      run = *std::move(indices);
    } else {
      if (out.positions.size() > UINT32_MAX)
        return bad_input(reader_.file(), place_, "has more than 4294967295 vertices", "split the mesh");
      run.resize(out.positions.size());
      std::iota(run.begin(), run.end(), 0u);
    }
    const auto beyond =
        std::find_if(run.begin(), run.end(), [&](uint32_t i) { return i >= out.positions.size(); });
    if (beyond != run.end())
      return bad_input(reader_.file(), place_,
                       fmt::format("index {} is vertex {}, beyond its {} vertices", beyond - run.begin(),
                                   *beyond, out.positions.size()),
                       kExportAgain);
    if (source_.mode == TINYGLTF_MODE_TRIANGLES && run.size() % 3 != 0)
      warn(fmt::format("{} indices are no whole number of triangles; the last are left out", run.size()));
    if (Status status = reader_.spend(run.size() * 3 * sizeof(uint32_t), place_); !status) return status;
    out.indices = expand_to_triangles(source_.mode, run);
    return Nothing{};
  }

  Status read_attributes(Primitive& out) {
    if (attribute("NORMAL") != -1) {
      Result<std::vector<vec3>> normals = reader_.vec3s(attribute("NORMAL"));
      if (!normals) return normals.error();
      if (complete("NORMAL", normals->size(), out.positions.size())) out.normals = *std::move(normals);
    }
    for (size_t set = 0; set < 2; ++set) {
      const std::string name = fmt::format("TEXCOORD_{}", set);
      if (attribute(name) == -1) continue;
      Result<std::vector<vec2>> texcoords = reader_.vec2s(attribute(name));
      if (!texcoords) return texcoords.error();
      if (complete(name.c_str(), texcoords->size(), out.positions.size()))
        out.texcoords[set] = *std::move(texcoords);
    }
    return Nothing{};
  }

  bool has_normal_texture() const {
    return source_.material != -1 && size_t(source_.material) < reader_.model().materials.size() &&
           scene_.materials[size_t(source_.material)].normal_texture.present();
  }

  /// Tangents, of those that need them.
  Status read_tangents(Primitive& out) {
    if (attribute("TANGENT") == -1 || !has_normal_texture()) return Nothing{};
    Result<std::vector<vec4>> tangents = reader_.vec4s(attribute("TANGENT"), false);
    if (!tangents) return tangents.error();
    if (complete("TANGENT", tangents->size(), out.positions.size())) out.tangents = *std::move(tangents);
    return Nothing{};
  }

  Status read_colours(Primitive& out) {
    const int accessor = attribute("COLOR_0");
    if (accessor == -1) return Nothing{};
    const Result<int> components = reader_.components(accessor);
    if (!components) return components.error();
    std::vector<vec4> colours;
    if (*components == 3) {
      const Result<std::vector<float>> rgb = reader_.floats(accessor, 3, true);
      if (!rgb) return rgb.error();
      colours.resize(rgb->size() / 3);
      for (size_t i = 0; i < colours.size(); ++i)
        colours[i] = vec4((*rgb)[3 * i], (*rgb)[3 * i + 1], (*rgb)[3 * i + 2], 1);
    } else {
      Result<std::vector<vec4>> rgba = reader_.vec4s(accessor, true);
      if (!rgba) return rgba.error();
      colours = *std::move(rgba);
    }
    if (complete("COLOR_0", colours.size(), out.positions.size())) out.colours = std::move(colours);
    return Nothing{};
  }

  /// Adds weight * displacement of attribute `name` of one target to `values`.
  Status add_target(const std::map<std::string, int>& target, const char* name, float weight,
                    std::vector<vec3>& values) {
    const auto found = target.find(name);
    if (found == target.end() || values.empty()) return Nothing{};
    const Result<std::vector<vec3>> moved = reader_.vec3s(found->second);
    if (!moved) return moved.error();
    if (!complete("a morph target", moved->size(), values.size())) return Nothing{};
    for (size_t i = 0; i < values.size(); ++i) values[i] += weight * (*moved)[i];
    return Nothing{};
  }

  Status apply_morph_targets(Primitive& out) {
    const size_t count = std::min(source_.targets.size(), pose_.weights.size());
    for (size_t t = 0; t < count; ++t) {
      const float weight = float(pose_.weights[t]);
      if (weight == 0) continue;
      if (Status status = add_target(source_.targets[t], "POSITION", weight, out.positions); !status)
        return status;
      if (Status status = add_target(source_.targets[t], "NORMAL", weight, out.normals); !status)
        return status;
      if (Status status = move_tangents(source_.targets[t], weight, out.tangents); !status) return status;
    }
    return Nothing{};
  }

  /// A target moves where tangents point; which side the bitangent is on stays.
  Status move_tangents(const std::map<std::string, int>& target, float weight, std::vector<vec4>& tangents) {
    std::vector<vec3> along(tangents.begin(), tangents.end());
    if (Status status = add_target(target, "TANGENT", weight, along); !status) return status;
    for (size_t i = 0; i < along.size(); ++i) tangents[i] = vec4(along[i], tangents[i].w);
    return Nothing{};
  }

  Result<std::vector<Influences>> read_influences(size_t vertices) {
    std::vector<Influences> sets;
    for (int set = 0; set < 4; ++set) {
      const int joints = attribute(fmt::format("JOINTS_{}", set));
      const int weights = attribute(fmt::format("WEIGHTS_{}", set));
      if (joints == -1 || weights == -1) break;
      Result<std::vector<uint32_t>> joint_values = reader_.integers(joints, 4);
      if (!joint_values) return joint_values.error();
      Result<std::vector<vec4>> weight_values = reader_.vec4s(weights, true);
      if (!weight_values) return weight_values.error();
      if (joint_values->size() != vertices * 4 || weight_values->size() != vertices)
        return bad_input(reader_.file(), place_, "joints and weights are not one for each vertex",
                         kExportAgain);
      sets.push_back({*std::move(joint_values), *std::move(weight_values)});
    }
    return sets;
  }

  /// The blend of joint matrices at one vertex, its weights summing to 1; nothing if it names no joint of the
  /// skin.
  std::optional<mat4> blend(const std::vector<Influences>& sets, size_t vertex) const {
    mat4 sum(0);
    float total = 0;
    for (const Influences& set : sets)
      for (int i = 0; i < 4; ++i) {
        const float weight = set.weights[vertex][i];
        const uint32_t joint = set.joints[4 * vertex + size_t(i)];
        if (weight == 0) continue;
        if (joint >= pose_.joints.size()) return std::nullopt;
        sum += weight * pose_.joints[joint];
        total += weight;
      }
    return total != 0 ? sum * (1 / total) : pose_.node;
  }

  Status apply_skin(Primitive& out) {
    if (!pose_.skinned) return Nothing{};
    const Result<std::vector<Influences>> sets = read_influences(out.positions.size());
    if (!sets) return sets.error();
    for (size_t v = 0; v < out.positions.size(); ++v) {
      const std::optional<mat4> matrix = sets->empty() ? pose_.node : blend(*sets, v);
      if (!matrix)
        return bad_input(reader_.file(), place_,
                         fmt::format("vertex {} names a joint that its skin lacks", v), kExportAgain);
      out.positions[v] = vec3(*matrix * vec4(out.positions[v], 1));
      if (!out.normals.empty()) out.normals[v] = area_vector_transform(mat3(*matrix)) * out.normals[v];
      if (!out.tangents.empty())
        out.tangents[v] = vec4(mat3(*matrix) * vec3(out.tangents[v]), out.tangents[v].w);
    }
    return Nothing{};
  }

  Status assign_material(Primitive& out) {
    const size_t count = reader_.model().materials.size();
    if (source_.material != -1 && size_t(source_.material) >= count)
      return bad_input(reader_.file(), place_, fmt::format("there is no material {}", source_.material),
                       kExportAgain);
    out.material = uint32_t(source_.material != -1 ? size_t(source_.material) : count);
    if (out.material == scene_.materials.size()) {
      scene_.materials.push_back(default_material());
      warn("it and maybe others have no material; they are taken as 80% grey");
    }
    return Nothing{};
  }

  AccessorReader& reader_;
  const tinygltf::Primitive& source_;
  std::string place_;
  const MeshPose& pose_;
  Scene& scene_;
};

}  // namespace

Result<Mesh> read_gltf_mesh(AccessorReader& reader, size_t index, const MeshPose& pose, Scene& scene) {
  const tinygltf::Mesh& source = reader.model().meshes[index];
  Mesh mesh;
  mesh.name = source.name;
  for (size_t p = 0; p < source.primitives.size(); ++p) {
    PrimitiveReader primitive_reader(reader, source.primitives[p],
                                     fmt::format("mesh {} primitive {}", index, p), pose, scene);
    Primitive primitive;
    primitive.source_primitive = uint32_t(p);
    const Result<bool> shown = primitive_reader.read(primitive);
    if (!shown) return shown.error();
    if (*shown) mesh.primitives.push_back(std::move(primitive));
  }
  return mesh;
}

std::vector<uint32_t> expand_to_triangles(int mode, const std::vector<uint32_t>& run) {
  std::vector<uint32_t> corners;
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    corners = run;
    corners.resize(run.size() / 3 * 3);
    return corners;
  }
  if (run.size() < 3) return corners;
  corners.reserve((run.size() - 2) * 3);
  // glTF 2.0 section 3.7.2.1: every other triangle of a strip turns around to keep its side; fans end in
  // vertex 0.
  for (size_t i = 0; i + 2 < run.size(); ++i)
    if (mode == TINYGLTF_MODE_TRIANGLE_STRIP)
      corners.insert(corners.end(), {run[i], run[i + 1 + i % 2], run[i + 2 - i % 2]});
    else
      corners.insert(corners.end(), {run[i + 1], run[i + 2], run[0]});
  return corners;
}

}  // namespace goldthread
