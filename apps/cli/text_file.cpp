#include "text_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace goldthread::cli {
namespace {

Error write_error(const std::string& file) {
  return Error{ErrorCode::kCannotWrite, std::string("cannot write: ") + std::strerror(errno), file, "",
               "choose a folder that exists, may be written and has room"};
}

}  // namespace

Status write_text(const std::string& file, const std::string& text) {
  if (file == "-") {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
      return write_error("standard output");
    return Nothing{};
  }
  const std::string temporary = file + ".tmp" + std::to_string(getpid());
  std::FILE* out = std::fopen(temporary.c_str(), "wb");
  if (!out) return write_error(file);
  bool written = std::fwrite(text.data(), 1, text.size(), out) == text.size();
  written = std::fclose(out) == 0 && written;
  if (written && std::rename(temporary.c_str(), file.c_str()) == 0) return Nothing{};
  const Error error = write_error(file);
  std::remove(temporary.c_str());
  return error;
}

}  // namespace goldthread::cli
