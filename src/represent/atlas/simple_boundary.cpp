// Boundary edges under a binary tree of boxes. In loop order neighbours in the tree are neighbours in the
// plane, so that no sorting is needed, and two halves that lie apart are done with at once.
#include "represent/atlas/grid_image.h"

namespace goldthread {
namespace {

struct Edge {
  uint32_t from, to;  ///< corners
};

struct GridBox {
  GridPoint low{std::numeric_limits<int>::max()}, high{std::numeric_limits<int>::min()};

  bool meets(const GridBox& o) const {
    return low.x <= o.high.x && o.low.x <= high.x && low.y <= o.high.y && o.low.y <= high.y;
  }
  static GridBox around(const GridPoint& a, const GridPoint& b) { return {glm::min(a, b), glm::max(a, b)}; }
};

int sign(int64_t value) {
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

/// Whether two segments, ends included, have a point in common.
bool meet(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
  if (!GridBox::around(a, b).meets(GridBox::around(c, d))) return false;
  // On one line they meet since their boxes do.
  return sign(turn(a, b, c)) * sign(turn(a, b, d)) <= 0 && sign(turn(c, d, a)) * sign(turn(c, d, b)) <= 0;
}

class EdgeTree {
 public:
  EdgeTree(const Piece& piece, const GridImage& image) : points_(image.points) {
    for (size_t l = 0; l < piece.loop_count(); ++l) {
      const auto loop = piece.loop(l);
      for (size_t i = 0; i < loop.size(); ++i) edges_.push_back({loop[i], loop[(i + 1) % loop.size()]});
    }
    while (leaves_ < edges_.size()) leaves_ *= 2;
    boxes_.resize(2 * leaves_);  // box k is round boxes 2k and 2k + 1; leaves beyond the edges stay empty
    for (size_t i = 0; i < edges_.size(); ++i)
      boxes_[leaves_ + i] = GridBox::around(points_[edges_[i].from], points_[edges_[i].to]);
    for (size_t k = leaves_ - 1; k > 0; --k)
      boxes_[k] = {glm::min(boxes_[2 * k].low, boxes_[2 * k + 1].low),
                   glm::max(boxes_[2 * k].high, boxes_[2 * k + 1].high)};
  }

  bool any_meet() const {
    for (size_t k = 1; k < leaves_; ++k)
      if (any_meet(2 * k, 2 * k + 1)) return true;
    return false;
  }

 private:
  /// Whether an edge under one node meets one under another of the same depth.
  bool any_meet(size_t a, size_t b) const {
    if (!boxes_[a].meets(boxes_[b])) return false;
    if (a >= leaves_) return edges_meet(edges_[a - leaves_], edges_[b - leaves_]);
    return any_meet(2 * a, 2 * b) || any_meet(2 * a, 2 * b + 1) || any_meet(2 * a + 1, 2 * b) ||
           any_meet(2 * a + 1, 2 * b + 1);
  }

  /// Edges that follow each other share a corner and must share no more: the second must not fold back.
  bool edges_meet(const Edge& e, const Edge& f) const {
    if (e.to == f.from) return folds_back(e.from, e.to, f.to) || (f.to == e.from);
    if (f.to == e.from) return folds_back(f.from, f.to, e.to);
    return meet(points_[e.from], points_[e.to], points_[f.from], points_[f.to]);
  }
  bool folds_back(uint32_t a, uint32_t b, uint32_t c) const {
    const glm::i64vec2 p = points_[a] - points_[b], q = points_[c] - points_[b];
    return turn(points_[a], points_[b], points_[c]) == 0 && p.x * q.x + p.y * q.y > 0;
  }

  const std::vector<GridPoint>& points_;
  std::vector<Edge> edges_;
  size_t leaves_ = 1;
  std::vector<GridBox> boxes_;
};

/// Twice the area that a loop goes round. Sums wrap, but that of a loop that does not cross itself is below
/// 2^47 and comes out right.
int64_t doubled_area(std::span<const uint32_t> loop, const GridImage& image) {
  uint64_t sum = 0;
  for (size_t i = 0; i < loop.size(); ++i) {
    const GridPoint &p = image.points[loop[i]], &q = image.points[loop[(i + 1) % loop.size()]];
    sum += uint64_t(int64_t(p.x) * q.y - int64_t(p.y) * q.x);
  }
  return int64_t(sum);
}

}  // namespace

bool boundary_is_simple(const Piece& piece, const GridImage& image) {
  if (EdgeTree(piece, image).any_meet()) return false;
  size_t outer = 0;
  for (size_t l = 0; l < piece.loop_count(); ++l) outer += doubled_area(piece.loop(l), image) > 0;
  return outer == 1;
}

}  // namespace goldthread
