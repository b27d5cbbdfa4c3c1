#include "files/ies_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "files/gltf_read_container.h"
#include "files/mesh_import.h"

namespace goldthread {
namespace {

// More angles than any goniophotometer measures; each value also needs two bytes of the file.
constexpr int kMostAngles = 10000;

// Angles this near to a quarter turn are meant to be one, degrees.
constexpr double kSameAngle = 0.01;

constexpr int kTypeC = 1, kTypeB = 2, kTypeA = 3;

// Errors are thrown within this file as what they are, and caught where it is entered.
struct Failure {
  Error error;
};

std::string upper_case(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

std::string_view trimmed(std::string_view text) {
  const size_t first = text.find_first_not_of(" \t");
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// What follows "TILT=" on the line; spaces may stand about the sign.
std::optional<std::string_view> tilt_value(std::string_view line) {
  line = trimmed(line);
  if (upper_case(line.substr(0, 4)) != "TILT") return std::nullopt;
  line = trimmed(line.substr(4));
  if (line.empty() || line[0] != '=') return std::nullopt;
  return trimmed(line.substr(1));
}

// The year of the format that the first line names: "IESNA:LM-63-1995" and the like; 1986 named none.
int format_year(std::string_view line) {
  const std::string name = upper_case(trimmed(line));
  if (name.rfind("IESNA91", 0) == 0) return 1991;
  const std::string_view mark = "LM-63-";
  const size_t at = name.find(mark);
  if (name.rfind("IES", 0) != 0 || at == name.npos) return 1986;
  int year = 0;
  const char* const digits = name.data() + at + mark.size();
  std::from_chars(digits, name.data() + name.size(), year);
  if (year < 100) return year < 50 ? 2000 + year : 1900 + year;
  return year;
}

// Reads the file from front to back: lines up to TILT, then numbers wherever they stand.
class IesReader {
 public:
  IesReader(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  LightProfile read() {
    check_text();
    const std::string tilt = read_header();
    const double tilt_factor = read_tilt(tilt);
    read_counts();
    read_factors(tilt_factor);
    PhotometricGrid grid;
    grid.vertical = read_angles(vertical_count_, "vertical");
    check_vertical(grid.vertical);
    grid.horizontal = read_angles(horizontal_count_, "horizontal");
    check_horizontal(grid.horizontal);
    grid.candela = read_candela();
    LightProfile profile = type_ == kTypeC ? type_c_profile(grid) : type_b_profile(grid);
    profile.changes_with_tilt = tilt == "INCLUDE";
    return profile;
  }

 private:
  [[noreturn]] void fail(const std::string& message, const std::string& cure = "correct the file") const {
    const std::string place = line_ > 0 ? fmt::format("line {}", line_) : "";
    throw Failure{bad_input(file_, place, message, cure)};
  }

  void check_text() {
    if (text_.substr(0, 3) == "\xEF\xBB\xBF") text_.remove_prefix(3);
    if (text_.find_first_not_of(" \t\r\n") == text_.npos)
      fail("the file is empty", "copy or download it again");
    if (text_.find('\0') != text_.npos)
      fail("is not text, as IES files are", "give an IES file (LM-63), saved as plain text");
  }

  // The next line without its end, be that LF, CR or both.
  std::optional<std::string_view> next_line() {
    if (at_ >= text_.size()) return std::nullopt;
    const size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
    const std::string_view line = text_.substr(at_, end - at_);
    at_ = std::min(end + (text_.substr(end, 2) == "\r\n" ? 2 : 1), text_.size());
    ++line_;
    return line;
  }

  // Skips the keywords. What TILT is, with letters as they should be.
  std::string read_header() {
    while (const std::optional<std::string_view> line = next_line()) {
      if (line_ == 1) year_ = format_year(*line);
      const std::optional<std::string_view> tilt = tilt_value(*line);
      if (!tilt) continue;
      const std::string name = upper_case(*tilt);
      if (name == "NONE" || name == "INCLUDE") return name;
      if (name.empty()) fail("TILT= names nothing", "write TILT=NONE");
      fail(fmt::format("TILT={} keeps the lamp's tilt factors in another file, which is not read",
                       plain_text(std::string(*tilt))),
           "write TILT=NONE, or TILT=INCLUDE and the factors");
    }
    line_ = 0;
    fail("has no TILT= line", "give an IES file (LM-63), with a line TILT=NONE before its numbers");
  }

  // The next word of the numbers; empty at the end.
  std::string_view next_word() {
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\n' || (c == '\r' && text_.substr(at_ + 1, 1) != "\n")) {
        ++lines_passed_;
      } else if (c != ' ' && c != '\t' && c != ',' && c != '\r') {
        break;
      }
    }
    const size_t end = std::min(text_.find_first_of(" \t,\r\n", at_), text_.size());
    const std::string_view word = text_.substr(at_, end - at_);
    at_ = end;
    if (!word.empty()) {
      line_ += lines_passed_;
      lines_passed_ = 0;
    }
    return word;
  }

  // `what` says what is due: a callable, for most are never said.
  template <typename What>
  double number(const What& what) {
    std::string_view word = next_word();
    if (word.empty()) fail(fmt::format("the file ends where {} is due", what()), "copy or download it again");
    const std::string_view shown = word;
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
    double value = 0;
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (status == std::errc::result_out_of_range && end == word.data() + word.size() && is_tiny(word))
      return 0;
    if (status != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
      fail(fmt::format("\"{}\" is not a finite number, where {} is due", plain_text(std::string(shown)),
                       what()));
    return value;
  }

  static bool is_tiny(std::string_view word) {
    const size_t exponent = word.find_first_of("eE");
    return exponent != word.npos && word.substr(exponent + 1, 1) == "-";
  }

  double number_named(const char* what) {
    return number([what] { return what; });
  }

  double positive(const char* what) {
    const double value = number_named(what);
    if (value <= 0) fail(fmt::format("{} is {}, not more than nought", what, value));
    return value;
  }

  int whole(const char* what, int least, int most) {
    const double value = number_named(what);
    if (value != std::floor(value) || value < least || value > most)
      fail(fmt::format("{} is {}, not a whole number from {} to {}", what, value, least, most));
    return static_cast<int>(value);
  }

  double read_tilt(const std::string& tilt) {
    if (tilt != "INCLUDE") return 1;
    whole("the lamp-to-luminaire geometry", 1, 3);
    const auto count = static_cast<size_t>(whole("the number of tilt angles", 1, kMostAngles));
    std::vector<double> angles, factors;
    for (size_t i = 0; i < count; ++i) {
      angles.push_back(number_named("a tilt angle"));
      if (i > 0 && angles[i] <= angles[i - 1])
        fail(fmt::format("tilt angle {} comes after {}: they do not ascend", angles[i], angles[i - 1]));
    }
    for (size_t i = 0; i < count; ++i) {
      factors.push_back(number_named("a tilt factor"));
      if (factors[i] < 0) fail(fmt::format("a tilt factor is {}, less than nought", factors[i]));
    }
    return factor_without_tilt(angles, factors);
  }

  double factor_without_tilt(const std::vector<double>& angles, const std::vector<double>& factors) const {
    for (size_t i = 0; i < angles.size(); ++i) {
      if (angles[i] == 0) return factors[i];
      if (i == 0 || angles[i - 1] > 0 || angles[i] < 0) continue;
      const double share = -angles[i - 1] / (angles[i] - angles[i - 1]);
      return (1 - share) * factors[i - 1] + share * factors[i];
    }
    fail("there is no tilt factor for a tilt of 0, the only one that is used",
         "write TILT=NONE, or add the factor");
  }

  void read_counts() {
    whole("the number of lamps", 0, std::numeric_limits<int>::max());
    number_named("the lumens per lamp");  // -1 for absolute photometry
    factor_ = positive("the candela multiplier");
    // Less has no solid angle.
    vertical_count_ = static_cast<size_t>(whole("the number of vertical angles", 2, kMostAngles));
    horizontal_count_ = static_cast<size_t>(whole("the number of horizontal angles", 1, kMostAngles));
    const size_t values = vertical_count_ * horizontal_count_;
    if (values > (text_.size() - at_) / 2)
      fail(fmt::format("{} x {} candela values are announced, more than the rest of the file can hold",
                       vertical_count_, horizontal_count_),
           "correct the numbers of angles, or copy the file again");
  }

  void read_factors(double tilt_factor) {
    type_ = whole("the photometric type", kTypeC, kTypeA);
    if (type_ == kTypeA) fail("photometry of type A is not supported", "convert the file to type C");
    if (type_ == kTypeB && horizontal_count_ < 2)
      fail("photometry of type B needs at least 2 horizontal angles");
    whole("the units type", 1, 2);
    for (const char* const what : {"the opening's width", "the opening's length", "the opening's height"})
      number_named(what);  // negative ones stand for round shapes
    factor_ *= positive("the ballast factor") * tilt_factor;
    // Reserved in 2002; in 2019 it says how the file came about.
    if (year_ < 2002)
      factor_ *= positive("the ballast-lamp photometric factor");
    else
      number_named("the field after the ballast factor");
    number_named("the input watts");
  }

  std::vector<float> read_angles(size_t count, const char* kind) {
    std::vector<float> angles;
    const auto what = [&] { return fmt::format("{} angle {} of {}", kind, angles.size() + 1, count); };
    while (angles.size() < count) {
      const double angle = number(what), quarter = 90 * std::round(angle / 90);
      const float value = static_cast<float>(std::abs(angle - quarter) <= kSameAngle ? quarter : angle);
      if (!angles.empty() && !(value > angles.back()))
        fail(fmt::format("{} is {} and comes after {}: the angles do not ascend, or their number is wrong",
                         what(), angle, angles.back()));
      check_range(angle, kind);
      angles.push_back(value);
    }
    return angles;
  }

  void check_range(double angle, const char* kind) const {
    const bool vertical = kind[0] == 'v';
    double least = 0, most = vertical ? 180 : 360;
    if (type_ == kTypeB) {
      most = vertical ? 180 : 90;
      least = -most;
    }
    if (angle < least - kSameAngle || angle > most + kSameAngle)
      fail(fmt::format("{} angle {} is not within {} to {}", kind, angle, least, most));
  }

  void check_vertical(const std::vector<float>& angles) const {
    if (type_ == kTypeB && angles.front() > 0)
      fail(fmt::format("vertical angles of type B begin with {}, not with 0 or less", angles.front()));
    if (type_ == kTypeB && angles.back() - angles.front() > 360)
      fail("vertical angles go round more than once");
  }

  void check_horizontal(const std::vector<float>& angles) const {
    const float first = angles.front(), last = angles.back();
    if (type_ == kTypeB) {
      if (first > 0)
        fail(fmt::format("horizontal angles of type B begin with {}, not with 0 or less", first));
      return;
    }
    if (first != 0 && (first != 90 || angles.size() == 1))
      fail(fmt::format("horizontal angles begin with {}, not with 0{}", first,
                       angles.size() > 1 ? " (or 90, to 270)" : ""));
    if (angles.size() == 1 || (first == 0 && (last == 90 || last == 180 || last == 360))) return;
    if (first == 90 && last != 270)
      fail(fmt::format("horizontal angles from 90 end with {}, not with 270", last));
    if (first == 0 && !closes_by_itself(angles))
      fail(fmt::format("horizontal angles end with {}, not with 90, 180 or 360", last));
  }

  // Some files leave the 360 out that would repeat the 0: the way there is one step more.
  static bool closes_by_itself(const std::vector<float>& angles) {
    float widest = 0;
    for (size_t i = 1; i < angles.size(); ++i) widest = std::max(widest, angles[i] - angles[i - 1]);
    return angles.back() > 180 && 360 - angles.back() <= widest + static_cast<float>(kSameAngle);
  }

  std::vector<float> read_candela() {
    const size_t count = vertical_count_ * horizontal_count_;
    std::vector<float> candela;
    candela.reserve(count);
    const auto what = [&] { return fmt::format("candela value {} of {}", candela.size() + 1, count); };
    while (candela.size() < count) {
      const double value = number(what);
      if (value < 0) fail(fmt::format("{} is {}, less than nought", what(), value));
      const double scaled = value * factor_;
      if (!(scaled <= double(std::numeric_limits<float>::max())))
        fail(fmt::format("{} is too large with its factors", what()));
      candela.push_back(static_cast<float>(scaled));
    }
    return candela;
  }

  std::string_view text_;
  const std::string& file_;
  size_t at_ = 0;
  size_t line_ = 0;          ///< of what was read last, from 1
  size_t lines_passed_ = 1;  ///< ends of lines between that and `at_`; the TILT line's own is one
  int year_ = 1986;
  int type_ = kTypeC;
  size_t vertical_count_ = 0, horizontal_count_ = 0;
  double factor_ = 1;
};

}  // namespace

Result<LightProfile> parse_ies(std::string_view text, const std::string& file) {
  try {
    return IesReader(text, file).read();
  } catch (const Failure& failure) {
    return failure.error;
  }
}

Result<LightProfile> read_ies(const std::string& file) {
  const Result<Bytes> bytes = read_file_bytes(file);
  if (!bytes) return bytes.error();
  return parse_ies({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, file);
}

}  // namespace goldthread
