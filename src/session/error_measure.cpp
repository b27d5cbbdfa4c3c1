#include "session/error_measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace goldthread {
namespace {

// Of the mean: what is darker is measured against this.
constexpr double kLeastTruth = 0.01;

double quantile(std::vector<double>& values, double share) {
  const auto rank = static_cast<size_t>(std::ceil(share * static_cast<double>(values.size())));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::max<size_t>(1, rank) - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

ErrorFigures measure_errors(const std::vector<Measured>& places) {
  ErrorFigures out;
  out.points = places.size();
  if (places.empty()) return out;
  const auto n = static_cast<double>(places.size());
  double squares = 0, noise = 0, sum = 0;
  for (const Measured& m : places) {
    const double off = m.value - m.truth;
    out.mean_truth += m.truth / n;
    squares += off * off / n;
    noise += m.standard_error * m.standard_error / n;
    sum += off / n;
  }
  if (out.mean_truth <= 0) return out;
  std::vector<double> relative;
  for (const Measured& m : places) {
    relative.push_back(std::abs(m.value - m.truth) / std::max(m.truth, kLeastTruth * out.mean_truth));
    if (relative.back() <= out.worst_error) continue;
    out.worst_error = relative.back();
    out.worst = m;
  }
  out.raw_rmse = std::sqrt(squares) / out.mean_truth;
  out.reference_noise = std::sqrt(noise) / out.mean_truth;
  out.relative_rmse = std::sqrt(std::max(0.0, squares - noise)) / out.mean_truth;
  out.bias = sum / out.mean_truth;
  out.bias_error = std::sqrt(std::max(0.0, squares - sum * sum) / n) / out.mean_truth;
  out.median = quantile(relative, 0.5);
  out.p99 = quantile(relative, 0.99);
  return out;
}

nlohmann::ordered_json as_json(const ErrorFigures& f) {
  return {{"points", f.points},
          {"relative_rmse", f.relative_rmse},
          {"bias", f.bias},
          {"bias_standard_error", f.bias_error},
          {"median_relative_error", f.median},
          {"p99_relative_error", f.p99},
          {"reference_noise", f.reference_noise},
          {"rmse_with_noise", f.raw_rmse},
          {"mean", f.mean_truth},
          {"worst",
           {{"position", {f.worst.position.x, f.worst.position.y, f.worst.position.z}},
            {"relative_error", f.worst_error},
            {"value", f.worst.value},
            {"reference", f.worst.truth},
            {"reference_standard_error", f.worst.standard_error}}}};
}

std::string as_text(const ErrorFigures& f, const std::string& unit) {
  const auto percent = [](double share) { return fmt::format("{:.3g} %", 100 * share); };
  std::string text = fmt::format("{} points, mean {:.4g} {}\n", f.points, f.mean_truth, unit);
  text += fmt::format("RMSE / mean   {}", percent(f.relative_rmse));
  if (f.reference_noise > 0)
    text += fmt::format("  (with the reference's own noise {}, which is {})", percent(f.raw_rmse),
                        percent(f.reference_noise));
  text += fmt::format("\nbias          {} ± {}\nmedian error  {}\n99th percent  {}\n", percent(f.bias),
                      percent(f.bias_error), percent(f.median), percent(f.p99));
  if (f.worst_error > 0)
    text += fmt::format("worst         {} at ({:.4g}, {:.4g}, {:.4g}): {:.4g} against {:.4g} ± {:.2g} {}\n",
                        percent(f.worst_error), f.worst.position.x, f.worst.position.y, f.worst.position.z,
                        f.worst.value, f.worst.truth, f.worst.standard_error, unit);
  return text;
}

vec3 error_colour(double signed_error, double full_scale, float shade) {
  const auto strength = static_cast<float>(std::clamp(std::abs(signed_error) / full_scale, 0.0, 1.0));
  const vec3 full = signed_error < 0 ? vec3(0.05f, 0.15f, 0.9f) : vec3(0.9f, 0.05f, 0.03f);
  return (1 - strength) * vec3(shade) + strength * full;
}

}  // namespace goldthread
