// The options of `goldthread compare`.
#pragma once
#include <string>

#include "goldthread/compare.h"

namespace CLI {  // NOLINT(readability-identifier-naming): the name is the library's
class App;
}

namespace goldthread::cli {

struct CompareCommand {
  CompareOptions options;
  bool quiet = false;
  std::string target_error, picture_size;  ///< texts that become options after parsing
  uint64_t samples = 0;
  double time_limit = 0;
};

void add_compare(CLI::App& app, CompareCommand& command);
/// Moves what was parsed as text into the options.
Status finish_compare(const CLI::App& app, CompareCommand& command);

}  // namespace goldthread::cli
