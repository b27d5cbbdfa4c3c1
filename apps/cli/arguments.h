// From the command line to a command (docs of the contract: README.md, "Command line").
#pragma once
#include <string>
#include <variant>
#include <vector>

#include "compare_arguments.h"
#include "form_factor_arguments.h"
#include "goldthread/bake.h"
#include "goldthread/reference.h"

namespace goldthread::cli {

struct MakeCommand {
  MakeOptions options;
  bool quiet = false;
};

struct InfoCommand {
  std::string input;
  std::string json_file;  ///< "-" for standard output, empty for lines for a person
};

struct BakeCommand {
  BakeOptions options;
  bool quiet = false;
};

struct ReferenceCommand {
  ReferenceOptions options;
  bool quiet = false;
};

/// Something to print and be done: help or the version.
struct ShowText {
  std::string text;
};

using Command = std::variant<MakeCommand, InfoCommand, BakeCommand, ReferenceCommand, CompareCommand,
                             FormFactorCommand, ShowText>;

/// `arguments` without the program's name. Wrong usage is an Error with code kUsage.
Result<Command> parse_arguments(std::vector<std::string> arguments);

}  // namespace goldthread::cli
