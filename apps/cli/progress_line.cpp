#include "progress_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace goldthread::cli {
namespace {

constexpr double kRedrawSeconds = 0.1;  // often enough to look alive, seldom enough to cost nothing
constexpr double kPlainSeconds = 5;

std::string rate_text(double rays_per_second) {
  if (rays_per_second >= 1e6) return fmt::format("{:.1f} Mrays/s", rays_per_second / 1e6);
  return fmt::format("{:.0f} krays/s", rays_per_second / 1e3);
}

std::string time_text(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < 100) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

std::string bar(double share) {
  constexpr int kWidth = 24;
  const int filled = static_cast<int>(std::clamp(share, 0.0, 1.0) * kWidth);
  return "[" + std::string(size_t(filled), '#') + std::string(size_t(kWidth - filled), '.') + "]";
}

size_t terminal_columns(std::FILE* out) {
  winsize size = {};
  if (ioctl(fileno(out), TIOCGWINSZ, &size) != 0 || size.ws_col < 2) return 79;
  return size.ws_col - 1u;  // the last column would wrap on some terminals
}

ProgressLine::Style style_of_stderr(bool quiet) {
  if (quiet) return ProgressLine::Style::kNone;
  return isatty(STDERR_FILENO) ? ProgressLine::Style::kTerminal : ProgressLine::Style::kPlain;
}

}  // namespace

std::string describe(const BakeEvent& event) {
  std::string text = fmt::format("{:<11} {:3.0f}%", event.stage, 100 * std::clamp(event.share, 0.0, 1.0));
  if (event.rays_per_second > 0) text += "  " + rate_text(event.rays_per_second);
  if (event.error_estimate > 0) text += fmt::format("  error {:.2g}%", 100 * event.error_estimate);
  if (event.remaining_seconds >= 0)
    text += "  " + time_text(event.remaining_seconds) + " left";
  else if (event.seconds >= 1)
    text += "  " + time_text(std::floor(event.seconds));
  return text;
}

ProgressLine::ProgressLine(bool quiet) : ProgressLine(stderr, style_of_stderr(quiet)) {}

void ProgressLine::show(const BakeEvent& event) {
  if (style_ == Style::kNone) return;
  const double pause = style_ == Style::kTerminal ? kRedrawSeconds : kPlainSeconds;
  if (event.stage == last_stage_ && event.seconds < last_shown_ + pause) return;
  last_stage_ = event.stage;
  last_shown_ = event.seconds;
  draw(event);
}

void ProgressLine::draw(const BakeEvent& event) {
  if (style_ == Style::kPlain) {
    fmt::print(out_, "{}\n", describe(event));
  } else {
    std::string text = bar(event.share) + " " + describe(event);
    text.resize(std::min(text.size(), terminal_columns(out_)));
    fmt::print(out_, "\r{}\033[K", text);  // the escape clears what an older, longer line left
    drawn_ = true;
  }
  std::fflush(out_);
}

void ProgressLine::clear() {
  if (!drawn_) return;
  fmt::print(out_, "\r\033[K");
  std::fflush(out_);
  drawn_ = false;
}

}  // namespace goldthread::cli
