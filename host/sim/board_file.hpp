// pure but for the disk: where raysteer-sim finds a board, for the laptop's half of a calibration to read the drawings.
#pragma once

#include <filesystem>
#include <string>

#include "hal/base/result.hpp"

namespace raysteer::host::sim {

/// A file, or one of ours by its name, as raysteer-sim looks for it: share/raysteer/boards beside the program's folder,
/// or boards/ in a folder above it. kFileMissing.
Result<std::filesystem::path> board_file(const std::string& board);

}  // namespace raysteer::host::sim
