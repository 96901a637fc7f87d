// The visible table of all commands.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "host/cli/command.hpp"

namespace raysteer::host::cli {

struct CommandRow {
  std::string_view path;  ///< "session check"
  std::unique_ptr<Command> (*make)();
};

/// A noun that groups commands: "session" of "session check".
struct GroupRow {
  std::string_view name;
  std::string_view summary;
};

/// In the order of --help.
struct CommandTable {
  std::span<const CommandRow> commands;
  std::span<const GroupRow> groups;
};

/// All commands of the program.
const CommandTable& all_commands();

// One function a command, each defined in the file of its name.
std::unique_ptr<Command> bake();
std::unique_ptr<Command> verify();
std::unique_ptr<Command> completion();
std::unique_ptr<Command> calibrate_cameras();
std::unique_ptr<Command> calibrate_projector();
std::unique_ptr<Command> calibrate_rig();
std::unique_ptr<Command> capture();
std::unique_ptr<Command> explain();
std::unique_ptr<Command> help();
std::unique_ptr<Command> plan_looks();
std::unique_ptr<Command> report();
std::unique_ptr<Command> scan();
std::unique_ptr<Command> sim();
std::unique_ptr<Command> session_check();
std::unique_ptr<Command> session_info();
std::unique_ptr<Command> session_render();
std::unique_ptr<Command> target_print();

}  // namespace raysteer::host::cli
