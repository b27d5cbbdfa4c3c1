#include "form_factor_arguments.h"

#include <CLI/CLI.hpp>
#include <map>

#include "values.h"

namespace goldthread::cli {
namespace {

constexpr const char* kVerb = "formfactors";
constexpr const char* kExamples =
    "Examples:\n"
    "  goldthread formfactors room.vs3\n"
    "  goldthread formfactors cases.json --case plate-1 --tolerance 1e-7\n"
    "  goldthread formfactors hall.json --method rays --npz hall.npz --enforce-closure";

using Method = FormFactorOptions::Method;
const std::map<std::string, Method> kMethods = {{"auto", Method::kAuto},
                                                {"exact", Method::kExact},
                                                {"rays", Method::kRays},
                                                {"hemicube", Method::kHemicube},
                                                {"cubic-tetrahedron", Method::kCubicTetrahedron},
                                                {"single-plane", Method::kSinglePlane}};

}  // namespace

void add_form_factors(CLI::App& app, FormFactorCommand& command) {
  FormFactorOptions& options = command.options;
  CLI::App* verb = app.add_subcommand(kVerb, "form factors of pairs of shapes and of whole models");
  verb->add_option("CASES", options.input, "pairs or models as .json, or View3D's .vs3")->required();
  verb->add_option("--case", options.only, "only the case of this id")->type_name("ID");
  verb->add_option(
          "--method", command.method,
          "of models: exact, rays, hemicube, cubic-tetrahedron, single-plane, or auto: exact for up to 100 "
          "polygons, else rays (auto)")
      ->type_name("M")
      ->check(CLI::IsMember(kMethods).description(""));
  verb->add_option("--tolerance", command.tolerance,
                   "relative, where something stands between (1e-5 for pairs, 1e-4 in models; of pairs with\n"
                   "curved shapes two standard errors, 1e-4, by at most sixteen million rays)")
      ->type_name("E")
      ->check(CLI::Range(1e-12, 0.5).description(""));
  verb->add_option("--rays", options.rays, "a pair, with --method rays, 1 to 64 (16)")
      ->type_name("N")
      ->check(CLI::Range(1, 64).description(""));
  verb->add_option("--resolution", options.resolution, "cells along a hemicube and its kin (64)")
      ->type_name("N")
      ->check(CLI::Range(1, 4096).description(""));
  verb->add_option("--samples", options.samples_across, "rays across each of these cells, 1 to 16 (2)")
      ->type_name("K")
      ->check(CLI::Range(1, 16).description(""));
  verb->add_flag("--enforce-reciprocity", options.enforce_reciprocity,
                 "A1 F12 = A2 F21 for hemicubes and their kin, by the mean; the others do so by themselves");
  verb->add_flag("--enforce-closure", options.enforce_closure,
                 "scale until every row and its surroundings sum to one");
  verb->add_option("--json", options.json_file, "write pairs, row sums and errors as JSON")
      ->type_name("FILE");
  verb->add_option("--text", options.text_file, "write one line a form factor")->type_name("FILE");
  verb->add_option("--npz", options.npz_file, "write one model's matrix for scipy.sparse.load_npz")
      ->type_name("FILE");
  verb->add_option("--max-memory", command.memory, "stay within, as 2G or 500M")->type_name("BYTES");
  verb->add_option("--threads", options.threads, "0 for all (0)")
      ->type_name("N")
      ->check(CLI::Range(0, 4096).description(""));
  verb->add_option("--seed", options.seed, "another choice of random samples (0)")->type_name("N");
  verb->add_flag("--quiet", command.quiet, "print nothing but errors");
  verb->footer(kExamples);
}

Status finish_form_factors(const CLI::App& app, FormFactorCommand& command) {
  const CLI::App* verb = app.get_subcommand(kVerb);
  command.options.method = kMethods.at(command.method);
  if (verb->count("--tolerance") > 0) command.options.tolerance = command.tolerance;
  if (verb->count("--max-memory") > 0) {
    command.options.max_memory = parse_bytes(command.memory);
    if (!command.options.max_memory)
      return Error{ErrorCode::kUsage, "--max-memory: '" + command.memory + "' is no size", "", "",
                   "write 2G, 500M or bytes"};
  }
  return Nothing{};
}

}  // namespace goldthread::cli
