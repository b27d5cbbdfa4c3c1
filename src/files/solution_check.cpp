// Whether a solution read from a file fits together, so that nobody who uses it has to ask. See
// solution_archive.h.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "files/solution_archive.h"

namespace goldthread {
namespace {

std::string check_texture(const Texture& texture, const Scene& scene) {
  const bool known = texture.image >= -1 && texture.image < static_cast<int64_t>(scene.images.size());
  if (!known || texture.texcoord > 1) return "a texture that is not there";
  if (texture.wrap_u > Wrap::kMirror || texture.wrap_v > Wrap::kMirror) return "an unknown texture wrap";
  return "";
}

std::string check_material(const Material& material, const Scene& scene) {
  for (const Texture* texture :
       {&material.base_colour_texture, &material.metallic_texture, &material.emission_texture,
        &material.transmission_texture, &material.diffuse_transmission_texture,
        &material.diffuse_transmission_colour_texture, &material.normal_texture})
    if (std::string problem = check_texture(*texture, scene); !problem.empty()) return problem;
  return material.alpha_mode > AlphaMode::kBlend ? "an unknown alpha mode" : "";
}

std::string check_primitive(const Primitive& primitive, const Scene& scene) {
  const size_t vertices = primitive.positions.size();
  for (size_t size : {primitive.normals.size(), primitive.texcoords[0].size(), primitive.texcoords[1].size(),
                      primitive.colours.size(), primitive.tangents.size()})
    if (size != 0 && size != vertices) return "attributes of different lengths";
  if (primitive.indices.size() % 3 != 0) return "an incomplete triangle";
  if (std::any_of(primitive.indices.begin(), primitive.indices.end(),
                  [&](uint32_t i) { return i >= vertices; }))
    return "an index out of range";
  return primitive.material >= scene.materials.size() ? "a material that is not there" : "";
}

std::string check_lit(const LitPrimitive& lit, const Scene& scene) {
  if (lit.instance >= scene.instances.size()) return "an instance that is not there";
  const Mesh& mesh = scene.meshes[scene.instances[lit.instance].mesh];
  if (lit.primitive >= mesh.primitives.size()) return "a primitive that is not there";
  const Primitive& primitive = mesh.primitives[lit.primitive];
  const size_t vertices = lit.source_mesh ? primitive.positions.size() : lit.origins.size();
  if (lit.irradiance.size() != vertices) return "values for another number of vertices";
  if (!lit.irradiance_back.empty() && lit.irradiance_back.size() != vertices)
    return "back values for another number of vertices";
  if (lit.source_mesh && !(lit.origins.empty() && lit.faces.empty()))
    return "a mesh where it claims the source's";
  if (lit.face_parents.size() != lit.faces.size()) return "faces without parents";
  const size_t triangles = primitive.triangle_count();
  for (const VertexOrigin& origin : lit.origins)
    if (origin.triangle >= triangles) return "an origin out of range";
  for (uint32_t parent : lit.face_parents)
    if (parent >= triangles) return "a parent out of range";
  for (const UVec3& face : lit.faces)
    if (std::max({face.x, face.y, face.z}) >= vertices) return "a face out of range";
  return "";
}

std::string check_mapped(const MappedMesh& mapped, const Scene& scene, const LightAtlas& atlas) {
  if (mapped.page >= atlas.pages.size()) return "a page that is not there";
  LitPrimitive lit;
  static_cast<LitMesh&>(lit) = mapped;
  lit.irradiance.resize(mapped.coordinates.size());
  return check_lit(lit, scene);
}

std::string check_page(const AtlasPage& page) {
  const FloatImage& image = page.irradiance;
  const uint64_t texels = uint64_t{image.width} * image.height;
  return texels == 0 || image.pixels.size() != texels || page.covered.size() != texels
             ? "texels for another size"
             : "";
}

std::string check_atlas(const LightAtlas& atlas, const Scene& scene) {
  for (size_t i = 0; i < atlas.meshes.size(); ++i)
    if (std::string problem = check_mapped(atlas.meshes[i], scene, atlas); !problem.empty())
      return fmt::format("mapped mesh {} has {}", i, problem);
  for (size_t i = 0; i < atlas.pages.size(); ++i)
    if (std::string problem = check_page(atlas.pages[i]); !problem.empty())
      return fmt::format("light map {} has {}", i, problem);
  return "";
}

std::string check_light(const Light& light) {
  if (light.kind > LightKind::kDisc) return "of an unknown kind";
  if (!light.has_area()) return "";
  const auto is_length = [](float metres) { return metres > 0 && std::isfinite(metres); };
  return is_length(light.size.x) && is_length(light.size.y) ? "" : "without an area";
}

std::string check_meshes(const Scene& scene) {
  for (size_t m = 0; m < scene.meshes.size(); ++m)
    for (size_t p = 0; p < scene.meshes[m].primitives.size(); ++p)
      if (std::string problem = check_primitive(scene.meshes[m].primitives[p], scene); !problem.empty())
        return fmt::format("mesh {} primitive {} has {}", m, p, problem);
  return "";
}

}  // namespace

std::string find_contradiction(const Solution& solution) {
  const Scene& scene = solution.scene;
  for (size_t i = 0; i < scene.images.size(); ++i) {
    const Image& image = scene.images[i];
    if (!image.empty() && image.rgba.size() / 4 != uint64_t{image.width} * image.height)
      return fmt::format("image {} has pixels for another size", i);
  }
  for (size_t i = 0; i < scene.materials.size(); ++i)
    if (std::string problem = check_material(scene.materials[i], scene); !problem.empty())
      return fmt::format("material {} has {}", i, problem);
  if (std::string problem = check_meshes(scene); !problem.empty()) return problem;
  for (size_t i = 0; i < scene.instances.size(); ++i)
    if (scene.instances[i].mesh >= scene.meshes.size()) return fmt::format("instance {} has no mesh", i);
  for (size_t i = 0; i < scene.lights.size(); ++i)
    if (std::string problem = check_light(scene.lights[i]); !problem.empty())
      return fmt::format("light {} is {}", i, problem);
  for (size_t i = 0; i < solution.lighting.primitives.size(); ++i)
    if (std::string problem = check_lit(solution.lighting.primitives[i], scene); !problem.empty())
      return fmt::format("lighting {} has {}", i, problem);
  return solution.atlas ? check_atlas(*solution.atlas, scene) : "";
}

}  // namespace goldthread
