// What an error costs: root mean square error against path tracing over CPU time, as a table and as a plot;
// and what each way of saving rays is worth.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "folder.h"
#include "goldthread/bake.h"
#include "goldthread/compare.h"

namespace goldthread {
namespace {

struct Measurement {
  double asked = 0, estimated = 0, error = 0;  // shares of the mean light
  double seconds = 0;                          // CPU, of the whole bake
  uint64_t links = 0, rays = 0, gather_rays = 0;
};

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Bakes to a .gold file and holds it against the reference: at the texels of its light maps if it has any.
Measurement measure(const Folder& folder, BakeOptions options) {
  options.outputs = {folder.path("lit.gold")};
  Measurement m;
  const double begin = cpu_seconds();
  const Result<BakeResult> baked = bake(options);
  if (!baked) throw std::runtime_error(baked.error().line());
  m.seconds = cpu_seconds() - begin;
  const auto solver = nlohmann::json::parse(baked->json)["solver"];
  m.asked = options.error.value_or(0);
  m.estimated = solver["error_estimate"];
  m.links = solver["links"];
  m.rays = solver["rays"];
  m.gather_rays = solver["reconstruct_rays"];
  CompareOptions compare_options;
  compare_options.first = options.outputs[0];
  compare_options.reference = true;
  compare_options.texels = options.mode == OutputMode::kLightmap;
  compare_options.points = 4000;
  compare_options.samples = compare_options.texels ? 2048 : 512;
  const Result<CompareResult> compared = compare(compare_options);
  if (!compared) throw std::runtime_error(compared.error().line());
  m.error = nlohmann::json::parse(compared->json)["relative_rmse"];
  return m;
}

std::string scene(const Folder& folder, const std::string& name) {
  const std::string file = folder.path(name + ".glb");
  const Result<uint64_t> made = make_scene({name, 0, file});
  if (!made) throw std::runtime_error(made.error().line());
  return file;
}

struct Curve {
  std::string name;
  std::vector<Measurement> points;
};

/// Both axes logarithmic: a factor of ten a decade, 0.1 to 1000 s and 0.5 to 50 %.
class Plot {
 public:
  void add(const Curve& curve, const char* colour) {
    std::string line;
    for (const Measurement& m : curve.points) {
      line += fmt::format("{:.1f},{:.1f} ", x(m.seconds), y(m.error));
      body_ += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='3' fill='{}'/>\n", x(m.seconds), y(m.error),
                           colour);
    }
    body_ += fmt::format("<polyline points='{}' fill='none' stroke='{}'/>\n", line, colour);
    body_ += fmt::format("<text x='{}' y='{}' fill='{}'>{}</text>\n", kWidth - 110, 40 + 16 * curves_++,
                         colour, curve.name);
  }

  void write(const std::string& file) const {
    std::string axes;
    for (const double t : {0.1, 1.0, 10.0, 100.0, 1000.0})
      axes += fmt::format(
          "<line x1='{0:.1f}' x2='{0:.1f}' y1='20' y2='{1}' stroke='#ccc'/><text x='{0:.1f}' y='{2}' "
          "text-anchor='middle'>{3:g} s</text>\n",
          x(t), kHeight - 40, kHeight - 24, t);
    for (const double e : {0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5})
      axes += fmt::format(
          "<line y1='{0:.1f}' y2='{0:.1f}' x1='50' x2='{1}' stroke='#ccc'/><text y='{2:.1f}' x='46' "
          "text-anchor='end'>{3:g}%</text>\n",
          y(e), kWidth - 20, y(e) + 4, 100 * e);
    std::ofstream out(file);
    out << fmt::format(
        "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' font-family='sans-serif' "
        "font-size='12'>\n<rect width='{0}' height='{1}' fill='white'/>\n{2}{3}<text x='{4}' y='{5}' "
        "text-anchor='middle'>CPU seconds of a bake; RMS error over the mean light</text>\n</svg>\n",
        kWidth, kHeight, axes, body_, kWidth / 2, kHeight - 6);
    if (!out.flush()) throw std::runtime_error("cannot write " + file);
  }

 private:
  static constexpr int kWidth = 640, kHeight = 420;
  static double x(double seconds) {
    return 50 + (kWidth - 70) * (std::log10(std::clamp(seconds, 0.1, 1000.0)) + 1) / 4;
  }
  static double y(double error) {
    return 20 + (kHeight - 60) * (1 - std::log10(std::clamp(error, 0.005, 0.5) / 0.005) / 2);
  }
  std::string body_;
  int curves_ = 0;
};

Curve error_over_time(const Folder& folder, const std::string& name, BakeOptions options,
                      const std::vector<double>& errors) {
  Curve curve{name, {}};
  for (const double error : errors) {
    options.error = error;
    curve.points.push_back(measure(folder, options));
    const Measurement& m = curve.points.back();
    fmt::print("{:13} --error {:4.1f}%: {:6.2f}% found, {:6.2f}% stated, {:6.2f} CPU s, {:6.2f} Mrays\n",
               name, 100 * m.asked, 100 * m.error, 100 * m.estimated, m.seconds,
               1e-6 * static_cast<double>(m.rays + m.gather_rays));
  }
  return curve;
}

Curve error_over_time(const Folder& folder, const std::string& name, const std::vector<double>& errors) {
  BakeOptions options;
  options.input = scene(folder, name);
  return error_over_time(folder, name, options, errors);
}

/// Everything into one light map of 512 texels aside, as Cycles' figures in
/// ../shared/peers/README.md were measured.
void plot_light_maps(const Folder& folder) {
  Plot plot;
  BakeOptions options;
  options.mode = OutputMode::kLightmap;
  options.lightmap.page_size = 512;
  options.input = scene(folder, "cornell-box");
  plot.add(error_over_time(folder, "cornell 512^2", options, {0.3, 0.15, 0.1, 0.06, 0.03, 0.015}), "#b03020");
  options.input = std::filesystem::path(__FILE__).parent_path() / "../../shared/scenes/sponza.glb";
  if (std::filesystem::exists(options.input)) {
    options.sky = {10000, 10000, 10000};
    options.sun = LightOptions::Sun();
    plot.add(error_over_time(folder, "sponza 512^2", options, {0.3, 0.15, 0.06, 0.03}), "#2060b0");
  } else {
    fmt::print("{} is not there: Sponza's light map was not measured\n", options.input);
  }
  plot.write("out/bench/light_map_error_over_time.svg");
  fmt::print("plot: out/bench/light_map_error_over_time.svg\n");
}

void print_accelerators(const Folder& folder, const std::string& name) {
  struct Row {
    const char* what;
    bool discontinuities, shafts, adaptive;
  };
  const std::vector<Row> rows{{"all", true, true, true},
                              {"--no-discontinuities", false, true, true},
                              {"--no-shafts", true, false, true},
                              {"--no-adaptive-sampling", true, true, false},
                              {"none", false, false, false}};
  double least = 0;
  for (const Row& row : rows) {
    BakeOptions options;
    options.input = scene(folder, name);
    options.quality = Quality::kDraft;
    options.discontinuities = row.discontinuities;
    options.shafts = row.shafts;
    options.adaptive_sampling = row.adaptive;
    const Measurement m = measure(folder, options);
    const auto rays = static_cast<double>(m.rays + m.gather_rays);
    if (least == 0) least = rays;
    fmt::print(
        "{:12} {:24} {:5.1f} rays a link, {:7.2f} Mrays in all, {:5.2f} times the least, RMSE {:5.2f}%\n",
        name, row.what, static_cast<double>(m.rays) / static_cast<double>(m.links), rays * 1e-6, rays / least,
        100 * m.error);
  }
}

int run() {
  const Folder folder;
  Plot plot;
  plot.add(error_over_time(folder, "cornell-box", {0.3, 0.15, 0.1, 0.06, 0.04, 0.03, 0.02}), "#b03020");
  plot.add(error_over_time(folder, "two-rooms", {0.3, 0.15, 0.1, 0.06, 0.04, 0.03, 0.02}), "#2060b0");
  plot.add(error_over_time(folder, "office", {0.3, 0.15, 0.1, 0.06}), "#208040");
  std::filesystem::create_directories("out/bench");
  plot.write("out/bench/error_over_time.svg");
  fmt::print("plot: out/bench/error_over_time.svg\n");
  plot_light_maps(folder);
  for (const char* name : {"cornell-box", "two-rooms", "office"}) print_accelerators(folder, name);
  return 0;
}

}  // namespace
}  // namespace goldthread

int main() {
  try {
    return goldthread::run();
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
