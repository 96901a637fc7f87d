// pure but for the disk: where raysteer-sim finds boards and plans; the laptop reads drawings and poses from them.
#pragma once

#include <filesystem>
#include <string>

#include "hal/base/result.hpp"

namespace raysteer::host::sim {

/// A file, or one of ours by its name, as raysteer-sim looks for it: in share/raysteer/KIND beside the program's
/// folder, or in KIND/ in a folder above it. `kind`: "boards", "plans". kFileMissing.
Result<std::filesystem::path> find_file(const std::string& kind, const std::string& name);

}  // namespace raysteer::host::sim
