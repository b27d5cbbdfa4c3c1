#include "values.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

namespace goldthread::cli {
namespace {

/// The number at the start of `text`, which is cut from it. std::from_chars, for it knows no locale.
std::optional<double> take_number(std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  text.erase(0, size_t(end - text.data()));
  return value;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// The power of 1024 that a unit stands for.
std::optional<int> unit_power(const std::string& unit) {
  constexpr const char* kLetters = "kmgt";
  if (unit.empty() || unit == "b") return 0;
  for (int i = 0; i < 4; ++i) {
    const std::string letter(1, kLetters[i]);
    if (unit == letter || unit == letter + "b" || unit == letter + "ib") return i + 1;
  }
  return std::nullopt;
}

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

}  // namespace

std::optional<uint64_t> parse_bytes(const std::string& text) {
  std::string rest = text;
  const auto number = take_number(rest);
  const auto power = unit_power(lower(rest));
  if (!number || !power) return std::nullopt;
  const double bytes = *number * std::pow(1024.0, *power);
  if (bytes < 1 || bytes > 9e18) return std::nullopt;
  return static_cast<uint64_t>(bytes);
}

std::optional<std::array<float, 3>> parse_sky(const std::string& text) {
  std::string rest = lower(text);
  double scale = 1;
  if (ends_with(rest, "lux")) {
    rest.resize(rest.size() - 3);
    scale = 1 / 3.14159265358979323846;
  }
  std::array<double, 3> channels{};
  size_t count = 0;
  while (true) {
    const auto number = take_number(rest);
    if (!number || *number < 0 || *number > 1e12 || count == 3) return std::nullopt;
    channels[count++] = *number * scale;
    if (rest.empty()) break;
    if (rest[0] != ',') return std::nullopt;
    rest.erase(0, 1);
  }
  if (count == 2) return std::nullopt;
  if (count == 1) channels[1] = channels[2] = channels[0];
  return std::array<float, 3>{float(channels[0]), float(channels[1]), float(channels[2])};
}

bool is_illuminance(const std::string& text) {
  return ends_with(lower(text), "lux");
}

std::optional<std::vector<double>> parse_numbers(const std::string& text, char separator) {
  std::string rest = text;
  std::vector<double> numbers;
  while (true) {
    const auto number = take_number(rest);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    if (rest.empty()) return numbers;
    if (rest[0] != separator) return std::nullopt;
    rest.erase(0, 1);
  }
}

namespace {

/// Whole numbers without sign, of at most four digits, with `separator` between them.
std::optional<std::vector<int>> parse_digits(const std::string& text, char separator) {
  std::vector<int> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    int number = 0;
    const auto [rest, error] = std::from_chars(at, end, number);
    if (error != std::errc() || *at == '-' || rest - at > 4) return std::nullopt;
    numbers.push_back(number);
    if (rest == end) return numbers;
    if (*rest != separator) return std::nullopt;
    at = rest + 1;
  }
}

}  // namespace

std::optional<std::array<int, 3>> parse_date(const std::string& text) {
  const auto parts = parse_digits(text, '-');
  if (!parts || parts->size() != 3) return std::nullopt;
  return std::array<int, 3>{(*parts)[0], (*parts)[1], (*parts)[2]};
}

std::optional<double> parse_hour(const std::string& text) {
  const auto parts = parse_digits(text, ':');
  if (!parts || parts->size() != 2 || (*parts)[0] > 24 || (*parts)[1] > 59) return std::nullopt;
  const double hour = (*parts)[0] + (*parts)[1] / 60.0;
  return hour <= 24 ? std::optional(hour) : std::nullopt;
}

std::optional<PictureSize> parse_picture_size(const std::string& text) {
  constexpr int kMost = 16384;
  PictureSize size;
  const char* const end = text.data() + text.size();
  auto [rest, error] = std::from_chars(text.data(), end, size.width);
  if (error != std::errc() || size.width < 1 || size.width > kMost) return std::nullopt;
  if (rest == end) return size;
  if (*rest != 'x' && *rest != 'X') return std::nullopt;
  auto [last, second_error] = std::from_chars(rest + 1, end, size.height);
  if (second_error != std::errc() || last != end || size.height < 1 || size.height > kMost)
    return std::nullopt;
  return size;
}

std::optional<double> parse_share(const std::string& text) {
  std::string rest = text;
  const auto number = take_number(rest);
  if (!number || !(rest.empty() || rest == "%")) return std::nullopt;
  const double share = rest.empty() ? *number : *number / 100;
  return share > 0 && share <= 1 ? std::optional(share) : std::nullopt;
}

std::optional<uint64_t> parse_count(const std::string& text) {
  uint64_t count = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, count);
  return error == std::errc() && rest == end && count > 0 ? std::optional(count) : std::nullopt;
}

bool is_number(const std::string& text) {
  std::string rest = text;
  return take_number(rest).has_value() && rest.empty();
}

}  // namespace goldthread::cli
