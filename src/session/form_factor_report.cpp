#include "session/form_factor_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "files/atomic_file.h"
#include "files/npz_write.h"

namespace goldthread {
namespace {

struct Entry {
  uint32_t column;
  double value, error;
  FormFactorMethod method;
};

// F row by row, both directions, ascending.
std::vector<std::vector<Entry>> rows_of(const FormFactorMatrix& matrix) {
  std::vector<std::vector<Entry>> rows(matrix.size());
  const auto add = [&](uint32_t from, uint32_t to, uint64_t k, double exchange) {
    if (exchange <= 0) return;
    rows[from].push_back({to, std::min(1.0, exchange / matrix.areas[from]),
                          static_cast<double>(matrix.error[k]) / matrix.areas[from], matrix.method[k]});
  };
  for (uint32_t i = 0; i < matrix.size(); ++i)
    for (uint64_t k = matrix.first[i]; k < matrix.first[i + 1]; ++k) {
      add(i, matrix.column[k], k, matrix.exchange[k]);
      if (matrix.column[k] != i) add(matrix.column[k], i, k, matrix.reverse_exchange(k));
    }
  for (auto& row : rows)
    std::sort(row.begin(), row.end(), [](const Entry& a, const Entry& b) { return a.column < b.column; });
  return rows;
}

// Collects text and hands it on in pieces of a size that a disk likes.
class Writer {
 public:
  explicit Writer(AtomicFile& file) : file_(file) {}

  void add(const std::string& text) {
    buffer_ += text;
    if (buffer_.size() > (1u << 20)) flush();
  }
  Status end() {
    flush();
    return status_;
  }

 private:
  void flush() {
    if (status_) status_ = file_.write(buffer_);
    buffer_.clear();
  }

  AtomicFile& file_;
  std::string buffer_;
  Status status_ = Nothing{};
};

Status write_pieces(const std::string& name, const std::function<void(Writer&)>& fill) {
  Result<AtomicFile> file = AtomicFile::create(name);
  if (!file) return file.error();
  Writer writer(*file);
  fill(writer);
  if (const Status status = writer.end(); !status) return status;
  return file->commit();
}

std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string json_pair(const std::string& id, const std::string& from, const std::string& to, double value,
                      FormFactorMethod method, double error) {
  return fmt::format(R"({{"id":{},"from":{},"to":{},"value":{:.17g},"method":"{}","error_bound":{:.3g}}})",
                     quoted(id), quoted(from), quoted(to), value, method_name(method), error);
}

// With the standard error of what rays have found.
std::string json_pair(const PairAnswer& pair) {
  const FormFactor& f = pair.factor;
  std::string text = json_pair(pair.id, pair.from, pair.to, f.value, f.method, f.error_bound);
  if (f.method != FormFactorMethod::kRays) return text;
  text.pop_back();
  return text + fmt::format(",\"standard_error\":{:.3g}}}", f.standard_error);
}

nlohmann::json summary(const ModelAnswer& model) {
  const ClosureCheck check = check_closure(model.matrix);
  nlohmann::json j;
  j["id"] = model.id;
  j["surfaces"] = model.names;
  j["areas_m2"] = model.matrix.areas;
  j["row_sums"] = model.matrix.row_sums();
  j["row_error_bounds"] = model.matrix.row_error_bounds();
  j["environment"] = model.matrix.environment;
  j["back"] = model.matrix.back;
  j["closure"] = {
      {"worst_surface", model.names[check.row]}, {"off", check.off}, {"tolerance", check.allowed}};
  j["reciprocity_error"] = model.matrix.reciprocity_error();
  j["entries"] = model.matrix.exchange.size();
  j["rays"] = model.matrix.rays;
  j["seconds"] = model.seconds;
  if (model.closed) j["closure_enforced_by"] = model.closing_change;
  return j;
}

std::string describe_model(const ModelAnswer& model, size_t most) {
  const FormFactorMatrix& matrix = model.matrix;
  std::string text = fmt::format("{}: {} surfaces, {} pairs exchange, {:.2f} s\n", model.id, matrix.size(),
                                 matrix.exchange.size(), model.seconds);
  const std::vector<double> sums = matrix.row_sums();
  if (matrix.size() <= most) {
    const auto rows = rows_of(matrix);
    for (size_t i = 0; i < rows.size(); ++i) {
      text += fmt::format("  {} ({:.6g} m²)\n", model.names[i], matrix.areas[i]);
      for (const Entry& e : rows[i])
        text += fmt::format("    {:<20} {:.9f} ± {:.1e} {}\n", model.names[e.column], e.value, e.error,
                            method_name(e.method));
      text += fmt::format("    {:<20} {:.9f}, environment {:.4f}, backs {:.4f}\n", "sum", sums[i],
                          matrix.environment[i], matrix.back[i]);
    }
  }
  const ClosureCheck check = check_closure(matrix);
  text +=
      fmt::format("  rows and their surroundings sum to one within {:.2e} (tolerance {:.2e}, surface {})\n",
                  check.off, check.allowed, model.names[check.row]);
  if (model.closed) text += fmt::format("  closed by changes of up to {:.2e}\n", model.closing_change);
  return text;
}

}  // namespace

ClosureCheck check_closure(const FormFactorMatrix& matrix) {
  const std::vector<double> sums = matrix.row_sums(), bounds = matrix.row_error_bounds();
  ClosureCheck worst;
  double most = -1;
  for (size_t i = 0; i < matrix.size(); ++i) {
    const auto around = static_cast<double>(matrix.environment[i] + matrix.back[i]);
    const double off = std::abs(sums[i] + around - 1);
    // Shares of N rays: all of them in agreement, and their error is that of the rows alone.
    const double share =
        static_cast<double>(matrix.share_error) * 2 *
        std::sqrt(std::max(0.0, around * (1 - around)) + static_cast<double>(matrix.share_error));
    const double allowed = bounds[i] + share + 1e-12;  // and rounding
    if (off / allowed > most) worst = {i, off, allowed};
    most = std::max(most, off / allowed);
  }
  return worst;
}

std::string describe(const std::vector<PairAnswer>& pairs, const std::vector<ModelAnswer>& models,
                     size_t most) {
  std::string text;
  for (const PairAnswer& pair : pairs) {
    text += fmt::format("{:<28} {:.15f} ± {:.1e} {}", pair.id, pair.factor.value, pair.factor.error_bound,
                        method_name(pair.factor.method));
    if (pair.factor.method == FormFactorMethod::kRays)
      text += fmt::format(", standard error {:.1e}", pair.factor.standard_error);
    text += '\n';
  }
  for (const ModelAnswer& model : models) text += describe_model(model, most);
  return text;
}

Status write_form_factor_text(const std::string& file, const std::vector<PairAnswer>& pairs,
                              const std::vector<ModelAnswer>& models) {
  return write_pieces(file, [&](Writer& out) {
    for (const PairAnswer& pair : pairs)
      out.add(fmt::format("{} {} {} {:.17g} {:.3g} {}\n", pair.id, pair.from, pair.to, pair.factor.value,
                          pair.factor.error_bound, method_name(pair.factor.method)));
    for (const ModelAnswer& model : models) {
      const auto rows = rows_of(model.matrix);
      for (size_t i = 0; i < rows.size(); ++i)
        for (const Entry& e : rows[i])
          out.add(fmt::format("{} {} {} {:.17g} {:.3g} {}\n", model.id, model.names[i], model.names[e.column],
                              e.value, e.error, method_name(e.method)));
    }
  });
}

Status write_form_factor_json(const std::string& file, const std::vector<PairAnswer>& pairs,
                              const std::vector<ModelAnswer>& models) {
  return write_pieces(file, [&](Writer& out) {
    const char* between = "";
    const auto pair = [&](const std::string& text) {
      out.add(between + text);
      between = ",\n";
    };
    out.add("{\"pairs\":[\n");
    for (const PairAnswer& p : pairs) pair(json_pair(p));
    nlohmann::json sums = nlohmann::json::array(), cases = nlohmann::json::array();
    for (const ModelAnswer& model : models) {
      const auto rows = rows_of(model.matrix);
      for (size_t i = 0; i < rows.size(); ++i)
        for (const Entry& e : rows[i])
          pair(json_pair(model.id, model.names[i], model.names[e.column], e.value, e.method, e.error));
      for (const double sum : model.matrix.row_sums()) sums.push_back(sum);
      cases.push_back(summary(model));
    }
    const auto plain = [](const nlohmann::json& j) {
      return j.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    };
    out.add("\n],\n\"row_sums\":" + plain(sums) + ",\n\"cases\":" + plain(cases) + "}\n");
  });
}

Status write_form_factor_npz(const std::string& file, const ModelAnswer& model) {
  std::vector<int64_t> starts{0}, columns;
  std::vector<double> values;
  for (const auto& row : rows_of(model.matrix)) {
    for (const Entry& e : row) {
      columns.push_back(e.column);
      values.push_back(e.value);
    }
    starts.push_back(static_cast<int64_t>(columns.size()));
  }
  const auto n = static_cast<int64_t>(model.matrix.size());
  const std::array<int64_t, 2> shape{n, n};
  const std::vector<NpzArray> arrays{{"indices", std::span<const int64_t>(columns)},
                                     {"indptr", std::span<const int64_t>(starts)},
                                     {"format", std::string("csr")},
                                     {"shape", std::span<const int64_t>(shape)},
                                     {"data", std::span<const double>(values)},
                                     {"areas", std::span<const double>(model.matrix.areas)},
                                     {"environment", std::span<const float>(model.matrix.environment)}};
  return write_npz(file, arrays);
}

}  // namespace goldthread
