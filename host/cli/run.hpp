// Runs one command line: finds the command, parses, guards --out, prints result or error, returns the exit code.
#pragma once

#include <string>
#include <vector>

#include "host/cli/commands.hpp"

namespace raysteer::host::cli {

/// `arguments` without the program's name. Prints to standard output and standard error.
int run(const CommandTable& table, std::vector<std::string> arguments);

}  // namespace raysteer::host::cli
