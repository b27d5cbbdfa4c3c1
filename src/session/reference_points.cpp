#include "session/reference_points.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <sstream>

#include "base/parallel.h"

namespace goldthread {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kListCure = R"(write a list of {"point": [x, y, z], "normal": [x, y, z]}, in metres)";
constexpr const char* kResumeCure = "give a file that an earlier run wrote with --json";

Error bad(const std::string& file, const std::string& place, const std::string& message,
          const std::string& cure) {
  return Error{ErrorCode::kBadInput, message, file, place, cure};
}

Result<Json> read_json(const std::string& file, const char* cure) {
  std::ifstream in(file, std::ios::binary);
  std::error_code none;
  if (!in || std::filesystem::is_directory(file, none))
    return bad(file, "", "cannot be read", "check the name and that it is a file");
  std::ostringstream text;
  text << in.rdbuf();
  try {
    return Json::parse(text.str());
  } catch (const Json::parse_error& error) {
    return bad(file, fmt::format("byte {}", error.byte), "is no JSON", cure);
  } catch (const Json::exception&) {
    return bad(file, "", "has a number beyond all numbers", cure);
  }
}

/// Three finite numbers, or nothing.
std::optional<dvec3> vector_of(const Json& record, const char* name) {
  if (!record.is_object() || !record.contains(name)) return std::nullopt;
  const Json& value = record[name];
  if (!value.is_array() || value.size() != 3) return std::nullopt;
  dvec3 v(0);
  for (int k = 0; k < 3; ++k) {
    const Json& number = value[static_cast<size_t>(k)];
    if (!number.is_number()) return std::nullopt;
    v[k] = number.get<double>();
    if (!std::isfinite(v[k]) || std::abs(v[k]) > 1e30) return std::nullopt;
  }
  return v;
}

Result<Receiver> read_point(const Json& record, const TracedScene& scene, const std::string& file,
                            const std::string& place) {
  const auto point = vector_of(record, "point"), normal = vector_of(record, "normal");
  if (!point) return bad(file, place, "has no \"point\" of three finite numbers", kListCure);
  if (!normal) return bad(file, place, "has no \"normal\" of three finite numbers", kListCure);
  const double length = glm::length(*normal);
  if (!(length > 1e-12))
    return bad(file, place, "its normal has no length", "give the side that light falls on");
  const PlacedReceiver placed = place_receiver(scene, vec3(*point), vec3(*normal / length));
  if (placed.distance > on_surface_distance(scene))
    return bad(file, place, fmt::format("lies on no surface: the nearest is {:.4g} m away", placed.distance),
               "give points of the scene's surfaces, in metres");
  return placed.receiver;
}

/// Numbers as the shortest text that reads back as the same double; null for what JSON has no word for.
void append(std::string& text, std::span<const double> numbers) {
  text += '[';
  for (size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0) text += ',';
    if (std::isfinite(numbers[i]))
      fmt::format_to(std::back_inserter(text), "{}", numbers[i]);
    else
      text += "null";
  }
  text += ']';
}

void append(std::string& text, const char* name, const dvec3& v) {
  fmt::format_to(std::back_inserter(text), "\"{}\":", name);
  append(text, std::array{v.x, v.y, v.z});
  text += ',';
}

/// One line of JSON. There may be a hundred thousand, and someone who has pressed Ctrl-C waits for them: so
/// they are put together as text, not as trees of values.
std::string record_of(const Receiver& receiver, const IrradianceSums& sums) {
  std::string text = "{";
  append(text, "point", dvec3(receiver.point));
  append(text, "normal", dvec3(receiver.normal));
  if (receiver.instance != Receiver::kNowhere) {
    fmt::format_to(std::back_inserter(text), R"("instance":{},"primitive":{},)", receiver.instance,
                   receiver.primitive);
    if (receiver.is_texel())
      fmt::format_to(std::back_inserter(text), R"("texel":[{},{}],)", receiver.texel_x, receiver.texel_y);
    else
      fmt::format_to(std::back_inserter(text), R"("vertex":{},)", receiver.vertex);
    fmt::format_to(std::back_inserter(text), R"("back":{},)", receiver.back);
  }
  if (sums.samples > 0) {
    const IrradianceValue value = evaluate(sums);
    append(text, "irradiance", value.mean);
    append(text, "standard_error", value.standard_error);
  } else {
    text += R"("irradiance":null,"standard_error":null,)";
  }
  append(text, "origin", dvec3(receiver.origin));
  if (receiver.surface != vec3(0)) append(text, "surface", dvec3(receiver.surface));
  fmt::format_to(std::back_inserter(text), "\"samples\":{}", sums.samples);
  if (sums.samples > 0) {
    text += ",\"batch_sums\":";
    append(text, std::span(&sums.batches[0].x, 3 * kBatches));
  }
  return text + "}";
}

/// False where the record is not what `record_of` writes.
bool from_json(const Json& record, const TexelLayout& layout, Receiver& receiver, IrradianceSums& sums) {
  const auto point = vector_of(record, "point"), normal = vector_of(record, "normal"),
             origin = vector_of(record, "origin");
  if (!point || !normal || !origin || !record.contains("samples")) return false;
  if (!record["samples"].is_number_unsigned()) return false;
  receiver.point = vec3(*point);
  receiver.normal = vec3(*normal);
  receiver.origin = vec3(*origin);
  if (!(std::abs(length(receiver.normal) - 1) < 1e-3f)) return false;
  if (record.contains("surface")) {
    const auto surface = vector_of(record, "surface");
    if (!surface || !(std::abs(glm::length(*surface) - 1) < 1e-3)) return false;
    receiver.surface = vec3(*surface);
  }
  if (record.contains("instance")) {
    receiver.instance = record.at("instance").get<uint32_t>();
    receiver.primitive = record.at("primitive").get<uint32_t>();
    receiver.back = record.at("back").get<bool>();
    if (layout.width > 0) {
      receiver.texel_x = record.at("texel").at(0).get<uint32_t>();
      receiver.texel_y = record.at("texel").at(1).get<uint32_t>();
      if (receiver.texel_x >= layout.width || receiver.texel_y >= layout.height) return false;
    } else {
      receiver.vertex = record.at("vertex").get<uint32_t>();
    }
  }
  if (receiver.is_texel() != (layout.width > 0)) return false;
  sums.samples = record["samples"].get<uint64_t>();
  if (sums.samples % kBatches != 0) return false;
  if (sums.samples == 0) return true;
  if (!record.contains("batch_sums") || record["batch_sums"].size() != 3 * kBatches) return false;
  for (size_t i = 0; i < 3 * kBatches; ++i)
    sums.batches[i / 3][static_cast<int>(i % 3)] = record["batch_sums"][i].get<double>();
  return true;
}

/// False where the layout is not one that `write_estimate` writes.
bool layout_from_json(const Json& record, TexelLayout& layout) {
  layout.width = record.at("width").get<uint32_t>();
  layout.height = record.at("height").get<uint32_t>();
  if (!record.at("uv").is_null()) layout.uv = record.at("uv").get<uint32_t>();
  const auto fits = [](uint32_t side) { return side >= 1 && side <= kMostTexelsAside; };
  return fits(layout.width) && fits(layout.height);
}

}  // namespace

Result<std::vector<Receiver>> read_points(const std::string& file, const TracedScene& scene) {
  const Result<Json> json = read_json(file, kListCure);
  if (!json) return json.error();
  if (!json->is_array() || json->empty()) return bad(file, "", "is no list of points", kListCure);
  std::vector<Receiver> receivers;
  for (size_t i = 0; i < json->size(); ++i) {
    const Result<Receiver> one = read_point((*json)[i], scene, file, fmt::format("point {}", i));
    if (!one) return one.error();
    receivers.push_back(*one);
  }
  return receivers;
}

namespace {

/// `figures` with `records`, each a line, as its "points".
std::string with_points(const Json& figures, const std::vector<std::string>& records) {
  std::string text = figures.dump(2, ' ', false, Json::error_handler_t::replace);
  text.resize(text.find_last_not_of("}\n ") + 1);
  text += figures.empty() ? "\n  \"points\": [" : ",\n  \"points\": [";
  for (size_t i = 0; i < records.size(); ++i) text += (i > 0 ? ",\n    " : "\n    ") + records[i];
  return text + "\n  ]\n}\n";
}

}  // namespace

std::string write_light(Json figures, const std::vector<Receiver>& receivers,
                        const std::vector<std::optional<vec3>>& light) {
  std::vector<std::string> records(receivers.size());
  for (size_t i = 0; i < records.size(); ++i) {
    std::string& text = records[i] = "{";
    append(text, "point", dvec3(receivers[i].point));
    append(text, "normal", dvec3(receivers[i].normal));
    if (light[i]) {
      text += "\"irradiance\":";
      append(text, std::array<double, 3>{double{light[i]->x}, double{light[i]->y}, double{light[i]->z}});
    } else {
      text += "\"irradiance\":null";
    }
    text += "}";
  }
  return with_points(figures, records);
}

std::string write_estimate(Json figures, const SavedEstimate& estimate) {
  if (const TexelLayout& layout = estimate.layout; layout.width > 0)
    figures["texels"] = {{"width", layout.width},
                         {"height", layout.height},
                         {"uv", layout.uv ? Json(*layout.uv) : Json(nullptr)}};
  figures["seed"] = estimate.seed;
  figures["rays"] = estimate.rays;
  figures["seconds"] = estimate.seconds;
  figures["ray_time_share"] = estimate.ray_time_share;
  figures["fingerprint"] = estimate.fingerprint;
  std::vector<std::string> records(estimate.receivers.size());
  parallel_for(
      records.size(), [&](size_t i) { records[i] = record_of(estimate.receivers[i], estimate.sums[i]); }, 64);
  return with_points(figures, records);
}

Result<SavedEstimate> read_estimate(const std::string& file) {
  const Result<Json> json = read_json(file, kResumeCure);
  if (!json) return json.error();
  SavedEstimate saved;
  std::string place;
  try {
    saved.seed = json->at("seed").get<uint64_t>();
    saved.fingerprint = json->at("fingerprint").get<uint64_t>();
    saved.rays = json->at("rays").get<uint64_t>();
    saved.seconds = json->at("seconds").get<double>();
    saved.ray_time_share = json->at("ray_time_share").get<double>();
    if (json->contains("texels") && !layout_from_json(json->at("texels"), saved.layout))
      return bad(file, "texels", "are no size that there can be", kResumeCure);
    const Json& points = json->at("points");
    for (size_t i = 0; i < points.size(); ++i) {
      place = fmt::format("point {}", i);
      saved.receivers.emplace_back();
      saved.sums.emplace_back();
      if (!from_json(points.at(i), saved.layout, saved.receivers.back(), saved.sums.back()))
        return bad(file, place, "cannot be gone on from", kResumeCure);
    }
  } catch (const Json::exception&) {
    return bad(file, place, "cannot be gone on from: something is missing or of the wrong kind", kResumeCure);
  }
  if (saved.receivers.empty()) return bad(file, "", "has no points", kResumeCure);
  return saved;
}

}  // namespace goldthread
