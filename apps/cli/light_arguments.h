// The options for light that is not in the scene: the same for bake and reference.
#pragma once
#include <string>
#include <vector>

#include "goldthread/error.h"
#include "goldthread/light.h"

namespace CLI {
class App;
}

namespace goldthread::cli {

/// What these options say, before it is a value.
struct LightTexts {
  std::string sky, place, date, time;
  double time_zone = 0;
  float lamp_radius = 0;
  std::vector<std::string> profiles;
  LightOptions::Sun sun;
  bool lone_sun = false;  ///< --sun came without a number
  LightOptions options;   ///< those that need no more parsing
};

/// `--sun` may stand alone or before a number. Gives a lone one its number, which keeps it from taking the
/// argument that follows it, and returns whether there was one.
bool complete_sun(std::vector<std::string>& arguments);

/// `texts` must live until the arguments are parsed.
void add_light(CLI::App& verb, LightTexts& texts);

/// Moves what was parsed into `options`. An Error (kUsage) for what makes no sense by itself or together.
Status finish_light(const CLI::App& verb, const LightTexts& texts, LightOptions& options);

}  // namespace goldthread::cli
