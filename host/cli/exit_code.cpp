#include "host/cli/exit_code.hpp"

#include <array>

namespace raysteer::host::cli {

ExitCode exit_code(RCode rcode) {
  if (rcode == RCode::kUsage) {
    return ExitCode::kUsage;
  }
  switch (explain(rcode).code) {
    case ErrorCode::kNotFound:
      return ExitCode::kNotFound;
    case ErrorCode::kPermissionDenied:
    case ErrorCode::kUnauthenticated:
    case ErrorCode::kAlreadyExists:
      return ExitCode::kRefused;
    case ErrorCode::kDeadlineExceeded:
      return ExitCode::kTimedOut;
    case ErrorCode::kCancelled:
      return ExitCode::kCancelled;
    case ErrorCode::kUnknown:
    case ErrorCode::kInvalidArgument:
    case ErrorCode::kResourceExhausted:
    case ErrorCode::kFailedPrecondition:
    case ErrorCode::kAborted:
    case ErrorCode::kOutOfRange:
    case ErrorCode::kUnimplemented:
    case ErrorCode::kInternal:
    case ErrorCode::kUnavailable:
    case ErrorCode::kDataLoss:
      break;
  }
  return ExitCode::kFailed;
}

std::span<const ExitCodeRow> all_exit_codes() {
  static constexpr std::array kRows{
      ExitCodeRow{ExitCode::kDone, "done, or nothing to do"},
      ExitCodeRow{ExitCode::kFailed, "failed: bad input, or the computation failed"},
      ExitCodeRow{ExitCode::kUsage, "the command line was not understood"},
      ExitCodeRow{ExitCode::kNotFound, "a file, a frame or a code was not found"},
      ExitCodeRow{ExitCode::kRefused, "refused: permissions, a path outside, or somebody else's output folder"},
      ExitCodeRow{ExitCode::kVerdictRedo, "carried out, but the verdict is 'redo' or a check did not pass"},
      ExitCodeRow{ExitCode::kRolledBack, "rolled back, the old state runs (reserved)"},
      ExitCodeRow{ExitCode::kTimedOut, "timed out (reserved)"},
      ExitCodeRow{ExitCode::kCancelled, "cancelled by Ctrl-C or a termination signal; nothing half-written is left"},
      ExitCodeRow{ExitCode::kDeviceFault, "a device fault is latched (reserved)"},
  };
  return kRows;
}

}  // namespace raysteer::host::cli
