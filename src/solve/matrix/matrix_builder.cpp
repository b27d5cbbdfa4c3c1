#include "solve/matrix/matrix_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "solve/matrix/patch_tracer.h"

namespace goldthread {
namespace {

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
    std::vector<MatrixRow> rows(n);
    parallel_for(n, [&](size_t i) {
      if (stopped()) return;
      const auto number = static_cast<uint32_t>(i);
      Surroundings surroundings;
      if (grid_) {
        ScannedRow scanned = tracer_.scan_row(number, *grid_);
        rows[i] = std::move(scanned.row);
        surroundings = scanned.surroundings;
        rays_ += scanned.rays;
      } else {
        rows[i] = row(number);
        surroundings = tracer_.look_around(number);
      }
      matrix.environment[i] = surroundings.environment;
      matrix.back[i] = surroundings.back;
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

  MatrixRow row(uint32_t i) {
    MatrixRow out;
    uint64_t rays = 0;
    for (uint32_t j = i + 1; j < model_.patches.size() && !stopped(); ++j) {
      if (const std::optional<MatrixEntry> pair = exact_ ? exact_pair(i, j) : tracer_.exchange(i, j, rays))
        out.push_back(*pair);
    }
    out.shrink_to_fit();
    rays_ += rays;
    return out;
  }

  std::optional<MatrixEntry> exact_pair(uint32_t i, uint32_t j) const {
    const Polygon &a = model_.patches[i], &b = model_.patches[j];
    CubatureLimits limits = options_.limits;
    limits.absolute *= std::min(area(a), area(b));
    const Exchange exchange = visible_exchange(a, b, blockers_->between(a, b, i, j), limits);
    if (exchange.area.value <= 0) return std::nullopt;
    return MatrixEntry{j, exchange.method, static_cast<float>(exchange.area.error), exchange.area.value};
  }

  void done(const MatrixRow& row, size_t i) {
    const uint64_t bytes = bytes_ += row.capacity() * sizeof(MatrixEntry);
    // While it is put together it is there twice.
    if (options_.max_memory > 0 && 2 * bytes > options_.max_memory) full_ = true;
    const double pairs = static_cast<double>(model_.patches.size() - i);
    const std::lock_guard guard(lock_);
    const auto n = static_cast<double>(model_.patches.size());
    done_ += pairs / (0.5 * n * (n + 1));
    if (progress_) progress_(std::min(1.0, done_));
  }

  // Rows that know both directions: what is left of the diagonal becomes the reverse of what is right of it.
  static void join_directions(std::vector<MatrixRow>& rows, FormFactorMatrix& matrix) {
    std::vector<MatrixRow> from_below(rows.size());  // row j: what higher ones send to it
    for (uint32_t i = 0; i < rows.size(); ++i) {
      for (const MatrixEntry& pair : rows[i])
        if (pair.column < i) from_below[pair.column].push_back({i, pair.method, pair.error, pair.exchange});
      std::erase_if(rows[i],
                    [i](const MatrixEntry& pair) { return pair.column <= i; });  // nothing sees itself
    }
    for (uint32_t i = 0; i < rows.size(); ++i) {
      MatrixRow joined;
      auto right = rows[i].begin();
      const auto take_right = [&](uint32_t before) {
        for (; right != rows[i].end() && right->column < before; ++right) {
          joined.push_back(*right);
          matrix.reverse.push_back(0);
        }
      };
      for (const MatrixEntry& back : from_below[i]) {
        take_right(back.column);
        if (right != rows[i].end() && right->column == back.column) {
          joined.push_back(*right++);
          joined.back().error = std::max(joined.back().error, back.error);
        } else {
          joined.push_back({back.column, back.method, back.error, 0});
        }
        matrix.reverse.push_back(back.exchange);
      }
      take_right(std::numeric_limits<uint32_t>::max());
      rows[i] = std::move(joined);
    }
  }

  static void put_together(std::vector<MatrixRow>& rows, FormFactorMatrix& matrix) {
    matrix.first.assign(1, 0);
    uint64_t count = 0;
    for (const MatrixRow& row : rows) matrix.first.push_back(count += row.size());
    matrix.column.reserve(count);
    matrix.exchange.reserve(count);
    matrix.error.reserve(count);
    matrix.method.reserve(count);
    for (MatrixRow& row : rows) {
      for (const MatrixEntry& pair : row) {
        matrix.column.push_back(pair.column);
        matrix.exchange.push_back(pair.exchange);
        matrix.error.push_back(pair.error);
        matrix.method.push_back(pair.method);
      }
      row = MatrixRow();
    }
  }

  const PatchModel& model_;
  const MatrixOptions& options_;
  const CancelToken& cancel_;
  const std::function<void(double)>& progress_;
  PatchTracer tracer_;
  bool exact_ = false;
  std::optional<Blockers> blockers_;
  std::optional<DirectionGrid> grid_;
  std::atomic<uint64_t> bytes_{0}, rays_{0};
  std::atomic<bool> full_{false};
  std::mutex lock_;
  double done_ = 0;
};

}  // namespace

Result<FormFactorMatrix> build_form_factor_matrix(const PatchModel& model, const MatrixOptions& options,
                                                  const CancelToken& cancel,
                                                  const std::function<void(double)>& progress) {
  return MatrixBuilder(model, options, cancel, progress).build();
}

}  // namespace goldthread
