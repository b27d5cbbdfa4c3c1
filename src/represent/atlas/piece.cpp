#include "represent/atlas/piece.h"

#include "base/parallel.h"
#include "mesh/dual_graph.h"

namespace goldthread {
namespace {

uint32_t next_in_triangle(uint32_t half_edge) {
  return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1;
}
uint32_t previous_in_triangle(uint32_t half_edge) {
  return half_edge % 3 == 0 ? half_edge + 2 : half_edge - 1;
}

/// Half-edges are numbered from the piece's first; half-edge 3 * t + k leaves corner k.
class Cutter {
 public:
  Cutter(const TriangleMesh& mesh, std::span<const uint32_t> twins, uint32_t first, uint32_t count)
      : mesh_(mesh), twins_(count * 3) {
    piece_.first = first;
    piece_.faces.assign(count, UVec3(kNoTwin));
    for (uint32_t h = 0; h < count * 3; ++h) {
      const uint32_t twin = twins[first * 3 + h];  // kNoTwin stays out of range
      twins_[h] = twin - first * 3 < count * 3 ? twin - first * 3 : kNoTwin;
    }
  }

  Piece cut() {
    for (uint32_t h = 0; h < twins_.size(); ++h)
      if (corner_of(h) == kNoTwin) walk_fan(h);
    find_loops();
    piece_.connected = reaches_all();
    return std::move(piece_);
  }

 private:
  uint32_t& corner_of(uint32_t half_edge) { return piece_.faces[half_edge / 3][int(half_edge % 3)]; }

  /// Gives the corner that half-edge `h` leaves, and all of its fan, the next number.
  void walk_fan(uint32_t h) {
    uint32_t begin = h;  // back to the boundary, or round
    while (twins_[begin] != kNoTwin) {
      begin = next_in_triangle(twins_[begin]);
      if (begin == h) break;
    }
    const uint32_t corner = uint32_t(piece_.positions.size());
    const vec3* const positions = mesh_.positions.data();
    const UVec3& origin = mesh_.triangles[piece_.first];
    const uint32_t vertex = mesh_.triangles[piece_.first + h / 3][int(h % 3)];
    piece_.positions.push_back(dvec3(positions[vertex]) - dvec3(positions[origin.x]));
    for (uint32_t at = begin;;) {
      corner_of(at) = corner;
      at = twins_[previous_in_triangle(at)];
      if (at == kNoTwin || at == begin) return;
    }
  }

  /// A fan has one boundary edge that leaves its corner, or none: loops are followed without choices.
  void find_loops() {
    std::vector<uint32_t> next(piece_.positions.size(), kNoTwin);
    for (uint32_t h = 0; h < twins_.size(); ++h)
      if (twins_[h] == kNoTwin) next[corner_of(h)] = corner_of(next_in_triangle(h));
    for (uint32_t corner = 0; corner < next.size(); ++corner) {
      if (next[corner] == kNoTwin) continue;
      piece_.loops.push_back(uint32_t(piece_.boundary.size()));
      for (uint32_t at = corner; next[at] != kNoTwin; at = std::exchange(next[at], kNoTwin))
        piece_.boundary.push_back(at);
    }
    piece_.loops.push_back(uint32_t(piece_.boundary.size()));
  }

  bool reaches_all() const {
    std::vector<uint32_t> reached{0};
    std::vector<bool> seen(piece_.faces.size());
    seen[0] = true;
    for (size_t i = 0; i < reached.size(); ++i)
      for (uint32_t k = 0; k < 3; ++k) {
        const uint32_t twin = twins_[reached[i] * 3 + k];
        if (twin == kNoTwin || seen[twin / 3]) continue;
        seen[twin / 3] = true;
        reached.push_back(twin / 3);
      }
    return reached.size() == piece_.faces.size();
  }

  const TriangleMesh& mesh_;
  std::vector<uint32_t> twins_;
  Piece piece_;
};

}  // namespace

bool Piece::is_disc_with_holes() const {
  // V - E + F = 2 - 2 handles - loops, of a connected surface that can be told inside from outside.
  const size_t doubled_edges = faces.size() * 3 + boundary.size();
  const auto euler = int64_t(positions.size() + faces.size()) - int64_t(doubled_edges / 2);
  return connected && loop_count() > 0 && euler == 2 - int64_t(loop_count());
}

std::vector<uint32_t> find_opposite_twins(const TriangleMesh& mesh) {
  std::vector<uint32_t> twins = find_twins(mesh);
  const auto from = [&](uint32_t h) { return mesh.triangles[h / 3][int(h % 3)]; };
  parallel_for(
      mesh.triangles.size(),
      [&](size_t t) {
        for (size_t h = 3 * t; h < 3 * t + 3; ++h)
          if (twins[h] != kNoTwin && from(twins[h]) == from(uint32_t(h))) twins[h] = kNoTwin;
      },
      16384);
  return twins;
}

Piece cut_piece(const TriangleMesh& mesh, std::span<const uint32_t> twins, uint32_t first, uint32_t count) {
  return Cutter(mesh, twins, first, count).cut();
}

}  // namespace goldthread
