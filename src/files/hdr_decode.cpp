#include "files/hdr_decode.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "files/image_decode.h"

namespace goldthread {
namespace {

// A longest run or stretch holds 127 pixels of one channel in 2 bytes; old runs in 4 bytes more, but nobody
// writes whole pictures of those.
constexpr uint64_t kMostPixelsAByte = 64;

Error broken(const std::string& message) {
  return Error{ErrorCode::kBadInput, "Radiance picture: " + message, "", "", "export the picture again"};
}

struct Reader {
  std::span<const unsigned char> left;

  bool take(unsigned char* out, size_t count) {
    if (left.size() < count) return false;
    std::memcpy(out, left.data(), count);
    left = left.subspan(count);
    return true;
  }

  // A line without its end; nothing where there is none.
  bool line(std::string_view& out) {
    const std::string_view text(reinterpret_cast<const char*>(left.data()), left.size());
    const size_t end = text.find('\n');
    if (end == std::string_view::npos) return false;
    out = text.substr(0, end);
    if (!out.empty() && out.back() == '\r') out.remove_suffix(1);
    left = left.subspan(end + 1);
    return true;
  }
};

struct Header {
  uint32_t width = 0, height = 0;
  float scale = 1;
};

bool take_word(std::string_view& text, std::string_view word) {
  if (text.substr(0, word.size()) != word) return false;
  text.remove_prefix(word.size());
  return true;
}

template <typename Number>
bool take_number(std::string_view& text, Number& number) {
  while (!text.empty() && text[0] == ' ') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return false;
  text.remove_prefix(static_cast<size_t>(end - text.data()));
  return true;
}

Result<Header> read_header(Reader& reader) {
  Header header;
  double exposure = 1;
  std::string_view line;
  while (true) {
    if (!reader.line(line)) return broken("the header has no end");
    if (line.empty()) break;
    double value = 1;
    std::string_view rest = line;
    if (take_word(rest, "FORMAT=") && rest != "32-bit_rle_rgbe") return broken("its pixels are not RGBE");
    rest = line;
    if (take_word(rest, "EXPOSURE=") && take_number(rest, value)) exposure *= value;
  }
  if (!(exposure > 0) || !std::isfinite(exposure)) return broken("its exposure is no positive number");
  header.scale = static_cast<float>(1 / exposure);
  if (!reader.line(line)) return broken("has no resolution");
  const bool usual = take_word(line, "-Y") && take_number(line, header.height) && take_word(line, " +X") &&
                     take_number(line, header.width);
  if (!usual) return broken("its rows do not run from the top left (-Y height +X width)");
  return header;
}

// One row with runs of channels, after its four bytes of introduction.
bool read_row_of_runs(Reader& reader, std::span<unsigned char> row) {
  const size_t width = row.size() / 4;
  for (size_t channel = 0; channel < 4; ++channel)
    for (size_t x = 0; x < width;) {
      unsigned char count = 0, value = 0;
      if (!reader.take(&count, 1)) return false;
      const bool run = count > 128;
      const size_t length = run ? count - 128u : count;
      if (length == 0 || x + length > width || (run && !reader.take(&value, 1))) return false;
      for (const size_t end = x + length; x < end; ++x) {
        if (!run && !reader.take(&value, 1)) return false;
        row[4 * x + channel] = value;
      }
    }
  return true;
}

// One row of whole pixels, of which (1, 1, 1, n) repeats the one before.
bool read_row_of_pixels(Reader& reader, std::span<unsigned char> row, const unsigned char* first) {
  const size_t width = row.size() / 4;
  std::memcpy(row.data(), first, 4);
  int shift = 0;
  for (size_t x = 1; x < width;) {
    unsigned char pixel[4];
    if (!reader.take(pixel, 4)) return false;
    if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
      std::memcpy(&row[4 * x++], pixel, 4);
      shift = 0;
      continue;
    }
    const uint64_t length = shift > 24 ? width + 1 : uint64_t{pixel[3]} << shift;
    if (x + length > width) return false;
    for (const size_t end = x + length; x < end; ++x) std::memcpy(&row[4 * x], &row[4 * x - 4], 4);
    shift += 8;
  }
  return true;
}

bool read_row(Reader& reader, std::span<unsigned char> row) {
  const size_t width = row.size() / 4;
  unsigned char first[4];
  if (!reader.take(first, 4)) return false;
  const bool runs = first[0] == 2 && first[1] == 2 && first[2] < 128 && width >= 8 && width < 32768;
  if (!runs) return read_row_of_pixels(reader, row, first);
  return size_t{first[2]} * 256 + first[3] == width && read_row_of_runs(reader, row);
}

vec3 colour_of(const unsigned char* rgbe, float scale) {
  if (rgbe[3] == 0) return vec3(0);
  const float unit = scale * std::ldexp(1.0f, int{rgbe[3]} - 136);
  return unit * vec3(rgbe[0], rgbe[1], rgbe[2]);
}

}  // namespace

bool is_radiance_picture(std::span<const unsigned char> bytes) {
  return bytes.size() >= 2 && bytes[0] == '#' && bytes[1] == '?';
}

Result<FloatImage> decode_radiance_picture(std::span<const unsigned char> bytes) {
  if (!is_radiance_picture(bytes)) return broken("it does not begin with #?");
  Reader reader{bytes};
  const Result<Header> header = read_header(reader);
  if (!header) return header.error();
  const uint32_t width = header->width, height = header->height;
  if (width == 0 || height == 0) return broken("it has no pixels");
  if (width > kLargestImageSide || height > kLargestImageSide)
    return broken(fmt::format("it is {} x {}, more than {} a side", width, height, kLargestImageSide));
  if (uint64_t{width} * height > kMostPixelsAByte * reader.left.size())
    return broken(fmt::format("it claims {} x {} pixels, more than its bytes can hold", width, height));
  FloatImage image{width, height, {}};
  image.pixels.resize(size_t{width} * height);
  std::vector<unsigned char> row(size_t{4} * width);
  for (size_t y = 0; y < height; ++y) {
    if (!read_row(reader, row)) return broken(fmt::format("row {} is broken or cut off", y));
    for (size_t x = 0; x < width; ++x) image.pixels[y * width + x] = colour_of(&row[4 * x], header->scale);
  }
  return image;
}

}  // namespace goldthread
