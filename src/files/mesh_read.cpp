#include "files/mesh_read.h"

#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>

#include "files/gltf_read_container.h"
#include "files/mesh_import.h"
#include "files/mesh_read_materials.h"
#include "math/colour.h"

namespace goldthread {
namespace {

vec3 to_vec3(const aiVector3D& v) {
  return vec3(v.x, v.y, v.z);
}
vec3 to_vec3(const aiColor3D& c) {
  return vec3(c.r, c.g, c.b);
}

/// assimp stores rows, glm columns.
mat4 to_mat4(const aiMatrix4x4& m) {
  return mat4(m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2, m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4);
}

/// FBX files name their axes, which assimp leaves to its caller: the map that brings right, up and front to
/// X, Y and Z.
mat4 axis_correction(const aiScene& source) {
  if (!source.mMetaData) return mat4(1);
  int32_t axes[3] = {0, 1, 2}, signs[3] = {1, 1, 1};
  constexpr const char* kNames[] = {"CoordAxis", "UpAxis", "FrontAxis"};
  for (int row = 0; row < 3; ++row) {
    source.mMetaData->Get(kNames[row], axes[row]);
    source.mMetaData->Get(fmt::format("{}Sign", kNames[row]), signs[row]);
  }
  mat4 map(0);
  map[3][3] = 1;
  for (int row = 0; row < 3; ++row) {
    if (axes[row] < 0 || axes[row] > 2) return mat4(1);
    map[axes[row]][row] = signs[row] < 0 ? -1.0f : 1.0f;
  }
  return glm::determinant(mat3(map)) != 0 ? map : mat4(1);
}

/// Objects that the author has hidden in the program that wrote the FBX.
bool is_hidden(const aiNode& node) {
  bool shown = true;
  return node.mMetaData && node.mMetaData->Get("Show", shown) && !shown;
}

class MeshFileReader {
 public:
  MeshFileReader(const aiScene& source, const std::string& file)
      : source_(source), file_(file), format_(mesh_format(file)) {}

  Result<Scene> read() {
    scene_.file = file_;
    read_mesh_materials(source_, format_, scene_);
    for (unsigned i = 0; i < source_.mNumMeshes; ++i)
      if (Status status = read_mesh(*source_.mMeshes[i], i); !status) return status.error();
    paint_default_materials(source_, format_, scene_);
    if (source_.mRootNode) read_nodes();
    for (unsigned i = 0; i < source_.mNumLights; ++i) read_light(*source_.mLights[i]);
    if (!scene_.lights.empty())
      scene_.warnings.push_back(
          "lights: this format has no photometric units; their numbers are taken as candela");
    for (unsigned i = 0; i < source_.mNumCameras; ++i) read_camera(*source_.mCameras[i]);
    return std::move(scene_);
  }

 private:
  /// V runs upwards in these formats and downwards in ours. Their vertex colours are as a screen shows them.
  Status read_mesh(const aiMesh& source, unsigned index) {
    Mesh mesh;
    mesh.name = source.mName.C_Str();
    Primitive primitive;
    const std::string place = fmt::format("mesh {}", index);
    if (source.mMaterialIndex >= scene_.materials.size())
      return bad_input(file_, place, fmt::format("there is no material {}", source.mMaterialIndex),
                       "export the file again");
    primitive.material = source.mMaterialIndex;
    for (unsigned v = 0; v < source.mNumVertices; ++v) {
      primitive.positions.push_back(to_vec3(source.mVertices[v]));
      if (source.HasNormals()) primitive.normals.push_back(to_vec3(source.mNormals[v]));
      for (unsigned set = 0; set < 2; ++set)
        if (source.HasTextureCoords(set))
          primitive.texcoords[set].emplace_back(source.mTextureCoords[set][v].x,
                                                1 - source.mTextureCoords[set][v].y);
      if (source.HasVertexColors(0)) {
        const aiColor4D& c = source.mColors[0][v];
        primitive.colours.emplace_back(srgb_to_linear(c.r), srgb_to_linear(c.g), srgb_to_linear(c.b), c.a);
      }
    }
    for (unsigned f = 0; f < source.mNumFaces; ++f) {
      const aiFace& face = source.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines
      for (unsigned corner = 0; corner < 3; ++corner) primitive.indices.push_back(face.mIndices[corner]);
    }
    if (!primitive.indices.empty()) mesh.primitives.push_back(std::move(primitive));
    scene_.meshes.push_back(std::move(mesh));
    return Nothing{};
  }

  /// Depth first in the file's order, on a stack of our own: hierarchies may be deep.
  void read_nodes() {
    struct Visit {
      const aiNode* node;
      mat4 parent;
    };
    std::vector<Visit> stack = {{source_.mRootNode, axis_correction(source_)}};
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      const aiNode& node = *visit.node;
      const mat4 world = visit.parent * to_mat4(node.mTransformation);
      placed_.try_emplace(node.mName.C_Str(), world);
      const bool hidden = node.mNumMeshes > 0 && is_hidden(node);
      hidden_ += hidden ? 1 : 0;
      for (unsigned i = 0; i < node.mNumMeshes && !hidden; ++i) {
        if (node.mMeshes[i] >= scene_.meshes.size()) continue;
        Instance instance;
        instance.mesh = node.mMeshes[i];
        instance.transform = world;
        instance.source_node = uint32_t(scene_.instances.size());
        instance.name = node.mName.C_Str();
        scene_.instances.push_back(std::move(instance));
      }
      for (unsigned i = node.mNumChildren; i > 0; --i) stack.push_back({node.mChildren[i - 1], world});
    }
    if (hidden_ > 0)
      scene_.warnings.push_back(fmt::format("{} objects are hidden in the file and left out", hidden_));
  }

  mat4 placement(const aiString& name) const {
    const auto found = placed_.find(name.C_Str());
    return found == placed_.end() ? mat4(1) : found->second;
  }

  /// Full angles in assimp, half ones here. Collada has one angle; where the file has no extension with a
  /// second one, assimp's is a guess from the exponent, and far too wide.
  void read_cone(const aiLight& source, Light& light) {
    float outer = source.mAngleOuterCone;
    if (format_ == MeshFormat::kCollada) {
      if (!outer_cones_) outer_cones_ = names_outer_cone();
      if (!*outer_cones_) outer = source.mAngleInnerCone;
    }
    light.outer_cone = std::clamp(outer / 2, 0.0f, kPi / 2);
    light.inner_cone = std::clamp(source.mAngleInnerCone / 2, 0.0f, light.outer_cone);
  }

  bool names_outer_cone() const {
    const Result<Bytes> bytes = read_file_bytes(file_);
    if (!bytes) return false;
    const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    for (const char* tag : {"<outer_cone", "<penumbra_angle", "<falloff>", "<decay_falloff"})
      if (text.find(tag) != text.npos) return true;
    return false;
  }

  void read_light(const aiLight& source) {
    Light light;
    if (source.mType == aiLightSource_SPOT)
      light.kind = LightKind::kSpot;
    else if (source.mType == aiLightSource_DIRECTIONAL)
      light.kind = LightKind::kDirectional;
    else if (source.mType != aiLightSource_POINT) {
      scene_.warnings.push_back(
          fmt::format("light \"{}\": ambient or area light; left out", plain_text(source.mName.C_Str())));
      return;
    }
    const mat4 world = placement(source.mName);
    light.name = source.mName.C_Str();
    light.intensity = glm::max(to_vec3(source.mColorDiffuse), vec3(0));
    light.position = vec3(world * vec4(to_vec3(source.mPosition), 1));
    light.direction = normalize_or(mat3(world) * to_vec3(source.mDirection), vec3(0, 0, -1));
    if (light.kind == LightKind::kSpot) read_cone(source, light);
    scene_.lights.push_back(std::move(light));
  }

  void read_camera(const aiCamera& source) {
    const mat4 world = placement(source.mName);
    Camera camera;
    camera.name = source.mName.C_Str();
    camera.position = vec3(world * vec4(to_vec3(source.mPosition), 1));
    camera.forward = normalize_or(mat3(world) * to_vec3(source.mLookAt), camera.forward);
    const vec3 up = normalize_or(mat3(world) * to_vec3(source.mUp), camera.up);
    camera.up = normalize_or(up - dot(up, camera.forward) * camera.forward, up);
    camera.aspect = std::max(source.mAspect, 0.0f);
    const float horizontal = source.mHorizontalFOV;  // of the full width (Collada, FBX)
    if (horizontal > 0 && horizontal < kPi)
      camera.vertical_fov =
          2 * std::atan(std::tan(horizontal / 2) / (camera.aspect > 0 ? camera.aspect : 1.0f));
    scene_.cameras.push_back(std::move(camera));
  }

  const aiScene& source_;
  const std::string& file_;
  MeshFormat format_;
  Scene scene_;
  size_t hidden_ = 0;
  std::optional<bool> outer_cones_;     ///< of Collada: whether the file gives them
  std::map<std::string, mat4> placed_;  ///< nodes by name, which is how lights and cameras refer to them
};

Result<Scene> read(const std::string& file) {
  Assimp::Importer importer;
  const Result<const aiScene*> source = import_mesh_file(file, importer);
  if (!source) return source.error();
  return MeshFileReader(**source, file).read();
}

}  // namespace

Result<Scene> read_mesh_file(const std::string& file) {
  try {
    return read(file);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimit, "out of memory while reading", file, "", "close other programs"};
  } catch (const std::exception& problem) {
    return bad_input(file, "", plain_text(problem.what()), "export the file again");
  }
}

}  // namespace goldthread
