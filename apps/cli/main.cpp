// The program `goldthread`: parse, call, print.
#include <fmt/format.h>

#include <new>
#include <string>

#include "arguments.h"
#include "goldthread/bake.h"
#include "goldthread/reference.h"
#include "interrupt.h"
#include "progress_line.h"
#include "text_file.h"

namespace goldthread::cli {
namespace {

int fail(const Error& error) {
  fmt::print(stderr, "goldthread: {}\n", error.line());
  return static_cast<int>(error.code);
}

/// Prints what was asked for; exit code 0 unless standard output is broken.
int print_out(const std::string& text) {
  const Status status = write_text("-", text);
  return status ? 0 : fail(status.error());
}

int run(const ShowText& command) {
  return print_out(command.text);
}

int run(const MakeCommand& command) {
  const Result<uint64_t> triangles = make_scene(command.options);
  if (!triangles) return fail(triangles.error());
  if (command.quiet) return 0;
  return print_out(fmt::format("wrote {}: {} triangles\n", command.options.output, *triangles));
}

int run(const InfoCommand& command) {
  const Result<SceneInfo> info = inspect(command.input);
  if (!info) return fail(info.error());
  if (command.json_file.empty()) return print_out(info->text);
  const Status status = write_text(command.json_file, info->json + "\n");
  return status ? 0 : fail(status.error());
}

template <typename AnyResult>
std::string result_lines(const AnyResult& result) {
  std::string text = result.summary;
  if (!text.empty() && text.back() != '\n') text += '\n';
  for (const std::string& file : result.written) text += "wrote " + file + "\n";
  return text;
}

/// Says what a long run has done; returns its exit code.
template <typename AnyResult>
int tell(const AnyResult& result, bool quiet, const std::string& printed = {}) {
  int code = 0;
  if (!quiet)
    for (const std::string& warning : result.warnings)
      fmt::print(stderr, "goldthread: warning: {}\n", warning);
  if (!printed.empty())
    code = print_out(printed);
  else if (!quiet)
    code = print_out(result_lines(result));
  return result.cancelled ? static_cast<int>(ErrorCode::kCancelled) : code;
}

BakeListener listener_for(ProgressLine& progress) {
  BakeListener listener;
  listener.on_progress = [&](const BakeEvent& event) { progress.show(event); };
  listener.cancelled = interrupted;
  return listener;
}

int run(const BakeCommand& command) {
  catch_interrupts();
  ProgressLine progress(command.quiet);
  const Result<BakeResult> result = bake(command.options, listener_for(progress));
  progress.clear();
  if (!result) return fail(result.error());
  return tell(*result, command.quiet, command.options.json_file == "-" ? result->points_json : std::string());
}

int run(const ReferenceCommand& command) {
  catch_interrupts();
  ProgressLine progress(command.quiet);
  const Result<ReferenceResult> result = reference(command.options, listener_for(progress));
  progress.clear();
  if (!result) return fail(result.error());
  return tell(*result, command.quiet, command.options.json_file == "-" ? result->json : std::string());
}

int run(const CompareCommand& command) {
  catch_interrupts();
  ProgressLine progress(command.quiet);
  const Result<CompareResult> result = compare(command.options, listener_for(progress));
  progress.clear();
  if (!result) return fail(result.error());
  return tell(*result, command.quiet, command.options.json_file == "-" ? result->json : std::string());
}

int run(const FormFactorCommand& command) {
  catch_interrupts();
  ProgressLine progress(command.quiet);
  BakeListener listener;
  listener.on_progress = [&](const BakeEvent& event) { progress.show(event); };
  listener.cancelled = interrupted;
  const Result<FormFactorResult> result = form_factors(command.options, listener);
  progress.clear();
  if (!result) return fail(result.error());
  if (command.quiet) return 0;
  for (const std::string& warning : result->warnings)
    fmt::print(stderr, "goldthread: warning: {}\n", warning);
  std::string text = result->text;
  for (const std::string& file : result->written) text += "wrote " + file + "\n";
  return print_out(text);
}

int run_program(int count, char** values) {
  const Result<Command> command =
      parse_arguments(std::vector<std::string>(values + (count > 0), values + count));
  if (!command) return fail(command.error());
  return std::visit([](const auto& verb) { return run(verb); }, *command);
}

}  // namespace
}  // namespace goldthread::cli

int main(int count, char** values) {
  using goldthread::Error;
  using goldthread::ErrorCode;
  try {
    return goldthread::cli::run_program(count, values);
  } catch (const std::bad_alloc&) {
    return goldthread::cli::fail(
        Error{ErrorCode::kLimit, "out of memory", "", "", "free some, or lower --quality or --max-memory"});
  } catch (const std::exception& error) {  // a library's surprise: still one line and no crash
    return goldthread::cli::fail(Error{ErrorCode::kBadInput, error.what(), "", "", ""});
  }
}
