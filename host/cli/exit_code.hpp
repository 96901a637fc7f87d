// value: what the process returns. The one place where errors and verdicts become exit codes (docs/cli.md).
#pragma once

#include <span>
#include <string_view>

#include "hal/base/rcode.hpp"

namespace raysteer::host::cli {

/// Numbers scripts rely on; one is never given another meaning. 6, 7 and 9 wait for commands that talk to a rig.
enum class ExitCode : int {
  kDone = 0,         ///< done, or nothing to do
  kFailed = 1,       ///< bad input, or the computation failed
  kUsage = 2,        ///< the command line was not understood
  kNotFound = 3,     ///< a file, frame or code is not there
  kRefused = 4,      ///< not allowed: permissions, a path outside, somebody else's output folder
  kVerdictRedo = 5,  ///< carried out, but the verdict is 'redo', or a check did not pass
  kRolledBack = 6,   ///< the old state runs
  kTimedOut = 7,     ///< no answer in time
  kCancelled = 8,    ///< Ctrl-C or a termination signal; nothing half-written is left
  kDeviceFault = 9,  ///< a device fault is latched
};

ExitCode exit_code(RCode rcode);

struct ExitCodeRow {
  ExitCode code;
  std::string_view meaning;
};

/// All codes in rising order, with one sentence each (docs/cli.md and the man page are made from it).
std::span<const ExitCodeRow> all_exit_codes();

}  // namespace raysteer::host::cli
