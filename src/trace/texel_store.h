// The images of a scene as lookups at random find them soonest.
#pragma once
#include <cstdint>
#include <vector>

#include "scene/image.h"

namespace goldthread {

/// Images by their numbers. Small ones are copied side by side into large pages, of which each would fill
/// none by itself; large ones stay where they are. Refers to these, which must outlive it.
class TexelStore {
 public:
  explicit TexelStore(const std::vector<Image>& images);
  TexelStore(const TexelStore&) = delete;  // its views lead into its copies
  TexelStore& operator=(const TexelStore&) = delete;

  /// Of no image where the texture has none.
  TexelView operator[](const Texture& texture) const {
    const auto image = static_cast<size_t>(texture.image);
    return texture.present() && image < views_.size() ? views_[image] : TexelView();
  }

 private:
  std::vector<uint8_t> copies_;
  std::vector<TexelView> views_;
};

}  // namespace goldthread
