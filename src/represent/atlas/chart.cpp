#include "represent/atlas/chart.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "represent/atlas/flatten.h"
#include "represent/atlas/grid_image.h"
#include "represent/atlas/piece.h"

namespace goldthread {
namespace {

enum class Verdict { kChart, kNotADisc, kFlipped, kOverlapping, kStretched, kSprawling };

/// What became of a cluster, or of a single triangle.
struct Trial {
  Verdict verdict = Verdict::kChart;
  Chart chart;
};

/// Where all normals point about one way, looking straight at the surface stretches it hardly more than the
/// best map would, and asks for no system to be solved.
constexpr float kNearlyFlat = 0.9f;
constexpr double kGoodEnough = 1.01;
/// Less than this of a surface's area faces one way: it is closed, or rolled up more than once, and no map
/// will lay it flat within any stretch that one would allow. (Three quarters of a cylinder face with 0.3.)
constexpr float kHopeless = 0.25f;

Chart chart_of(const Piece& piece, const GridImage& grid, double stretch) {
  Chart chart;
  chart.triangles.resize(piece.faces.size());
  std::iota(chart.triangles.begin(), chart.triangles.end(), piece.first);
  chart.faces = piece.faces;
  chart.coordinates.resize(piece.positions.size());
  for (size_t i = 0; i < chart.coordinates.size(); ++i) chart.coordinates[i] = grid.coordinates(i);
  chart.stretch = static_cast<float>(stretch);
  return chart;
}

Verdict judge(const Piece& piece, const GridImage& grid, double most_stretch, double& stretch) {
  if (!all_positive(piece.faces, grid)) return Verdict::kFlipped;
  stretch = stretch_of(piece, grid.plane_image());
  if (!(stretch <= most_stretch)) return Verdict::kStretched;
  return boundary_is_simple(piece, grid) ? Verdict::kChart : Verdict::kOverlapping;
}

/// How much of its box a chart leaves free.
double waste_of(const Piece& piece, const GridImage& grid) {
  GridPoint high(0);
  for (const GridPoint& point : grid.points) high = glm::max(high, point);
  double doubled = 2 * static_cast<double>(high.x) * static_cast<double>(high.y);
  for (const UVec3& face : piece.faces)
    doubled -= static_cast<double>(turn(grid.points[face.x], grid.points[face.y], grid.points[face.z]));
  return doubled / 2 * grid.step * grid.step;
}

Trial try_image(const Piece& piece, const std::optional<PlaneImage>& image, double most_stretch,
                double most_waste) {
  if (!image) return {Verdict::kFlipped, {}};
  const GridImage grid = lay_on_grid(*image);
  if (waste_of(piece, grid) > most_waste) return {Verdict::kSprawling, {}};
  double stretch = 0;
  const Verdict verdict = judge(piece, grid, most_stretch, stretch);
  if (verdict != Verdict::kChart) return {verdict, {}};
  return {verdict, chart_of(piece, grid, stretch)};
}

Trial lone_triangle(const TriangleMesh& mesh, uint32_t triangle) {
  Piece piece;
  piece.first = triangle;
  piece.faces = {UVec3(0, 1, 2)};
  for (int k = 0; k < 3; ++k) piece.positions.emplace_back(mesh.positions[mesh.triangles[triangle][k]]);
  const GridImage grid = lay_on_grid(piece.positions[0], piece.positions[1], piece.positions[2]);
  return {Verdict::kChart, chart_of(piece, grid, 1)};
}

Trial try_cluster(const FaceClusterTree& tree, std::span<const uint32_t> twins, const FaceCluster& cluster,
                  const ChartOptions& options) {
  const float facing = cluster.area > 0 ? length(cluster.summed_normal) / cluster.area : 0.0f;
  if (facing < kHopeless) return {Verdict::kStretched, {}};
  const Piece piece = cut_piece(tree.mesh, twins, cluster.first, cluster.count);
  if (!piece.is_disc_with_holes()) return {Verdict::kNotADisc, {}};
  const auto most = static_cast<double>(options.most_stretch),
             waste = static_cast<double>(options.most_waste);
  if (facing >= kNearlyFlat) {
    Trial trial = try_image(piece, project(piece), std::min(most, kGoodEnough), waste);
    if (trial.verdict == Verdict::kChart || trial.verdict == Verdict::kSprawling) return trial;
  }
  return try_image(piece, map_conformally(piece), most, waste);
}

void count(const Trial& trial, const FaceClusterTree& tree, ChartStats& stats) {
  ++stats.tried;
  stats.not_discs += trial.verdict == Verdict::kNotADisc;
  stats.flipped += trial.verdict == Verdict::kFlipped;
  stats.overlapping += trial.verdict == Verdict::kOverlapping;
  stats.stretched += trial.verdict == Verdict::kStretched;
  stats.sprawling += trial.verdict == Verdict::kSprawling;
  if (trial.verdict != Verdict::kChart) return;
  double area = 0;
  for (const uint32_t t : trial.chart.triangles) {
    const UVec3& corners = tree.mesh.triangles[t];
    const auto at = [&](int k) { return tree.mesh.positions[corners[k]]; };
    area += static_cast<double>(length(area_vector(at(0), at(1), at(2))));
  }
  ++stats.charts;
  stats.area += area;
  stats.sum_of_stretch += area * static_cast<double>(trial.chart.stretch);
  stats.most_stretch = std::max(stats.most_stretch, trial.chart.stretch);
}

}  // namespace

std::vector<Chart> make_charts(const FaceClusterTree& tree, const ChartOptions& options,
                               const CancelToken& cancel, ChartStats& stats) {
  const std::vector<uint32_t> twins = find_opposite_twins(tree.mesh);
  std::vector<Chart> charts;
  // In waves: all clusters that are to be tried, in parallel, then the children of those that are no charts.
  std::vector<ClusterRef> wave = tree.roots;
  while (!wave.empty() && !cancel.cancelled()) {
    std::vector<Trial> trials(wave.size());
    parallel_for(wave.size(), [&](size_t i) {
      trials[i] = is_triangle(wave[i]) ? lone_triangle(tree.mesh, triangle_of(wave[i]))
                                       : try_cluster(tree, twins, tree.nodes[wave[i]], options);
    });
    std::vector<ClusterRef> next;
    for (size_t i = 0; i < wave.size(); ++i) {
      count(trials[i], tree, stats);
      if (trials[i].verdict == Verdict::kChart)
        charts.push_back(std::move(trials[i].chart));
      else
        for (const ClusterRef child : tree.nodes[wave[i]].child) next.push_back(child);
    }
    wave = std::move(next);
  }
  std::sort(charts.begin(), charts.end(),
            [](const Chart& a, const Chart& b) { return a.triangles[0] < b.triangles[0]; });
  return charts;
}

}  // namespace goldthread
