#include "goldthread/form_factors.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <atomic>

#include "files/form_factor_read.h"
#include "session/form_factor_report.h"
#include "session/watched.h"
#include "solve/matrix/fold_surfaces.h"
#include "solve/matrix/matrix_builder.h"
#include "solve/matrix/shape_form_factor.h"

namespace goldthread {
namespace {

// Matrices with more rows are not printed.
constexpr size_t kPrintedRows = 40;

struct ShapeName {
  std::string operator()(const PointShape&) const { return "point"; }
  std::string operator()(const Polygon&) const { return "polygon"; }
  std::string operator()(const DiscShape&) const { return "disk"; }
  std::string operator()(const SphereShape&) const { return "sphere"; }
  std::string operator()(const CylinderShape&) const { return "cylinder"; }
  std::string operator()(const CapShape&) const { return "cap"; }
};

class FormFactors {
 public:
  FormFactors(const FormFactorOptions& options, const BakeListener& listener)
      : options_(options), listener_(listener) {}

  Result<FormFactorResult> run() {
    const int threads = options_.threads > 0 ? options_.threads : tbb::info::default_concurrency();
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      static_cast<size_t>(threads));
    Result<FormFactorInput> input = read_form_factor_cases(options_.input);
    if (!input) return input.error();
    if (Status status = choose(*input); !status) return status.error();
    if (Status status = answer_pairs(*input); !status) return status.error();
    for (const PolygonModel& model : input->models)
      if (Status status = answer_model(model); !status) return status.error();
    return write();
  }

 private:
  Error stopped() const { return {ErrorCode::kCancelled, "stopped", options_.input, {}, {}}; }
  bool stop_asked() const { return listener_.cancelled && listener_.cancelled(); }
  void tell(double share) const {
    BakeEvent event;
    event.stage = "form factors";
    event.share = share;
    event.seconds = since(start_);
    if (share > 0.02)
      event.remaining_seconds = event.seconds * (1 - share) / share;
    else
      event.remaining_seconds = -1;
    if (listener_.on_progress) listener_.on_progress(event);
  }

  Status choose(FormFactorInput& input) const {
    if (!options_.only.empty()) {
      std::erase_if(input.pairs, [&](const ShapePair& p) { return p.id != options_.only; });
      std::erase_if(input.models, [&](const PolygonModel& m) { return m.id != options_.only; });
      if (input.pairs.empty() && input.models.empty())
        return Error{ErrorCode::kUsage,
                     fmt::format("has no case \"{}\"", options_.only),
                     options_.input,
                     {},
                     "leave out --case for all"};
    }
    if (!options_.npz_file.empty() && (input.models.size() != 1 || !input.pairs.empty()))
      return Error{ErrorCode::kUsage,
                   "--npz holds one model, and here are other cases",
                   options_.input,
                   {},
                   "choose one with --case"};
    return Nothing{};
  }

  Status answer_pairs(const FormFactorInput& input) {
    CubatureLimits limits;
    ShapeRayLimits ray_limits;
    if (options_.tolerance) limits.relative = ray_limits.relative = *options_.tolerance;
    ray_limits.seed = static_cast<uint32_t>(options_.seed);
    for (const ShapePair& pair : input.pairs) {
      if (stop_asked()) return stopped();
      tell(static_cast<double>(pairs_.size()) / static_cast<double>(input.pairs.size()));
      Result<FormFactor> factor = shape_form_factor(pair.from, pair.to, pair.occluders, limits, ray_limits);
      // One that cannot be told keeps no other from being told.
      if (!factor) {
        unanswered_ = factor.error();
        unanswered_.file = options_.input;
        unanswered_.place = "case " + pair.id;
        result_.warnings.push_back(fmt::format("{} has no answer", unanswered_.line()));
        continue;
      }
      warn_of_rays(pair, *factor, ray_limits);
      pairs_.push_back(
          {pair.id, std::visit(ShapeName(), pair.from), std::visit(ShapeName(), pair.to), *factor});
    }
    return Nothing{};
  }

  void warn_of_rays(const ShapePair& pair, const FormFactor& factor, const ShapeRayLimits& limits) {
    if (factor.method != FormFactorMethod::kRays || factor.value == 0) return;
    if (factor.error_bound > 1.01 * limits.relative * factor.value)
      result_.warnings.push_back(fmt::format(
          "case {}: {} million rays leave an error of {:.1e} of the value, more than the tolerance {:.1e}",
          pair.id, limits.most_rays >> 20, factor.error_bound / factor.value, limits.relative));
  }

  MatrixOptions matrix_options() const {
    MatrixOptions out;
    switch (options_.method) {
      case FormFactorOptions::Method::kAuto:
        out.method = MatrixMethod::kAuto;
        break;
      case FormFactorOptions::Method::kExact:
        out.method = MatrixMethod::kExact;
        break;
      case FormFactorOptions::Method::kRays:
        out.method = MatrixMethod::kRays;
        break;
      case FormFactorOptions::Method::kHemicube:
        out.method = MatrixMethod::kHemicube;
        break;
      case FormFactorOptions::Method::kCubicTetrahedron:
        out.method = MatrixMethod::kCubicTetrahedron;
        break;
      case FormFactorOptions::Method::kSinglePlane:
        out.method = MatrixMethod::kSinglePlane;
        break;
    }
    if (options_.tolerance) out.limits.relative = *options_.tolerance;
    out.rays = options_.rays;
    out.resolution = options_.resolution;
    out.samples_across = options_.samples_across;
    out.seed = static_cast<uint32_t>(options_.seed);
    out.max_memory = options_.max_memory.value_or(0);
    return out;
  }

  // On a thread of its own, so that this one can tell how far it is and hear that it should stop.
  Result<FormFactorMatrix> build(const PatchModel& patches) {
    std::atomic<double> share{0};
    Result<FormFactorMatrix> matrix = stopped();
    run_watched(
        [&](const CancelToken& stop) {
          matrix = build_form_factor_matrix(patches, matrix_options(), stop, [&](double s) { share = s; });
        },
        [&] { return stop_asked(); }, [&] { tell(share); });
    return matrix;
  }

  // A ray of an item buffer meets one surface of those in a plane, whichever it happens to be.
  void warn_of_bases(const PolygonModel& model) {
    const MatrixMethod method = matrix_options().method;
    const bool by_rows = method == MatrixMethod::kHemicube || method == MatrixMethod::kCubicTetrahedron ||
                         method == MatrixMethod::kSinglePlane;
    const auto lies_in_another = [](uint32_t base) { return base != PolygonModel::kNone; };
    if (by_rows && (model.on_occluders || std::any_of(model.base.begin(), model.base.end(), lies_in_another)))
      result_.warnings.push_back(fmt::format(
          "{}: item buffers do not tell a surface from the base that it lies in, and what they say of "
          "these is wrong: use --method exact or rays",
          model.id.empty() ? options_.input : model.id));
  }

  Status answer_model(const PolygonModel& model) {
    const auto begin = Clock::now();
    warn_of_bases(model);
    Result<FormFactorMatrix> matrix = build({model.surfaces, model.occluders});
    if (!matrix) {
      Error error = matrix.error();
      error.file = options_.input;
      return error;
    }
    ModelAnswer answer;
    answer.id = model.id.empty() ? options_.input : model.id;
    answer.names = model.names;
    if (model.base.empty()) {
      answer.matrix = *std::move(matrix);
    } else {
      std::vector<uint32_t> kept;
      answer.matrix = fold_surfaces(*matrix, {model.base, model.combined, model.cover}, kept);
      answer.names.clear();
      for (const uint32_t surface : kept) answer.names.push_back(model.names[surface]);
    }
    if (options_.enforce_reciprocity) enforce_reciprocity(answer.matrix);
    if (options_.enforce_closure) {
      Result<double> change = enforce_closure(answer.matrix);
      if (!change) {
        Error error = change.error();
        error.file = options_.input;
        return error;
      }
      answer.closed = true;
      answer.closing_change = *change;
    }
    answer.seconds = since(begin);
    const ClosureCheck check = check_closure(answer.matrix);
    if (check.off > check.allowed)
      result_.warnings.push_back(
          fmt::format("{}: the row of {} is {:.2e} off one, more than its tolerance {:.2e}: do surfaces "
                      "overlap or cross?",
                      answer.id, answer.names[check.row], check.off, check.allowed));
    models_.push_back(std::move(answer));
    return Nothing{};
  }

  Result<FormFactorResult> write() {
    if (stop_asked()) return stopped();
    if (pairs_.empty() && models_.empty()) return unanswered_;
    result_.text = describe(pairs_, models_, kPrintedRows);
    const auto done = [&](const std::string& file, const Status& status) {
      if (status) result_.written.push_back(file);
      return status;
    };
    if (const std::string& file = options_.json_file; !file.empty())
      if (Status s = done(file, write_form_factor_json(file, pairs_, models_)); !s) return s.error();
    if (const std::string& file = options_.text_file; !file.empty())
      if (Status s = done(file, write_form_factor_text(file, pairs_, models_)); !s) return s.error();
    if (const std::string& file = options_.npz_file; !file.empty())
      if (Status s = done(file, write_form_factor_npz(file, models_[0])); !s) return s.error();
    return std::move(result_);
  }

  const FormFactorOptions& options_;
  const BakeListener& listener_;
  const Clock::time_point start_ = Clock::now();
  std::vector<PairAnswer> pairs_;
  std::vector<ModelAnswer> models_;
  Error unanswered_;
  FormFactorResult result_;
};

}  // namespace

Result<FormFactorResult> form_factors(const FormFactorOptions& options, const BakeListener& listener) {
  return FormFactors(options, listener).run();
}

}  // namespace goldthread
