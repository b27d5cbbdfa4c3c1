#include "text_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace goldthread::cli {
namespace {

Error write_error(const std::string& file) {
  return Error{ErrorCode::kCannotWrite, std::string("cannot write: ") + std::strerror(errno), file, "",
               "choose a folder that exists, may be written and has room"};
}

/// Whether `out` took all of `text`; closes it.
bool put(std::FILE* out, const std::string& text) {
  const bool taken = std::fwrite(text.data(), 1, text.size(), out) == text.size();
  return std::fclose(out) == 0 && taken;
}

}  // namespace

Status write_text(const std::string& file, const std::string& text) {
  if (file == "-") {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
      return write_error("standard output");
    return Nothing{};
  }
  // A device or a pipe cannot be replaced; a link stays one.
  std::error_code none;
  const bool in_place = std::filesystem::exists(file, none) && !std::filesystem::is_regular_file(file, none);
  const std::filesystem::path resolved = std::filesystem::weakly_canonical(file, none);
  const std::string target = none || in_place ? file : resolved.string();
  const std::string temporary = in_place ? target : target + ".tmp" + std::to_string(getpid());
  std::FILE* out = std::fopen(temporary.c_str(), "wb");
  if (!out) return write_error(file);
  if (put(out, text) && (in_place || std::rename(temporary.c_str(), target.c_str()) == 0)) return Nothing{};
  const Error error = write_error(file);
  if (!in_place) std::remove(temporary.c_str());
  return error;
}

}  // namespace goldthread::cli
