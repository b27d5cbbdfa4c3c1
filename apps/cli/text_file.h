// A small text file, written whole or not at all.
#pragma once
#include <string>

#include "goldthread/error.h"

namespace goldthread::cli {

/// Written under a temporary name beside it and renamed; "-" is standard output.
Status write_text(const std::string& file, const std::string& text);

}  // namespace goldthread::cli
