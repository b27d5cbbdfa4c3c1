#include "session/reference_options.h"

#include <fmt/format.h>

#include <utility>

#include "files/atomic_file.h"
#include "files/file_name.h"
#include "trace/texel_receivers.h"

namespace goldthread {
namespace {

// Known before hours are spent on what cannot be kept.
Status check_outputs(const ReferenceOptions& options) {
  for (const std::string& file : options.pictures) {
    const std::string extension = file_extension(file);
    if (!paints(options) && extension != ".exr")
      return Error{ErrorCode::kUsage, "light maps are .exr", file, {}, "end it in .exr"};
    if (extension != ".png" && extension != ".exr")
      return Error{ErrorCode::kUsage, "cannot tell the picture's format", file, {}, "end it in .png or .exr"};
    if (const auto probe = AtomicFile::create(file); !probe) return probe.error();
  }
  for (const std::string& file : {options.json_file, options.report_file})
    if (!file.empty() && file != "-")
      if (const auto probe = AtomicFile::create(file); !probe) return probe.error();
  return Nothing{};
}

}  // namespace

bool resumes_picture(const ReferenceOptions& options) {
  return file_extension(options.resume_file) == ".exr";
}

bool resumes_points(const ReferenceOptions& options) {
  return !options.resume_file.empty() && !resumes_picture(options);
}

bool paints(const ReferenceOptions& options) {
  return !options.pictures.empty() && !options.texels && !resumes_points(options);
}

Error usage_error(std::string message, std::string cure) {
  return Error{ErrorCode::kUsage, std::move(message), {}, {}, std::move(cure)};
}

Status check_reference_options(const ReferenceOptions& options) {
  const int wishes = int(!options.points_file.empty()) + int(options.random_points > 0) +
                     int(options.vertices) + int(options.texels.has_value()) + int(resumes_points(options)) +
                     int(paints(options));
  if (resumes_picture(options) && options.pictures.empty())
    return usage_error("--resume goes on with a picture, and none is asked for",
                       "add -o " + options.resume_file);
  if (wishes == 0)
    return usage_error(
        "nothing to measure",
        "add --points 1000, --points FILE.json, --vertices, --texels 256, --resume FILE.json or -o x.png");
  if (wishes > 1)
    return usage_error("--points, --vertices, --texels, --resume and -o each say what to measure",
                       "give one of them, or -o with --texels");
  if (paints(options) && !options.json_file.empty())
    return usage_error("--json is for points; a picture has none", "leave --json out, or use --report");
  if (options.texels && resumes_picture(options))
    return usage_error("--resume: light maps are gone on with from their --json file, not from an .exr",
                       "give that file, without --texels");
  if (const auto& texels = options.texels) {
    const auto fits = [](int side) { return side >= 1 && side <= static_cast<int>(kMostTexelsAside); };
    if (!fits(texels->width) || !fits(texels->height) || texels->uv.value_or(0) < 0 ||
        texels->uv.value_or(0) > 1)
      return usage_error(
          fmt::format("--texels: there are 1 to {} texels a side, and --uv 0 and 1", kMostTexelsAside),
          "write --texels 256x128 --uv 1");
  }
  return check_outputs(options);
}

}  // namespace goldthread
