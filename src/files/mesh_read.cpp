#include "files/mesh_read.h"

#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <map>
#include <optional>

#include "files/gltf_read_container.h"
#include "files/image_decode.h"

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

/// FBX files name their axes, which assimp leaves to its caller: a turn that brings their up axis to Y.
mat4 axis_correction(const aiScene& source) {
  int32_t up = 1, sign = 1;
  if (!source.mMetaData || !source.mMetaData->Get("UpAxis", up)) return mat4(1);
  source.mMetaData->Get("UpAxisSign", sign);
  if (up == 2 && sign > 0) return mat4(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1);
  return mat4(1);
}

class MeshFileReader {
 public:
  MeshFileReader(const aiScene& source, const std::string& file) : source_(source), file_(file) {}

  Result<Scene> read() {
    scene_.file = file_;
    for (unsigned i = 0; i < source_.mNumMaterials; ++i) read_material(*source_.mMaterials[i]);
    if (scene_.materials.empty()) scene_.materials.emplace_back().metallic = 0;
    for (unsigned i = 0; i < source_.mNumMeshes; ++i)
      if (Status status = read_mesh(*source_.mMeshes[i], i); !status) return status.error();
    if (source_.mRootNode) read_nodes();
    for (unsigned i = 0; i < source_.mNumLights; ++i) read_light(*source_.mLights[i]);
    if (!scene_.lights.empty())
      scene_.warnings.push_back(
          "lights: this format has no photometric units; their numbers are taken as candela");
    for (unsigned i = 0; i < source_.mNumCameras; ++i) read_camera(*source_.mCameras[i]);
    return std::move(scene_);
  }

 private:
  void read_material(const aiMaterial& source) {
    Material material;
    aiString name;
    if (source.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS) material.name = name.C_Str();
    material.metallic = 0;
    material.base_colour = vec3(0.8f);
    aiColor3D colour;
    if (source.Get(AI_MATKEY_COLOR_DIFFUSE, colour) == aiReturn_SUCCESS)
      material.base_colour = glm::clamp(to_vec3(colour), 0.0f, 1.0f);
    if (source.Get(AI_MATKEY_COLOR_EMISSIVE, colour) == aiReturn_SUCCESS)
      material.emission = glm::max(to_vec3(colour), vec3(0));
    float opacity = 1;
    if (source.Get(AI_MATKEY_OPACITY, opacity) == aiReturn_SUCCESS && opacity < 1 && opacity >= 0) {
      material.alpha = opacity;
      material.alpha_mode = AlphaMode::kBlend;
    }
    int two_sided = 0;
    if (source.Get(AI_MATKEY_TWOSIDED, two_sided) == aiReturn_SUCCESS) material.double_sided = two_sided != 0;
    material.base_colour_texture = read_texture(source, aiTextureType_DIFFUSE);
    if (material.emits()) material.emission_texture = read_texture(source, aiTextureType_EMISSIVE);
    scene_.materials.push_back(std::move(material));
  }

  static Wrap wrap_mode(aiTextureMapMode mode) {
    if (mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal) return Wrap::kClamp;
    return mode == aiTextureMapMode_Mirror ? Wrap::kMirror : Wrap::kRepeat;
  }

  Texture read_texture(const aiMaterial& material, aiTextureType type) {
    Texture texture;
    aiString path;
    unsigned channel = 0;
    aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    if (material.GetTexture(type, 0, &path, nullptr, &channel, nullptr, nullptr, modes) != aiReturn_SUCCESS ||
        channel > 1)
      return texture;
    texture.image = read_image(path.C_Str());
    texture.texcoord = uint8_t(channel);
    texture.wrap_u = wrap_mode(modes[0]);
    texture.wrap_v = wrap_mode(modes[1]);
    return texture;
  }

  /// A picture of the file itself or beside it; -1 and a warning where it cannot be had. Each is decoded
  /// once.
  int32_t read_image(const std::string& path) {
    const auto [known, is_new] = images_.try_emplace(path, -1);
    if (!is_new) return known->second;
    Result<Image> image = embedded_image(path);
    if (!image) {
      scene_.warnings.push_back(
          fmt::format("texture \"{}\": {}; materials keep their plain colour", path, image.error().message));
      return -1;
    }
    image->name = path;
    scene_.images.push_back(*std::move(image));
    return known->second = int32_t(scene_.images.size()) - 1;
  }

  Result<Image> embedded_image(const std::string& path) const {
    const aiTexture* inside = source_.GetEmbeddedTexture(path.c_str());
    if (!inside) {
      const Result<Bytes> bytes = fetch_uri(path, file_);
      return bytes ? decode_image(*bytes) : Result<Image>(bytes.error());
    }
    if (inside->mHeight == 0)  // encoded: mWidth counts bytes
      return decode_image({reinterpret_cast<const uint8_t*>(inside->pcData), inside->mWidth});
    Image image;
    image.width = inside->mWidth;
    image.height = inside->mHeight;
    image.rgba.reserve(size_t(image.width) * image.height * 4);
    for (size_t i = 0; i < size_t(image.width) * image.height; ++i) {
      const aiTexel& t = inside->pcData[i];
      image.rgba.insert(image.rgba.end(), {t.r, t.g, t.b, t.a});
    }
    return image;
  }

  /// V runs upwards in these formats and downwards in ours.
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
        primitive.colours.emplace_back(c.r, c.g, c.b, c.a);
      }
    }
    for (unsigned f = 0; f < source.mNumFaces; ++f) {
      const aiFace& face = source.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines
      for (unsigned corner = 0; corner < 3; ++corner) {
        if (face.mIndices[corner] >= source.mNumVertices)
          return bad_input(
              file_, place,
              fmt::format("face {} names vertex {} of {}", f, face.mIndices[corner], source.mNumVertices),
              "export the file again");
        primitive.indices.push_back(face.mIndices[corner]);
      }
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
      for (unsigned i = 0; i < node.mNumMeshes; ++i) {
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
  }

  mat4 placement(const aiString& name) const {
    const auto found = placed_.find(name.C_Str());
    return found == placed_.end() ? mat4(1) : found->second;
  }

  void read_light(const aiLight& source) {
    Light light;
    if (source.mType == aiLightSource_SPOT)
      light.kind = LightKind::kSpot;
    else if (source.mType == aiLightSource_DIRECTIONAL)
      light.kind = LightKind::kDirectional;
    else if (source.mType != aiLightSource_POINT) {
      scene_.warnings.push_back(
          fmt::format("light \"{}\": ambient or area light; left out", source.mName.C_Str()));
      return;
    }
    const mat4 world = placement(source.mName);
    light.name = source.mName.C_Str();
    light.intensity = glm::max(to_vec3(source.mColorDiffuse), vec3(0));
    light.position = vec3(world * vec4(to_vec3(source.mPosition), 1));
    light.direction = normalize_or(mat3(world) * to_vec3(source.mDirection), vec3(0, 0, -1));
    light.outer_cone = std::clamp(source.mAngleOuterCone / 2, 0.0f, kPi / 2);  // assimp's are full angles
    light.inner_cone = std::clamp(source.mAngleInnerCone / 2, 0.0f, light.outer_cone);
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
  Scene scene_;
  std::map<std::string, int32_t> images_;  ///< path -> Scene::images
  std::map<std::string, mat4> placed_;     ///< nodes by name, which is how lights and cameras refer to them
};

Result<Scene> read(const std::string& file) {
  // Opened first for a plain message, and so that assimp never sees a device or a folder.
  if (const Result<Bytes> bytes = read_file_bytes(file); !bytes)
    return bytes.error();
  else if (bytes->empty())
    return bad_input(file, "", "the file is empty", "export it again");
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const unsigned steps =
      aiProcess_Triangulate | aiProcess_JoinIdenticalVertices | aiProcess_SortByPType | aiProcess_GlobalScale;
  const aiScene* source = importer.ReadFile(file, steps);
  if (!source || (source->mFlags & AI_SCENE_FLAGS_INCOMPLETE))
    return bad_input(file, "", fmt::format("assimp cannot read it: {}", importer.GetErrorString()),
                     "export the file again, best as glTF");
  return MeshFileReader(*source, file).read();
}

}  // namespace

Result<Scene> read_mesh_file(const std::string& file) {
  try {
    return read(file);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimit, "out of memory while reading", file, "", "close other programs"};
  } catch (const std::exception& problem) {
    return bad_input(file, "", problem.what(), "export the file again");
  }
}

}  // namespace goldthread
