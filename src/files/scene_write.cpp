#include "files/scene_write.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>
#include <utility>

#include "files/file_name.h"
#include "files/gltf_build.h"
#include "files/gltf_light.h"
#include "files/gltf_light_map.h"
#include "files/gltf_read_container.h"
#include "files/gltf_source.h"
#include "files/gltf_write.h"

namespace goldthread {
namespace {

bool is_gltf(const std::string& file) {
  const std::string extension = file_extension(file);
  return extension == ".gltf" || extension == ".glb";
}

/// Attributes as the file has them, by way of tinygltf's model, in which nothing is compressed.
SourceReader read_from_file(const GltfSource& source, const Scene& scene) {
  SourceReader reader;
  reader.attribute = [&](const LitMesh& lit, uint32_t mesh, uint32_t primitive, const std::string& name,
                         int target) -> Result<Elements> {
    const size_t vertices =
        scene.meshes[scene.instances[lit.instance].mesh].primitives[lit.primitive].positions.size();
    const tinygltf::Primitive& part = source.model.meshes.at(mesh).primitives.at(primitive);
    const auto& attributes = target < 0 ? part.attributes : part.targets.at(static_cast<size_t>(target));
    const auto found = attributes.find(name);
    return read_elements(source.model, found == attributes.end() ? -1 : found->second, vertices, scene.file);
  };
  reader.accessor = [&](uint32_t accessor, size_t count) {
    return read_elements(source.model, static_cast<int>(accessor), count, scene.file);
  };
  return reader;
}

/// Attributes of a document that was built from the scene itself.
SourceReader read_from_scene(const Scene& scene) {
  SourceReader reader;
  reader.attribute = [&](const LitMesh& lit, uint32_t, uint32_t, const std::string& name,
                         int) -> Result<Elements> {
    const Primitive& primitive = scene.meshes[scene.instances[lit.instance].mesh].primitives[lit.primitive];
    if (name == "POSITION") return to_elements(std::span<const vec3>(primitive.positions));
    if (name == "NORMAL") return to_elements(std::span<const vec3>(unit_normals(primitive.normals)));
    if (name == "COLOR_0") return to_elements(std::span<const vec4>(clamp_colours(primitive.colours)));
    const std::vector<vec2>& texcoords = primitive.texcoords[name == "TEXCOORD_1" ? 1 : 0];
    const std::vector<vec2> origin(texcoords.empty() ? primitive.positions.size() : 0, vec2(0));
    return to_elements(std::span<const vec2>(texcoords.empty() ? origin : texcoords));
  };
  reader.accessor = [&](uint32_t, size_t) -> Result<Elements> {
    return bad_input(scene.file, "", "has no GPU instances");
  };
  return reader;
}

/// Opens or builds the document, has `add(document, map, read)` put light into it, and writes it.
template <typename Add>
Status write_with(const std::string& file, const Scene& scene, const Add& add) {
  if (is_gltf(scene.file)) {
    Result<GltfSource> source = open_source(scene);
    if (!source) return source.error();
    const SourceReader reader = read_from_file(*source, scene);
    if (Status status = add(source->document, source->map, reader); !status) return status;
    return write_gltf_document(file, std::move(source->document));
  }
  BuiltDocument built = build_document(scene);
  const SourceReader reader = read_from_scene(scene);
  if (Status status = add(built.document, built.map, reader); !status) return status;
  return write_gltf_document(file, std::move(built.document));
}

/// No exception leaves: those of the JSON library mean a file that is not what glTF says.
template <typename Write>
Status guarded(const std::string& file, const Scene& scene, const Write& write) {
  try {
    return write();
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimit, "out of memory while writing", file, "", "close other programs"};
  } catch (const std::exception& problem) {
    return bad_input(scene.file, "", problem.what(), "export the file again");
  }
}

}  // namespace

Status write_lit_scene(const std::string& file, const Scene& scene, const Lighting& lighting,
                       const SceneWriteOptions& options) {
  const auto add = [&](GltfDocument& document, const DocumentMap& map, const SourceReader& read) {
    return add_lighting(document, map, scene, lighting, options, read);
  };
  return guarded(file, scene, [&] { return write_with(file, scene, add); });
}

Status write_mapped_scene(const std::string& file, const Scene& scene, const LightAtlas& atlas,
                          std::span<const EncodedPage> encoded) {
  const auto add = [&](GltfDocument& document, const DocumentMap& map, const SourceReader& read) {
    return add_light_maps(document, map, scene, atlas, encoded, read);
  };
  return guarded(file, scene, [&] { return write_with(file, scene, add); });
}

Status write_baked_scene(const std::string& file, const Scene& scene, const LightAtlas& atlas,
                         std::span<const BakedPage> pages) {
  const auto add = [&](GltfDocument& document, const DocumentMap& map, const SourceReader& read) {
    return add_baked_pages(document, map, scene, atlas, pages, read);
  };
  return guarded(file, scene, [&] { return write_with(file, scene, add); });
}

Status write_occluded_scene(const std::string& file, const Scene& scene, const LightAtlas& atlas,
                            std::span<const EncodedPage> grey) {
  const auto add = [&](GltfDocument& document, const DocumentMap& map, const SourceReader& read) {
    return add_occlusion_pages(document, map, scene, atlas, grey, read);
  };
  return guarded(file, scene, [&] { return write_with(file, scene, add); });
}

Status write_scene(const std::string& file, const Scene& scene) {
  return guarded(file, scene, [&] { return write_gltf_document(file, build_document(scene).document); });
}

}  // namespace goldthread
