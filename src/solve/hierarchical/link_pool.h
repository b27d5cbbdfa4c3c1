// All links, ordered so that those of one receiver lie together.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "solve/hierarchical/link.h"

namespace goldthread {

class LinkPool {
 public:
  std::vector<Link>& all() { return links_; }
  const std::vector<Link>& all() const { return links_; }

  /// What the links' `view` numbers stand for.
  std::vector<SourceView>& views() { return views_; }
  const std::vector<SourceView>& views() const { return views_; }

  /// Drops dead links and orders the rest by receiver, keeping the order within one. `elements` is the pool's
  /// size.
  void sort(size_t elements);

  /// Links into a receiver. Valid after `sort`, until links change. Elements made since have none.
  std::span<const Link> into(ElementId receiver) const {
    if (receiver + size_t{1} >= first_.size()) return {};
    return {links_.data() + first_[receiver], links_.data() + first_[receiver + 1]};
  }

  uint64_t memory_bytes() const {
    return links_.capacity() * sizeof(Link) + views_.capacity() * sizeof(SourceView) +
           first_.capacity() * sizeof(uint64_t);
  }

 private:
  std::vector<Link> links_;
  std::vector<SourceView> views_;
  std::vector<uint64_t> first_;  // per element, one more at the end
};

}  // namespace goldthread
