#include "compare_arguments.h"

#include <CLI/CLI.hpp>

#include "values.h"

namespace goldthread::cli {
namespace {

constexpr const char* kVerb = "compare";
constexpr const char* kExamples =
    "Examples:\n"
    "  goldthread compare room.gold --reference --points 2000 --target-error 1%\n"
    "  goldthread compare room.gold --reference --seen --picture-size 128x128\n"
    "  goldthread compare room.gold --reference --texels --points 5000\n"
    "  goldthread compare draft.gold final.gold -o diff.png\n"
    "  goldthread compare mine.exr theirs.exr --json c.json";

}  // namespace

void add_compare(CLI::App& app, CompareCommand& command) {
  CompareOptions& options = command.options;
  CLI::App* verb = app.add_subcommand(kVerb, "tell how far two results are apart, or one from the truth");
  verb->add_option("A", options.first, ".gold solution, or .exr or .png picture")->required();
  verb->add_option("B", options.second, "what A is measured against: the same kind of file");
  verb->add_flag("--reference", options.reference, "measure A, a solution, against path tracing");
  verb->add_option("--points", options.points, "of solutions: random places on the lit surfaces (1000)")
      ->type_name("N")
      ->check(CLI::Range(uint64_t{1}, uint64_t{100000000}).description(""));
  verb->add_flag("--seen", options.seen,
                 "of solutions: instead, the places that the camera sees, one a pixel of --picture-size")
      ->excludes("--points");
  verb->add_flag("--light-maps", options.light_maps,
                 "of solutions baked with --output lightmap: read their light from the maps");
  verb->add_flag("--texels", options.texels,
                 "the same at --points texels of A's maps, each against the mean over what it covers")
      ->excludes("--seen");
  verb->add_option("--samples", command.samples, "of the reference: paths a point (1024)")
      ->type_name("N")
      ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 36).description(""));
  verb->add_option("--target-error", command.target_error,
                   "of the reference: stop at this mean of standard error over irradiance, as 0.01 or 1%")
      ->type_name("E");
  verb->add_option("--time-limit", command.time_limit, "of the reference: stop after so many seconds")
      ->type_name("SECONDS")
      ->check(CLI::PositiveNumber.description(""));
  verb->add_option("--json", options.json_file, "write the figures, - to print")->type_name("FILE");
  verb->add_option("--csv", options.csv_file, "write every point with both values as a line")
      ->type_name("FILE");
  verb->add_option("-o", options.picture, "a .png: grey where A is right, blue under, red over")
      ->type_name("FILE");
  verb->add_option("--full-scale", options.full_scale, "relative error that is all blue or red (0.2)")
      ->type_name("E")
      ->check(CLI::Range(1e-6, 1e6).description(""));
  verb->add_option("--picture-size", command.picture_size, "pixels, as 320x240 or 320 (320)")
      ->type_name("WxH");
  verb->add_option("--threads", options.threads, "0 for all (0)")
      ->type_name("N")
      ->check(CLI::Range(0, 4096).description(""));
  verb->add_option("--seed", options.seed, "another choice of random places and paths (0)")->type_name("N");
  verb->add_flag("--quiet", command.quiet, "print nothing but errors");
  verb->footer(kExamples);
}

Status finish_compare(const CLI::App& app, CompareCommand& command) {
  const CLI::App* verb = app.get_subcommand(kVerb);
  const auto usage = [](const std::string& message, const std::string& cure) {
    return Error{ErrorCode::kUsage, message, "", "", cure};
  };
  CompareOptions& options = command.options;
  if (!options.reference)
    for (const char* name : {"--samples", "--target-error", "--time-limit"})
      if (verb->count(name) > 0)
        return usage(std::string(name) + " is of the reference, and there is none", "add --reference");
  if (verb->count("--samples") > 0) options.samples = command.samples;
  if (verb->count("--time-limit") > 0) options.time_limit = command.time_limit;
  if (verb->count("--target-error") > 0) {
    options.target_error = parse_share(command.target_error);
    if (!options.target_error)
      return usage("--target-error: '" + command.target_error + "' is no share", "write 0.01 or 1%");
  }
  if (verb->count("--picture-size") > 0) {
    const auto size = parse_picture_size(command.picture_size);
    if (!size)
      return usage("--picture-size: '" + command.picture_size + "' is no size", "write 320x240 or 320");
    options.picture_width = size->width;
    options.picture_height = size->height;
  }
  return Nothing{};
}

}  // namespace goldthread::cli
