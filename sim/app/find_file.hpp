// pure but for the disk: boards, scenes and plans by name.
#pragma once

#include <filesystem>
#include <string>

#include "hal/base/result.hpp"

namespace raysteer::sim::app {

/// A path to a file, or the name of one of ours: "step" is
/// <share>/scenes/step.toml, where <share> is what was installed beside this
/// program, or the source tree that it was built in. `kind`: "boards",
/// "scenes", "plans". kFileMissing lists the names there are.
Result<std::filesystem::path> find_file(const std::string& kind, const std::string& name);

/// The whole file. kFileMissing, kFileUnreadable.
Result<std::string> read_text(const std::filesystem::path& file);

}  // namespace raysteer::sim::app
