// A page while it is being filled: which texels are taken, and where there is room.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "represent/atlas/mask.h"

namespace goldthread {

/// A place for a mask's first texel. Compared by row, then column.
struct PagePlace {
  uint32_t y = 0, x = 0;
  auto operator<=>(const PagePlace&) const = default;
};

class Page {
 public:
  /// `padding` texels round a chart stay free of others, but may lie beyond the page.
  Page(uint32_t size, uint32_t padding);

  /// The first place, by row and column and not before `from`, at which a chart fits: nothing that is taken
  /// meets `blocked`, which is its mask dilated by the padding.
  std::optional<PagePlace> find(const Mask& blocked, PagePlace from) const;

  /// Takes a chart's texels.
  void take(const Mask& touched, PagePlace place);
  uint64_t taken() const { return taken_; }

 private:
  uint32_t padding_;
  Mask texels_;                        ///< with a margin of the padding round the page
  std::vector<uint32_t> longest_gap_;  ///< of each of its rows
  uint64_t taken_ = 0;
};

}  // namespace goldthread
