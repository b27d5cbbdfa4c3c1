#include "solve/hierarchical/link_pool.h"

namespace goldthread {

void LinkPool::sort(size_t elements) {
  first_.assign(elements + 1, 0);
  for (const Link& link : links_)
    if (link.alive) ++first_[link.receiver + 1];
  for (size_t e = 0; e < elements; ++e) first_[e + 1] += first_[e];
  std::vector<uint64_t> cursor(first_.begin(), first_.end() - 1);
  std::vector<Link> sorted(first_.back());
  for (const Link& link : links_)
    if (link.alive) sorted[cursor[link.receiver]++] = link;
  links_ = std::move(sorted);
}

}  // namespace goldthread
