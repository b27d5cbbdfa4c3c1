#include "trace/traced_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "math/colour.h"
#include "mesh/triangle_mesh.h"
#include "scene/place_claim.h"
#include "trace/scrambled_sobol.h"
#include "visibility/coincident.h"

namespace goldthread {
namespace {

/// The unit vector along the double-precision cross product of two sides, or zero for a triangle without
/// area.
vec3 unit_normal(const vec3& a, const vec3& b, const vec3& c) {
  const dvec3 area = cross(dvec3(b) - dvec3(a), dvec3(c) - dvec3(a));
  const double squared = dot(area, area);
  return squared > 0 && std::isfinite(squared) ? vec3(area / std::sqrt(squared)) : vec3(0);
}

bool is_even(const TracedPart& part) {
  const Material& m = *part.material;
  return part.source->colours.empty() && !m.base_colour_texture.present() && !m.metallic_texture.present() &&
         !m.emission_texture.present() && !m.transmission_texture.present() &&
         !m.diffuse_transmission_texture.present() && !m.diffuse_transmission_colour_texture.present();
}

/// Whether reflectance is a colour times that of its texture.
bool is_textured(const TracedPart& part) {
  const Material& m = *part.material;
  return part.source->colours.empty() && part.base_colour_texture.present() &&
         !m.metallic_texture.present() && !m.unlit && !m.is_glass() && !m.is_translucent();
}

uint8_t set_of(const Texture& texture) {
  return std::min<uint8_t>(texture.texcoord, 1);
}

/// All textures that say what a point does with light.
std::array<const Texture*, 6> textures_of(const Material& m) {
  return {&m.base_colour_texture,
          &m.metallic_texture,
          &m.emission_texture,
          &m.transmission_texture,
          &m.diffuse_transmission_texture,
          &m.diffuse_transmission_colour_texture};
}

/// Those texture coordinates that the material's textures use and the primitive has.
std::vector<uint8_t> texcoord_sets(const Material& m, const Primitive& source) {
  std::vector<uint8_t> sets;
  for (uint8_t set = 0; set < 2; ++set)
    for (const Texture* t : textures_of(m))
      if (t->present() && set_of(*t) == set && !source.texcoords[set].empty()) {
        sets.push_back(set);
        break;
      }
  return sets;
}

/// FNV-1a over the bytes of plain values.
class Fingerprint {
 public:
  template <typename T>
  void add(const T& value) {
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    for (const unsigned char byte : bytes) add_word(byte);
  }
  void add_word(uint32_t word) { state_ = (state_ ^ word) * 0x100000001b3u; }
  void add(const vec3& v) {
    for (int k = 0; k < 3; ++k) add(v[k]);
  }
  uint64_t value() const { return state_; }

 private:
  uint64_t state_ = 0xcbf29ce484222325u;
};

void add_texture(Fingerprint& print, const Texture& t) {
  print.add(t.image);
  print.add(t.texcoord);
  for (const vec2& v : {t.offset, t.scale, vec2(t.rotation, 0)}) print.add(vec3(v.x, v.y, 0));
}

void add_material(Fingerprint& print, const Material& m) {
  print.add(m.base_colour);
  print.add(m.emission);
  print.add(m.alpha);
  print.add(m.metallic);
  print.add(m.alpha_cutoff);
  print.add(m.alpha_mode);
  print.add(m.double_sided);
  print.add(m.unlit);
  if (m.is_glass()) {
    print.add(m.transmission);
    print.add(m.volume_tint);
    add_texture(print, m.transmission_texture);
  }
  if (m.is_translucent()) {
    print.add(m.diffuse_transmission);
    print.add(m.diffuse_transmission_colour);
    add_texture(print, m.diffuse_transmission_texture);
    add_texture(print, m.diffuse_transmission_colour_texture);
  }
  if (m.normal_texture.present()) {
    add_texture(print, m.normal_texture);
    print.add(m.normal_scale);
  }
  for (const Texture* t : {&m.base_colour_texture, &m.metallic_texture, &m.emission_texture})
    add_texture(print, *t);
}

void add_image(Fingerprint& print, const Image& image) {
  print.add(image.width);
  print.add(image.height);
  for (size_t i = 0; i + 4 <= image.rgba.size(); i += 4) {
    uint32_t texel = 0;
    std::memcpy(&texel, &image.rgba[i], 4);
    print.add_word(texel);
  }
}

void add_light(Fingerprint& print, const Light& light) {
  print.add(light.kind);
  print.add(light.intensity);
  print.add(light.position);
  print.add(light.direction);
  print.add(vec3(light.inner_cone, light.outer_cone, light.range));
  print.add(vec2(light.angular_diameter, light.radius));
  if (light.has_area()) {
    print.add(light.size);
    print.add(light.across);
  }
  if (!light.profile) return;
  print.add(light.across);
  print.add(light.profile->pole);
  for (const std::vector<float>* values :
       {&light.profile->polar, &light.profile->azimuth, &light.profile->candela})
    for (const float value : *values) print.add(value);
}

void add_sky(Fingerprint& print, const Sky& sky) {
  print.add(sky.radiance);
  if (sky.model) {
    const SkyDescription& d = sky.model->description();
    for (const int32_t number : {int32_t(d.kind), d.cie_type, int32_t(d.level.measure)}) print.add(number);
    for (const vec3& v : {d.sun_direction, d.level.value, d.ground_reflectance, d.sunlight}) print.add(v);
    print.add(d.turbidity);
  }
  if (!sky.map) return;
  print.add(sky.map->picture().width);
  print.add(sky.map->rotation());
  for (const vec3& pixel : sky.map->picture().pixels) print.add(pixel);
}

}  // namespace

TracedScene::TracedScene(const Scene& scene) : scene_(scene), texels_(scene.images) {
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t p = 0; p < scene.meshes[scene.instances[i].mesh].primitives.size(); ++p) add(i, p);
  std::vector<uint8_t> see_through;
  for (const TracedTriangle& t : triangles_) {
    const TracedPart& part = parts_[t.part];
    const Material& m = *part.material;
    const bool coloured = m.is_glass() && (m.emits() || m.is_coloured() || !part.source->colours.empty());
    see_through.push_back(coloured ? 2 : m.is_see_through() ? 1 : 0);
  }
  caster_ = std::make_unique<RayCaster>(
      positions_, corners_, see_through,
      [this](uint32_t triangle, vec2 weights, const Ray&) { return passing(triangle, weights); });
  epsilon_ = caster_->epsilon();
  find_covered();
}

float TracedScene::mean_luminance(uint32_t triangle) const {
  const TracedPart& part = parts_[triangles_[triangle].part];
  if (!part.shines) return 0;
  const Material& m = *part.material;
  const bool even = !m.emission_texture.present() && !m.is_see_through();
  const uint32_t count = even ? 1 : 64;
  float sum = 0;
  for (uint32_t i = 0; i < count; ++i) {
    const SobolPoint p = sobol_point(i, triangle);
    const vec2 weights = even ? vec2(1 / 3.0f) : to_triangle(unit_double(p.u), unit_double(p.v));
    sum += luminance(emission(triangle, weights)) * coverage(triangle, weights);
  }
  return sum / static_cast<float>(count);
}

bool TracedScene::contends(uint32_t triangle) const {
  return !material(triangle).unlit && !material(triangle).is_see_through();
}

bool TracedScene::owns(uint32_t owner, uint32_t other) const {
  const auto claim_of = [this](uint32_t t) {
    const TracedPart& part = parts_[triangles_[t].part];
    return PlaceClaim{place_order(triangles_[t].part, triangles_[t].source), mean_luminance(t),
                      part.lit_behind, area(t) * triangles_[t].normal};
  };
  return contends(owner) && contends(other) && owns_place(claim_of(owner), claim_of(other));
}

void TracedScene::find_covered() {
  const PlaceClaims claims{[this](uint32_t t) { return contends(t); },
                           [this](uint32_t first, uint32_t second) { return owns(first, second); }};
  covered_ = find_coincident(positions_, corners_, *caster_, claims, CancelToken());
  for (const auto& [triangle, owner] : covered_) triangles_[triangle].covered = true;
}

void TracedScene::add(uint32_t instance, uint32_t primitive) {
  const mat4& transform = scene_.instances[instance].transform;
  const Primitive& source = scene_.meshes[scene_.instances[instance].mesh].primitives[primitive];
  const bool mirrored = glm::determinant(mat3(transform)) < 0;
  const auto first_vertex = static_cast<uint32_t>(positions_.size());
  for (const vec3& p : source.positions) positions_.emplace_back(transform * vec4(p, 1));
  TracedPart part;
  part.instance = instance;
  part.primitive = primitive;
  part.source = &source;
  part.material = &scene_.materials[source.material];
  for (const Texture* texture : textures_of(*part.material))
    if (texture->present() && texture != &part.material->base_colour_texture)
      part.other_textures.push_back(texture);
  part.base_colour_texture = part.material->base_colour_texture;
  part.base_colour_texels = texels_[part.base_colour_texture];
  part.textured = is_textured(part);
  part.tint = part.material->base_colour * (1 - part.material->metallic);
  part.unlit = part.material->unlit;
  part.lit_behind = part.material->lit_behind();
  part.translucent = part.material->is_translucent();
  part.shines = part.material->emits() && !part.unlit;
  part.first_triangle = static_cast<uint32_t>(triangles_.size());
  const std::vector<uint8_t> used = texcoord_sets(*part.material, source);
  for (uint32_t t = 0; t < source.triangle_count(); ++t) {
    const uint32_t* index = &source.indices[3 * size_t{t}];
    const UVec3 corners = first_vertex + UVec3(index[0], index[1], index[2]);
    const vec3 normal = unit_normal(positions_[corners.x], positions_[corners.y], positions_[corners.z]);
    if (normal == vec3(0) || !is_finite(normal)) continue;
    corners_.push_back(corners);
    for (const uint8_t set : used)
      part.texcoords[set].push_back({source.texcoords[set][index[0]], source.texcoords[set][index[1]],
                                     source.texcoords[set][index[2]]});
    triangles_.push_back({mirrored ? -normal : normal, static_cast<uint32_t>(parts_.size()), t, false});
  }
  part.triangle_count = static_cast<uint32_t>(triangles_.size()) - part.first_triangle;
  has_translucent_ |= part.triangle_count > 0 && part.translucent;
  const bool even = part.triangle_count > 0 && is_even(part);
  parts_.push_back(std::move(part));
  TracedPart& added = parts_.back();
  if (!even) return;
  added.diffuse = diffuse(added.first_triangle, vec2(0));
  added.emission = emission(added.first_triangle, vec2(0));
  added.even = true;
}

bool TracedScene::is_live(uint32_t triangle, const vec3& direction) const {
  const TracedPart& part = parts_[triangles_[triangle].part];
  return !part.unlit && (part.lit_behind || dot(triangles_[triangle].normal, direction) < 0);
}

Meeting TracedScene::closest(const Ray& ray) const {
  Meeting met;
  meet(ray, caster_->closest(ray), met);
  return met;
}

void TracedScene::meet(const Ray& ray, const Hit& hit, Meeting& met) const {
  met.triangle = hit.triangle;
  met.part = nullptr;
  met.live = false;
  met.tint = hit.tint;
  if (hit.missed()) return;
  const TracedTriangle& triangle = triangles_[hit.triangle];
  const TracedPart& part = parts_[triangle.part];
  const bool from_front = dot(triangle.normal, ray.direction) < 0;
  met.part = &part;
  met.distance = hit.distance;
  met.weights = hit.weights;
  met.normal = from_front ? triangle.normal : -triangle.normal;
  met.live = !part.unlit && (from_front || part.lit_behind);
  if (!met.live && !part.unlit) look_for_front(ray, met);
  if (triangles_[met.triangle].covered) look_for_owner(ray, met);
}

bool TracedScene::lies_on(const vec3& p, uint32_t triangle, float tolerance) const {
  return lies_on_triangle(p, corner(triangle, 0), corner(triangle, 1), corner(triangle, 2), tolerance);
}

// Makes a meeting one with another triangle in the same place.
void TracedScene::give_to(uint32_t triangle, const vec3& p, const Ray& ray, Meeting& met) const {
  const dvec3 a(corner(triangle, 0)), u = dvec3(corner(triangle, 1)) - a, v = dvec3(corner(triangle, 2)) - a;
  const dvec3 n = cross(u, v), w = dvec3(p) - a;
  const double squared = dot(n, n);
  met.triangle = triangle;
  met.part = &parts_[triangles_[triangle].part];
  met.weights = glm::max(vec2(dot(cross(w, v), n) / squared, dot(cross(u, w), n) / squared), vec2(0));
  met.weights /= std::max(1.0f, met.weights.x + met.weights.y);
  met.live = is_live(triangle, ray.direction);
}

uint32_t TracedScene::owner_at(uint32_t triangle, const vec3& p) const {
  uint32_t found = Hit::kMiss;
  if (!triangles_[triangle].covered) return found;
  const float tolerance = 2 * epsilon_;
  caster_->near(p, tolerance, [&](uint32_t t) {
    if (t < found && std::binary_search(covered_.begin(), covered_.end(), std::pair(triangle, t)) &&
        lies_on(p, t, tolerance))
      found = t;
  });
  return found;
}

// Owners may be covered in their turn.
void TracedScene::look_for_owner(const Ray& ray, Meeting& met) const {
  const vec3 p = ray.origin + met.distance * ray.direction;
  for (uint32_t owner = owner_at(met.triangle, p); owner != Hit::kMiss; owner = owner_at(owner, p))
    give_to(owner, p, ray, met);
}

void TracedScene::look_for_front(const Ray& ray, Meeting& met) const {
  const vec3 p = ray.origin + met.distance * ray.direction;
  const float tolerance = 2 * epsilon_;
  uint32_t found = Hit::kMiss;
  caster_->near(p, tolerance, [&](uint32_t t) {
    if (t >= found || !is_live(t, ray.direction) || material(t).is_see_through()) return;
    if (std::abs(dot(triangles_[t].normal, met.normal)) < 0.999f) return;
    if (lies_on(p, t, tolerance)) found = t;
  });
  if (found != Hit::kMiss) give_to(found, p, ray, met);
}

template <typename T>
T TracedScene::interpolate(const std::vector<T>& values, uint32_t triangle, vec2 weights) const {
  const TracedTriangle& t = triangles_[triangle];
  const uint32_t* index = &parts_[t.part].source->indices[3 * size_t{t.source}];
  return (1 - weights.x - weights.y) * values[index[0]] + weights.x * values[index[1]] +
         weights.y * values[index[2]];
}

vec2 TracedScene::texcoord(const TracedPart& part, const Texture& texture, uint32_t triangle,
                           vec2 weights) const {
  const std::vector<CornerTexcoords>& set = part.texcoords[set_of(texture)];
  if (set.empty()) return vec2(0);
  const CornerTexcoords& corners = set[triangle - part.first_triangle];
  return (1 - weights.x - weights.y) * corners[0] + weights.x * corners[1] + weights.y * corners[2];
}

TextureLookup TracedScene::lookup(const TracedPart& part, const Texture& texture, uint32_t triangle,
                                  vec2 weights) const {
  return {texture, texels_[texture], texcoord(part, texture, triangle, weights)};
}

TextureLookup TracedScene::base_colour_lookup(const TracedPart& part, uint32_t triangle, vec2 weights) const {
  const Texture& texture = part.base_colour_texture;
  if (!texture.present()) return {};
  return {texture, part.base_colour_texels, texcoord(part, texture, triangle, weights)};
}

TextureLookup TracedScene::begin_lookup(const Meeting& met) const {
  const TextureLookup base_colour = base_colour_lookup(*met.part, met.triangle, met.weights);
  base_colour.prefetch();
  for (const Texture* texture : met.part->other_textures)
    lookup(*met.part, *texture, met.triangle, met.weights).prefetch();
  return base_colour;
}

vec4 TracedScene::base_colour(const TracedPart& part, uint32_t triangle, vec2 weights,
                              const TextureLookup& texel) const {
  const Material& m = *part.material;
  const vec4 colour = vec4(m.base_colour, m.alpha) * texel.colour();
  return part.source->colours.empty() ? colour
                                      : colour * interpolate(part.source->colours, triangle, weights);
}

vec4 TracedScene::base_colour(uint32_t triangle, vec2 weights) const {
  const TracedPart& part = parts_[triangles_[triangle].part];
  return base_colour(part, triangle, weights, base_colour_lookup(part, triangle, weights));
}

Diffuse TracedScene::diffuse_at(const TracedPart& part, uint32_t triangle, vec2 weights,
                                const TextureLookup& base_colour_texel) const {
  const Material& m = *part.material;
  if (m.unlit) return {};
  const float metallic = factor(m.metallic, m.metallic_texture, 2, triangle, weights);
  if (metallic == 1) return {};
  Diffuse diffuse;
  diffuse.back = glm::clamp(vec3(base_colour(part, triangle, weights, base_colour_texel)) * (1 - metallic),
                            vec3(0), vec3(kMaxReflectance));
  if (m.is_translucent()) {
    const float share = factor(m.diffuse_transmission, m.diffuse_transmission_texture, 3, triangle, weights);
    const Texture& texture = m.diffuse_transmission_colour_texture;
    vec3 colour = m.diffuse_transmission_colour;
    if (texture.present()) colour *= vec3(lookup(part, texture, triangle, weights).colour());
    diffuse.through = share * (1 - metallic) * glm::clamp(colour, vec3(0), vec3(1));
    diffuse.back *= 1 - share;
    // The two together may not be more than the one is otherwise.
    for (int c = 0; c < 3; ++c) {
      const float sum = diffuse.back[c] + diffuse.through[c];
      if (sum <= kMaxReflectance) continue;
      diffuse.back[c] *= kMaxReflectance / sum;
      diffuse.through[c] *= kMaxReflectance / sum;
    }
  }
  if (!m.is_glass()) return diffuse;
  const float all = coverage(triangle, weights), surface = alpha_coverage(triangle, weights);
  const float transmission = factor(m.transmission, m.transmission_texture, 0, triangle, weights);
  const float kept = all > 0 ? surface * (1 - transmission) / all : 0.0f;
  return {diffuse.back * kept, diffuse.through * kept};
}

/// A factor times one channel of its texture.
float TracedScene::factor(float value, const Texture& texture, int channel, uint32_t triangle,
                          vec2 weights) const {
  if (!(value > 0) || !texture.present()) return value;
  const TracedPart& part = parts_[triangles_[triangle].part];
  return value * lookup(part, texture, triangle, weights).data(channel);
}

/// Share of what alpha leaves that lets light straight on, but for its colour.
float TracedScene::glass_share(uint32_t triangle, vec2 weights) const {
  const Material& m = material(triangle);
  return factor(m.transmission, m.transmission_texture, 0, triangle, weights) *
         (1 - factor(m.metallic, m.metallic_texture, 2, triangle, weights));
}

vec3 TracedScene::emission_at(const TracedPart& part, uint32_t triangle, vec2 weights) const {
  const Material& m = *part.material;
  vec3 nits = m.emission;
  if (m.emission_texture.present())
    nits *= vec3(lookup(part, m.emission_texture, triangle, weights).colour());
  if (!m.is_glass()) return nits;
  const float all = coverage(triangle, weights);
  return all > 0 ? nits * (alpha_coverage(triangle, weights) / all) : vec3(0);
}

/// What goes straight on through a point. Of glass that glows half the rays are stopped at the least: else
/// none would find that it does.
Passing TracedScene::passing(uint32_t triangle, vec2 weights) const {
  const Material& m = material(triangle);
  const float surface = alpha_coverage(triangle, weights);
  if (!m.is_glass()) return Passing(1 - surface);
  const vec3 colour = glm::clamp(vec3(base_colour(triangle, weights)) * m.volume_tint, vec3(0), vec3(1));
  Passing through(1 - surface + surface * glass_share(triangle, weights) * colour);
  if (m.emits()) through.rays = std::min(through.rays, 1 - surface / 2);
  return through;
}

float TracedScene::coverage(uint32_t triangle, vec2 weights) const {
  if (!material(triangle).is_see_through()) return 1;
  return 1 - passing(triangle, weights).rays;
}

float TracedScene::alpha_coverage(uint32_t triangle, vec2 weights) const {
  const Material& m = material(triangle);
  if (m.alpha_mode == AlphaMode::kOpaque) return 1;
  const float alpha = base_colour(triangle, weights).w;
  if (m.alpha_mode == AlphaMode::kMask) return alpha >= m.alpha_cutoff ? 1.0f : 0.0f;
  return std::clamp(alpha, 0.0f, 1.0f);
}

vec3 TracedScene::unlit_colour(uint32_t triangle, vec2 weights) const {
  return vec3(base_colour(triangle, weights));
}

vec3 TracedScene::point(uint32_t triangle, vec2 weights) const {
  return (1 - weights.x - weights.y) * corner(triangle, 0) + weights.x * corner(triangle, 1) +
         weights.y * corner(triangle, 2);
}

float TracedScene::area(uint32_t triangle) const {
  return length(area_vector(corner(triangle, 0), corner(triangle, 1), corner(triangle, 2)));
}

uint64_t TracedScene::fingerprint() const {
  Fingerprint print;
  for (uint32_t t = 0; t < triangles_.size(); ++t) {
    for (int k = 0; k < 3; ++k) print.add(corner(t, k));
    const Primitive& source = *parts_[triangles_[t].part].source;
    print.add(source.material);
    for (const std::vector<vec2>& uv : source.texcoords)
      if (!uv.empty()) print.add(vec3(interpolate(uv, t, vec2(0.25f, 0.5f)), 0));
    if (!source.colours.empty()) print.add(vec3(interpolate(source.colours, t, vec2(0.25f, 0.5f))));
    if (!source.tangents.empty()) print.add(vec3(interpolate(source.tangents, t, vec2(0.25f, 0.5f))));
  }
  for (const auto& [triangle, owner] : covered_) {
    print.add(triangle);
    print.add(owner);
  }
  for (const Image& image : scene_.images) add_image(print, image);
  for (const Material& m : scene_.materials) add_material(print, m);
  for (const Light& light : scene_.lights) add_light(print, light);
  add_sky(print, scene_.sky);
  return print.value();
}

}  // namespace goldthread
