#include "element/leaf_mesh.h"

#include "base/check.h"
#include "mesh/dual_graph.h"

namespace goldthread {

LeafMesh::LeafMesh(const Part& part, const TriangleMesh& mesh) : positions_(part.positions) {
  const auto triangles = static_cast<uint32_t>(mesh.triangles.size());
  twin_ = find_twins(mesh);
  origin_.resize(3 * size_t{triangles});
  next_.resize(origin_.size());
  face_.resize(origin_.size());
  face_edge_.resize(triangles);
  face_triangle_.resize(triangles);
  for (uint32_t t = 0; t < triangles; ++t) {
    for (uint32_t k = 0; k < 3; ++k) {
      origin_[3 * t + k] = mesh.triangles[t][static_cast<int>(k)];
      next_[3 * t + k] = 3 * t + (k + 1) % 3;
      face_[3 * t + k] = t;
    }
    face_edge_[t] = 3 * t;
    face_triangle_[t] = t;
  }
}

void LeafMesh::loop(uint32_t face, std::vector<uint32_t>& vertices) const {
  vertices.clear();
  const uint32_t first = face_edge_[face];
  uint32_t edge = first;
  do {
    vertices.push_back(origin_[edge]);
    edge = next_[edge];
  } while (edge != first);
}

uint32_t LeafMesh::add_edge(uint32_t origin, uint32_t face) {
  origin_.push_back(origin);
  next_.push_back(kNoEdge);
  twin_.push_back(kNoEdge);
  face_.push_back(face);
  return static_cast<uint32_t>(origin_.size() - 1);
}

void LeafMesh::mark_seam(uint32_t edge, Seam seam) {
  if (seam == Seam::kNone) return;
  if (edge >= seam_.size()) seam_.resize(edge + 1, Seam::kNone);
  seam_[edge] = seam;
}

uint32_t LeafMesh::split_edge(uint32_t edge, const vec3& position) {
  const auto vertex = static_cast<uint32_t>(positions_.size());
  positions_.push_back(position);
  const uint32_t other = twin_[edge];
  const uint32_t after = add_edge(vertex, face_[edge]);
  next_[after] = next_[edge];
  next_[edge] = after;
  mark_seam(after, seam(edge));
  if (other == kNoEdge) return vertex;
  // A neighbour wound the other way round runs along the edge in the same direction as we do.
  const bool same_direction = origin_[other] == origin_[edge];
  const uint32_t other_after = add_edge(vertex, face_[other]);
  next_[other_after] = next_[other];
  next_[other] = other_after;
  mark_seam(other_after, seam(other));
  const auto pair = [this](uint32_t a, uint32_t b) {
    twin_[a] = b;
    twin_[b] = a;
  };
  pair(edge, same_direction ? other : other_after);
  pair(after, same_direction ? other_after : other);
  return vertex;
}

uint32_t LeafMesh::split_face(uint32_t from, uint32_t to, Seam seam) {
  const uint32_t old_face = face_[from];
  const auto new_face = static_cast<uint32_t>(face_edge_.size());
  uint32_t before_to = from;
  while (next_[before_to] != to) before_to = next_[before_to];
  uint32_t before_from = to;
  while (next_[before_from] != from) before_from = next_[before_from];
  const uint32_t back = add_edge(origin_[to], old_face);     // closes from .. before_to
  const uint32_t forth = add_edge(origin_[from], new_face);  // closes to .. before_from
  next_[before_to] = back;
  next_[back] = from;
  next_[before_from] = forth;
  next_[forth] = to;
  twin_[back] = forth;
  twin_[forth] = back;
  mark_seam(back, seam);
  mark_seam(forth, seam);
  for (uint32_t edge = to; edge != forth; edge = next_[edge]) face_[edge] = new_face;
  face_edge_[old_face] = from;
  face_edge_.push_back(to);
  face_triangle_.push_back(face_triangle_[old_face]);
  return new_face;
}

uint64_t LeafMesh::memory_bytes() const {
  return positions_.capacity() * sizeof(vec3) + seam_.capacity() +
         (origin_.capacity() + next_.capacity() + twin_.capacity() + face_.capacity() +
          face_edge_.capacity() + face_triangle_.capacity()) *
             sizeof(uint32_t);
}

void validate(const LeafMesh& mesh) {
  std::vector<uint32_t> loop;
  for (uint32_t f = 0; f < mesh.face_count(); ++f) {
    mesh.loop(f, loop);
    GOLDTHREAD_CHECK_LE(size_t{3}, loop.size());
    uint32_t edge = mesh.first_edge(f);
    for (size_t i = 0; i < loop.size(); ++i, edge = mesh.next(edge)) {
      GOLDTHREAD_CHECK_EQ(mesh.face(edge), f);
      const uint32_t twin = mesh.twin(edge);
      if (twin == kNoEdge) continue;
      GOLDTHREAD_CHECK_EQ(mesh.twin(twin), edge);
      const uint32_t end = mesh.origin(mesh.next(edge));
      const uint32_t twin_end = mesh.origin(mesh.next(twin));
      const bool opposite = mesh.origin(twin) == end && twin_end == mesh.origin(edge);
      const bool same = mesh.origin(twin) == mesh.origin(edge) && twin_end == end;
      GOLDTHREAD_CHECK_EQ(opposite || same, true);
    }
  }
}

}  // namespace goldthread
