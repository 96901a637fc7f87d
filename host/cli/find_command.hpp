// pure: which command do the first words name?
#pragma once

#include <string>
#include <vector>

#include "hal/base/result.hpp"
#include "host/cli/commands.hpp"

namespace raysteer::host::cli {

/// What a command line begins with. Exactly one of `command` and `group` is set, or none for `raysteer` alone.
struct Found {
  const CommandRow* command = nullptr;
  const GroupRow* group = nullptr;
  std::vector<std::string> rest;  ///< words that are not the command's name: options and arguments
};

/// Flags may stand before the command ("raysteer --json scan ..."). Errors: kUsage with the nearest command.
Result<Found> find_command(const CommandTable& table, const std::vector<std::string>& words);

}  // namespace raysteer::host::cli
