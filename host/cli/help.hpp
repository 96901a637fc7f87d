// pure: the text of --help, from the same lists that parsing uses.
#pragma once

#include <string>
#include <string_view>

#include "host/cli/commands.hpp"

namespace raysteer::host::cli {

/// `raysteer --help`
std::string help_of_program(const CommandTable& table);
/// `raysteer session --help`
std::string help_of_group(const CommandTable& table, const GroupRow& group);
/// `raysteer scan --help`; `options` with the common ones
std::string help_of_command(std::string_view path, const Manual& manual, const Options& options);
/// "raysteer scan [options] SESSION --calibration FILE"
std::string usage_of_command(std::string_view path, const Options& options);

/// A command's own options and the common ones, for everything that walks the tree. `command` and the returned object
/// must outlive the use of the list.
struct Declared {
  CommonOptions common;
  bool help = false;
  Options options;
};
std::unique_ptr<Declared> declare(Command& command);

}  // namespace raysteer::host::cli
