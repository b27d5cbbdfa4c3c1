#include "arguments.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <utility>

#include "values.h"

namespace goldthread::cli {
namespace {

constexpr const char* kExamples =
    "Examples:\n"
    "  goldthread make cornell-box -o box.glb\n"
    "  goldthread info box.glb\n"
    "  goldthread bake box.glb -o lit.glb -o lit.png\n"
    "\n"
    "Exit codes: 0 done, 2 wrong usage, 3 bad input, 4 nothing to bake, 5 out of memory or limit,\n"
    "6 could not write, 130 cancelled. 'goldthread VERB --help' tells a verb's options.";

constexpr const char* kBakeExamples =
    "Examples:\n"
    "  goldthread bake room.glb -o lit.glb -o lit.png --quality high\n"
    "  goldthread bake room.glb -o lit.glb --output unlit\n"
    "  goldthread bake house.obj -o lit.glb --sky 10000lux --sun 80000 --sun-elevation 35\n"
    "  goldthread bake car.glb -o car.gold --time-limit 60 --max-memory 2G --report car.json";

constexpr const char* kMakeExamples =
    "Examples:\n"
    "  goldthread make office -o office.glb\n"
    "  goldthread make car --triangles 500000 -o car.glb";

const std::vector<std::pair<std::string, Quality>> kQualities = {{"draft", Quality::kDraft},
                                                                 {"medium", Quality::kMedium},
                                                                 {"high", Quality::kHigh},
                                                                 {"final", Quality::kFinal}};
const std::vector<std::pair<std::string, OutputMode>> kOutputModes = {
    {"vertex-light", OutputMode::kVertexLight}, {"unlit", OutputMode::kUnlit}};

template <typename Value>
std::vector<std::string> names_of(const std::vector<std::pair<std::string, Value>>& table) {
  std::vector<std::string> names;
  names.reserve(table.size());
  for (const auto& entry : table) names.push_back(entry.first);
  return names;
}

template <typename Value>
Value value_of(const std::vector<std::pair<std::string, Value>>& table, const std::string& name) {
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const auto& entry) { return entry.first == name; });
  return found == table.end() ? table.front().second : found->second;
}

Error usage_error(std::string message, std::string cure = "see goldthread --help") {
  return Error{ErrorCode::kUsage, std::move(message), "", "", std::move(cure)};
}

/// `--sun` may stand alone or before a number. Giving a lone one its number here keeps it from taking the
/// argument that follows it.
void complete_sun(std::vector<std::string>& arguments) {
  for (size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] != "--sun") continue;
    if (i + 1 < arguments.size() && is_number(arguments[i + 1])) continue;
    arguments[i] = fmt::format("--sun={}", BakeOptions::Sun{}.illuminance);
  }
}

/// An Error when the first argument should be a verb and is none; CLI11 would only say that one is required.
Status check_verb(const CLI::App& app, const std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments[0].empty() || arguments[0][0] == '-') return Nothing{};
  const auto is_it = [&](const CLI::App* verb) { return verb->get_name() == arguments[0]; };
  if (!app.get_subcommands(is_it).empty()) return Nothing{};
  return usage_error("there is no verb '" + arguments[0] + "'", "choose make, info, bake or formfactors");
}

void add_make(CLI::App& app, MakeCommand& make) {
  std::string scenes = "one of:";
  for (const auto& [name, sentence] : scene_names()) scenes += fmt::format("\n{:<14}{}", name, sentence);
  CLI::App* verb = app.add_subcommand("make", "write a procedural scene");
  verb->add_option("NAME", make.options.name, scenes)->required();
  verb->add_option("-o", make.options.output, "the file, .glb or .gltf (NAME.glb)")->type_name("FILE");
  verb->add_option("--triangles", make.options.triangles, "about how many triangles (the scene's own number)")
      ->type_name("N");
  verb->add_flag("--quiet", make.quiet, "print nothing but errors");
  verb->footer(kMakeExamples);
}

void add_info(CLI::App& app, InfoCommand& info) {
  CLI::App* verb = app.add_subcommand("info", "tell what is in a scene and what is wrong with it");
  verb->add_option("SCENE", info.input, "glTF, GLB, OBJ, PLY, STL, FBX or Collada")->required();
  verb->add_option("--json,--report", info.json_file, "write JSON to FILE, - for standard output")
      ->type_name("FILE");
}

/// Texts of options that become values after parsing.
struct BakeTexts {
  std::string quality = "medium", mode = "vertex-light", memory, sky, picture;
  double time_limit = 0;
  BakeOptions::Sun sun;
};

void add_bake_light(CLI::App& verb, BakeTexts& texts) {
  const auto group = "Light that is not in the scene";
  verb.add_option("--sky", texts.sky, "even sky: luminance in nits, one number or R,G,B; or 10000lux")
      ->type_name("NITS")
      ->group(group);
  verb.add_option("--sun", texts.sun.illuminance, "sun: illuminance in lux facing it (100000)")
      ->type_name("[LUX]")
      ->check(CLI::Range(0.0, 1e9).description(""))
      ->group(group);
  verb.add_option("--sun-elevation", texts.sun.elevation, "degrees above the horizon (45)")
      ->type_name("DEG")
      ->check(CLI::Range(-90.0, 90.0).description(""))
      ->group(group);
  verb.add_option("--sun-azimuth", texts.sun.azimuth, "degrees: 0 is -Z, 90 is +X (135)")
      ->type_name("DEG")
      ->check(CLI::Range(-360.0, 360.0).description(""))
      ->group(group);
}

void add_bake_output(CLI::App& verb, BakeOptions& options, BakeTexts& texts) {
  const auto group = "Results";
  verb.add_option("-o", options.outputs,
                  "result, more than once: .glb .gltf scene, .gold solution, .png .exr picture")
      ->allow_extra_args(false)
      ->type_name("FILE")
      ->group(group);
  verb.add_option("--output", texts.mode, "how the scene carries light: vertex-light or unlit (vertex-light)")
      ->type_name("MODE")
      ->check(CLI::IsMember(names_of(kOutputModes)).description(""))
      ->group(group);
  verb.add_option("--exposure", options.exposure, "multiplies light before tone mapping, 0 chooses (0)")
      ->type_name("X")
      ->check(CLI::Range(0.0, 1e12).description(""))
      ->group(group);
  verb.add_option("--picture-size", texts.picture, "pixels, as 960x540 or 960 (960)")
      ->type_name("WxH")
      ->group(group);
  verb.add_option("--report", options.report_file, "write the report as JSON")
      ->type_name("FILE")
      ->group(group);
}

void add_bake_effort(CLI::App& verb, BakeCommand& bake, BakeTexts& texts) {
  const auto group = "Effort";
  verb.add_option("--quality", texts.quality, "draft, medium, high or final (medium)")
      ->type_name("Q")
      ->check(CLI::IsMember(names_of(kQualities)).description(""))
      ->group(group);
  verb.add_option("--time-limit", texts.time_limit, "stop after so many seconds with what there is")
      ->type_name("SECONDS")
      ->check(CLI::PositiveNumber.description(""))
      ->group(group);
  verb.add_option("--max-memory", texts.memory, "stay within, as 2G or 500M")
      ->type_name("BYTES")
      ->group(group);
  verb.add_option("--threads", bake.options.threads, "0 for all (0)")
      ->type_name("N")
      ->check(CLI::Range(0, 4096).description(""))
      ->group(group);
  verb.add_option("--seed", bake.options.seed, "another choice of random samples (0)")
      ->type_name("N")
      ->group(group);
  verb.add_flag("--fix-normals", bake.options.fix_normals, "turn shells that are wound inside out")
      ->group(group);
  verb.add_flag("--quiet", bake.quiet, "print nothing but errors")->group(group);
}

/// Moves what was parsed as text into `options`.
Status finish_bake(const CLI::App& verb, const BakeTexts& texts, BakeOptions& options) {
  if (options.outputs.empty()) return usage_error("bake has nothing to write", "add -o lit.glb");
  options.quality = value_of(kQualities, texts.quality);
  options.mode = value_of(kOutputModes, texts.mode);
  if (verb.count("--time-limit") > 0) options.time_limit = texts.time_limit;
  if (verb.count("--max-memory") > 0) {
    options.max_memory = parse_bytes(texts.memory);
    if (!options.max_memory)
      return usage_error("--max-memory: '" + texts.memory + "' is no size", "write 2G, 500M or bytes");
  }
  if (verb.count("--sky") > 0) {
    options.sky = parse_sky(texts.sky);
    if (!options.sky) {
      return usage_error("--sky: '" + texts.sky + "' is no luminance",
                         "write nits as 2000 or 2000,2200,2600, or lux as 10000lux");
    }
  }
  if (verb.count("--sun") > 0) options.sun = texts.sun;
  if (!options.sun && (verb.count("--sun-elevation") > 0 || verb.count("--sun-azimuth") > 0))
    return usage_error("the sun has a place but does not shine", "add --sun");
  if (verb.count("--picture-size") > 0) {
    const auto size = parse_picture_size(texts.picture);
    if (!size)
      return usage_error("--picture-size: '" + texts.picture + "' is no size", "write 960x540 or 960");
    options.picture_width = size->width;
    options.picture_height = size->height;
  }
  return Nothing{};
}

}  // namespace

Result<Command> parse_arguments(std::vector<std::string> arguments) {
  CLI::App app("goldthread: radiosity for glTF. A scene file in, the same scene out with its light baked in.",
               "goldthread");
  app.footer(kExamples);
  app.set_version_flag("--version", "goldthread " GOLDTHREAD_VERSION);
  app.require_subcommand(1);

  MakeCommand make;
  InfoCommand info;
  BakeCommand bake;
  BakeTexts texts;
  add_make(app, make);
  add_info(app, info);
  CLI::App* bake_verb = app.add_subcommand("bake", "light a scene");
  bake_verb->add_option("SCENE", bake.options.input, "glTF, GLB, OBJ, PLY, STL, FBX or Collada")->required();
  add_bake_output(*bake_verb, bake.options, texts);
  add_bake_effort(*bake_verb, bake, texts);
  add_bake_light(*bake_verb, texts);
  bake_verb->footer(kBakeExamples);
  FormFactorCommand form_factors;
  add_form_factors(app, form_factors);

  if (const Status status = check_verb(app, arguments); !status) return status.error();
  complete_sun(arguments);
  std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
  try {
    app.parse(arguments);
  } catch (const CLI::CallForHelp&) {
    return Command(ShowText{app.help()});
  } catch (const CLI::CallForVersion&) {
    return Command(ShowText{"goldthread " GOLDTHREAD_VERSION "\n"});
  } catch (const CLI::ParseError& error) {
    return usage_error(error.what());
  }
  if (app.got_subcommand("make")) {
    if (make.options.output.empty()) make.options.output = make.options.name + ".glb";
    return Command(make);
  }
  if (app.got_subcommand("info")) return Command(info);
  if (app.got_subcommand("formfactors")) {
    if (const Status status = finish_form_factors(app, form_factors); !status) return status.error();
    return Command(form_factors);
  }
  if (const Status status = finish_bake(*bake_verb, texts, bake.options); !status) return status.error();
  return Command(bake);
}

}  // namespace goldthread::cli
