#include "solve/matrix/form_factor_matrix.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>

#include "base/parallel.h"
#include "base/rng.h"
#include "math/form_factor.h"
#include "math/oriented_box.h"
#include "math/polygon_exchange.h"
#include "visibility/hemicube.h"
#include "visibility/ray_caster.h"

namespace goldthread {
namespace {

struct Pair {
  uint32_t column;
  FormFactorMethod method;
  float error;
  double exchange;
};
using Row = std::vector<Pair>;

// Points of Strang's 3-point rule, one nearer to each corner: exact to degree 2.
constexpr double kNear = 2.0 / 3, kBeside = 1.0 / 6;
constexpr size_t kMostRays = 64;
constexpr uint32_t kOccluder = 0xffffffffu;

// A patch as rays need it: single precision, triangles for sampling, points for quadrature.
struct TracedPatch {
  std::vector<vec3> corners;
  std::vector<std::array<vec3, 3>> triangles;
  std::vector<float> area_up_to;  // running sum over the triangles
  std::vector<vec3> points;       // of the quadrature
  std::vector<float> weights;     // their areas
  vec3 normal{0}, centre{0};
  float area = 0, radius = 0;

  vec3 sample(float u, float v) const {
    size_t t = 0;
    while (t + 1 < triangles.size() && u * area > area_up_to[t]) ++t;
    const float before = t > 0 ? area_up_to[t - 1] : 0;
    const float width = area_up_to[t] - before;
    const float within = std::sqrt(std::clamp(width > 0 ? (u * area - before) / width : 0.5f, 0.0f, 1.0f));
    const auto& c = triangles[t];
    return (1 - within) * c[0] + within * ((1 - v) * c[1] + v * c[2]);
  }
};

void add_points(const std::array<dvec3, 3>& c, int cuts, TracedPatch& out) {
  if (cuts > 0) {
    const dvec3 m[3] = {0.5 * (c[1] + c[2]), 0.5 * (c[2] + c[0]), 0.5 * (c[0] + c[1])};
    for (const auto& part :
         {std::array<dvec3, 3>{c[0], m[2], m[1]}, {m[2], c[1], m[0]}, {m[1], m[0], c[2]}, {m[0], m[1], m[2]}})
      add_points(part, cuts - 1, out);
    return;
  }
  const auto size = static_cast<float>(0.5 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0])));
  for (size_t k = 0; k < 3; ++k) {
    out.points.emplace_back(kNear * c[k] + kBeside * (c[(k + 1) % 3] + c[(k + 2) % 3]));
    out.weights.push_back(size / 3);
  }
}

// Each triangle's rule is that of 4^cuts parts.
TracedPatch traced(const Polygon& polygon, int cuts) {
  TracedPatch out;
  for (const dvec3& p : polygon) out.corners.emplace_back(p);
  out.normal = vec3(plane_of(polygon).normal);
  out.centre = vec3(mean_corner(polygon));
  out.radius = static_cast<float>(radius(polygon));
  for (const UVec3& t : triangulate(polygon)) {
    const std::array<dvec3, 3> c{polygon[t.x], polygon[t.y], polygon[t.z]};
    const auto size = static_cast<float>(0.5 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0])));
    out.triangles.push_back({vec3(c[0]), vec3(c[1]), vec3(c[2])});
    out.area_up_to.push_back(out.area += size);
    add_points(c, cuts, out);
  }
  return out;
}

RayCaster build_caster(const PatchModel& model) {
  std::vector<vec3> positions;
  std::vector<UVec3> triangles;
  for (const auto* polygons : {&model.patches, &model.occluders})
    for (const Polygon& polygon : *polygons) {
      const auto offset = static_cast<uint32_t>(positions.size());
      for (const dvec3& p : polygon) positions.emplace_back(p);
      for (const UVec3& t : triangulate(polygon)) triangles.push_back(t + offset);
    }
  return {positions, triangles};
}

std::vector<uint32_t> patches_of_triangles(const PatchModel& model) {
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < model.patches.size(); ++i) out.insert(out.end(), model.patches[i].size() - 2, i);
  for (const Polygon& polygon : model.occluders) out.insert(out.end(), polygon.size() - 2, kOccluder);
  return out;
}

DirectionGrid grid_of(const MatrixOptions& options) {
  switch (options.method) {
    case MatrixMethod::kCubicTetrahedron:
      return DirectionGrid::cubic_tetrahedron(options.resolution);
    case MatrixMethod::kSinglePlane:
      return DirectionGrid::single_plane(options.resolution, options.plane_half_width);
    default:
      return DirectionGrid::hemicube(options.resolution);
  }
}

bool scans_rows(MatrixMethod method) {
  return method == MatrixMethod::kHemicube || method == MatrixMethod::kCubicTetrahedron ||
         method == MatrixMethod::kSinglePlane;
}

bool none_above(const TracedPatch& patch, const TracedPatch& plane, float tolerance) {
  return std::none_of(patch.corners.begin(), patch.corners.end(),
                      [&](const vec3& p) { return dot(plane.normal, p - plane.centre) > tolerance; });
}

class PairTracer {
 public:
  PairTracer(const PatchModel& model, const MatrixOptions& options)
      : model_(model), options_(options), caster_(build_caster(model)) {
    // Few patches are mostly large ones.
    const int cuts = model.patches.size() <= kMostExact ? 1 : 0;
    for (const Polygon& polygon : model.patches) patches_.push_back(traced(polygon, cuts));
    patch_of_triangle_ = patches_of_triangles(model);
    find_twins();
  }

  // What i and j exchange: the unobstructed exchange times the share that rays see of it.
  std::optional<Pair> exchange(uint32_t i, uint32_t j, uint64_t& rays) const {
    const bool turn = patches_[j].points.size() > patches_[i].points.size();
    const TracedPatch &from = patches_[turn ? j : i], &to = patches_[turn ? i : j];
    const float tolerance = 1e-6f * (from.radius + to.radius);
    if (none_above(from, to, tolerance) || none_above(to, from, tolerance)) return std::nullopt;
    double open = 0;
    for (size_t k = 0; k < from.points.size(); ++k)
      open += static_cast<double>(
          from.weights[k] * dot(from.normal, polygon_form_factor(from.points[k], from.normal, to.corners)));
    const bool near = length(from.centre - to.centre) < kNearPair * (from.radius + to.radius);
    if (open <= 0 && !near) return std::nullopt;
    const auto [share, deviation] = seen(from, to, hash(hash(i, j), options_.seed), rays);
    double rule_error = kFarError * open;
    if (near && share > 0) {
      const Estimate exact = polygon_exchange(model_.patches[i], model_.patches[j]);
      open = exact.value;
      rule_error = exact.error;
    }
    if (open * share <= 0) return std::nullopt;
    return Pair{j, FormFactorMethod::kRays, static_cast<float>(open * 2 * deviation + rule_error),
                open * share};
  }

  // The whole row of i at once, both ways' pairs; what each point sees, averaged.
  Row scan_row(uint32_t i, const DirectionGrid& grid, float& environment, float& back, uint64_t& rays) const {
    const TracedPatch& patch = patches_[i];
    std::map<uint32_t, std::pair<double, double>> shares;  // patch: front, and its error
    double missed = 0, behind = 0;
    for (size_t k = 0; k < patch.points.size(); ++k) {
      ScanOptions scan;
      scan.samples_across = options_.samples_across;
      scan.seed = hash(hash(i, static_cast<uint32_t>(k)), options_.seed);
      scan.turn = 2 * kPi * unit_float(hash(scan.seed, 1));
      const HemisphereScan seen = scan_hemisphere(caster_, grid, patch.points[k], patch.normal, scan);
      const auto weight = static_cast<double>(patch.weights[k] / patch.area);
      rays += seen.rays;
      missed += weight * (seen.environment + seen.missing);
      for (const SeenShare& share : seen.seen) {
        const uint32_t j = patch_of_triangle_[share.triangle];
        const auto add = [&](uint32_t to, double form_factor) {
          if (form_factor <= 0) return;
          auto& [front, error] = shares[to];
          front += weight * form_factor;
          error += weight * share.error;
        };
        if (has_twin(share.triangle)) {
          add(j, share.front);
          add(twins_[j], share.back);
        } else if (j == kOccluder) {
          behind += weight * (share.back + share.front);
        } else {
          add(j, share.front);
          behind += weight * share.back;
        }
      }
    }
    environment = static_cast<float>(missed);
    back = static_cast<float>(behind);
    Row row;
    for (const auto& [j, share] : shares)
      row.push_back({j, FormFactorMethod::kHemicube, static_cast<float>(share.second * double(patch.area)),
                     share.first * static_cast<double>(patch.area)});
    return row;
  }

  // Shares of i's cosine-distributed rays that meet nothing and that meet a back.
  void look_around(uint32_t i, float& environment, float& back) const {
    const TracedPatch& patch = patches_[i];
    const mat3 frame = frame_about(patch.normal);
    uint32_t missed = 0, behind = 0;
    for (uint32_t k = 0; k < options_.environment_rays; ++k) {
      const auto [place, direction] = r4_point(k, hash(i, options_.seed));
      const float r = std::sqrt(direction.u), turn = 2 * kPi * direction.v;
      Ray ray;
      ray.direction =
          frame * vec3(r * std::cos(turn), r * std::sin(turn), std::sqrt(std::max(0.0f, 1 - direction.u)));
      ray.origin = patch.sample(place.u, place.v) + caster_.epsilon() * patch.normal;
      const Hit hit = caster_.closest(ray);
      if (hit.missed()) {
        ++missed;
      } else if (patch_of_triangle_[hit.triangle] == kOccluder) {
        ++behind;  // what only blocks has no front
      } else if (dot(hit.normal, ray.direction) > 0 && !has_twin(hit.triangle)) {
        ++behind;  // of two opposite faces in one place the ray meets either
      }
    }
    const auto count = static_cast<float>(std::max(1u, options_.environment_rays));
    environment = static_cast<float>(missed) / count;
    back = static_cast<float>(behind) / count;
  }

 private:
  static constexpr float kNearPair = 2.5f;   // in radii: nearer ones are integrated exactly
  static constexpr double kFarError = 2e-3;  // of the 3-point rule beyond that

  // The share of the exchange that is seen, and its standard deviation.
  std::pair<double, double> seen(const TracedPatch& from, const TracedPatch& to, uint32_t seed,
                                 uint64_t& rays) const {
    const size_t count = std::min<size_t>(options_.rays, kMostRays);
    std::array<Ray, kMostRays> cast;
    std::array<float, kMostRays> weight, passing;
    for (size_t k = 0; k < count; ++k) {
      const auto [a, b] = r4_point(static_cast<uint32_t>(k), seed);
      const vec3 x = from.sample(a.u, a.v) + caster_.epsilon() * from.normal,
                 y = to.sample(b.u, b.v) + caster_.epsilon() * to.normal;
      const vec3 d = y - x;
      const float squared = dot(d, d);
      // As in the integral of F: cos cos / r².
      weight[k] = squared > 0 ? std::max(0.0f, dot(from.normal, d)) * std::max(0.0f, -dot(to.normal, d)) /
                                    (squared * squared)
                              : 0.0f;
      cast[k].origin = x;
      cast[k].direction = d;
      cast[k].far = 1;
    }
    for (size_t k = 0; k < count; k += 16) {
      const size_t some = std::min<size_t>(16, count - k);
      caster_.packet_transmittance({&cast[k], some}, {&passing[k], some});
    }
    rays += count;
    double all = 0, free = 0, squares = 0;
    for (size_t k = 0; k < count; ++k) {
      const auto w = static_cast<double>(weight[k]);
      all += w;
      squares += w * w;
      free += w * static_cast<double>(passing[k]);
    }
    if (all <= 0) return {0, 0};
    const double share = free / all;
    // Of so many rays as the weights are worth. What all agree on may still be wrong once in so often.
    const double worth = all * all / squares;
    const double agreed = (share * worth + 0.5) / (worth + 1);
    return {share, std::sqrt(agreed * (1 - agreed) / (worth + 1))};
  }

  // Plates are modelled as two opposite patches in one place.
  void find_twins() {
    twins_.assign(patches_.size(), kOccluder);
    const auto rounded = [&](const vec3& p) {
      return std::array<int64_t, 3>{std::llround(p.x / (4 * caster_.epsilon())),
                                    std::llround(p.y / (4 * caster_.epsilon())),
                                    std::llround(p.z / (4 * caster_.epsilon()))};
    };
    std::map<std::array<int64_t, 3>, std::vector<uint32_t>> at;
    for (uint32_t i = 0; i < patches_.size(); ++i) {
      std::vector<uint32_t>& here = at[rounded(patches_[i].centre)];
      for (const uint32_t j : here)
        if (dot(patches_[i].normal, patches_[j].normal) < -0.999f &&
            std::abs(patches_[i].area - patches_[j].area) < 1e-4f * patches_[i].area) {
          twins_[i] = j;
          twins_[j] = i;
        }
      here.push_back(i);
    }
  }

  bool has_twin(uint32_t triangle) const {
    const uint32_t patch = patch_of_triangle_[triangle];
    return patch != kOccluder && twins_[patch] != kOccluder;
  }

  const PatchModel& model_;
  const MatrixOptions& options_;
  RayCaster caster_;
  std::vector<TracedPatch> patches_;
  std::vector<uint32_t> patch_of_triangle_, twins_;  // kOccluder: of none
};

// Builds rows in parallel and puts them together in order.
class MatrixBuilder {
 public:
  MatrixBuilder(const PatchModel& model, const MatrixOptions& options, const CancelToken& cancel,
                const std::function<void(double)>& progress)
      : model_(model), options_(options), cancel_(cancel), progress_(progress), tracer_(model, options) {
    if (scans_rows(options.method)) grid_.emplace(grid_of(options));
    exact_ = options.method == MatrixMethod::kExact ||
             (options.method == MatrixMethod::kAuto &&
              model.patches.size() + model.occluders.size() <= kMostExact);
    if (!exact_) return;
    std::vector<Polygon> all = model.patches;
    all.insert(all.end(), model.occluders.begin(), model.occluders.end());
    std::vector<uint32_t> owners(all.size());
    std::iota(owners.begin(), owners.end(), 0u);
    blockers_.emplace(all, owners);
  }

  Result<FormFactorMatrix> build() {
    const size_t n = model_.patches.size();
    FormFactorMatrix matrix;
    for (const Polygon& polygon : model_.patches) matrix.areas.push_back(area(polygon));
    matrix.environment.resize(n);
    matrix.back.resize(n);
    std::vector<Row> rows(n);
    parallel_for(n, [&](size_t i) {
      if (stopped()) return;
      const auto number = static_cast<uint32_t>(i);
      if (grid_) {
        uint64_t rays = 0;
        rows[i] = tracer_.scan_row(number, *grid_, matrix.environment[i], matrix.back[i], rays);
        rays_ += rays;
      } else {
        rows[i] = row(number);
        tracer_.look_around(number, matrix.environment[i], matrix.back[i]);
      }
      done(rows[i], i);
    });
    if (cancel_.cancelled()) return Error{ErrorCode::kCancelled, "stopped", {}, {}, {}};
    if (full_)
      return Error{ErrorCode::kLimit,
                   fmt::format("the form factors of {} patches need more memory than allowed", n),
                   {},
                   {},
                   "raise --max-memory, or give fewer patches"};
    matrix.rays = rays_;
    if (grid_) {
      join_directions(rows, matrix);
    } else {
      matrix.share_error = 1 / std::sqrt(static_cast<float>(std::max(1u, options_.environment_rays)));
      matrix.rays += n * options_.environment_rays;
    }
    put_together(rows, matrix);
    return matrix;
  }

 private:
  bool stopped() const { return cancel_.cancelled() || full_; }

  Row row(uint32_t i) {
    Row out;
    uint64_t rays = 0;
    for (uint32_t j = i + 1; j < model_.patches.size() && !stopped(); ++j) {
      if (const std::optional<Pair> pair = exact_ ? exact_pair(i, j) : tracer_.exchange(i, j, rays))
        out.push_back(*pair);
    }
    out.shrink_to_fit();
    rays_ += rays;
    return out;
  }

  std::optional<Pair> exact_pair(uint32_t i, uint32_t j) const {
    const Polygon &a = model_.patches[i], &b = model_.patches[j];
    CubatureLimits limits = options_.limits;
    limits.absolute *= std::min(area(a), area(b));
    const Exchange exchange = visible_exchange(a, b, blockers_->between(a, b, i, j), limits);
    if (exchange.area.value <= 0) return std::nullopt;
    return Pair{j, exchange.method, static_cast<float>(exchange.area.error), exchange.area.value};
  }

  void done(const Row& row, size_t i) {
    const uint64_t bytes = bytes_ += row.capacity() * sizeof(Pair);
    // While it is put together it is there twice.
    if (options_.max_memory > 0 && 2 * bytes > options_.max_memory) full_ = true;
    const double pairs = static_cast<double>(model_.patches.size() - i);
    const std::lock_guard guard(lock_);
    const auto n = static_cast<double>(model_.patches.size());
    done_ += pairs / (0.5 * n * (n + 1));
    if (progress_) progress_(std::min(1.0, done_));
  }

  // Rows that know both directions: what is left of the diagonal becomes the reverse of what is right of it.
  static void join_directions(std::vector<Row>& rows, FormFactorMatrix& matrix) {
    std::vector<Row> from_below(rows.size());  // row j: what higher ones send to it
    for (uint32_t i = 0; i < rows.size(); ++i) {
      for (const Pair& pair : rows[i])
        if (pair.column < i) from_below[pair.column].push_back({i, pair.method, pair.error, pair.exchange});
      std::erase_if(rows[i], [i](const Pair& pair) { return pair.column <= i; });  // nothing sees itself
    }
    for (uint32_t i = 0; i < rows.size(); ++i) {
      Row joined;
      auto right = rows[i].begin();
      const auto take_right = [&](uint32_t before) {
        for (; right != rows[i].end() && right->column < before; ++right) {
          joined.push_back(*right);
          matrix.reverse.push_back(0);
        }
      };
      for (const Pair& back : from_below[i]) {
        take_right(back.column);
        if (right != rows[i].end() && right->column == back.column) {
          joined.push_back(*right++);
          joined.back().error = std::max(joined.back().error, back.error);
        } else {
          joined.push_back({back.column, back.method, back.error, 0});
        }
        matrix.reverse.push_back(back.exchange);
      }
      take_right(kOccluder);
      rows[i] = std::move(joined);
    }
  }

  static void put_together(std::vector<Row>& rows, FormFactorMatrix& matrix) {
    matrix.first.assign(1, 0);
    uint64_t count = 0;
    for (const Row& row : rows) matrix.first.push_back(count += row.size());
    matrix.column.reserve(count);
    matrix.exchange.reserve(count);
    matrix.error.reserve(count);
    matrix.method.reserve(count);
    for (Row& row : rows) {
      for (const Pair& pair : row) {
        matrix.column.push_back(pair.column);
        matrix.exchange.push_back(pair.exchange);
        matrix.error.push_back(pair.error);
        matrix.method.push_back(pair.method);
      }
      row = Row();
    }
  }

  const PatchModel& model_;
  const MatrixOptions& options_;
  const CancelToken& cancel_;
  const std::function<void(double)>& progress_;
  PairTracer tracer_;
  bool exact_ = false;
  std::optional<Blockers> blockers_;
  std::optional<DirectionGrid> grid_;
  std::atomic<uint64_t> bytes_{0}, rays_{0};
  std::atomic<bool> full_{false};
  std::mutex lock_;
  double done_ = 0;
};

}  // namespace

uint64_t FormFactorMatrix::memory_bytes() const {
  return areas.capacity() * sizeof(double) + first.capacity() * sizeof(uint64_t) +
         column.capacity() * (sizeof(uint32_t) + sizeof(double) + sizeof(float) + sizeof(FormFactorMethod)) +
         (environment.capacity() + back.capacity()) * sizeof(float) + reverse.capacity() * sizeof(double);
}

double FormFactorMatrix::reciprocity_error() const {
  double most = 0;
  for (size_t i = 0; i < size(); ++i)
    for (uint64_t k = first[i]; k < first[i + 1]; ++k)
      most =
          std::max(most, std::abs(exchange[k] - reverse_exchange(k)) / std::min(areas[i], areas[column[k]]));
  return most;
}

std::vector<double> FormFactorMatrix::row_sums() const {
  std::vector<double> sums(size());
  for (size_t i = 0; i < size(); ++i)
    for (uint64_t k = first[i]; k < first[i + 1]; ++k) {
      sums[i] += exchange[k] / areas[i];
      if (column[k] != i) sums[column[k]] += reverse_exchange(k) / areas[column[k]];
    }
  return sums;
}

std::vector<double> FormFactorMatrix::row_error_bounds() const {
  // Bounds add up; standard errors, which are independent, add up in quadrature.
  std::vector<double> bounds(size()), squares(size());
  const auto add = [&](size_t i, uint64_t k) {
    const double e = static_cast<double>(error[k]) / areas[i];
    if (method[k] == FormFactorMethod::kRays) {
      squares[i] += e * e;
    } else {
      bounds[i] += e;
    }
  };
  for (size_t i = 0; i < size(); ++i)
    for (uint64_t k = first[i]; k < first[i + 1]; ++k) {
      add(i, k);
      if (column[k] != i) add(column[k], k);
    }
  for (size_t i = 0; i < size(); ++i) bounds[i] += std::sqrt(squares[i]);
  return bounds;
}

Result<FormFactorMatrix> build_form_factor_matrix(const PatchModel& model, const MatrixOptions& options,
                                                  const CancelToken& cancel,
                                                  const std::function<void(double)>& progress) {
  return MatrixBuilder(model, options, cancel, progress).build();
}

double enforce_reciprocity(FormFactorMatrix& matrix) {
  const double was = matrix.reciprocity_error();
  for (size_t k = 0; k < matrix.reverse.size(); ++k)
    matrix.exchange[k] = 0.5 * (matrix.exchange[k] + matrix.reverse[k]);
  matrix.reverse.clear();
  return was;
}

Result<double> enforce_closure(FormFactorMatrix& matrix) {
  constexpr int kMostRounds = 10000;
  constexpr double kClosed = 1e-12, kCloseEnough = 1e-9;
  const size_t n = matrix.size();
  const bool symmetric = matrix.reverse.empty();
  std::vector<double> wanted(n), scale(n, 1.0), sums;
  for (size_t i = 0; i < n; ++i)
    wanted[i] = matrix.areas[i] * (1 - static_cast<double>(matrix.environment[i] + matrix.back[i]));
  const std::vector<double> open = matrix.row_sums();
  for (size_t i = 0; i < n; ++i)
    if (wanted[i] > 1e-9 * matrix.areas[i] && open[i] <= 0)
      return Error{ErrorCode::kBadInput,
                   "its row is empty and cannot be closed",
                   {},
                   fmt::format("surface {}", i + 1),
                   "leave out --enforce-closure"};
  // One side of an entry alone, or both: then the root, since the other side is scaled as well.
  const auto by = [&](size_t i, size_t j) { return symmetric ? scale[i] * scale[j] : scale[i]; };
  double off = 1;
  for (int round = 0; round < kMostRounds && off > kClosed; ++round) {
    sums.assign(n, 0.0);
    for (size_t i = 0; i < n; ++i)
      for (uint64_t k = matrix.first[i]; k < matrix.first[i + 1]; ++k) {
        const uint32_t j = matrix.column[k];
        sums[i] += matrix.exchange[k] * by(i, j);
        if (j != i) sums[j] += matrix.reverse_exchange(k) * by(j, i);
      }
    off = 0;
    for (size_t i = 0; i < n; ++i) {
      if (wanted[i] <= 1e-9 * matrix.areas[i]) continue;
      off = std::max(off, std::abs(sums[i] - wanted[i]) / matrix.areas[i]);
      scale[i] *= symmetric ? std::sqrt(wanted[i] / sums[i]) : wanted[i] / sums[i];
    }
  }
  if (off > kCloseEnough)
    return Error{ErrorCode::kLimit,
                 fmt::format("rows stay {:.1e} off one after {} rounds of scaling", off, kMostRounds),
                 {},
                 {},
                 "leave out --enforce-closure, or cast more rays"};
  double change = 0;
  for (size_t i = 0; i < n; ++i)
    for (uint64_t k = matrix.first[i]; k < matrix.first[i + 1]; ++k) {
      const uint32_t j = matrix.column[k];
      matrix.exchange[k] *= by(i, j);
      if (!symmetric) matrix.reverse[k] *= by(j, i);
      change = std::max({change, std::abs(by(i, j) - 1), std::abs(by(j, i) - 1)});
    }
  return change;
}

}  // namespace goldthread
