// pure: the manual page, from the same lists that parsing and --help use; docs/errors.md from the codes.
#pragma once

#include <string>

#include "host/cli/commands.hpp"

namespace raysteer::host::cli {

/// raysteer(1) in man(7) macros.
std::string man_page(const CommandTable& table);

/// docs/errors.md
std::string errors_markdown();

}  // namespace raysteer::host::cli
