#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>

#include "files/form_factor_read.h"
#include "files/gltf_read_container.h"
#include "files/mesh_import.h"

namespace goldthread {
namespace {

constexpr double kRadians = 3.14159265358979323846 / 180;

struct Failure {
  Error error;
};

// Reads records in order; a surface's base and whole may come after it and are looked up at the end.
class Vs3Reader {
 public:
  Vs3Reader(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  PolygonModel read() {
    while (next_line()) {
      const char record = static_cast<char>(std::toupper(static_cast<unsigned char>(words_[0][0])));
      const bool one_letter = words_[0].size() == 1;
      if (!one_letter && (words_[0] == "End" || words_[0] == "END" || words_[0] == "end")) break;
      if (!one_letter) fail(fmt::format("record \"{}\" is not known", plain_text(words_[0])));
      switch (record) {
        case 'T':
          break;
        case 'C':
          break;  // View3D's own tolerances and print-outs
        case 'F':
          format();
          break;
        case 'V':
          vertex();
          break;
        case 'S':
        case 'O':
        case 'M':
        case 'N':
          surface(record);
          break;
        default:
          fail(fmt::format("record \"{}\" is not known", plain_text(words_[0])));
      }
    }
    if (model_.surfaces.empty()) {
      place_.clear();
      fail("holds no surfaces");
    }
    resolve();
    check_twice(false);
    check_twice(true);
    return std::move(model_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw Failure{bad_input(file_, place_, message, "correct the file")};
  }

  // The next line with words on it; comments are cut off.
  bool next_line() {
    while (at_ < text_.size()) {
      const size_t end = std::min(text_.find('\n', at_), text_.size());
      std::string line(text_.substr(at_, end - at_));
      at_ = end + 1;
      place_ = fmt::format("line {}", ++number_);
      std::istringstream stream(line.substr(0, line.find('!')));
      words_.clear();
      for (std::string word; stream >> word;) words_.push_back(word);
      if (!words_.empty()) return true;
    }
    return false;
  }

  double number(size_t word) const {
    if (word >= words_.size())
      fail(fmt::format("has {} words, at least {} are due", words_.size(), word + 1));
    try {
      size_t used = 0;
      const double value = std::stod(words_[word], &used);
      if (used == words_[word].size() && std::isfinite(value)) return value;
    } catch (const std::exception&) {  // said below
    }
    fail(fmt::format("\"{}\" is not a number", plain_text(words_[word])));
  }

  int64_t whole(size_t word) const {
    const double value = number(word);
    if (value != std::floor(value) || std::abs(value) > 1e9)
      fail(fmt::format("\"{}\" is not a whole number", plain_text(words_[word])));
    return static_cast<int64_t>(value);
  }

  void format() {
    const std::string name = words_.size() > 1 ? words_[1] : "";
    if (name != "3" && name != "3a" && name != "3A")
      fail(fmt::format("geometry format \"{}\" is not known: 3 and 3a are", plain_text(name)));
    by_origin_ = name != "3";
  }

  void vertex() {
    const dvec3 position(number(2), number(3), number(4));
    if (!vertices_.emplace(whole(1), position).second)
      fail(fmt::format("vertex {} is there twice", whole(1)));
  }

  void surface(char record) {
    const int64_t id = whole(1);
    // Number, shape or four vertices, then base, whole, emittance and name.
    const size_t after = by_origin_ ? 3 : 6;
    const std::string start = place_;
    Polygon corners;
    if (!by_origin_) corners = listed_corners();
    // Of an obstruction View3D reads no more than its place.
    const int64_t base = record == 'O' ? 0 : whole(after), combined = record == 'O' ? 0 : whole(after + 1);
    const std::string name = words_.size() > after + 3 ? words_[after + 3] : fmt::format("surface {}", id);
    if (by_origin_) corners = placed_corners();  // on lines of their own
    place_ = fmt::format("{}: surface {}", start, id);
    if (const std::optional<std::string> problem = polygon_problem(corners)) fail(*problem);
    if (record == 'O') {
      obstructions_.emplace(id, model_.occluders.size());
      model_.occluders.push_back(std::move(corners));
      return;
    }
    const Cover cover = record == 'M' ? Cover::kMask : record == 'N' ? Cover::kNull : Cover::kNothing;
    if (cover != Cover::kNothing) {
      if (base == 0) fail("a mask or null surface needs a base surface");
      if (combined != 0) fail("a mask or null surface cannot be combined with another");
      std::reverse(corners.begin(), corners.end());  // the part of the base that it covers
    }
    if (!numbers_.emplace(id, static_cast<uint32_t>(model_.surfaces.size())).second)
      fail("this number is there twice");
    model_.surfaces.push_back(std::move(corners));
    model_.names.push_back(name);
    model_.cover.push_back(cover);
    wanted_.push_back({base, combined, place_});
  }

  // Two in one place: of what sends, and of what covers (a mask may cover all of its base).
  void check_twice(bool covers) {
    std::vector<Polygon> polygons;
    std::vector<size_t> numbers;
    for (size_t s = 0; s < model_.surfaces.size(); ++s) {
      if ((model_.cover.empty() || model_.cover[s] == Cover::kNothing) == covers) continue;
      polygons.push_back(model_.surfaces[s]);
      numbers.push_back(s);
    }
    const auto twice = find_twice(polygons);
    if (!twice) return;
    place_ = wanted_[numbers[twice->second]].place;
    fail(fmt::format("it lies where the surface of {} lies and faces the same way",
                     wanted_[numbers[twice->first]].place));
  }

  Polygon listed_corners() const {
    Polygon corners;
    for (size_t word = 2; word < 6; ++word) {
      const int64_t id = whole(word);
      if (id == 0 && word == 5) break;  // a triangle
      const auto found = vertices_.find(id);
      if (found == vertices_.end()) fail(fmt::format("vertex {} is not there", id));
      corners.push_back(found->second);
    }
    return corners;
  }

  // An origin, azimuth (clockwise from y) and tilt (0 faces up) in degrees, and corners in that plane, x to
  // the left as one looks along the normal's azimuth, y up.
  Polygon placed_corners() {
    const std::string kind = words_.size() > 2 ? words_[2] : "";
    const bool is_rectangle = kind == "R" || kind == "r", is_four = kind == "Q" || kind == "q";
    if (!is_rectangle && !is_four)
      fail(fmt::format("shape \"{}\" is not known: R and Q are", plain_text(kind)));
    if (!next_line()) fail("the file ends where a surface's place is due");
    const dvec3 origin(number(0), number(1), number(2));
    const double azimuth = number(3) * kRadians, tilt = number(4) * kRadians;
    const dvec3 ahead(std::sin(azimuth), std::cos(azimuth), 0), up(0, 0, 1);
    const dvec3 x(-std::cos(azimuth), std::sin(azimuth), 0),
        y = -std::cos(tilt) * ahead + std::sin(tilt) * up;
    std::vector<dvec2> corners;
    if (is_rectangle) {
      const double width = number(5), height = number(6);
      corners = {{0, 0}, {width, 0}, {width, height}, {0, height}};
    } else {
      if (!next_line()) fail("the file ends where a surface's corners are due");
      for (size_t k = 0; k < 4; ++k) corners.emplace_back(number(2 * k), number(2 * k + 1));
    }
    Polygon out;
    for (const dvec2& c : corners) out.push_back(origin + c.x * x + c.y * y);
    return out;
  }

  uint32_t surface_number(int64_t id, const std::string& place, const char* what) {
    if (id == 0) return PolygonModel::kNone;
    place_ = place;
    const auto found = numbers_.find(id);
    if (found == numbers_.end()) fail(fmt::format("its {} surface {} is not there", what, id));
    return found->second;
  }

  void resolve() {
    bool any = false;
    for (size_t s = 0; s < wanted_.size(); ++s) {
      const Wanted& wanted = wanted_[s];
      model_.base.push_back(lies_on_obstruction(s) ? PolygonModel::kNone
                                                   : surface_number(wanted.base, wanted.place, "base"));
      model_.combined.push_back(surface_number(wanted.combined, wanted.place, "combined"));
      any = any || wanted.base != 0 || wanted.combined != 0;
    }
    for (size_t s = 0; s < model_.combined.size(); ++s) {
      // Round in a circle, a surface would be part of itself.
      uint32_t whole = static_cast<uint32_t>(s);
      for (size_t steps = 0; model_.combined[whole] != PolygonModel::kNone; whole = model_.combined[whole]) {
        place_ = wanted_[s].place;
        if (++steps > model_.combined.size()) fail("it is combined with itself");
      }
      check_base(s);
    }
    if (any) return;
    model_.base.clear();
    model_.combined.clear();
    model_.cover.clear();
  }

  // What only blocks has no exchange to be taken from, so that it is no base to what follows.
  bool lies_on_obstruction(size_t s) {
    const auto found = obstructions_.find(wanted_[s].base);
    if (found == obstructions_.end() || numbers_.count(wanted_[s].base) > 0) return false;
    check_plane(s, model_.occluders[found->second]);
    if (model_.cover[s] != Cover::kNothing) fail("a mask or null surface cannot lie on an obstruction");
    return model_.on_occluders = true;
  }

  void check_plane(size_t s, const Polygon& base) {
    place_ = wanted_[s].place;
    for (const dvec3& corner : model_.surfaces[s])
      if (std::abs(plane_of(base).height(corner)) > 1e-5 * radius(base))
        fail("it does not lie in its base surface");
  }

  void check_base(size_t s) {
    if (model_.base[s] == PolygonModel::kNone) return;
    const Polygon& base = model_.surfaces[model_.base[s]];
    const Plane plane = plane_of(base);
    check_plane(s, base);
    if (model_.cover[s] != Cover::kNothing) check_cover(s, base, plane.normal);
  }

  void check_cover(size_t s, const Polygon& base, const dvec3& normal) const {
    if (model_.cover[model_.base[s]] != Cover::kNothing)
      fail("its base surface is itself a mask or null surface");
    if (glm::dot(plane_of(model_.surfaces[s]).normal, normal) < 0.999)  // it has been turned
      fail("a mask or null surface has to face its base surface");
    // View3D's surfaces are convex.
    for (size_t k = 0; k < base.size(); ++k) {
      const dvec3 inwards = glm::normalize(glm::cross(normal, base[(k + 1) % base.size()] - base[k]));
      for (const dvec3& corner : model_.surfaces[s])
        if (glm::dot(corner - base[k], inwards) < -1e-5 * radius(base))
          fail("it does not lie within its base surface");
    }
    if (model_.cover[s] == Cover::kNull && area(model_.surfaces[s]) > (1 - 1e-6) * area(base))
      fail("it leaves nothing of its base surface");
  }

  struct Wanted {
    int64_t base, combined;
    std::string place;
  };

  std::string_view text_;
  const std::string& file_;
  size_t at_ = 0, number_ = 0;
  std::string place_;
  std::vector<std::string> words_;
  bool by_origin_ = false;
  std::map<int64_t, dvec3> vertices_;
  std::map<int64_t, uint32_t> numbers_;
  std::map<int64_t, size_t> obstructions_;  // number in the file, and as an occluder
  std::vector<Wanted> wanted_;
  PolygonModel model_;
};

}  // namespace

Result<FormFactorInput> parse_vs3(std::string_view text, const std::string& file) {
  FormFactorInput input;
  try {
    input.models.push_back(Vs3Reader(text, file).read());
  } catch (const Failure& failure) {
    return failure.error;
  }
  return input;
}

}  // namespace goldthread
