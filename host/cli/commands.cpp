#include "host/cli/commands.hpp"

#include <array>

namespace raysteer::host::cli {

const CommandTable& all_commands() {
  // clang-format off: one row a line
  static constexpr std::array kCommands{
      CommandRow{"capture", capture},
      CommandRow{"session check", session_check},
      CommandRow{"session info", session_info},
      CommandRow{"session render", session_render},
      CommandRow{"calibrate cameras", calibrate_cameras},
      CommandRow{"calibrate projector", calibrate_projector},
      CommandRow{"calibrate rig", calibrate_rig},
      CommandRow{"plan looks", plan_looks},
      CommandRow{"scan", scan},
      CommandRow{"bake", bake},
      CommandRow{"verify", verify},
      CommandRow{"report", report},
      CommandRow{"target print", target_print},
      CommandRow{"sim", sim},
      CommandRow{"explain", explain},
      CommandRow{"help", help},
      CommandRow{"completion", completion},
  };
  // clang-format on
  static constexpr std::array kGroups{
      GroupRow{"session", "Look at recorded sessions"},
      GroupRow{"calibrate", "Solve cameras, projector and mirror from a session"},
      GroupRow{"plan", "Plan captures"},
      GroupRow{"target", "Calibration boards"},
  };
  static constexpr CommandTable kTable{kCommands, kGroups};
  return kTable;
}

}  // namespace raysteer::host::cli
