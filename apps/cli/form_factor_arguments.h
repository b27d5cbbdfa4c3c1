// The options of `goldthread formfactors`.
#pragma once
#include <string>

#include "goldthread/form_factors.h"

namespace CLI {  // NOLINT(readability-identifier-naming): the name is the library's
class App;
}

namespace goldthread::cli {

struct FormFactorCommand {
  FormFactorOptions options;
  bool quiet = false;
  std::string method = "auto", memory;  ///< texts that become options after parsing
  double tolerance = 0;
};

void add_form_factors(CLI::App& app, FormFactorCommand& command);
/// Moves what was parsed as text into the options.
Status finish_form_factors(const CLI::App& app, FormFactorCommand& command);

}  // namespace goldthread::cli
