#include "files/form_factor_read.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "files/file_name.h"
#include "files/gltf_read_container.h"
#include "files/mesh_import.h"

namespace goldthread {
namespace {

using nlohmann::json;

constexpr double kRadians = 3.14159265358979323846 / 180;

// Errors are thrown within this file as what they are, and caught where it is entered: JSON is read in deep
// nests of small functions.
struct Failure {
  Error error;
};

class CaseReader {
 public:
  explicit CaseReader(const std::string& file) : file_(file) {}

  void read(const json& item, const std::string& fallback, FormFactorInput& input) {
    if (!item.is_object()) fail(fallback, "is not an object");
    id_ = item.contains("id") && item["id"].is_string() ? item["id"].get<std::string>() : fallback;
    if (item.contains("surfaces")) {
      input.models.push_back(model(item));
    } else if (item.contains("from") && item.contains("to")) {
      input.pairs.push_back({id_, shape(item["from"], "from"), shape(item["to"], "to"), occluders(item)});
      if (std::holds_alternative<PointShape>(input.pairs.back().to)) fail("to", "a point cannot be sent to");
    } else {
      fail("", "has neither \"surfaces\" nor \"from\" and \"to\"");
    }
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& message) const {
    const std::string place = what.empty() ? "case " + id_ : fmt::format("case {}: {}", id_, what);
    throw Failure{bad_input(file_, plain_text(place), message, "correct the file")};
  }

  const json& member(const json& object, const char* name, const std::string& what) const {
    if (!object.is_object() || !object.contains(name)) fail(what, fmt::format("has no \"{}\"", name));
    return object[name];
  }

  double number(const json& object, const char* name, const std::string& what) const {
    const json& value = member(object, name, what);
    if (!value.is_number() || !std::isfinite(value.get<double>()))
      fail(what, fmt::format("\"{}\" is not a finite number", name));
    return value.get<double>();
  }

  double positive(const json& object, const char* name, const std::string& what) const {
    const double value = number(object, name, what);
    if (value <= 0) fail(what, fmt::format("\"{}\" is not greater than nought", name));
    return value;
  }

  dvec3 vector(const json& value, const std::string& what) const {
    if (!value.is_array() || value.size() != 3) fail(what, "is not three numbers");
    dvec3 out;
    for (int k = 0; k < 3; ++k) {
      const json& x = value[static_cast<size_t>(k)];
      if (!x.is_number() || !std::isfinite(x.get<double>())) fail(what, "is not three finite numbers");
      out[k] = x.get<double>();
    }
    return out;
  }

  dvec3 direction(const json& object, const char* name, const std::string& what) const {
    const dvec3 value = vector(member(object, name, what), what + "." + name);
    if (!(glm::length(value) > 0)) fail(what, fmt::format("\"{}\" has no direction", name));
    return glm::normalize(value);
  }

  Polygon polygon(const json& object, const std::string& what) const {
    Polygon out;
    const json& vertices = member(object, "vertices", what);
    if (!vertices.is_array()) fail(what, "\"vertices\" is not an array");
    for (const json& vertex : vertices) out.push_back(vector(vertex, what + ".vertices"));
    if (const std::optional<std::string> problem = polygon_problem(out)) fail(what, *problem);
    return out;
  }

  std::vector<Polygon> occluders(const json& item) const {
    std::vector<Polygon> out;
    if (!item.contains("occluders")) return out;
    if (!item["occluders"].is_array()) fail("occluders", "is not an array");
    for (const json& occluder : item["occluders"])
      out.push_back(polygon(occluder, fmt::format("occluder {}", out.size() + 1)));
    return out;
  }

  bool is_inside(const json& object, const std::string& what) const {
    const json& side = member(object, "side", what);
    if (side != "inside" && side != "outside") fail(what, "\"side\" is neither inside nor outside");
    return side == "inside";
  }

  Shape shape(const json& object, const std::string& what) const {
    const json& type = member(object, "type", what);
    const auto centre = [&] { return vector(member(object, "centre", what), what + ".centre"); };
    if (type == "polygon") return polygon(object, what);
    if (type == "point")
      return PointShape{vector(member(object, "position", what), what + ".position"),
                        direction(object, "normal", what)};
    if (type == "disk")
      return DiscShape{centre(), direction(object, "normal", what), positive(object, "radius", what)};
    if (type == "sphere")
      return SphereShape{centre(), positive(object, "radius", what), is_inside(object, what)};
    if (type == "cylinder_lateral")
      return CylinderShape{vector(member(object, "base", what), what + ".base"),
                           direction(object, "axis", what), positive(object, "radius", what),
                           positive(object, "height", what), is_inside(object, what)};
    if (type == "spherical_cap") {
      if (!is_inside(object, what)) fail(what, "a cap is known from inside only");
      return CapShape{centre(), direction(object, "axis", what), positive(object, "radius", what),
                      positive(object, "half_angle_deg", what) * kRadians};
    }
    fail(what, fmt::format("shape {} is not known", plain_text(type.dump())));
  }

  PolygonModel model(const json& item) const {
    PolygonModel out;
    out.id = id_;
    if (!item["surfaces"].is_array()) fail("surfaces", "is not an array");
    for (const json& surface : item["surfaces"]) {
      const std::string what = fmt::format("surface {}", out.surfaces.size() + 1);
      out.surfaces.push_back(polygon(surface, what));
      const bool named = surface.contains("name") && surface["name"].is_string();
      out.names.push_back(named ? surface["name"].get<std::string>() : what);
    }
    if (out.surfaces.empty()) fail("surfaces", "is empty");
    if (const auto twice = find_twice(out.surfaces))
      fail(fmt::format("surface {}", twice->second + 1),
           fmt::format("lies where surface {} lies and faces the same way", twice->first + 1));
    out.occluders = occluders(item);
    return out;
  }

  const std::string& file_;
  std::string id_;
};

}  // namespace

Result<FormFactorInput> parse_form_factor_json(std::string_view text, const std::string& file) {
  json document;
  try {
    document = json::parse(text);
  } catch (const json::exception& error) {
    return bad_input(file, "", fmt::format("is not JSON: {}", plain_text(error.what())), "correct the file");
  }
  FormFactorInput input;
  try {
    CaseReader reader(file);
    if (document.is_object() && document.contains("cases") && document["cases"].is_array()) {
      size_t count = 0;
      for (const json& item : document["cases"]) reader.read(item, std::to_string(++count), input);
    } else {
      reader.read(document, "1", input);
    }
  } catch (const Failure& failure) {
    return failure.error;
  }
  if (input.pairs.empty() && input.models.empty())
    return bad_input(file, "", "holds no cases", "give it \"cases\"");
  return input;
}

Result<FormFactorInput> read_form_factor_cases(const std::string& file) {
  const Result<Bytes> bytes = read_file_bytes(file);
  if (!bytes) return bytes.error();
  const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  if (text.empty()) return bad_input(file, "", "the file is empty", "export it again");
  const std::string extension = file_extension(file);
  if (extension == ".vs3") return parse_vs3(text, file);
  if (extension == ".json") return parse_form_factor_json(text, file);
  return Error{
      ErrorCode::kUsage, "cannot tell the format of these cases", file, {}, "give a .json or .vs3 file"};
}

}  // namespace goldthread
