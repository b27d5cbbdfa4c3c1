#include "files/ies_write.h"

#include <fmt/format.h>

#include <iterator>
#include <map>

namespace goldthread {
namespace {

// What goes with each horizontal angle, over the vertical ones.
using Columns = std::map<float, std::vector<float>>;

// Lines may be no longer than 256 characters.
void append_numbers(std::string& text, const std::vector<float>& numbers, float scale) {
  constexpr size_t kPerLine = 10;
  for (size_t i = 0; i < numbers.size(); ++i)
    fmt::format_to(std::back_inserter(text), "{}{}", scale * numbers[i],
                   i + 1 == numbers.size() || (i + 1) % kPerLine == 0 ? '\n' : ' ');
}

Columns columns_of_type_b(const LightProfile& profile) {
  Columns columns;
  for (size_t p = 0; p < profile.polar.size(); ++p)
    for (size_t a = 0; a < profile.azimuth.size(); ++a)
      columns[profile.polar[p] - 90].push_back(profile.candela[a * profile.polar.size() + p]);
  return columns;
}

// Columns that go round begin with 0 and end with 360.
Columns columns_of_type_c(const LightProfile& profile) {
  Columns columns;
  const auto rows = static_cast<std::ptrdiff_t>(profile.polar.size());
  auto first = profile.candela.begin();
  for (const float angle : profile.azimuth) {
    columns[angle >= 360 ? angle - 360 : angle].assign(first, first + rows);
    first += rows;
  }
  if (profile.azimuth.size() == 1) return columns;
  if (columns.begin()->first > 0) {
    const auto& [after, low] = *columns.begin();
    const auto& [before, high] = *columns.rbegin();
    const float share = (360 - before) / (360 - before + after);
    std::vector<float> between;
    for (size_t i = 0; i < low.size(); ++i) between.push_back((1 - share) * high[i] + share * low[i]);
    columns[0] = between;
  }
  columns[360] = columns[0];
  return columns;
}

}  // namespace

std::string ies_text(const LightProfile& profile, float scale) {
  const bool side = profile.pole == LightProfile::Pole::kSide;
  const std::vector<float>& vertical = side ? profile.azimuth : profile.polar;
  const Columns columns = side ? columns_of_type_b(profile) : columns_of_type_c(profile);
  std::string text = fmt::format("IESNA:LM-63-2002\n[TEST] none\nTILT=NONE\n1 -1 1 {} {} {} 2 0 0 0\n1 1 0\n",
                                 vertical.size(), columns.size(), side ? 2 : 1);
  append_numbers(text, vertical, 1);
  std::vector<float> horizontal;
  for (const auto& column : columns) horizontal.push_back(column.first);
  append_numbers(text, horizontal, 1);
  for (const auto& column : columns) append_numbers(text, column.second, scale);
  return text;
}

}  // namespace goldthread
