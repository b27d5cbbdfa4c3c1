#include "trace/texel_receivers.h"

#include <array>

#include "base/parallel.h"
#include "mesh/texel_raster.h"

namespace goldthread {
namespace {

/// The coordinates that the layout asks for of this primitive, or nothing.
const std::vector<vec2>* chosen_texcoords(const Primitive& source, const TexelLayout& layout) {
  const uint32_t set = layout.uv.value_or(source.texcoords[1].empty() ? 0 : 1);
  return set > 1 || source.texcoords[set].empty() ? nullptr : &source.texcoords[set];
}

TexelRaster raster_of(const TracedScene& scene, const TracedPart& part, const std::vector<vec2>& texcoords,
                      const TexelLayout& layout) {
  std::vector<std::array<vec2, 3>> triangles;
  triangles.reserve(part.triangle_count);
  for (uint32_t t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t) {
    const uint32_t* index = &part.source->indices[3 * size_t{scene.triangles()[t].source}];
    triangles.push_back({texcoords[index[0]], texcoords[index[1]], texcoords[index[2]]});
  }
  return rasterise_texels(triangles, layout.width, layout.height);
}

std::vector<Receiver> fronts_of(const TracedScene& scene, const TracedPart& part, const TexelRaster& raster) {
  std::vector<Receiver> fronts(raster.texels.size());
  parallel_for(
      fronts.size(),
      [&](size_t i) {
        const CoveredTexel& texel = raster.texels[i];
        Receiver& r = fronts[i];
        r.triangle = part.first_triangle + texel.triangle;
        r.weights = texel.weights;
        r.point = scene.point(r.triangle, r.weights);
        r.normal = shading_normal(scene, r.triangle, r.weights);
        r.origin = ray_origin(scene, r.triangle, r.point, scene.triangles()[r.triangle].normal);
        r.instance = part.instance;
        r.primitive = part.primitive;
        r.texel_x = texel.x;
        r.texel_y = texel.y;
        bend(scene, r.normal, r);
      },
      256);
  std::erase_if(fronts, [&](const Receiver& r) { return scene.coverage(r.triangle, r.weights) <= 0; });
  return fronts;
}

Receiver back_of(const TracedScene& scene, const Receiver& front) {
  Receiver back = front;
  back.normal = -front.normal;
  back.surface = -front.surface;
  back.origin = ray_origin(scene, front.triangle, front.point, -scene.triangles()[front.triangle].normal);
  back.back = true;
  return back;
}

}  // namespace

TexelReceivers texel_receivers(const TracedScene& scene, const TexelLayout& layout) {
  TexelReceivers out;
  for (const TracedPart& part : scene.parts()) {
    if (part.material->unlit) continue;
    ++out.problems.parts;
    const std::vector<vec2>* texcoords = chosen_texcoords(*part.source, layout);
    if (texcoords == nullptr) {
      ++out.problems.without_uv;
      continue;
    }
    const TexelRaster raster = raster_of(scene, part, *texcoords, layout);
    out.problems.overlapping += raster.overlapping;
    out.problems.outside += raster.outside;
    out.problems.without_uv_area += raster.without_area;
    const std::vector<Receiver> fronts = fronts_of(scene, part, raster);
    out.problems.without_texel += fronts.empty();
    const size_t sides = part.material->lit_behind() ? 2 : 1;
    if (out.receivers.size() + sides * fronts.size() > kMostTexelReceivers) {
      out.receivers.clear();
      out.too_many = true;
      return out;
    }
    out.receivers.insert(out.receivers.end(), fronts.begin(), fronts.end());
    if (sides == 1) continue;
    for (const Receiver& front : fronts) out.receivers.push_back(back_of(scene, front));
  }
  return out;
}

}  // namespace goldthread
