#include "scene/procedural.h"

#include "scene/procedural/scenes.h"

namespace goldthread {
namespace {

struct Entry {
  const char* name;
  const char* sentence;
  Scene (*build)(uint64_t triangles);
};

constexpr Entry kEntries[] = {
    {"cornell-box", "the Cornell box: published geometry and colours, front open", procedural::cornell_box},
    {"furnace", "closed cube that glows evenly: irradiance is 2 lux everywhere", procedural::furnace},
    {"sphere", "closed sphere that glows evenly: irradiance is 2 lux everywhere", procedural::sphere},
    {"office", "two cubicles under ceiling panels, after Cohen 1988", procedural::office},
    {"car", "a car of curved panels with long thin triangles, in a studio", procedural::car},
    {"two-rooms", "two rooms joined by a corridor, lights of different colour", procedural::two_rooms},
};

// A wish beyond this would outgrow 32-bit indices of vertices on the way.
constexpr uint64_t kMostTriangles = 100'000'000;

}  // namespace

Result<Scene> build_procedural(std::string_view name, uint64_t triangles) {
  if (triangles > kMostTriangles) {
    return Error{ErrorCode::kUsage, "too many triangles: " + std::to_string(triangles), "", "",
                 "ask for " + std::to_string(kMostTriangles) + " at most"};
  }
  std::string known;
  for (const Entry& entry : kEntries) {
    if (name == entry.name) return entry.build(triangles);
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  return Error{ErrorCode::kUsage, "no scene is called '" + std::string(name) + "'", "", "",
               "choose one of: " + known};
}

std::vector<std::pair<std::string, std::string>> procedural_names() {
  std::vector<std::pair<std::string, std::string>> names;
  for (const Entry& entry : kEntries) names.emplace_back(entry.name, entry.sentence);
  return names;
}

}  // namespace goldthread
