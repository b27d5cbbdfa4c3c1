#include "trace/texel_store.h"

#include <algorithm>

#include "base/huge_pages.h"

namespace goldthread {
namespace {

/// Bytes from which on an image has most of its texels in large pages of its own (files/image_decode.cpp).
constexpr size_t kLarge = size_t{8} << 20;

bool is_copied(const Image& image) {
  return image.rgba.size() < kLarge;
}

}  // namespace

TexelStore::TexelStore(const std::vector<Image>& images) {
  size_t bytes = 0;
  for (const Image& image : images)
    if (is_copied(image)) bytes += image.rgba.size();
  copies_ = zeros_in_huge_pages<uint8_t>(bytes);
  uint8_t* next = copies_.data();
  for (const Image& image : images) {
    TexelView& view = views_.emplace_back(image);
    if (!is_copied(image) || image.empty()) continue;
    view.rgba = next;
    next = std::copy(image.rgba.begin(), image.rgba.end(), next);
  }
}

}  // namespace goldthread
