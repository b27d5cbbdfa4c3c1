#include "mesh/orient.h"

#include <cmath>

#include "mesh/components.h"
#include "mesh/dual_graph.h"

namespace goldthread {
namespace {

uint32_t start_vertex(const TriangleMesh& mesh, uint32_t half_edge) {
  return mesh.triangles[half_edge / 3][static_cast<int>(half_edge % 3)];
}

/// Two neighbours are wound alike when their half-edges run in opposite directions.
bool wound_alike(const TriangleMesh& mesh, uint32_t half_edge, uint32_t twin) {
  return start_vertex(mesh, half_edge) != start_vertex(mesh, twin);
}

/// Floods the shell of triangle `seed`: side[t] becomes 0 or 1. False when two paths disagree.
bool flood(const TriangleMesh& mesh, std::span<const uint32_t> twins, uint32_t seed,
           std::vector<uint8_t>& side, std::vector<uint32_t>& stack) {
  constexpr uint8_t kUnseen = 2;
  bool agreed = true;
  side[seed] = 0;
  stack.assign(1, seed);
  while (!stack.empty()) {
    const uint32_t triangle = stack.back();
    stack.pop_back();
    for (uint32_t half_edge = 3 * triangle; half_edge < 3 * triangle + 3; ++half_edge) {
      const uint32_t twin = twins[half_edge];
      if (twin == kNoTwin) continue;
      const uint8_t wanted = side[triangle] ^ uint8_t(wound_alike(mesh, half_edge, twin) ? 0 : 1);
      if (side[twin / 3] == kUnseen) {
        side[twin / 3] = wanted;
        stack.push_back(twin / 3);
      } else if (side[twin / 3] != wanted) {
        agreed = false;
      }
    }
  }
  return agreed;
}

struct Sums {
  double side_area[2] = {0, 0};
  double volume = 0;  ///< of side 0 as it is wound and side 1 turned
};

/// Sums over triangles; volumes from the shell's own corner, lest far from the origin they drown in rounding.
void add_triangle(const TriangleMesh& mesh, size_t t, uint8_t side, const dvec3& origin, Sums& sums) {
  const UVec3& corners = mesh.triangles[t];
  const dvec3 a = dvec3(mesh.positions[corners.x]) - origin, b = dvec3(mesh.positions[corners.y]) - origin,
              c = dvec3(mesh.positions[corners.z]) - origin;
  const dvec3 twice_area = cross(b - a, c - a);
  sums.side_area[side] += 0.5 * length(twice_area);
  sums.volume += (side ? -1 : 1) * dot(a, twice_area) / 6;
}

void measure_shells(const TriangleMesh& mesh, const std::vector<uint8_t>& side, Winding& winding) {
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      winding.shells[winding.shell_of_triangle[t]].box.add(mesh.positions[mesh.triangles[t][k]]);
  std::vector<Sums> sums(winding.shells.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const uint32_t shell = winding.shell_of_triangle[t];
    add_triangle(mesh, t, side[t], dvec3(winding.shells[shell].box.centre()), sums[shell]);
  }
  std::vector<uint8_t> greater(winding.shells.size());
  for (size_t s = 0; s < sums.size(); ++s) {
    greater[s] = sums[s].side_area[1] > sums[s].side_area[0];
    winding.shells[s].area = sums[s].side_area[0] + sums[s].side_area[1];
    winding.shells[s].volume = greater[s] ? -sums[s].volume : sums[s].volume;
  }
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    Shell& shell = winding.shells[winding.shell_of_triangle[t]];
    winding.against[t] = shell.orientable && side[t] != greater[winding.shell_of_triangle[t]];
    shell.against += winding.against[t];
    ++shell.triangles;
  }
}

}  // namespace

bool Shell::faces_inwards() const {
  constexpr double kFlat =
      1e-5;  // of the cube with the shell's area: two layers back to back enclose nothing
  return closed && orientable && volume < -kFlat * std::pow(area, 1.5);
}

Winding find_winding(const TriangleMesh& mesh, std::span<const uint32_t> twins) {
  Components components = find_components(twins);
  Winding winding;
  winding.shells.resize(components.count);
  winding.shell_of_triangle = std::move(components.of_triangle);
  winding.against.resize(mesh.triangles.size());
  for (Shell& shell : winding.shells) shell.closed = true;
  for (size_t half_edge = 0; half_edge < twins.size(); ++half_edge)
    if (twins[half_edge] == kNoTwin) winding.shells[winding.shell_of_triangle[half_edge / 3]].closed = false;

  std::vector<uint8_t> side(mesh.triangles.size(), 2);
  std::vector<uint32_t> stack;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (side[t] == 2)
      winding.shells[winding.shell_of_triangle[t]].orientable = flood(mesh, twins, t, side, stack);
  measure_shells(mesh, side, winding);
  return winding;
}

std::vector<uint8_t> triangles_to_turn(const Winding& winding, std::span<const uint8_t> rooms) {
  std::vector<uint8_t> turn(winding.against);
  for (size_t t = 0; t < turn.size(); ++t) {
    const uint32_t shell = winding.shell_of_triangle[t];
    const bool is_room = !rooms.empty() && rooms[shell];
    if (winding.shells[shell].faces_inwards() && !is_room) turn[t] ^= 1;
  }
  return turn;
}

}  // namespace goldthread
