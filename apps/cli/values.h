// Option values that are more than one number.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace goldthread::cli {

/// "2G", "500M", "1.5GiB", "64k", "1073741824": bytes, with multiples of 1024. Nothing when it is no such
/// size.
std::optional<uint64_t> parse_bytes(const std::string& text);

/// Sky luminance: "2000" or "2000,2200,2600" (linear RGB) in nits; with "lux" at the end, the illuminance of
/// an open horizontal plane, which is pi times the luminance.
std::optional<std::array<float, 3>> parse_sky(const std::string& text);
/// Whether such a text ends in "lux".
bool is_illuminance(const std::string& text);

/// Finite numbers with `separator` between them.
std::optional<std::vector<double>> parse_numbers(const std::string& text, char separator);
/// Year, month, day of "2026-06-21"; whether there is such a day is not asked.
std::optional<std::array<int, 3>> parse_date(const std::string& text);
/// Hours of "15:30", 0 to 24.
std::optional<double> parse_hour(const std::string& text);

struct PictureSize {
  int width = 0, height = 0;  ///< height 0: from the camera's aspect
};
/// "960x540" or "960". Both sides within 1..16384.
std::optional<PictureSize> parse_picture_size(const std::string& text);

/// "0.01" or "1%": a share above 0 and at most 1.
std::optional<double> parse_share(const std::string& text);

/// A whole number of at least 1, or nothing.
std::optional<uint64_t> parse_count(const std::string& text);

/// True when the whole of `text` is a finite number.
bool is_number(const std::string& text);

}  // namespace goldthread::cli
