// The elements that exchange light: volume clusters, face clusters, triangles, patches and lights, in one
// array, made on demand. This room alone knows the kinds; solvers see children, area, summed normal, samples.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "element/leaf_mesh.h"
#include "element/paint.h"
#include "element/polygon_view.h"
#include "element/sky_cells.h"
#include "element/surface_set.h"
#include "math/box.h"
#include "math/form_factor.h"

namespace goldthread {

using ElementId = uint32_t;
constexpr ElementId kNoElement = 0xffffffffu;

enum class ElementKind : uint8_t {
  kVolume,    ///< a box of surfaces
  kCluster,   ///< a face cluster of at least two triangles
  kTriangle,  ///< an input triangle
  kPatch,     ///< a convex piece of one
  kSky,       ///< a spherical triangle of directions
  kPoint,     ///< a point or spot light, or an area lamp
  kSun,       ///< a directional light
};

/// Whether it has area and may reflect.
constexpr bool is_surface(ElementKind kind) {
  return kind <= ElementKind::kPatch;
}

/// One side of something that sends or receives light. World space.
struct Element {
  ElementKind kind = ElementKind::kVolume;
  bool back = false;         ///< the other side of the source's winding
  bool flat = false;         ///< all normals agree, here and in all children: light varies with place alone
  bool indivisible = false;  ///< has no children and will have none
  uint8_t depth = 0;
  ElementId parent = kNoElement;
  ElementId first_child = kNoElement;  ///< the second follows it; kNoElement while there are none
  uint32_t part = 0;                   ///< SurfaceSet::parts, for surfaces
  uint32_t shape = 0;    ///< volume cluster, ClusterRef, triangle, patch number, light number, by kind
  uint32_t samples = 0;  ///< first of kStoredSamples in the pool, for kVolume and kCluster
  vec3 centre{0};
  float radius = 0;
  float thickness = 0;     ///< how far it reaches from the plane through its centre, on either side, metres
  vec3 summed_normal{0};   ///< S, m^2 (equation 4.9), on the side that this element is
  float area = 0;          ///< m^2
  float cone_cosine = -1;  ///< normals lie within acos(this) of S
  float coverage = 1;
  vec3 reflectance{0};  ///< area average
  vec3 exitance{0};     ///< lm/m^2, area average; for lights: cd (point, area lamp), lux (sun), lm/m^2 (sky)
};

/// What elements have besides in scenes with glass or translucent surfaces.
struct ElementPassage {
  vec3 stopped{1};              ///< area average of the light that does not go straight on, by channel
  vec3 transmittance{0};        ///< area average of the light that leaves diffusely on the other side
  ElementId twin = kNoElement;  ///< the same piece of the other side; kNoElement where that is not cut so far
};

constexpr uint32_t kStoredSamples = 16;

/// A plane across which a triangle or patch is cut in two: dot(normal, p) = offset, normal unit or, for the
/// cut that shape alone suggests, 0.
struct CutPlane {
  vec3 normal{0};
  float offset = 0;
  Seam seam = Seam::kNone;
  bool present() const { return normal != vec3(0); }
};

class ElementPool {
 public:
  /// Makes the volume clusters, the surfaces' roots and the lights of `set`, which must outlive the pool.
  explicit ElementPool(const SurfaceSet& set);

  const Element& operator[](ElementId id) const { return elements_[id]; }
  size_t size() const { return elements_.size(); }
  ElementId root() const { return root_; }  ///< kNoElement when there is no surface
  std::span<const ElementId> lights() const {
    return lights_;
  }  ///< first cells of the sky, point, spot and directional lights
  size_t volume_clusters() const { return volume_boxes_.size(); }
  const SurfaceSet& surfaces() const { return *set_; }

  /// Gives each of `ids` (ascending, childless, divisible) its two children, or marks it indivisible.
  /// Triangles and patches are cut along `cuts`, one for each of `ids`, if given: the two sides of a surface
  /// are cut at once, as the first asks.
  void expand(std::span<const ElementId> ids, std::span<const CutPlane> cuts = {});

  /// Share of light that stops at a surface element, by channel: Element::coverage, of coloured glass in its
  /// colours.
  vec3 stopped(ElementId id) const {
    return passages_.empty() ? vec3(elements_[id].coverage) : passages_[id].stopped;
  }

  /// Share of the light on the other side of a surface element that leaves on this one.
  vec3 transmittance(ElementId id) const { return passages_.empty() ? vec3(0) : passages_[id].transmittance; }
  /// The same piece of the other side; kNoElement where that is not cut so far, and where nothing gets
  /// through.
  ElementId twin(ElementId id) const { return passages_.empty() ? kNoElement : passages_[id].twin; }
  /// The smallest element of the other side, numbered below `end`, that holds the whole of `id` on it;
  /// kNoElement where there is no other side.
  ElementId behind(ElementId id, size_t end) const;

  /// Point i of kStoredSamples that are spread evenly by area over the triangles or outlines of a volume or
  /// face cluster.
  const SurfacePoint& stored_sample(ElementId id, uint32_t i) const {
    return samples_[elements_[id].samples + i];
  }
  /// 4, 8 or 16 points of equal weight whose mean value is that of the element's surface: chosen from the
  /// stored samples of clusters; on triangles and patches exact for functions of second degree. `second`
  /// gives another set, independent of the first.
  void quadrature(ElementId id, std::span<SurfacePoint> points, bool second = false) const;
  /// Any point: u selects by area, v moves within. For more samples than are stored.
  SurfacePoint sample_at(ElementId id, float u, float v) const;
  /// A point on a face cluster, triangle or patch by what it sends to `x` rather than by area: large sources
  /// nearby are sampled where they are near. `weight` is the sample's form-factor density over the density it
  /// was drawn with (its mean over samples is the form factor times pi, occlusion apart); 0 where x is below
  /// or behind.
  SurfacePoint sample_towards(ElementId id, const vec3& x, const vec3& n, float u, float v,
                              float& weight) const;
  /// The one polygon that an element is (a patch, a triangle, a cluster with an outline), to draw places of
  /// as sample_at does, or, by its PolygonView, as sample_towards; nothing for other clusters.
  std::optional<PolygonSampler> one_polygon(ElementId id) const;
  /// The deepest element below `id` that holds a point of it; a volume cluster is not searched.
  ElementId deepest(ElementId id, const SurfacePoint& point) const;
  /// The direction within a sky element that belongs to (u, v), spread evenly over its solid angle.
  vec3 sky_direction(ElementId id, float u, float v) const;

  /// The box of a volume cluster: all its surfaces lie within.
  const Box& box(ElementId id) const { return volume_boxes_[elements_[id].shape]; }
  /// Corners of a triangle or patch.
  ElementPolygon polygon(ElementId id) const;
  /// Corners of a triangle (of the part's tree) of a face cluster.
  ElementPolygon polygon(ElementId cluster, uint32_t triangle) const {
    return triangle_polygon(elements_[cluster], triangle);
  }
  /// RMS contrast of what a face cluster, triangle or patch reflects: the standard deviation of its
  /// reflectance's luminance over the mean, by sixteen places; 0 of one colour and of black.
  float texture_contrast(ElementId id) const;
  /// The convex polygon that an inner node below a face cluster is; without corners when it is none.
  ElementPolygon outline(ElementId cluster, ClusterRef node) const;
  /// Unit corner directions of a sky element, wound as sky_form_factor wants them.
  const std::array<vec3, 3>& sky_corners(ElementId id) const { return sky_cell(id).corners; }
  /// SkyCells::relative_luminance.
  float sky_relative_luminance(ElementId id, const vec3& direction) const {
    return sky_.relative_luminance(elements_[id].shape, direction);
  }
  const SkyCell& sky_cell(ElementId id) const { return sky_[elements_[id].shape]; }
  /// How far radiosity is from its mean on the average over a sky element, lm/m^2 (SkyCell::unevenness); 0
  /// for others, whose children say so.
  float unevenness(ElementId id) const {
    return elements_[id].kind == ElementKind::kSky ? kPi * sky_cell(id).unevenness : 0.0f;
  }
  const Light& light(ElementId id) const { return set_->scene->lights[elements_[id].shape]; }

  /// The leaf mesh of a part, or null when none of its triangles has been cut.
  const LeafMesh* leaf_mesh(uint32_t part) const { return leaf_meshes_[part].get(); }
  /// Per face of a part's leaf mesh (per triangle when it has none): the deepest element on each side that
  /// holds it.
  std::vector<ElementId> leaf_elements(uint32_t part, bool back) const;

  /// Roots of the surfaces, in SurfaceSet's order.
  std::span<const ElementId> surface_roots() const { return surface_roots_; }
  std::array<uint64_t, 4> count_by_kind() const;  ///< volume, face (clusters and triangles), patch, light
  uint64_t memory_bytes() const;

 private:
  struct Patch {  // a node below a triangle, shared by both sides of it
    uint32_t part = 0, face = 0, triangle = 0;
    uint32_t first_corner = 0, corners = 0;
    uint32_t first_child = kNoElement;
  };

  void make_volumes();
  void make_lights();
  Element make_surface_element(const Surface& surface) const;
  void fill_cluster(Element& element, ClusterRef ref) const;
  void fill_triangle(Element& element, uint32_t triangle) const;
  void fill_patch(Element& element, uint32_t patch) const;
  void fill_paint(Element& element, uint32_t first, uint32_t count) const;
  bool emits_here(const Element& element) const;
  void fill_passage(ElementId id);
  void join_sides();
  void join_children(ElementId id);
  Paint patch_paint(uint32_t patch) const;
  void fill_volume(ElementId id);
  void fill_samples(ElementId id);
  void fill_child(ElementId id);
  bool prepare_children(ElementId id, const CutPlane& cut);
  bool split_patch(uint32_t patch, const CutPlane& cut);
  uint32_t patch_of_triangle(uint32_t part, uint32_t triangle);
  void store_polygon(Patch& patch);
  void fill_sky(Element& element, uint32_t cell) const;
  SurfacePoint sample_triangle(const Element& element, uint32_t triangle, float u, float v) const;
  void polygon_quadrature(const ElementPolygon& polygon, const vec3& normal, std::span<SurfacePoint> points,
                          bool second) const;
  ElementPolygon triangle_polygon(const Element& element, uint32_t triangle) const;
  ElementPolygon patch_polygon(const Element& element) const;
  ElementPolygon outline(const Element& element, ClusterRef node) const;
  uint32_t find_triangle(const Element& cluster, const SurfacePoint& point) const;
  Paint paint_of(const Part& part, uint32_t triangle, const vec3& place) const;

  const SurfaceSet* set_;
  std::vector<Element> elements_;
  std::vector<ElementPassage> passages_;  // by element; empty where there is neither glass nor translucence
  std::vector<SurfacePoint> samples_;
  std::vector<ElementId> lights_, surface_roots_;
  SkyCells sky_;
  ElementId root_ = kNoElement;
  std::vector<Box> volume_boxes_;

  std::vector<Patch> patches_;
  std::vector<vec3> corners_;
  std::vector<std::unique_ptr<LeafMesh>> leaf_meshes_;
  std::vector<std::vector<uint32_t>> triangle_patches_;  // per part with a leaf mesh: root patch per triangle
};

}  // namespace goldthread
