#include "host/cli/run.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <utility>

#include "host/cli/cancel.hpp"
#include "host/cli/complete.hpp"
#include "host/cli/find_command.hpp"
#include "host/cli/help.hpp"
#include "host/cli/output_folder.hpp"
#include "host/cli/parse.hpp"
#include "host/cli/progress.hpp"
#include "host/exchange/write_file.hpp"

namespace raysteer::host::cli {
namespace {

// A terminal that understands colours, unless told otherwise (https://no-color.org).
bool colours(const std::string& when, int file) {
  if (when != "auto") {
    return when == "always";
  }
  const char* no_color = std::getenv("NO_COLOR");
  const char* term = std::getenv("TERM");
  return ::isatty(file) != 0 && (no_color == nullptr || *no_color == '\0') && term != nullptr &&
         std::string_view(term) != "dumb";
}

ExitCode report(const Error& error, const CommonOptions& options) {
  const Explanation& row = explain(error.rcode);
  const std::string code = to_string(error.rcode);
  if (options.json) {
    Json object;
    object["error"] = {{"code", code}, {"message", error.message()}, {"remedy", row.remedy}};
    fmt::print("{}\n", object.dump(2, ' ', false, Json::error_handler_t::replace));
    std::fflush(stdout);
  } else {
    const bool bright = colours(options.color, STDERR_FILENO);
    fmt::print(stderr, "{}error[{}]:{} {}\ncause: {}\nremedy: {}\n", bright ? "\033[1;31m" : "", code,
               bright ? "\033[0m" : "", error.message(), row.cause, row.remedy);
    if (options.verbose) {
      fmt::print(stderr, "raised at {}:{}\n", error.file, error.line);
    }
  }
  return exit_code(error.rcode);
}

// Everything printed must have arrived: a full disk behind '>' is an error, a reader that left is none.
Status print_all(std::string_view text) {
  errno = 0;
  if ((std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) && errno != EPIPE) {
    return exchange::write_error("standard output", errno);
  }
  return ok();
}

Result<ExitCode> run_guarded(Command& command, Context& context) {
  try {
    return command.run(context);
  } catch (const std::exception& exception) {
    return fail(RCode::kInternal, exception.what());
  }
}

Result<ExitCode> run_command(Command& command, const CommonOptions& options) {
  std::optional<OutputFolder> out;
  if (!options.out.empty()) {
    Result<OutputFolder> made = OutputFolder::make(options.out);
    RAYSTEER_TRY(made);
    out.emplace(*std::move(made));
  }
  const bool draws = !options.quiet && ::isatty(STDERR_FILENO) != 0;
  Progress progress(draws ? STDERR_FILENO : -1, [] { return std::chrono::steady_clock::now().time_since_epoch(); });
  Context context(options, out ? &*out : nullptr, progress);
  const Result<ExitCode> result = run_guarded(command, context);
  progress.clear();
  RAYSTEER_TRY(result);
  RAYSTEER_TRY(Context::poll());
  if (out) {
    RAYSTEER_TRY(out->commit());
  }
  RAYSTEER_TRY(print_all(options.json ? context.json().dump(2, ' ', false, Json::error_handler_t::replace) + "\n"
                                      : context.text()));
  return result;
}

ExitCode print_help(const std::string& text, bool asked) {
  if (!asked) {
    std::fputs(text.c_str(), stderr);
    return ExitCode::kUsage;
  }
  if (const Status printed = print_all(text); !printed) {
    return report(printed.error(), {});
  }
  return ExitCode::kDone;
}

bool has(const std::vector<std::string>& words, std::initializer_list<std::string_view> wanted) {
  return std::ranges::any_of(words,
                             [&](const std::string& word) { return std::ranges::find(wanted, word) != wanted.end(); });
}

}  // namespace

int run(const CommandTable& table, std::vector<std::string> arguments) {
  listen_for_signals();
  if (!arguments.empty() && arguments.front() == "__complete") {  // what the shells' adaptors call
    for (const std::string& line : complete(table, {arguments.begin() + 1, arguments.end()})) {
      fmt::print("{}\n", line);
    }
    return static_cast<int>(ExitCode::kDone);
  }
  CommonOptions early;  // how to print errors before options are parsed
  early.json = has(arguments, {"--json"});
  const Result<Found> found = find_command(table, arguments);
  if (!found) {
    return static_cast<int>(report(found.error(), early));
  }
  const bool wants_help = has(found->rest, {"-h", "--help"});
  if (found->command == nullptr) {
    if (has(found->rest, {"--version"})) {
      return static_cast<int>(print_help("raysteer " RAYSTEER_VERSION "\n", true));
    }
    if (!wants_help && !found->rest.empty()) {
      const Error error = fail(RCode::kUsage, "'" + found->rest.front() + "' needs a command before it");
      return static_cast<int>(report(error, early));
    }
    return static_cast<int>(
        print_help(found->group != nullptr ? help_of_group(table, *found->group) : help_of_program(table), wants_help));
  }
  const std::unique_ptr<Command> command = found->command->make();
  const std::unique_ptr<Declared> declared = declare(*command);
  if (const Status parsed = parse(declared->options, declared->help, found->rest); !parsed) {
    return static_cast<int>(
        report(with_context(parsed.error(), "raysteer " + std::string(found->command->path)), early));
  }
  if (declared->help) {
    return static_cast<int>(
        print_help(help_of_command(found->command->path, command->manual(), declared->options), true));
  }
  const Result<ExitCode> result = run_command(*command, declared->common);
  return static_cast<int>(result ? *result : report(result.error(), declared->common));
}

}  // namespace raysteer::host::cli
