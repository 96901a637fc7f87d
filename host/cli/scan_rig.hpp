// raysteer scan --rig: all looks of a steered rig's session become one surface.
#pragma once

#include <string>
#include <vector>

#include "hal/base/result.hpp"
#include "host/cli/context.hpp"
#include "host/cli/exit_code.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::cli {

struct ScanRigRequest {
  std::string session;               ///< path as the user gave it
  std::string rig;                   ///< likewise: calibration of the rig, or its folder
  std::vector<std::string> looks;    ///< by name; empty: all
  std::vector<std::string> without;  ///< by name
};

/// Prints, fills the context's JSON, and writes surface.ply, surface.png, result.json and report.html into its folder.
Result<ExitCode> scan_rig(Context& context, const session::Session& session, const ScanRigRequest& request);

}  // namespace raysteer::host::cli
