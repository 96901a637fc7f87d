// raysteer help: the help of a command, or the manual page.
#include <string>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/find_command.hpp"
#include "host/cli/help.hpp"
#include "host/cli/manual.hpp"

namespace raysteer::host::cli {
namespace {

class Help : public Command {
 public:
  Manual manual() const override {
    return {.summary = "Print the help of a command, or the manual page",
            .description = "",
            .example = "raysteer help scan\nraysteer help --man | man -l -",
            .has_json = false};
  }

  void declare(Options& options) override {
    options.argument("COMMAND", &words_, "whose help").is_required = false;
    options.flag("--man", man_, "print the manual page, raysteer(1)");
  }

  Result<ExitCode> run(Context& context) override {
    const CommandTable& table = all_commands();
    if (man_) {
      context.print(man_page(table));
      return ExitCode::kDone;
    }
    const Result<Found> found = find_command(table, words_);
    RAYSTEER_TRY(found);
    if (found->command != nullptr) {
      const std::unique_ptr<Command> command = found->command->make();
      const std::unique_ptr<Declared> declared = cli::declare(*command);
      context.print(help_of_command(found->command->path, command->manual(), declared->options));
    } else {
      context.print(found->group != nullptr ? help_of_group(table, *found->group) : help_of_program(table));
    }
    return ExitCode::kDone;
  }

 private:
  std::vector<std::string> words_;
  bool man_ = false;
};

}  // namespace

std::unique_ptr<Command> help() { return std::make_unique<Help>(); }

}  // namespace raysteer::host::cli
