// The scene as a path tracer meets it: world triangles as they are in the file, nothing welded, clustered or
// averaged, so that it has no mistake in common with the solver that it judges.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "scene/scene.h"
#include "trace/texel_store.h"
#include "visibility/ray_caster.h"

namespace goldthread {

using CornerTexcoords = std::array<vec2, 3>;  ///< of a triangle's corners 0, 1 and 2

/// Where light that a point stops goes on diffusely, as shares of it.
struct Diffuse {
  vec3 back{0};     ///< to the side that it came from: reflectance
  vec3 through{0};  ///< to the other side: translucence
};

/// The triangles of one primitive of one instance.
struct TracedPart {
  uint32_t instance = 0, primitive = 0;
  const Primitive* source = nullptr;
  const Material* material = nullptr;
  uint32_t first_triangle = 0, triangle_count = 0;
  /// By set, of each triangle, side by side; empty where no texture asks for them.
  std::array<std::vector<CornerTexcoords>, 2> texcoords;
  std::vector<const Texture*> other_textures;  ///< that say what a point does with light, besides base colour
  /// What the material says of itself, where paths need not go far for it.
  bool unlit = false, lit_behind = false, translucent = false;
  bool shines = false;    ///< emits, and is not unlit
  bool even = false;      ///< no texture and no vertex colour: the next two hold all over
  Diffuse diffuse;        ///< as TracedScene::diffuse
  vec3 emission{0};       ///< as TracedScene::emission
  bool textured = false;  ///< nothing but the texture of its base colour makes its reflectance uneven:
  vec3 tint{0};           ///< reflectance is this times its colour
  Texture base_colour_texture;
  TexelView base_colour_texels;
};

/// One triangle of the world.
struct TracedTriangle {
  vec3 normal{0};        ///< unit, to the front: by the winding, turned where the instance mirrors
  uint32_t part = 0;     ///< TracedScene::parts()
  uint32_t source = 0;   ///< its number in the source primitive
  bool covered = false;  ///< whether another triangle owns some of its place
};

/// Where a ray ends.
struct Meeting {
  uint32_t triangle = Hit::kMiss;
  const TracedPart* part = nullptr;  ///< the triangle's; null where it missed
  float distance = 0;                ///< in lengths of the ray's direction
  vec2 weights{0};                   ///< barycentric, of the source triangle's corners 1 and 2
  vec3 normal{0};                    ///< unit, of the side that the ray comes from
  bool live = false;  ///< that side reflects and emits: the front, or either side of what is two-sided
  vec3 tint{1};       ///< what the light that came this way was multiplied by: Hit::tint

  bool missed() const { return triangle == Hit::kMiss; }
};

/// Borrows the scene, which must outlive it. Triangles without area or with corners that are not finite are
/// left out.
class TracedScene {
 public:
  explicit TracedScene(const Scene& scene);
  TracedScene(const TracedScene&) = delete;  // the ray caster calls back into this object
  TracedScene& operator=(const TracedScene&) = delete;

  /// The nearest surface. Of alpha-masked and blended ones, and of glass, a share of rays, their coverage, is
  /// stopped. Where surfaces overlap in one plane it is the place's owner (scene/place_claim.h), and
  /// where the black back of one sheet is met and another sheet in the same place shows its front, as in
  /// plates without thickness that are modelled as two, it is the front.
  Meeting closest(const Ray& ray) const;
  /// What `closest` makes of what the ray caster says.
  void meet(const Ray& ray, const Hit& hit, Meeting& met) const;
  /// Share of light that gets along the ray from near to far, in the channel that passes best.
  float transmittance(const Ray& ray) const { return caster_->transmittance(ray); }

  /// Diffuse light at a point for the rays that are stopped there. Reflectance is base colour x texture x
  /// vertex colour x (1 - metallic), within 0 and kMaxReflectance; 0 where the material is unlit. Not times
  /// coverage; of glass it is the diffuse share of all light over coverage.
  Diffuse diffuse(uint32_t triangle, vec2 weights) const {
    const TracedPart& part = parts_[triangles_[triangle].part];
    if (part.even) return part.diffuse;
    return diffuse(part, triangle, weights, base_colour_lookup(part, triangle, weights));
  }
  /// The same of what is met, where `begin_lookup` has said where its base colour is.
  Diffuse diffuse(const Meeting& met, const TextureLookup& base_colour) const {
    return diffuse(*met.part, met.triangle, met.weights, base_colour);
  }
  /// Emitted luminance, nits, over coverage just so; 0 where the material is unlit.
  vec3 emission(uint32_t triangle, vec2 weights) const {
    const TracedPart& part = parts_[triangles_[triangle].part];
    if (!part.shines) return vec3(0);
    return part.even ? part.emission : emission_at(part, triangle, weights);
  }
  /// The same of what is met: nothing from the back of what is translucent and yet one-sided.
  vec3 emission(const Meeting& met) const {
    if (!met.part->shines) return vec3(0);
    const bool dark = met.part->translucent && !met.part->material->double_sided &&
                      dot(met.normal, triangles_[met.triangle].normal) < 0;
    return dark ? vec3(0) : emission(met.triangle, met.weights);
  }
  /// Mean luminance of what a triangle emits, times coverage: its texture at a few dozen points.
  float mean_luminance(uint32_t triangle) const;
  /// Whether `owner` gets what the two triangles have in common, should they overlap (scene/place_claim.h).
  bool owns(uint32_t owner, uint32_t other) const;
  /// Whether another triangle owns the place `p` of this one.
  bool is_covered(uint32_t triangle, const vec3& p) const { return owner_at(triangle, p) != Hit::kMiss; }
  /// Whether anything is translucent.
  bool has_translucent() const { return has_translucent_; }
  /// Asks memory for what `meet` reads of a triangle, and does not wait for it.
  void prefetch(const Hit& hit) const {
    if (!hit.missed()) __builtin_prefetch(&triangles_[hit.triangle]);
  }
  /// The same for what `begin_lookup` reads.
  void prefetch_texcoords(const Meeting& met) const {
    for (const std::vector<CornerTexcoords>& set : met.part->texcoords)
      if (!set.empty()) __builtin_prefetch(&set[met.triangle - met.part->first_triangle]);
  }
  /// The same for what `diffuse` and `emission` read of textures; says where the base colour is.
  TextureLookup begin_lookup(const Meeting& met) const;
  /// Share of rays that a point stops, 0..1: 0 or 1 for a mask, the clamped alpha for a blend; of glass, what
  /// neither alpha nor transmission lets through.
  float coverage(uint32_t triangle, vec2 weights) const;
  /// What an unlit material shows: its colour, taken as nits.
  vec3 unlit_colour(uint32_t triangle, vec2 weights) const;

  const Scene& scene() const { return scene_; }
  std::span<const TracedPart> parts() const { return parts_; }
  std::span<const TracedTriangle> triangles() const { return triangles_; }
  const Material& material(uint32_t triangle) const { return *parts_[triangles_[triangle].part].material; }
  /// World position of corner 0, 1 or 2, in the source's order.
  const vec3& corner(uint32_t triangle, int k) const { return positions_[corners_[triangle][k]]; }
  vec3 point(uint32_t triangle, vec2 weights) const;
  float area(uint32_t triangle) const;  ///< m2, one side
  const RayCaster& caster() const { return *caster_; }
  /// How far rays start from the surface that they leave, metres.
  float epsilon() const { return epsilon_; }
  /// A hash of triangles, paint and lights: estimates may be continued only where it is the same.
  uint64_t fingerprint() const;

 private:
  void add(uint32_t instance, uint32_t primitive);
  Diffuse diffuse(const TracedPart& part, uint32_t triangle, vec2 weights,
                  const TextureLookup& base_colour) const {
    if (!part.textured) return diffuse_at(part, triangle, weights, base_colour);
    return {glm::clamp(part.tint * vec3(base_colour.colour()), vec3(0), vec3(kMaxReflectance)), vec3(0)};
  }
  Diffuse diffuse_at(const TracedPart& part, uint32_t triangle, vec2 weights,
                     const TextureLookup& base_colour_texel) const;
  vec3 emission_at(const TracedPart& part, uint32_t triangle, vec2 weights) const;
  vec2 texcoord(const TracedPart& part, const Texture& texture, uint32_t triangle, vec2 weights) const;
  TextureLookup lookup(const TracedPart& part, const Texture& texture, uint32_t triangle, vec2 weights) const;
  TextureLookup base_colour_lookup(const TracedPart& part, uint32_t triangle, vec2 weights) const;
  vec4 base_colour(const TracedPart& part, uint32_t triangle, vec2 weights, const TextureLookup& texel) const;
  vec4 base_colour(uint32_t triangle, vec2 weights) const;
  float factor(float value, const Texture& texture, int channel, uint32_t triangle, vec2 weights) const;
  float glass_share(uint32_t triangle, vec2 weights) const;
  float alpha_coverage(uint32_t triangle, vec2 weights) const;
  Passing passing(uint32_t triangle, vec2 weights) const;
  template <typename T>
  T interpolate(const std::vector<T>& values, uint32_t triangle, vec2 weights) const;
  bool is_live(uint32_t triangle, const vec3& direction) const;
  bool contends(uint32_t triangle) const;
  void find_covered();
  bool lies_on(const vec3& p, uint32_t triangle, float tolerance) const;
  void give_to(uint32_t triangle, const vec3& p, const Ray& ray, Meeting& met) const;
  uint32_t owner_at(uint32_t triangle, const vec3& p) const;
  void look_for_owner(const Ray& ray, Meeting& met) const;
  void look_for_front(const Ray& ray, Meeting& met) const;

  const Scene& scene_;
  TexelStore texels_;
  std::vector<TracedPart> parts_;
  std::vector<TracedTriangle> triangles_;
  std::vector<vec3> positions_;  ///< world
  std::vector<UVec3> corners_;   ///< per triangle, into positions_
  std::unique_ptr<RayCaster> caster_;
  std::vector<std::pair<uint32_t, uint32_t>> covered_;  ///< (triangle, by which), in order
  float epsilon_ = 0;
  bool has_translucent_ = false;
};

}  // namespace goldthread
