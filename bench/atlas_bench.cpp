// Charts and packing beside xatlas: CPU seconds and page use at padding 2, one page. xatlas's figures are
// those of ../shared/peers/README.md, measured on two cores of the kind that this project is measured on.
#include <fmt/format.h>
#include <sys/resource.h>

#include <filesystem>

#include "files/scene_read.h"
#include "represent/atlas_layout.h"
#include "scene/procedural.h"

using namespace goldthread;

namespace {

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// All of a scene's primitives, once each, as one is asked to unwrap a model.
struct Model {
  std::vector<FaceClusterTree> trees;
  double clustering = 0;
  uint64_t triangles = 0;

  explicit Model(const Scene& scene) {
    const double begin = cpu_seconds();
    for (const Mesh& mesh : scene.meshes)
      for (const Primitive& primitive : mesh.primitives) {
        trees.push_back(build_face_clusters(weld(primitive.positions, primitive.indices)));
        triangles += trees.back().mesh.triangles.size();
      }
    clustering = cpu_seconds() - begin;
  }
};

void run(const std::string& name, const Scene& scene, const char* peer) {
  const Model model(scene);
  const CancelToken never;
  ChartStats stats;
  double begin = cpu_seconds();
  std::vector<std::vector<Chart>> charts;
  ChartOptions options;
  double area = 0;
  for (const FaceClusterTree& tree : model.trees) area += surface_of(tree);
  options.most_waste = float(area * kMostWaste);
  for (const FaceClusterTree& tree : model.trees) charts.push_back(make_charts(tree, options, never, stats));
  const double charting = cpu_seconds() - begin;
  std::vector<PackChart> shapes;
  for (const std::vector<Chart>& own : charts)
    for (const Chart& chart : own) shapes.push_back({chart.faces, chart.coordinates, 1});
  begin = cpu_seconds();
  const std::optional<Packing> packing = pack(shapes, {}, never);
  const double packed = cpu_seconds() - begin;
  fmt::print("{:<16}{:>9}{:>8}{:>8.2f}{:>8.2f}{:>8.2f}{:>9.1f}%{:>8.3f}{:>7.2f}   {}\n", name,
             model.triangles, shapes.size(), model.clustering, charting, packed,
             packing ? 100 * packing->use : 0.0, stats.area > 0 ? stats.sum_of_stretch / stats.area : 0.0,
             stats.most_stretch, peer);
  if (!packing) std::exit(1);
}

}  // namespace

int main() {
  fmt::print("{:<16}{:>9}{:>8}{:>8}{:>8}{:>8}{:>10}{:>8}{:>7}   {}\n", "model", "faces", "charts", "trees",
             "charts", "pack", "use", "stretch", "most", "xatlas: charts + pack, use");
  const std::filesystem::path shared = std::filesystem::path(__FILE__).parent_path() / "../../shared/scenes";
  const std::pair<const char*, const char*> models[] = {
      {"sponza", "5.7 + 0.3 s, 88.5%"},
      {"engine-room", "2.0 + 1.0 s, 77.2% (the engine alone)"},
      {"sportscar-room", ""},
      {"bathroom", ""}};
  for (const auto& [name, peer] : models) {
    const std::filesystem::path file = shared / (std::string(name) + ".glb");
    if (!std::filesystem::exists(file)) {
      fmt::print("{:<16} is not here: {}\n", name, file.string());
      continue;
    }
    const Result<Scene> scene = read_scene(file.string());
    if (scene) run(name, *scene, peer);
  }
  const Result<Scene> car = build_procedural("car", 1000000);
  if (car) run("car, a million", *car, "");
  return 0;
}
