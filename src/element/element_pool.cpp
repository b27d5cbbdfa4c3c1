#include "element/element_pool.h"

#include <algorithm>

#include "base/check.h"
#include "base/parallel.h"
#include "cluster/volume_cluster_tree.h"

namespace goldthread {

ElementPool::ElementPool(const SurfaceSet& set) : set_(&set), sky_(set.scene->sky) {
  leaf_meshes_.resize(set.parts.size());
  triangle_patches_.resize(set.parts.size());
  make_volumes();
  make_lights();
  if (!set.has_glass && !set.has_translucent) return;
  passages_.resize(elements_.size());
  for (ElementId id = 0; id < elements_.size(); ++id) fill_passage(id);
  join_sides();
}

// The two sides of a component are cut alike, each as far as its own light asks: so they share a tree, of
// which either knows a part.
void ElementPool::join_sides() {
  for (size_t s = 1; s < set_->surfaces.size(); ++s) {
    const Surface &front = set_->surfaces[s - 1], &back = set_->surfaces[s];
    if (!back.back || front.part != back.part || front.root != back.root) continue;
    passages_[surface_roots_[s - 1]].twin = surface_roots_[s];
    passages_[surface_roots_[s]].twin = surface_roots_[s - 1];
  }
}

void ElementPool::join_children(ElementId id) {
  const ElementId twin = passages_[id].twin, child = elements_[id].first_child;
  if (twin == kNoElement || child == kNoElement || elements_[twin].first_child == kNoElement) return;
  for (uint32_t c = 0; c < 2; ++c) {
    passages_[child + c].twin = elements_[twin].first_child + c;
    passages_[elements_[twin].first_child + c].twin = child + c;
  }
}

ElementId ElementPool::behind(ElementId id, size_t end) const {
  if (passages_.empty()) return kNoElement;
  while (id != kNoElement && passages_[id].twin >= end) id = elements_[id].parent;
  return id == kNoElement ? kNoElement : passages_[id].twin;
}

void ElementPool::make_volumes() {
  const size_t count = set_->surfaces.size();
  if (count == 0) return;
  std::vector<Box> items(count);
  std::vector<Element> roots(count);
  parallel_for(
      count,
      [&](size_t i) {
        roots[i] = make_surface_element(set_->surfaces[i]);
        items[i] = box_of(*set_, set_->surfaces[i]);
      },
      16);
  const VolumeClusterTree tree = build_volume_clusters(items);
  volume_boxes_.reserve(tree.nodes.size());
  for (const VolumeCluster& node : tree.nodes) volume_boxes_.push_back(node.box);
  surface_roots_.assign(count, kNoElement);
  root_ = 0;
  elements_.emplace_back();
  struct Visit {
    VolumeRef ref;
    ElementId id;
  };
  // Breadth first, so that a pair of children always has two consecutive numbers.
  std::vector<Visit> queue{{tree.nodes.empty() ? kItemBit : 0, 0}};
  for (size_t head = 0; head < queue.size(); ++head) {
    const auto [ref, id] = queue[head];
    const ElementId parent = elements_[id].parent;
    const uint8_t depth = elements_[id].depth;
    if ((ref & kItemBit) != 0) {
      const uint32_t item = ref & ~kItemBit;
      elements_[id] = roots[item];
      elements_[id].parent = parent;
      surface_roots_[item] = id;
      continue;
    }
    const auto child = static_cast<ElementId>(elements_.size());
    elements_[id].first_child = child;
    elements_[id].kind = ElementKind::kVolume;
    elements_[id].shape = ref;
    elements_.resize(elements_.size() + 2);
    for (uint32_t c = 0; c < 2; ++c) {
      elements_[child + c].parent = id;
      elements_[child + c].depth = static_cast<uint8_t>(std::min(depth + 1, 255));
      queue.push_back({tree.nodes[ref].child[c], child + c});
    }
  }
  for (size_t i = queue.size(); i-- > 0;)
    if (elements_[queue[i].id].kind == ElementKind::kVolume) fill_volume(queue[i].id);
  for (ElementId id = 0; id < elements_.size(); ++id)
    if (elements_[id].kind == ElementKind::kVolume || elements_[id].kind == ElementKind::kCluster) {
      elements_[id].samples = static_cast<uint32_t>(samples_.size());
      samples_.resize(samples_.size() + kStoredSamples);
    }
  parallel_for(
      elements_.size(), [&](size_t id) { fill_samples(static_cast<ElementId>(id)); }, 16);
}

void ElementPool::make_lights() {
  const Scene& scene = *set_->scene;
  for (const uint32_t cell : sky_.make_first()) {
    Element sky;
    fill_sky(sky, cell);
    lights_.push_back(static_cast<ElementId>(elements_.size()));
    elements_.push_back(sky);
  }
  for (uint32_t i = 0; i < scene.lights.size(); ++i) {
    Element light;
    light.kind = scene.lights[i].kind == LightKind::kDirectional ? ElementKind::kSun : ElementKind::kPoint;
    light.shape = i;
    light.centre = scene.lights[i].position;
    light.exitance = scene.lights[i].intensity;
    light.indivisible = true;
    lights_.push_back(static_cast<ElementId>(elements_.size()));
    elements_.push_back(light);
  }
}

// Whether the element can have children; makes what has to be made one after another (cuts in the leaf mesh).
bool ElementPool::prepare_children(ElementId id, const CutPlane& cut) {
  const Element& element = elements_[id];
  switch (element.kind) {
    case ElementKind::kSky:
      return element.depth < 250 && sky_.divisible(element.shape);
    case ElementKind::kCluster:
      return element.depth < 250;
    case ElementKind::kTriangle:
      return split_patch(patch_of_triangle(element.part, element.shape), cut);
    case ElementKind::kPatch:
      return split_patch(element.shape, cut);
    case ElementKind::kVolume:
    case ElementKind::kPoint:
    case ElementKind::kSun:
      return false;
  }
  return false;
}

void ElementPool::expand(std::span<const ElementId> ids, std::span<const CutPlane> cuts) {
  const auto first = static_cast<ElementId>(elements_.size());
  for (size_t i = 0; i < ids.size(); ++i) {
    const ElementId id = ids[i];
    if (elements_[id].first_child != kNoElement || elements_[id].indivisible) continue;
    if (!prepare_children(id, cuts.empty() ? CutPlane() : cuts[i])) {
      elements_[id].indivisible = true;
      continue;
    }
    const auto child = static_cast<ElementId>(elements_.size());
    elements_[id].first_child = child;
    Element blank;
    blank.parent = id;
    blank.depth = static_cast<uint8_t>(elements_[id].depth + 1);
    blank.back = elements_[id].back;
    blank.part = elements_[id].part;
    elements_.push_back(blank);
    elements_.push_back(blank);
    if (elements_[id].kind == ElementKind::kSky) {
      const uint32_t half = sky_.split(elements_[id].shape);
      for (uint32_t c = 0; c < 2; ++c) fill_sky(elements_[child + c], half + c);
    } else if (elements_[id].kind == ElementKind::kCluster) {
      const FaceCluster& node = set_->tree(set_->parts[blank.part]).nodes[elements_[id].shape];
      for (uint32_t c = 0; c < 2; ++c) {
        elements_[child + c].shape = node.child[c];
        if (is_triangle(node.child[c])) continue;
        elements_[child + c].samples = static_cast<uint32_t>(samples_.size());
        samples_.resize(samples_.size() + kStoredSamples);
      }
    } else {
      const uint32_t patch = elements_[id].kind == ElementKind::kPatch
                                 ? elements_[id].shape
                                 : patch_of_triangle(blank.part, elements_[id].shape);
      for (uint32_t c = 0; c < 2; ++c) elements_[child + c].shape = patches_[patch].first_child + c;
    }
  }
  parallel_for(
      elements_.size() - first, [&](size_t i) { fill_child(first + static_cast<ElementId>(i)); }, 8);
  if (passages_.empty()) return;
  passages_.resize(elements_.size());
  parallel_for(
      elements_.size() - first, [&](size_t i) { fill_passage(first + static_cast<ElementId>(i)); }, 8);
  for (const ElementId id : ids) join_children(id);
}

std::vector<ElementId> ElementPool::leaf_elements(uint32_t part, bool back) const {
  const FaceClusterTree& tree = set_->tree(set_->parts[part]);
  const LeafMesh* leaves = leaf_meshes_[part].get();
  std::vector<ElementId> out(leaves != nullptr ? leaves->face_count() : tree.mesh.triangles.size(),
                             kNoElement);
  // What lies below an element that has no children of its own side: every triangle, and every face cut by
  // the other.
  std::vector<std::vector<uint32_t>> faces_of_triangle;
  std::vector<uint32_t> first_face(tree.mesh.triangles.size() + 1, 0);
  std::vector<uint32_t> faces(out.size());
  const auto triangle_of_face = [&](uint32_t f) {
    return leaves != nullptr ? leaves->triangle_of_face(f) : f;
  };
  for (uint32_t f = 0; f < out.size(); ++f) ++first_face[triangle_of_face(f) + 1];
  for (size_t t = 1; t < first_face.size(); ++t) first_face[t] += first_face[t - 1];
  std::vector<uint32_t> cursor(first_face.begin(), first_face.end() - 1);
  for (uint32_t f = 0; f < out.size(); ++f) faces[cursor[triangle_of_face(f)]++] = f;

  std::vector<ElementId> stack;
  for (size_t s = 0; s < set_->surfaces.size(); ++s)
    if (set_->surfaces[s].part == part && set_->surfaces[s].back == back) stack.push_back(surface_roots_[s]);
  std::vector<uint32_t> patch_stack;
  while (!stack.empty()) {
    const ElementId id = stack.back();
    stack.pop_back();
    const Element& element = elements_[id];
    if (element.first_child != kNoElement) {
      stack.push_back(element.first_child);
      stack.push_back(element.first_child + 1);
    } else if (element.kind == ElementKind::kPatch) {
      patch_stack.assign(1, element.shape);
      while (!patch_stack.empty()) {
        const Patch& patch = patches_[patch_stack.back()];
        patch_stack.pop_back();
        if (patch.first_child == kNoElement) {
          out[patch.face] = id;
        } else {
          patch_stack.push_back(patch.first_child);
          patch_stack.push_back(patch.first_child + 1);
        }
      }
    } else {
      uint32_t first = element.shape, count = 1;
      if (element.kind == ElementKind::kCluster) {
        first = tree.nodes[element.shape].first;
        count = tree.nodes[element.shape].count;
      }
      for (uint32_t i = first_face[first]; i < first_face[first + count]; ++i) out[faces[i]] = id;
    }
  }
  return out;
}

std::array<uint64_t, 4> ElementPool::count_by_kind() const {
  std::array<uint64_t, 4> count{};
  for (const Element& e : elements_) {
    switch (e.kind) {
      case ElementKind::kVolume:
        ++count[0];
        break;
      case ElementKind::kCluster:
      case ElementKind::kTriangle:
        ++count[1];
        break;
      case ElementKind::kPatch:
        ++count[2];
        break;
      default:
        ++count[3];
    }
  }
  return count;
}

uint64_t ElementPool::memory_bytes() const {
  uint64_t bytes = elements_.capacity() * sizeof(Element) + passages_.capacity() * sizeof(ElementPassage) +
                   samples_.capacity() * sizeof(SurfacePoint) + patches_.capacity() * sizeof(Patch) +
                   corners_.capacity() * sizeof(vec3) + volume_boxes_.capacity() * sizeof(Box);
  for (const auto& mesh : leaf_meshes_)
    if (mesh) bytes += mesh->memory_bytes();
  return bytes;
}

}  // namespace goldthread
