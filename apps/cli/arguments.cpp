#include "arguments.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <utility>

#include "light_arguments.h"
#include "values.h"

namespace goldthread::cli {
namespace {

constexpr const char* kExamples =
    "Examples:\n"
    "  goldthread make cornell-box -o box.glb\n"
    "  goldthread info box.glb\n"
    "  goldthread bake box.glb -o lit.glb -o lit.png\n"
    "  goldthread reference box.glb --points 1000 --json box.json\n"
    "\n"
    "Exit codes: 0 done, 2 wrong usage, 3 bad input, 4 nothing to bake, 5 out of memory or limit,\n"
    "6 could not write, 130 cancelled. 'goldthread VERB --help' tells a verb's options.";

constexpr const char* kBakeExamples =
    "Examples:\n"
    "  goldthread bake room.glb -o lit.glb -o lit.png --quality high\n"
    "  goldthread bake room.glb -o lit.glb --output unlit\n"
    "  goldthread bake room.glb -o lit.glb --output lightmap --page-size 2048\n"
    "  goldthread bake house.obj -o lit.glb --sky 10000lux --sun 80000 --sun-elevation 35\n"
    "  goldthread bake house.glb -o lit.glb --sky-model clear --place 59.3,18.1 --date 2026-06-21 --time "
    "15:00 \\\n"
    "    --time-zone 2 --sun\n"
    "  goldthread bake car.glb -o car.gold --time-limit 60 --max-memory 2G --report car.json";

constexpr const char* kReferenceExamples =
    "Examples:\n"
    "  goldthread reference room.glb --points 1000 --target-error 1% --json room.json\n"
    "  goldthread reference room.glb --resume room.json --samples 65536 --json room.json\n"
    "  goldthread reference room.glb --vertices --time-limit 600 --json vertices.json\n"
    "  goldthread reference room.glb --texels 256 --samples 4096 -o map.exr --json map.json\n"
    "  goldthread reference house.obj -o house.png --sky 10000lux --sun 80000 --samples 256";

constexpr const char* kMakeExamples =
    "Examples:\n"
    "  goldthread make office -o office.glb\n"
    "  goldthread make car --triangles 500000 -o car.glb";

const std::vector<std::pair<std::string, Quality>> kQualities = {{"draft", Quality::kDraft},
                                                                 {"medium", Quality::kMedium},
                                                                 {"high", Quality::kHigh},
                                                                 {"final", Quality::kFinal}};
const std::vector<std::pair<std::string, OutputMode>> kOutputModes = {
    {"vertex-light", OutputMode::kVertexLight},
    {"unlit", OutputMode::kUnlit},
    {"lightmap", OutputMode::kLightmap},
    {"baked", OutputMode::kBaked},
    {"occlusion", OutputMode::kOcclusion}};
const std::vector<std::pair<std::string, MapEncoding>> kMapEncodings = {
    {"float", MapEncoding::kFloat}, {"half", MapEncoding::kHalf}, {"rgbe", MapEncoding::kRgbe},
    {"rgbm", MapEncoding::kRgbm},   {"rgbd", MapEncoding::kRgbd}, {"srgb", MapEncoding::kSrgb}};

constexpr const char* kSceneFormats = "glTF, GLB, OBJ, PLY, STL, FBX or Collada";

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

/// An Error when the first argument should be a verb and is none; CLI11 would only say that one is required.
Status check_verb(const CLI::App& app, const std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments[0].empty() || arguments[0][0] == '-') return Nothing{};
  const auto is_it = [&](const CLI::App* verb) { return verb->get_name() == arguments[0]; };
  if (!app.get_subcommands(is_it).empty()) return Nothing{};
  return usage_error("there is no verb '" + arguments[0] + "'",
                     "choose make, info, bake, reference, compare or formfactors");
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
  verb->add_option("SCENE", info.input, kSceneFormats)->required();
  verb->add_option("--json,--report", info.json_file, "write JSON to FILE, - for standard output")
      ->type_name("FILE");
}

/// Texts of options that become values after parsing.
struct BakeTexts {
  std::string quality = "medium", mode = "vertex-light", memory, picture, error, encoding;
  double time_limit = 0;
  LightTexts light;
};
struct ReferenceTexts {
  std::string points, texels, target_error, picture;
  int uv = 0;
  uint64_t samples = 0, seed = 0;
  double time_limit = 0;
  LightTexts light;
};

constexpr const char* kResults = "Results";
constexpr const char* kEffort = "Effort";

void add_picture(CLI::App& verb, double& exposure, std::string& size, std::string& report_file) {
  verb.add_option("--exposure", exposure, "multiplies light before tone mapping, 0 chooses (0)")
      ->type_name("X")
      ->check(CLI::Range(0.0, 1e12).description(""))
      ->group(kResults);
  verb.add_option("--picture-size", size, "pixels, as 960x540 or 960 (960)")
      ->type_name("WxH")
      ->group(kResults);
  verb.add_option("--report", report_file, "write the report as JSON")->type_name("FILE")->group(kResults);
}

void add_run(CLI::App& verb, double& time_limit, int& threads, bool& quiet) {
  verb.add_option("--time-limit", time_limit, "stop after so many seconds with what there is")
      ->type_name("SECONDS")
      ->check(CLI::PositiveNumber.description(""))
      ->group(kEffort);
  verb.add_option("--threads", threads, "0 for all (0)")
      ->type_name("N")
      ->check(CLI::Range(0, 4096).description(""))
      ->group(kEffort);
  verb.add_flag("--quiet", quiet, "print nothing but errors")->group(kEffort);
}

void add_bake_output(CLI::App& verb, BakeOptions& options, BakeTexts& texts) {
  verb.add_option("-o", options.outputs,
                  "result, more than once: .glb .gltf scene, .gold solution, .png .exr picture")
      ->allow_extra_args(false)
      ->type_name("FILE")
      ->group(kResults);
  verb.add_option("--points", options.points_file,
                  "also tell the light at the places of a JSON list of {point, normal}")
      ->type_name("FILE")
      ->group(kResults);
  verb.add_option("--json", options.json_file, "where to: a file, - to print")
      ->type_name("FILE")
      ->group(kResults);
  verb.add_option(
          "--output", texts.mode,
          "how the scene carries light: vertex-light, unlit, lightmap, baked or occlusion\n(vertex-light)")
      ->type_name("MODE")
      ->check(CLI::IsMember(names_of(kOutputModes)).description(""))
      ->group(kResults);
  add_picture(verb, options.exposure, texts.picture, options.report_file);
}

constexpr const char* kLightmapNames[] = {"--page-size",     "--pages",     "--padding",
                                          "--texel-density", "--map-files", "--map-encoding"};

void add_lightmap(CLI::App& verb, LightmapOptions& options, std::string& encoding) {
  const auto group = "Light maps (--output lightmap, baked or occlusion)";
  verb.add_option("--page-size", options.page_size, "texels aside (1024)")->type_name("N")->group(group);
  verb.add_option("--pages", options.pages, "how many pages at most (1)")->type_name("N")->group(group);
  verb.add_option("--padding", options.padding, "free texels between charts (2)")
      ->type_name("N")
      ->group(group);
  verb.add_option("--texel-density", options.texel_density,
                  "texels a metre, fewer where the pages cannot hold them (what they hold)")
      ->type_name("X")
      ->group(group);
  verb.add_option(
          "--map-files", options.files,
          "pages as files besides, in lux, .exr, .hdr or .png: room.exr stands for\nroom-0.exr, room-1.exr "
          "... and room.json, which lists them")
      ->type_name("FILE")
      ->group(group);
  verb.add_option(
          "--map-encoding", encoding,
          "of these: float or half (.exr), rgbe (.hdr), rgbm, rgbd, rgbe or srgb (.png);\nthe first is "
          "what each has if nothing is said")
      ->type_name("E")
      ->check(CLI::IsMember(names_of(kMapEncodings)).description(""))
      ->group(group);
}

void add_bake_effort(CLI::App& verb, BakeCommand& bake, BakeTexts& texts) {
  verb.add_option("--quality", texts.quality, "draft, medium, high or final (medium)")
      ->type_name("Q")
      ->check(CLI::IsMember(names_of(kQualities)).description(""))
      ->group(kEffort);
  verb.add_option("--error", texts.error,
                  "RMS error of the light to aim at, as 2%, instead of --quality (15, 6, 3 and 1.5%)")
      ->type_name("E")
      ->excludes("--quality")
      ->group(kEffort);
  add_run(verb, texts.time_limit, bake.options.threads, bake.quiet);
  verb.add_option("--max-memory", texts.memory, "stay within, as 2G or 500M")
      ->type_name("BYTES")
      ->group(kEffort);
  const auto without = [&](const char* name, bool& uses, const char* what) {
    verb.add_flag_callback(
            name, [&uses] { uses = false; }, what)
        ->group(kEffort);
  };
  without("--no-discontinuities", bake.options.discontinuities,
          "cut surfaces regularly, not along the edges of shadows and the feet of what stands on them");
  without("--no-shafts", bake.options.shafts, "cast rays where nothing stands between two elements, too");
  without("--no-adaptive-sampling", bake.options.adaptive_sampling,
          "cast as many rays for every link and point");
  verb.add_option("--seed", bake.options.seed, "another choice of random samples (0)")
      ->type_name("N")
      ->group(kEffort);
  verb.add_flag("--fix-normals", bake.options.fix_normals, "turn shells that are wound inside out")
      ->group(kEffort);
}

void add_reference(CLI::App& app, ReferenceCommand& reference, ReferenceTexts& texts) {
  ReferenceOptions& options = reference.options;
  CLI::App* verb = app.add_subcommand("reference", "measure light by unbiased path tracing");
  verb->add_option("SCENE", options.input, kSceneFormats)->required();
  const auto group = "What to measure";
  verb->add_option("--points", texts.points,
                   "irradiance at N random points, or at those of a JSON list of {point, normal}")
      ->type_name("N|FILE")
      ->group(group);
  verb->add_flag("--vertices", options.vertices, "irradiance at all vertices")->group(group);
  verb->add_option("--texels", texts.texels,
                   "irradiance at the texels of a light map for each lit primitive of each\n"
                   "instance, by its texture coordinates; SIZE as 256 or 256x128")
      ->type_name("SIZE")
      ->group(group);
  verb->add_option("--uv", texts.uv, "TEXCOORD_0 or _1 for --texels (1 where there is one, else 0)")
      ->type_name("0|1")
      ->check(CLI::Range(0, 1).description(""))
      ->group(group);
  verb->add_option("--resume", options.resume_file,
                   "more samples for the points or texels of an earlier --json FILE,\nor with -o for the "
                   "pixels of an earlier -o FILE.exr")
      ->type_name("FILE")
      ->group(group);
  verb->add_option("-o", options.pictures,
                   "a picture, .png or .exr; more than once. With --texels irradiance in lux, .exr;\n"
                   "of several primitives map-INSTANCE-PRIMITIVE.exr for each, from 0, and -back\n"
                   "for a two-sided one's back. A, samples, error: covered or not, of each texel")
      ->allow_extra_args(false)
      ->type_name("FILE")
      ->group(group);
  verb->add_option("--json", options.json_file, "write points, irradiance and standard errors, - to print")
      ->type_name("FILE")
      ->group(kResults);
  add_picture(*verb, options.exposure, texts.picture, options.report_file);
  verb->add_option("--samples", texts.samples, "stop after so many a point or pixel (1024 or 64)")
      ->type_name("N")
      ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 36).description(""))
      ->group(kEffort);
  verb->add_option("--target-error", texts.target_error,
                   "stop at this mean of standard error over irradiance, as 0.01 or 1%")
      ->type_name("E")
      ->group(kEffort);
  add_run(*verb, texts.time_limit, options.threads, reference.quiet);
  verb->add_option("--seed", texts.seed, "another choice of random samples (0)")
      ->type_name("N")
      ->group(kEffort);
  add_light(*verb, texts.light);
  verb->footer(kReferenceExamples);
}

Status finish_picture(const CLI::App& verb, const std::string& text, int& width, int& height) {
  if (verb.count("--picture-size") == 0) return Nothing{};
  const auto size = parse_picture_size(text);
  if (!size) return usage_error("--picture-size: '" + text + "' is no size", "write 960x540 or 960");
  width = size->width;
  height = size->height;
  return Nothing{};
}

/// Moves what was parsed as text into `options`.
Status finish_bake(const CLI::App& verb, const BakeTexts& texts, BakeOptions& options) {
  if (options.points_file.empty() != options.json_file.empty())
    return usage_error("bake needs both or neither of --points and --json",
                       "write --points places.json --json light.json");
  if (options.outputs.empty() && options.points_file.empty() && options.lightmap.files.empty())
    return usage_error("bake has nothing to write", "add -o lit.glb");
  options.quality = value_of(kQualities, texts.quality);
  if (verb.count("--error") > 0) {
    options.error = parse_share(texts.error);
    if (!options.error) return usage_error("--error: '" + texts.error + "' is no share", "write 0.02 or 2%");
  }
  options.mode = value_of(kOutputModes, texts.mode);
  if (options.mode == OutputMode::kVertexLight || options.mode == OutputMode::kUnlit)
    for (const char* name : kLightmapNames)
      if (verb.count(name) > 0)
        return usage_error(fmt::format("{} is about light maps, and none are asked for", name),
                           "add --output lightmap, baked or occlusion");
  if (verb.count("--map-encoding") > 0) {
    if (options.lightmap.files.empty())
      return usage_error("--map-encoding is about --map-files, and there are none",
                         "add --map-files maps.exr");
    options.lightmap.encoding = value_of(kMapEncodings, texts.encoding);
  }
  if (verb.count("--time-limit") > 0) options.time_limit = texts.time_limit;
  if (verb.count("--max-memory") > 0) {
    options.max_memory = parse_bytes(texts.memory);
    if (!options.max_memory)
      return usage_error("--max-memory: '" + texts.memory + "' is no size", "write 2G, 500M or bytes");
  }
  if (Status status = finish_light(verb, texts.light, options); !status) return status;
  return finish_picture(verb, texts.picture, options.picture_width, options.picture_height);
}

/// `--points` is a number of points where it is one, else the name of a file.
Status finish_points(const std::string& text, ReferenceOptions& options) {
  if (!is_number(text)) {
    options.points_file = text;
    return Nothing{};
  }
  const auto count = parse_count(text);
  if (!count || *count > 100'000'000)
    return usage_error("--points: '" + text + "' is no number of points", "write 1 to 100000000, or a file");
  options.random_points = *count;
  return Nothing{};
}

Status finish_texels(const CLI::App& verb, const ReferenceTexts& texts, ReferenceOptions& options) {
  if (verb.count("--texels") == 0)
    return verb.count("--uv") == 0
               ? Status(Nothing{})
               : usage_error("--uv says where --texels lie, and there are none", "add --texels 256");
  const auto size = parse_picture_size(texts.texels);
  if (!size) return usage_error("--texels: '" + texts.texels + "' is no size", "write 256 or 256x128");
  options.texels = {size->width, size->height > 0 ? size->height : size->width, std::nullopt};
  if (verb.count("--uv") > 0) options.texels->uv = texts.uv;
  return Nothing{};
}

Status finish_reference(const CLI::App& verb, const ReferenceTexts& texts, ReferenceOptions& options) {
  if (verb.count("--points") > 0)
    if (Status status = finish_points(texts.points, options); !status) return status;
  if (Status status = finish_texels(verb, texts, options); !status) return status;
  if (verb.count("--samples") > 0) options.samples = texts.samples;
  if (verb.count("--time-limit") > 0) options.time_limit = texts.time_limit;
  if (verb.count("--seed") > 0) options.seed = texts.seed;
  if (verb.count("--target-error") > 0) {
    options.target_error = parse_share(texts.target_error);
    if (!options.target_error)
      return usage_error("--target-error: '" + texts.target_error + "' is no share", "write 0.01 or 1%");
  }
  if (Status status = finish_light(verb, texts.light, options); !status) return status;
  return finish_picture(verb, texts.picture, options.picture_width, options.picture_height);
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
  bake_verb->add_option("SCENE", bake.options.input, kSceneFormats)->required();
  add_bake_output(*bake_verb, bake.options, texts);
  add_lightmap(*bake_verb, bake.options.lightmap, texts.encoding);
  add_bake_effort(*bake_verb, bake, texts);
  add_light(*bake_verb, texts.light);
  bake_verb->footer(kBakeExamples);
  FormFactorCommand form_factors;
  add_form_factors(app, form_factors);
  CompareCommand compare;
  add_compare(app, compare);
  ReferenceCommand reference;
  ReferenceTexts reference_texts;
  add_reference(app, reference, reference_texts);

  if (const Status status = check_verb(app, arguments); !status) return status.error();
  const bool lone_sun = complete_sun(arguments);
  texts.light.lone_sun = reference_texts.light.lone_sun = lone_sun;
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
  if (app.got_subcommand("compare")) {
    if (const Status status = finish_compare(app, compare); !status) return status.error();
    return Command(compare);
  }
  if (app.got_subcommand("bake")) {
    if (const Status status = finish_bake(*bake_verb, texts, bake.options); !status) return status.error();
    return Command(bake);
  }
  const Status status =
      finish_reference(*app.get_subcommand("reference"), reference_texts, reference.options);
  if (!status) return status.error();
  return Command(reference);
}

}  // namespace goldthread::cli
