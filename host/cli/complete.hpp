// pure: what could stand at the end of a half-typed command line.
#pragma once

#include <string>
#include <vector>

#include "host/cli/commands.hpp"

namespace raysteer::host::cli {

/// `words` after the program's name; the last one is being typed and may be empty. Each line is a word, a tab and what
/// it is; or the one line ":files" or ":dirs" where the shell knows better.
std::vector<std::string> complete(const CommandTable& table, const std::vector<std::string>& words);

}  // namespace raysteer::host::cli
